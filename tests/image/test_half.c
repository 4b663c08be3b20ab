#include "image/image_internal.h"
#include "test.h"

static double half_value(uint16_t half)
{
    int exponent = half >> 10 & 31, fraction = half & 0x3ff;
    double magnitude = exponent == 0 ? ldexp(fraction, -24) : ldexp(fraction + 1024, exponent - 25);
    return half & 0x8000 ? -magnitude : magnitude;
}

TEST(every_half_is_itself)
{
    for (uint32_t half = 0; half < 0x10000; half++)
        if ((half & 0x7c00) != 0x7c00)
            CHECK(half_from_float((float)half_value((uint16_t)half)) == half &&
                      float_from_half((uint16_t)half) == (float)half_value((uint16_t)half),
                  "%04x", half);
    CHECK(signbit(float_from_half(0x8000)) && !signbit(float_from_half(0)));
    CHECK(float_from_half(0x7c00) == INFINITY && float_from_half(0xfc00) == -INFINITY);
    CHECK(isnan(float_from_half(0x7c01)) && isnan(float_from_half(0xfe00)));
}

// Values between two neighbours become the nearer one, and in the middle the even one.
TEST(rounds_to_nearest_even)
{
    for (uint16_t half = 0; half < 0x7bff; half++) {
        double low = half_value(half), high = half_value((uint16_t)(half + 1));
        float middle = (float)(0.5 * (low + high)); // exact with 11 or 12 bits
        uint16_t even = half & 1 ? (uint16_t)(half + 1) : half;
        CHECK(half_from_float(middle) == even, "%04x", half);
        CHECK(half_from_float(nextafterf(middle, 0)) == half, "%04x", half);
        CHECK(half_from_float(nextafterf(middle, 1e9f)) == half + 1, "%04x", half);
        CHECK(half_from_float(-middle) == (even | 0x8000), "%04x", half);
    }
}

TEST(extremes)
{
    CHECK(half_from_float(65504) == 0x7bff && half_from_float(65519.996f) == 0x7bff);
    CHECK(half_from_float(65520) == 0x7bff && half_from_float(3e38f) == 0x7bff);
    CHECK(half_from_float(-3e38f) == 0xfbff);
    CHECK(half_from_float(INFINITY) == 0x7c00 && half_from_float(-INFINITY) == 0xfc00);
    CHECK((half_from_float(NAN) & 0x7fff) > 0x7c00);
    CHECK(half_from_float(0x1p-149f) == 0 && half_from_float(-0.0f) == 0x8000);
}

TEST_MAIN(TEST_CASE(every_half_is_itself), TEST_CASE(rounds_to_nearest_even), TEST_CASE(extremes))
