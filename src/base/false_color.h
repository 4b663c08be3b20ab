// The scale of colours that numbers are shown in.
#ifndef LAMPYRIS_BASE_FALSE_COLOR_H
#define LAMPYRIS_BASE_FALSE_COLOR_H

// Of a level in [0, 1], in linear Rec. 709: black, violet, red, orange, pale yellow. Lightness
// rises evenly, so that the colours keep their order in shades of grey, too.
void false_color(double level, double out[3]);

#endif
