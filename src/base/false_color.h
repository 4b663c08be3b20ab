// The colour scale for displaying numbers.
#ifndef LAMPYRIS_BASE_FALSE_COLOR_H
#define LAMPYRIS_BASE_FALSE_COLOR_H

// Computes the colour of a level in [0, 1], in linear Rec. 709: black, violet, red, orange, pale
// yellow. Lightness increases evenly, so that the order is also visible in shades of grey.
void false_color(double level, double out[3]);

#endif
