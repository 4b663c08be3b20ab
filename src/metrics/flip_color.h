// The colour spaces of FLIP, from linear Rec. 709 (Andersson et al. 2020).
#ifndef LAMPYRIS_METRICS_FLIP_COLOR_H
#define LAMPYRIS_METRICS_FLIP_COLOR_H

// Opponent colours in which contrast sensitivity is known: linear in X, Y, Z.
void flip_ycxcz_of_rgb(const double rgb[3], double out[3]);
void flip_rgb_of_ycxcz(const double ycxcz[3], double out[3]);

// CIE L*a*b*, chroma scaled by lightness after Hunt (1952).
void flip_hunt_lab(const double rgb[3], double out[3]);
// The distance for large colour differences (Abasi, Tehran, Fairchild 2020).
double flip_hyab(const double a[3], const double b[3]);

double flip_luminance(const double rgb[3]); // Y of CIE XYZ; 1 of white

#endif
