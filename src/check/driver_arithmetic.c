// Compares the driver's arithmetic with double precision. Tests what the Vulkan specification
// requires ("Precision of Individual Operations"), and what the renderer requires in addition.
#include "check/driver.h"

#include "check/case_list.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

#define ITEMS (1u << 14)

// An operation, its input and the greatest permitted error.
struct arithmetic {
    uint32_t routine;
    void (*fill)(uint64_t *state, uint32_t index, driver_item *item);
    // Returns the error of a result; more than `most` is a failure.
    double (*error)(const driver_item *in, const driver_item *out);
    double most;
    const char *unit;
    // Returns the error on devices that may round to either neighbour, for which the kernels use
    // bounds twice as wide; it may be at most 1. NULL: `error` applies to these devices, too.
    double (*error_of_any)(const driver_item *in, const driver_item *out);
};

// Returns the error in ulps of the float nearest to the exact value.
static double ulps(float value, double exact)
{
    int exponent;
    frexp(exact, &exponent);
    return fabs((double)value - exact) / ldexp(1.0, exponent - 24);
}

static double is_other(float value, float expected)
{
    return memcmp(&value, &expected, sizeof value) == 0 ? 0.0 : 1.0;
}

// --- correctly rounded operations ----------------------------------------------------------------

static void fill_floats(uint64_t *state, uint32_t index, driver_item *item)
{
    (void)index;
    for (int i = 0; i < 4; i++)
        item->f[i] = driver_random_float(state, 12);
}

// Generates sums that are exactly midway between two floats, or next to such a sum.
static void fill_ties(uint64_t *state, uint32_t index, driver_item *item)
{
    float sign = index & 1u ? -1.0f : 1.0f;
    float low = (float)(1u << 23) + (float)(driver_random(state) >> 10);
    float part = 0.5f + (float)((int)(index >> 1) % 3 - 1) * 0x1p-20f;
    item->f[0] = sign * low;
    item->f[1] = sign * part;
}

static double error_of_sum(const driver_item *in, const driver_item *out)
{
    return is_other(out->f[0], in->f[0] + in->f[1]);
}

static double error_of_product(const driver_item *in, const driver_item *out)
{
    return is_other(out->f[0], in->f[0] * in->f[1]);
}

// Returns the error of a sum that may be rounded to either neighbour.
static double either_sum(const driver_item *in, const driver_item *out)
{
    return ulps(out->f[0], (double)in->f[0] + (double)in->f[1]);
}

static double either_product(const driver_item *in, const driver_item *out)
{
    return ulps(out->f[0], (double)in->f[0] * (double)in->f[1]);
}

// Returns 0 if the sum and its rounding error are exact, and 1 otherwise. Doubles represent the
// exact results, because these operations need at most 53 bits.
static double rest_of_sum(const driver_item *in, const driver_item *out)
{
    return (double)out->f[0] + (double)out->f[1] == (double)in->f[0] + (double)in->f[1] ? 0.0 : 1.0;
}

static double rest_of_product(const driver_item *in, const driver_item *out)
{
    return (double)out->f[0] + (double)out->f[1] == (double)in->f[0] * (double)in->f[1] ? 0.0 : 1.0;
}

// Returns the error of a sum in units of 2^-46 of the operand with the greater magnitude
// (lib/double_float.glsl).
static double about_sum(const driver_item *in, const driver_item *out)
{
    double sum = (double)in->f[0] + (double)in->f[1];
    double most = fmax(fabs((double)in->f[0]), fabs((double)in->f[1]));
    return fabs((double)out->f[0] + (double)out->f[1] - sum) / (0x1p-46 * most);
}

static double about_product(const driver_item *in, const driver_item *out)
{
    double product = (double)in->f[0] * (double)in->f[1];
    return fabs((double)out->f[0] + (double)out->f[1] - product) / (0x1p-46 * fabs(product));
}

// Generates operands for which a b + c depends on whether the product is rounded, because c is
// nearly the negated product.
static void fill_contraction(uint64_t *state, uint32_t index, driver_item *item)
{
    (void)index;
    item->f[0] = driver_random_float(state, 2);
    item->f[1] = driver_random_float(state, 2);
    item->f[2] = -(item->f[0] * item->f[1]) * (1.0f + 0x1p-10f);
}

static double error_of_precise(const driver_item *in, const driver_item *out)
{
    float product = in->f[0] * in->f[1];
    return is_other(out->f[0], product + in->f[2]);
}

