#include "image/image.h"
#include "test.h"

#include <math.h>

enum { SIDE = 40, PIXELS = SIDE * SIDE };

static float pixels[PIXELS][3];

static float measure(void)
{
    const struct image image = {SIDE, SIDE, pixels};
    return image_measure_exposure(&image);
}

static void fill(float value)
{
    for (int i = 0; i < PIXELS; i++)
        for (int c = 0; c < 3; c++)
            pixels[i][c] = value;
}

static void set(int i, float value)
{
    for (int c = 0; c < 3; c++)
        pixels[i][c] = value;
}

// A constant image is exposed to 0.5, whatever its value is.
TEST(even_pictures)
{
    for (int stops = -140; stops <= 120; stops += 10) {
        fill(ldexpf(1.0f, stops));
        CHECK(fabs((double)measure() + stops + 1) <= 1.0 / 64, "2^%d: %g", stops,
              (double)measure());
    }
    fill(0);
    CHECK(measure() == 0);
}

// One pixel in twenty may have any brightness; one more changes the exposure.
TEST(lamps_do_not_count)
{
    fill(0.25f);
    for (int i = 0; i < PIXELS / 20; i++)
        set(i * 7, 1e20f);
    CHECK(fabs((double)measure() - 1) <= 1.0 / 64, "%g", (double)measure());
    set(3, 1e20f);
    CHECK(measure() < -60, "%g", (double)measure());
}

TEST(pixels_without_light_do_not_count)
{
    fill(0);
    for (int i = 0; i < 40; i++)
        set(i, i < 2 ? INFINITY : 4.0f);
    set(39, NAN);
    CHECK(fabs((double)measure() + 3) <= 1.0 / 64, "%g", (double)measure());
}

TEST(the_order_does_not_count)
{
    for (int i = 0; i < PIXELS; i++)
        set(i, 0.001f * (float)(1 + i * 37 % PIXELS));
    float before = measure();
    for (int i = 0; i < PIXELS; i++)
        set(i, 0.001f * (float)(1 + i * 91 % PIXELS));
    // 91 has no common divisor with 2 and 5, so this permutes the pixels.
    CHECK(measure() == before, "%g %g", (double)measure(), (double)before);
}

TEST_MAIN(TEST_CASE(even_pictures), TEST_CASE(lamps_do_not_count),
          TEST_CASE(pixels_without_light_do_not_count), TEST_CASE(the_order_does_not_count))
