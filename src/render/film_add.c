// Adds one film to another, word by word: see shared/film_sums.h.
#include "render/film_copy.h"
#include "render/sampling_plan.h"
#include "shared/aov.h"

#include <assert.h>
#include <string.h>

// Returns the highest digit of sum `component`; `digits` has the highest digits of several sums.
static uint32_t top_digit(uint32_t digits, uint32_t component)
{
    uint32_t top = 0;
    for (uint32_t set = digits >> FILM_DIGIT_BITS * component & FILM_DIGITS_MASK; set; set >>= 1)
        top++;
    return top;
}

// Adds one bin of a sum, the even or the odd one, to the bin of another sum with the same digit.
static void add_bin(uint32_t *to, const uint32_t *from, uint32_t odd)
{
    uint32_t *words = &to[2 * odd];
    uint64_t bin =
        ((uint64_t)words[1] << 32 | words[0]) + ((uint64_t)from[2 * odd + 1] << 32 | from[2 * odd]);
    words[0] = (uint32_t)bin;
    words[1] = (uint32_t)(bin >> 32);
}

static void empty_bin(uint32_t *sum, uint32_t odd)
{
    sum[2 * odd] = sum[2 * odd + 1] = 0;
}

static void add_sum(uint32_t *to, uint32_t to_top, const uint32_t *from, uint32_t from_top)
{
    uint32_t top = to_top > from_top ? to_top : from_top;
    for (uint32_t digit = to_top; digit < top && digit < to_top + 2; digit++)
        empty_bin(to, (digit + 1) & 1u);
    // The higher bin of `from` holds digit from_top, its lower bin digit from_top - 1.
    if (from_top + 1 >= top)
        add_bin(to, from, from_top & 1u);
    if (from_top == top)
        add_bin(to, from, (from_top + 1) & 1u);
}

// Adds `count` sums that share a word of digits.
static void add_sums(uint32_t *to, uint32_t *to_digits, const uint32_t *from, uint32_t from_digits,
                     uint32_t count)
{
    for (uint32_t i = 0; i < count; i++)
        add_sum(&to[4 * i], top_digit(*to_digits, i), &from[4 * i], top_digit(from_digits, i));
    *to_digits |= from_digits;
}

// Adds both halves of a record that begins like struct gpu_film_pixel, except the sample counts.
static void add_halves(uint32_t *to, const uint32_t *from)
{
    for (uint32_t half = 0; half < 2; half++) {
        const uint32_t sums = 4 * (1 + FILM_HALF_WORDS * half);
        add_sums(&to[sums], &to[2 + half], &from[sums], from[2 + half], 3);
    }
}

static void add_layers(uint32_t aovs, uint32_t *to, const uint32_t *from)
{
    const uint32_t digits = 4 * AOV_FILM_DIGITS_AT(aovs);
    for (uint32_t group = 0; group < AOV_SUM_WORDS(aovs); group++) {
        const uint32_t sums = 4 * (FILM_WORDS + 4 * group);
        add_sums(&to[sums], &to[digits + group], &from[sums], from[digits + group], 4);
    }
}

// Returns the luminance by which kernels compare contributions (lib/radiance.glsl).
static float brightness(const uint32_t words[3])
{
    float rgb[3];
    memcpy(rgb, words, sizeof rgb);
    return 0.2126f * rgb[0] + 0.7152f * rgb[1] + 0.0722f * rgb[2];
}

// Keeps the brighter of two contributions; if both are equally bright, that of the lower sample.
static void keep_brightest(uint32_t *to, const uint32_t *from)
{
    float own = brightness(to), other = brightness(from);
    if (other > own || (other == own && other > 0.0f && from[4] < to[4]))
        memcpy(to, from, 2 * 4 * sizeof *to);
}

// Adds the record of one pixel. precedes: the samples of `from` come before those of `to`, whose
// ids are then replaced.
static void add_pixel(uint32_t aovs, uint32_t *to, const uint32_t *from, bool precedes)
{
    const uint32_t ids = 4 * (AOV_FILM_WORDS(aovs) - 1), classes = 4 * AOV_FILM_CLASSES_AT(aovs);
    if (AOV_ID_WORDS(aovs) && from[0] > 0 && (to[0] == 0 || precedes))
        memcpy(&to[ids], &from[ids], 4 * sizeof *to);
    to[0] += from[0];
    to[1] += from[1];
    add_halves(to, from);
    add_layers(aovs, to, from);
    for (uint32_t i = 0; i < AOV_CLASSES(aovs); i++)
        add_halves(&to[classes + 4 * FILM_WORDS * i], &from[classes + 4 * FILM_WORDS * i]);
    if (AOV_HAS_CLASSES(aovs))
        keep_brightest(&to[4 * AOV_FILM_BRIGHTEST_AT(aovs)],
                       &from[4 * AOV_FILM_BRIGHTEST_AT(aovs)]);
}

void film_records_add(uint32_t aovs, const char *part, char *to, uint64_t pixels, bool precedes)
{
    const uint64_t bytes = 16 * AOV_FILM_WORDS(aovs);
    for (uint64_t i = 0; i < pixels; i++)
        add_pixel(aovs, (uint32_t *)(void *)(to + i * bytes),
                  (const uint32_t *)(const void *)(part + i * bytes), precedes);
}

static bool can_add(const struct renderer *r, const struct film_copy *part,
                    const struct film_copy *to, struct err *err)
{
    if (r->specialization.accumulation != ACCUMULATION_BINNED)
        return err_set(
            err, ERR_INPUT,
            "films can be added only if their sums do not depend on the order of samples; "
            "expected --accumulation binned");
    if (halves_are_contiguous(r))
        return err_set(err, ERR_INPUT,
                       "films whose halves are contiguous cannot be added; expected "
                       "--halves independent");
    if (part->done || to->done)
        return err_set(err, ERR_INPUT,
                       "films whose tiles have different numbers of samples cannot be added");
    if (part->seed != to->seed)
        return err_set(err, ERR_INPUT, "a film of seed %u cannot be added to one of seed %u",
                       part->seed, to->seed);
    if (part->emptied_at % 2 != 0 || to->emptied_at % 2 != 0)
        return err_set(err, ERR_INPUT,
                       "films whose first samples are %llu and %llu cannot be added; expected even "
                       "sample numbers",
                       (unsigned long long)part->emptied_at, (unsigned long long)to->emptied_at);
    return true;
}

bool film_copy_add(const struct renderer *r, const struct film_copy *part, struct film_copy *to,
                   struct err *err)
{
    assert(part->records && to->records);
    if (!can_add(r, part, to, err))
        return false;
    const uint32_t aovs = r->specialization.aovs;
    const bool precedes = part->emptied_at < to->emptied_at;
    film_records_add(aovs, part->records, to->records,
                     film_copy_bytes(r) / (16 * AOV_FILM_WORDS(aovs)), precedes);
    to->emptied_at = precedes ? part->emptied_at : to->emptied_at;
    to->next_sample = part->next_sample > to->next_sample ? part->next_sample : to->next_sample;
    return true;
}