// Returns the error if the product, and the sum, which is 2^-10 of the product, may both be rounded
// to either neighbour.
static double either_precise(const driver_item *in, const driver_item *out)
{
    double product = (double)in->f[0] * (double)in->f[1];
    int exponent;
    frexp(product, &exponent);
    return fabs((double)out->f[0] - (product + (double)in->f[2])) /
           (ldexp(1.0, exponent - 24) * (1.0 + 0x1p-9));
}

// --- operations with an error bound --------------------------------------------------------------

static double error_of_quotient(const driver_item *in, const driver_item *out)
{
    return ulps(out->f[0], (double)in->f[0] / (double)in->f[1]);
}

static void fill_positive(uint64_t *state, uint32_t index, driver_item *item)
{
    (void)index;
    item->f[0] = fabsf(driver_random_float(state, 40));
}

static double error_of_root(const driver_item *in, const driver_item *out)
{
    return ulps(out->f[0], sqrt((double)in->f[0]));
}

static void fill_angle(uint64_t *state, uint32_t index, driver_item *item)
{
    (void)state;
    item->f[0] = (float)((2.0 * index / ITEMS - 1.0) * M_PI);
}

static double error_of_sine(const driver_item *in, const driver_item *out)
{
    double x = (double)in->f[0];
    return fmax(fabs((double)out->f[0] - sin(x)), fabs((double)out->f[1] - cos(x)));
}

static void fill_turns(uint64_t *state, uint32_t index, driver_item *item)
{
    (void)state;
    item->f[0] = (float)index / (float)ITEMS;
}

static double error_of_turns(const driver_item *in, const driver_item *out)
{
    double x = 2.0 * M_PI * (double)in->f[0], c = (double)out->f[0], s = (double)out->f[1];
    return fmax(fmax(fabs(c - cos(x)), fabs(s - sin(x))), fabs(hypot(c, s) - 1.0));
}

// --- denormals -----------------------------------------------------------------------------------

static void fill_denormals(uint64_t *state, uint32_t index, driver_item *item)
{
    (void)index;
    item->f[0] = ldexpf(1.0f + (float)(driver_random(state) >> 9) * 0x1p-23f, -120);
    item->f[1] = ldexpf(1.0f, -8 - (int)(driver_random(state) % 10));
}

static double error_of_denormal(const driver_item *in, const driver_item *out)
{
    return out->f[0] == 0.0f ? 0.0 : is_other(out->f[0], in->f[0] * in->f[1]);
}

// --- integers ------------------------------------------------------------------------------------

static void fill_words(uint64_t *state, uint32_t index, driver_item *item)
{
    for (int i = 0; i < 4; i++)
        item->u[i] = driver_random(state) >> (index & 31u);
}

static double error_of_integers(const driver_item *in, const driver_item *out)
{
    uint64_t product = (uint64_t)in->u[0] * in->u[1];
    uint32_t reversed = 0, highest = UINT32_MAX;
    for (uint32_t i = 0; i < 32; i++) {
        reversed |= (in->u[2] >> i & 1u) << (31 - i);
        highest = in->u[3] >> i & 1u ? i : highest;
    }
    return (double)(out->u[0] != (uint32_t)(product >> 32)) +
           (double)(out->u[1] != (uint32_t)product) + (double)(out->u[2] != reversed) +
           (double)(out->u[3] != highest);
}

static void fill_halves(uint64_t *state, uint32_t index, driver_item *item)
{
    (void)state;
    // Generates all bit patterns of finite halves, 2 per word. Patterns with the exponent 31, which
    // are not finite, are omitted.
    uint32_t pattern = 2u * index % 0x7c00u;
    item->u[0] = pattern | ((pattern + 1u) | 0x8000u) << 16;
}

static float value_of_half(uint32_t half)
{
    uint32_t exponent = half >> 10 & 31u, fraction = half & 1023u;
    float value = exponent ? ldexpf((float)(1024u + fraction), (int)exponent - 25)
                           : ldexpf((float)fraction, -24);
    return half & 0x8000u ? -value : value;
}

// A denormal half may be flushed to 0.
static double error_of_half(uint32_t half, float value)
{
    bool is_denormal = (half >> 10 & 31u) == 0;
    return is_denormal && value == 0.0f ? 0.0 : is_other(value, value_of_half(half));
}

static double error_of_halves(const driver_item *in, const driver_item *out)
{
    return error_of_half(in->u[0] & 0xffffu, out->f[0]) + error_of_half(in->u[0] >> 16, out->f[1]);
}

