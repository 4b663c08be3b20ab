#include "image/image.h"
#include "test.h"

#include <float.h>

static const enum tone_curve tones[] = {TONE_NONE, TONE_REINHARD, TONE_ACES, TONE_AGX};
enum { TONES = sizeof tones / sizeof tones[0] };

// Converts all codes by IEC 61966-2-1 and back, and compares some with values computed by hand.
TEST(srgb_transfer)
{
    CHECK(image_srgb_from_linear(0) == 0 && image_srgb_from_linear(1) == 1);
    CHECK(fabsf(image_srgb_from_linear(0.18f) - 0.4613561f) < 1e-6f, "%.8g",
          (double)image_srgb_from_linear(0.18f));
    CHECK(fabsf(image_srgb_from_linear(0.002f) - 0.02584f) < 1e-7f);
    CHECK(fabsf(image_srgb_to_linear(0.5f) - 0.2140411f) < 1e-6f);
    for (int code = 0; code < 256; code++) {
        float linear = image_srgb_to_linear((float)code / 255.0f);
        CHECK(image_quantize(image_srgb_from_linear(linear)) == code, "%d", code);
    }
}

TEST(quantize_rounds_to_nearest)
{
    CHECK(image_quantize(0) == 0 && image_quantize(1) == 255);
    CHECK(image_quantize(0.4999f / 255) == 0 && image_quantize(0.5001f / 255) == 1);
    CHECK(image_quantize(0.5f) == 128);
}

TEST(zero_is_black_and_white_is_not_passed)
{
    const float black[3] = {0, 0, 0}, bright[3] = {FLT_MAX, FLT_MAX, FLT_MAX};
    for (int i = 0; i < TONES; i++) {
        float out[3];
        image_tone_map(tones[i], 0, black, out);
        CHECK(out[0] == 0 && out[1] == 0 && out[2] == 0, "tone %d: %g", i, (double)out[0]);
        image_tone_map(tones[i], 0, bright, out);
        CHECK(out[0] > 0.999f && out[0] <= 1, "tone %d: %g", i, (double)out[0]);
    }
}

TEST(curves_match_hand_values)
{
    const float grey[3] = {1, 1, 1}, colour[3] = {4, 1, 0};
    float out[3];
    image_tone_map(TONE_NONE, -1, grey, out);
    CHECK(out[0] == image_srgb_from_linear(0.5f));
    image_tone_map(TONE_REINHARD, 0, grey, out);
    CHECK(fabsf(out[0] - image_srgb_from_linear(0.5f)) < 1e-6f);
    image_tone_map(TONE_REINHARD, 0, colour, out);
    float scale = 1 / (1 + 0.2126f * 4 + 0.7152f);
    CHECK(out[0] == 1 && fabsf(out[1] - image_srgb_from_linear(scale)) < 1e-6f && out[2] == 0);
    image_tone_map(TONE_ACES, 0, grey, out);
    CHECK(fabsf(out[0] - image_srgb_from_linear(2.54f / 3.16f)) < 1e-6f);
    // The curve must not change middle grey.
    const float middle[3] = {0.18f, 0.18f, 0.18f};
    image_tone_map(TONE_AGX, 0, middle, out);
    for (int c = 0; c < 3; c++)
        CHECK(fabsf(out[c] - image_srgb_from_linear(0.18f)) < 1e-5f, "%g", (double)out[c]);
    // The limits of the logarithm's range: 10 stops below and 6.5 above.
    const float end[3] = {16.3f, 16.3f, 16.3f}, start[3] = {1.7e-4f, 1.7e-4f, 1.7e-4f};
    image_tone_map(TONE_AGX, 0, end, out);
    CHECK(out[0] == 1, "%.9g", (double)out[0]);
    image_tone_map(TONE_AGX, 0, start, out);
    CHECK(out[0] == 0, "%.9g", (double)out[0]);
}

// Computes the share of white in each primary from the chromaticities of ITU-R BT.709-6, table 1:
// white is their mean weighted by X + Y + Z (barycentric coordinates). Pure primaries show it
// directly.
TEST(agx_inset_follows_from_the_primaries)
{
    const double red[2] = {0.64, 0.33}, green[2] = {0.30, 0.60}, blue[2] = {0.15, 0.06};
    const double white[2] = {0.3127, 0.3290};
    double area =
        (red[0] - blue[0]) * (green[1] - blue[1]) - (green[0] - blue[0]) * (red[1] - blue[1]);
    double share = ((white[0] - blue[0]) * (green[1] - blue[1]) -
                    (green[0] - blue[0]) * (white[1] - blue[1])) /
                   area;
    // Red with radiance x gives green .2 share x, like grey of that value.
    float value = 1, leak = (float)(0.2 * share);
    const float pure[3] = {value, 0, 0}, equal[3] = {leak, leak, leak};
    float out[3], expected[3];
    image_tone_map(TONE_AGX, 0, pure, out);
    image_tone_map(TONE_AGX, 0, equal, expected);
    CHECK(fabsf(out[1] - expected[1]) < 1e-5f, "%g, expected %g", (double)out[1],
          (double)expected[1]);
    CHECK(out[1] == out[2] && out[0] > out[1]);
}

// More light in a channel never makes that channel darker, whatever the other channels are.
TEST(monotone_in_every_channel)
{
    static const float others[] = {0, 0.01f, 0.18f, 1, 40, 1e6f};
    for (int i = 0; i < TONES; i++)
        for (int channel = 0; channel < 3; channel++)
            for (size_t k = 0; k < sizeof others / sizeof others[0]; k++) {
                float last = 0;
                for (int step = 0; step <= 4000; step++) {
                    float rgb[3] = {others[k], others[k], others[k]}, out[3];
                    rgb[channel] = exp2f((float)step / 100 - 20);
                    image_tone_map(tones[i], 0, rgb, out);
                    REQUIRE(out[channel] >= last && out[channel] <= 1,
                            "tone %d, channel %d, others %g: %.9g after %.9g at %g", i, channel,
                            (double)others[k], (double)out[channel], (double)last,
                            (double)rgb[channel]);
                    last = out[channel];
                }
            }
}

TEST(never_out_of_range)
{
    static const float values[] = {NAN,     INFINITY, -INFINITY, -1,    -0.0f,    0,
                                   FLT_MAX, FLT_MIN,  1e-40f,    0.18f, -FLT_MAX, 1};
    enum { COUNT = sizeof values / sizeof values[0] };
    static const float stops[] = {0, 30, -30, 2000, -2000};
    for (int i = 0; i < TONES; i++)
        for (int k = 0; k < COUNT * COUNT * 5; k++) {
            const float rgb[3] = {values[k % COUNT], values[k / COUNT % COUNT], values[k % 7]};
            float out[3];
            image_tone_map(tones[i], stops[k / (COUNT * COUNT)], rgb, out);
            for (int c = 0; c < 3; c++)
                CHECK(out[c] >= 0 && out[c] <= 1, "tone %d of %g %g %g: %g", i, (double)rgb[0],
                      (double)rgb[1], (double)rgb[2], (double)out[c]);
        }
}

TEST_MAIN(TEST_CASE(srgb_transfer), TEST_CASE(quantize_rounds_to_nearest),
          TEST_CASE(zero_is_black_and_white_is_not_passed), TEST_CASE(curves_match_hand_values),
          TEST_CASE(agx_inset_follows_from_the_primaries), TEST_CASE(monotone_in_every_channel),
          TEST_CASE(never_out_of_range))
