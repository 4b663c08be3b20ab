#include "base/false_color.h"

#include <math.h>
#include <stdbool.h>

// Converts a colour of Oklab (Ottosson 2020, "A perceptual color space for image processing") to
// linear Rec. 709.
static void rgb_of_oklab(double lightness, double a, double b, double out[3])
{
    double l = lightness + 0.3963377774 * a + 0.2158037573 * b;
    double m = lightness - 0.1055613458 * a - 0.0638541728 * b;
    double s = lightness - 0.0894841775 * a - 1.2914855480 * b;
    l = l * l * l;
    m = m * m * m;
    s = s * s * s;
    out[0] = 4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s;
    out[1] = -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s;
    out[2] = -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s;
}

static bool is_shown(const double rgb[3])
{
    bool ok = true;
    for (int c = 0; c < 3; c++)
        ok = ok && rgb[c] >= 0 && rgb[c] <= 1;
    return ok;
}

// Lightness increases evenly. The hue traverses half of the circle, from violet through red to
// yellow. The chroma is greatest in the middle and is reduced to the gamut of displays.
void false_color(double level, double out[3])
{
    double lightness = 0.97 * level, hue = (285 + 180 * level) * M_PI / 180;
    double chroma = 0.165 * pow(sin(M_PI * pow(level, 0.85)), 0.8) + 0.05 * level;
    double low = 0, high = 2; // bisection: the first value tried is 1
    for (int i = 0; i < 40 && low < 1; i++) {
        double share = 0.5 * (low + high);
        rgb_of_oklab(lightness, share * chroma * cos(hue), share * chroma * sin(hue), out);
        *(is_shown(out) ? &low : &high) = share;
    }
    low = fmin(low, 1);
    rgb_of_oklab(lightness, low * chroma * cos(hue), low * chroma * sin(hue), out);
}