static void fill_conversions(uint64_t *state, uint32_t index, driver_item *item)
{
    (void)index;
    item->u[0] = driver_random(state) >> 8;
    item->f[1] = driver_random_float(state, 20);
    item->f[2] = fabsf(driver_random_float(state, 20));
}

static double error_of_conversions(const driver_item *in, const driver_item *out)
{
    return is_other(out->f[0], (float)in->u[0]) + is_other(out->f[1], floorf(in->f[1])) +
           (double)(out->u[2] != (uint32_t)in->f[2]);
}

// --- kernels -------------------------------------------------------------------------------------

static bool run_items(const struct check *check, const struct arithmetic *a, driver_item *in,
                      driver_item *out, struct err *err)
{
    struct driver_run run = {.program = DRIVER_ARITHMETIC, .routine = a->routine, .items = ITEMS};
    uint64_t state = a->routine;
    for (uint32_t i = 0; i < ITEMS; i++)
        a->fill(&state, i, &in[i]);
    memcpy(out, in, ITEMS * sizeof *in);
    return driver_run(check, &run, out, err);
}

struct spread {
    double worst;
    uint32_t wrong, at; // number of items beyond the bound, and the index of the worst item
};

static struct spread judge(const struct check *check, const struct arithmetic *a,
                           const driver_item *in, const driver_item *out)
{
    bool is_any = a->error_of_any && !check->gpu->rounds_to_nearest;
    struct spread s = {0};
    for (uint32_t i = 0; i < ITEMS; i++) {
        double error = is_any ? a->error_of_any(&in[i], &out[i]) : a->error(&in[i], &out[i]);
        s.wrong += !(error <= (is_any ? 1.0 : a->most)); // also true for NaN
        if (!(error <= s.worst)) {
            s.worst = error;
            s.at = i;
        }
    }
    return s;
}

// Reports whether all items have the expected result, or how many do not, and appends `besides`.
static bool tell_wrong(struct check_result *result, uint32_t wrong, const char *besides)
{
    if (wrong == 0)
        return check_seen(result, true, "all %u as expected%s", ITEMS, besides);
    return check_seen(result, false, "%u of %u not as expected%s", wrong, ITEMS, besides);
}

static bool run_arithmetic(const struct check *check, const struct check_case *this_case,
                           struct check_result *result, struct err *err)
{
    const struct arithmetic *a = this_case->data;
    struct arena arena = {0};
    driver_item *in = ARENA_NEW(&arena, driver_item, ITEMS);
    driver_item *out = ARENA_NEW(&arena, driver_item, ITEMS);
    bool ok = in && out ? run_items(check, a, in, out, err)
                        : err_memory(err, "numbers", 2 * ITEMS * sizeof *in);
    if (ok) {
        struct spread s = judge(check, a, in, out);
        const driver_item *worst = &in[s.at];
        if (a->unit)
            check_seen(result, s.wrong == 0, "at most %.3g %s", s.worst, a->unit);
        else
            tell_wrong(result, s.wrong, "");
        if (s.wrong > 0)
            snprintf(result->why, sizeof result->why, "for %a, %a, %a the result is %a, %a",
                     (double)worst->f[0], (double)worst->f[1], (double)worst->f[2],
                     (double)out[s.at].f[0], (double)out[s.at].f[1]);
    }
    arena_finish(&arena);
    return ok;
}

// Determines the rounding mode by rounding 2^23 + 1/2 and 2^23 + 3/2 of either sign.
static bool run_rounding(const struct check *check, const struct check_case *this_case,
                         struct check_result *result, struct err *err)
{
    (void)this_case;
    static const struct {
        const char *name;
        float values[4];
    } ways[] = {{"to nearest, ties to even", {0x800000, 0x800002, -0x800000, -0x800002}},
                {"towards zero", {0x800000, 0x800001, -0x800000, -0x800001}},
                {"upwards", {0x800001, 0x800002, -0x800000, -0x800001}},
                {"downwards", {0x800000, 0x800001, -0x800001, -0x800002}}};
    driver_item items[DRIVER_WORKGROUP] = {{.f = {0x800000, 0.5f}},
                                           {.f = {0x800001, 0.5f}},
                                           {.f = {-0x800000, -0.5f}},
                                           {.f = {-0x800001, -0.5f}}};
    struct driver_run run = {
        .program = DRIVER_ARITHMETIC, .routine = CHECK_SUM, .items = DRIVER_WORKGROUP};
    if (!driver_run(check, &run, items, err))
        return false;
    for (size_t i = 0; i < sizeof ways / sizeof ways[0]; i++) {
        bool same = true;
        for (int k = 0; k < 4; k++)
            same &= items[k].f[0] == ways[i].values[k];
        if (same)
            return check_seen(result, i == 0 || !check->gpu->rounds_to_nearest, "%s", ways[i].name);
    }
    return check_seen(result, false, "%g %g %g %g", (double)items[0].f[0], (double)items[1].f[0],
                      (double)items[2].f[0], (double)items[3].f[0]);
}

