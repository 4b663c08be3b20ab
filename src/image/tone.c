// From linear radiance to display values: tone curves and the sRGB encoding.
#include "image/image.h"

#include "base/maths.h"
#include <float.h>
#include <math.h>

// Encodes sRGB (IEC 61966-2-1, 5.2), as the inverse of image_srgb_to_linear(). The linear segments
// of both functions end at corresponding values.
float image_srgb_from_linear(float linear)
{
    if (linear <= 0.0031308f)
        return 12.92f * linear;
    return (float)(1.055 * pow(linear, 1 / 2.4) - 0.055);
}

// Decodes sRGB (IEC 61966-2-1, 5.3).
float image_srgb_to_linear(float encoded)
{
    if (encoded <= 0.04045f)
        return encoded / 12.92f;
    return (float)pow((encoded + 0.055) / 1.055, 2.4);
}

uint8_t image_quantize(float display)
{
    return (uint8_t)(display * 255.0f + 0.5f);
}

// Replaces negative values and NaN by 0, and infinity by the greatest float. The result is a
// double, because the curves square it.
static double clean(double value)
{
    return value > 0 ? fmin(value, FLT_MAX) : 0;
}

// Applies the curve of Reinhard, Stark, Shirley, Ferwerda 2002, "Photographic tone reproduction for
// digital images", equation 3, L / (1 + L), to the luminance. A saturated colour can exceed 1 in a
// channel and is clamped.
static void reinhard(double rgb[3])
{
    double divisor = 1 + vec3_luminance(rgb);
    for (int c = 0; c < 3; c++)
        rgb[c] /= divisor;
}

// Applies the curve of Narkowicz 2015, "ACES filmic tone mapping curve", a rational fit of the ACES
// reference rendering and sRGB output transforms, applied to each channel. It tends to 2.51 / 2.43
// and is clamped at 1.
static double aces(double x)
{
    return x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14);
}

// The approach of Sobotka's AgX (2019-2022): move the primaries towards white so that bright
// saturated colours become white instead of clipping, take the logarithm, and shape it by a sigmoid
// through middle grey. The numbers are this program's own.
//
// The inset moves each Rec. 709 primary's chromaticity a share k = 20 % of its way to the white
// point D65. With S the sum X + Y + Z of the tristimulus values of a primary or of white, primary j
// becomes (1 - k) XYZ_j + k S_j / S_white XYZ_white, and the matrix on RGB is (1 - k) I + k 1 s^T
// with s_j = S_j / S_white. All its entries are positive, so every output grows with every input.
// AgX's later versions undo the inset after the curve; this one does not, because the inverse has
// negative entries and a channel could then fall while its input rises.
static const double agx_inset = 0.2;
// S_j / S_white of ITU-R BT.709-6, table 1, from its chromaticities; a test derives these numbers
// again.
static const double agx_white_share[3] = {0.2119946452, 0.3921508255, 0.3958545292};

// Stops below and above middle grey that the logarithm covers, as in AgX.
static const double agx_stops_below = 10, agx_stops_above = 6.5;
static const double agx_middle_grey = 0.18;
// The sigmoid works on values encoded by a power of 1 / 2.2. Its slope there is 2.4, and both ends
// bend with exponent 1.5, as in AgX.
static const double agx_power = 2.2, agx_slope = 2.4, agx_bend = 1.5;

// A half of the sigmoid: rises from 0 with the slope agx_slope and reaches `height` at `length`.
// With q = slope length, g(u) = u / (1 + u^p)^(1/p) is scaled to s g(slope x / s); solving s g(q /
// s) = height for s gives s = q / ((q / height)^p - 1)^(1/p).
static double agx_half_sigmoid(double x, double length, double height)
{
    double q = agx_slope * length;
    double scale = q / pow(pow(q / height, agx_bend) - 1, 1 / agx_bend);
    double u = agx_slope * x / scale;
    return scale * u / pow(1 + pow(u, agx_bend), 1 / agx_bend);
}

// Maps a linear value to a linear display value.
static double agx_curve(double value)
{
    const double pivot = agx_stops_below / (agx_stops_below + agx_stops_above);
    const double grey = pow(agx_middle_grey, 1 / agx_power);
    double stops = log2(value / agx_middle_grey); // -inf for 0, which fmax() below replaces
    double x = fmin(fmax((stops + agx_stops_below) / (agx_stops_below + agx_stops_above), 0), 1);
    double y = x < pivot ? grey - agx_half_sigmoid(pivot - x, pivot, grey)
                         : grey + agx_half_sigmoid(x - pivot, 1 - pivot, 1 - grey);
    return pow(fmax(y, 0), agx_power);
}

static void agx(double rgb[3])
{
    double white = 0;
    for (int c = 0; c < 3; c++)
        white += agx_white_share[c] * rgb[c];
    for (int c = 0; c < 3; c++)
        rgb[c] = agx_curve((1 - agx_inset) * rgb[c] + agx_inset * white);
}

void image_tone_map(enum tone_curve tone, float exposure_stops, const float rgb[3], float out[3])
{
    double gain = exp2(exposure_stops);
    double mapped[3];
    for (int c = 0; c < 3; c++)
        mapped[c] = clean(rgb[c] * gain);
    switch (tone) {
    case TONE_NONE:
        break;
    case TONE_REINHARD:
        reinhard(mapped);
        break;
    case TONE_ACES:
        for (int c = 0; c < 3; c++)
            mapped[c] = aces(mapped[c]);
        break;
    case TONE_AGX:
        agx(mapped);
        break;
    }
    for (int c = 0; c < 3; c++)
        out[c] = image_srgb_from_linear((float)fmin(mapped[c], 1));
}
