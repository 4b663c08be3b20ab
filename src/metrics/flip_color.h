// The colour spaces of FLIP (Andersson et al. 2020). Colours are linear Rec. 709.
#ifndef LAMPYRIS_METRICS_FLIP_COLOR_H
#define LAMPYRIS_METRICS_FLIP_COLOR_H

// Converts to YCxCz, opponent colours that are linear in X, Y, Z, for which contrast sensitivity is
// known.
void flip_ycxcz_of_rgb(const double rgb[3], double out[3]);
void flip_rgb_of_ycxcz(const double ycxcz[3], double out[3]);

// Converts to CIE L*a*b*, with chroma scaled by lightness after Hunt (1952).
void flip_hunt_lab(const double rgb[3], double out[3]);
// Returns the HyAB distance, a measure for large colour differences (Abasi, Tehran, Fairchild
// 2020).
double flip_hyab(const double a[3], const double b[3]);

double flip_luminance(const double rgb[3]); // Y of CIE XYZ; white has 1

#endif