// Tests that operations marked `precise` are not contracted, and reports how the driver treats
// other operations.
static bool run_contraction(const struct check *check, const struct check_case *this_case,
                            struct check_result *result, struct err *err)
{
    static driver_item in[ITEMS], out[ITEMS];
    const struct arithmetic *a = this_case->data;
    if (!run_items(check, a, in, out, err))
        return false;
    uint32_t contracted = 0, fused = 0;
    for (uint32_t i = 0; i < ITEMS; i++) {
        contracted += out[i].u[1] != out[i].u[0];
        fused += out[i].u[2] != out[i].u[0];
    }
    char besides[CHECK_TEXT_MAX / 2];
    snprintf(besides, sizeof besides, "; without precise %s; fma() rounds %s",
             contracted ? "it is contracted" : "there are two roundings as well",
             fused ? "once" : "twice");
    return tell_wrong(result, judge(check, a, in, out).wrong, besides);
}

#define ARITHMETIC(...)                                                                            \
    .run = run_arithmetic, .data = &(const struct arithmetic)                                      \
    {                                                                                              \
        __VA_ARGS__                                                                                \
    }

static const struct check_case cases[] = {
    {"sums", "each to the nearest float",
     ARITHMETIC(CHECK_SUM, fill_floats, error_of_sum, .error_of_any = either_sum)},
    {"sums halfway between floats", "each to the nearest float, ties to even",
     ARITHMETIC(CHECK_SUM, fill_ties, error_of_sum, .error_of_any = either_sum)},
    {"rounding", "to nearest, ties to even", .run = run_rounding},
    {"products", "each to the nearest float",
     ARITHMETIC(CHECK_PRODUCT, fill_floats, error_of_product, .error_of_any = either_product)},
    {"rounding errors of sums", "the sum and its error are exact (Knuth 1969)",
     ARITHMETIC(CHECK_SUM_ERROR, fill_floats, rest_of_sum, .error_of_any = about_sum)},
    {"rounding errors of products", "the product and its error are exact (Dekker 1971)",
     ARITHMETIC(CHECK_PRODUCT_ERROR, fill_floats, rest_of_product, .error_of_any = about_product)},
    {"precise a b + c", "two roundings: not contracted", .run = run_contraction,
     .data = &(const struct arithmetic){CHECK_CONTRACTION, fill_contraction, error_of_precise,
                                        .error_of_any = either_precise}},
    {"division", "within 2.5 ulp",
     ARITHMETIC(CHECK_QUOTIENT, fill_floats, error_of_quotient, 2.5, "ulp")},
    {"square root", "within 5 ulp, the sum of the bounds of inversesqrt() and a division",
     ARITHMETIC(CHECK_ROOT, fill_positive, error_of_root, 5.0, "ulp")},
    {"the driver's sine and cosine", "within 2^-11 from -pi to pi",
     ARITHMETIC(CHECK_SINE, fill_angle, error_of_sine, 0x1p-11, "off")},
    {"the renderer's sine and cosine", "within 5e-7, and of length 1",
     ARITHMETIC(CHECK_TURNS, fill_turns, error_of_turns, 5e-7, "off")},
    {"denormals", "exact, or 0", ARITHMETIC(CHECK_DENORMALS, fill_denormals, error_of_denormal)},
    {"integers", "products of 64 bits, reversed bits, highest bits",
     ARITHMETIC(CHECK_INTEGERS, fill_words, error_of_integers)},
    {"halves", "every finite half becomes the float of its value, or 0 if it is denormal",
     ARITHMETIC(CHECK_HALVES, fill_halves, error_of_halves)},
    {"conversions", "exact: 24-bit integers to float, floor(), float to integers",
     ARITHMETIC(CHECK_CONVERSIONS, fill_conversions, error_of_conversions)},
};

CHECK_GROUP(check_arithmetic, "arithmetic",
            "the driver's arithmetic, compared with double precision", cases);
