// One thread adds the samples of one pixel to the film, in sums that depend neither on the order of
// the samples nor on their division into waves and films. For comparison there are also a plain sum
// and a running mean, which add samples in ascending order.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/film_sums.glsl"
#include "lib/halves.glsl"
#include "lib/queue.glsl"
#include "lib/radiance.glsl"

layout(std430, set = 0, binding = BINDING_FILM) buffer film_block {
    uvec4 film_words[];
};

const uint SUM_WORDS = AOV_SUM_WORDS(AOVS);
const uint PIXEL_WORDS = AOV_FILM_WORDS(AOVS);

// The sums of a half-buffer, or of one class of --error-by in a half-buffer.
struct half_sums {
    uvec4 bins[3];
    uint tops[3]; // highest digits
    uint digits;
};

// at: the first word of gpu_film_pixel or of a class.
half_sums load_half(uint at, uint number)
{
    half_sums sums;
    sums.digits = film_words[at][2u + number];
    for (uint c = 0u; c < 3u; c++) {
        sums.bins[c] = film_words[at + 1u + FILM_HALF_WORDS * number + c];
        sums.tops[c] = film_top_digit(sums.digits, c);
    }
    return sums;
}

// Stores all words of the sums except the digits.
void store_bins(uint at, uint number, half_sums sums)
{
    for (uint c = 0u; c < 3u; c++)
        film_words[at + 1u + FILM_HALF_WORDS * number + c] = sums.bins[c];
}

void add(inout half_sums sums, vec3 value)
{
    for (uint c = 0u; c < 3u; c++) {
        film_add(sums.bins[c], sums.tops[c], value[c]);
        sums.digits |= film_digit_bit(value[c], c);
    }
}

// Adds a value to a half-buffer that keeps floats. count: the number of its samples, including this
// one.
void add_float(inout half_sums sums, vec3 value, uint count)
{
    vec3 before = vec3(uintBitsToFloat(sums.bins[0].x), uintBitsToFloat(sums.bins[1].x),
                       uintBitsToFloat(sums.bins[2].x));
    precise vec3 after = ACCUMULATION == ACCUMULATION_SUM
                             ? before + value
                             : before + (value - before) / float(count);
    for (uint c = 0u; c < 3u; c++)
        sums.bins[c].x = floatBitsToUint(after[c]);
}

// Returns the sum of one word over the records of a sample's slots, added in ascending order.
vec4 load_sample(uint sample_of_wave, uint word)
{
    uint slot = first_slot(sample_of_wave);
    precise vec4 sum = load_radiance_float(slot * SLOT_WORDS + word);
    if (HAS(FEATURE_SPLIT_LOBES)) {
        for (uint branch = 1u; branch < slots_a_sample(); branch++)
            sum += load_radiance_float((slot + branch) * SLOT_WORDS + word);
    }
    return sum;
}

// Adds the AOVs of an item's samples, in groups of four floats. at: the first word of the pixel's
// record.
void add_aovs(uint item, uint at)
{
    uint samples = 1u << push.sample_shift;
    for (uint word = 0u; word < SUM_WORDS; word++) {
        uint sums = at + FILM_WORDS + 4u * word;
        uint group = at + AOV_FILM_DIGITS_AT(AOVS) + word / FILM_GROUPS_A_WORD;
        uint digits = film_words[group][word % FILM_GROUPS_A_WORD];
        uvec4 bins[4];
        for (uint c = 0u; c < 4u; c++)
            bins[c] = film_words[sums + c];
        for (uint i = 0u; i < samples; i++) {
            vec4 values = load_sample((item << push.sample_shift) + i, 1u + word);
            for (uint c = 0u; c < 4u; c++) {
                uint top = film_top_digit(digits, c);
                film_add(bins[c], top, values[c]);
                digits |= film_digit_bit(values[c], c);
            }
        }
        for (uint c = 0u; c < 4u; c++)
            film_words[sums + c] = bins[c];
        film_words[group][word % FILM_GROUPS_A_WORD] = digits;
    }
}

// Adds the contributions of each class of --error-by to half-buffer `number`. `range` has the
// samples of that half-buffer (samples_of_half()).
void add_classes(uint item, uint at, uint number, uvec3 range)
{
    for (uint i = 0u; i < AOV_CLASSES(AOVS); i++) {
        uint class_at = at + AOV_FILM_CLASSES_AT(AOVS) + FILM_WORDS * i;
        half_sums sums = load_half(class_at, number);
        for (uint j = range.x; j < range.y; j += range.z)
            add(sums, load_sample((item << push.sample_shift) + j,
                                  AOV_SLOT_CLASSES_AT(AOVS) + i).rgb);
        film_words[class_at][2u + number] = sums.digits;
        store_bins(class_at, number, sums);
    }
}

// Keeps the brightest contribution. If several are equally bright, it keeps the one of the lowest
// sample, and of that sample's first branch.
void keep_brightest_sample(uint item, uint at)
{
    uint word = at + AOV_FILM_BRIGHTEST_AT(AOVS);
    uvec4 brightest = film_words[word];
    uint its_sample = film_words[word + 1u].x;
    float most = brightness(uintBitsToFloat(brightest.rgb));
    uint slots = slots_a_sample() << push.sample_shift;
    uint first = first_slot(item << push.sample_shift);
    for (uint slot = first; slot < first + slots; slot++) {
        uvec4 found = load_radiance(slot * SLOT_WORDS + AOV_SLOT_BRIGHTEST_AT(AOVS));
        float bright = brightness(uintBitsToFloat(found.rgb));
        if (bright > most) {
            most = bright;
            brightest = found;
            its_sample = slot_sample(slot);
        }
    }
    film_words[word] = brightest;
    film_words[word + 1u] = uvec4(its_sample, 0u, 0u, 0u);
}

// Adds the radiance of the samples in `range` to half-buffer `number` of a pixel, and returns the
// digits of the half-buffer. count: the number of samples already in the half-buffer. dropped: is
// increased by the number of samples from which a contribution was left out.
uint add_samples(uint item, uint at, uint number, uvec3 range, uint count, inout uint dropped)
{
    half_sums sums = load_half(at, number);
    for (uint i = range.x; i < range.y; i += range.z) {
        vec4 radiance = load_sample((item << push.sample_shift) + i, 0u);
#ifdef PLANTED_FILM_FACTOR // planted fault, which tests must detect: the film gains light
        radiance.rgb *= PLANTED_FILM_FACTOR;
#endif
        // The sum over branches may overflow although each branch is finite.
        if (HAS(FEATURE_SPLIT_LOBES) && !is_finite(radiance.rgb))
            radiance = vec4(0.0, 0.0, 0.0, 1.0);
        if (ACCUMULATION == ACCUMULATION_BINNED)
            add(sums, radiance.rgb);
        else
            add_float(sums, radiance.rgb, ++count);
        // Counts samples, not their branches.
        dropped += HAS(FEATURE_SPLIT_LOBES) ? min(uint(radiance.w), 1u) : uint(radiance.w);
    }
    store_bins(at, number, sums);
    return sums.digits;
}

void main()
{
    uint item = item_index();
    if (item >= min(push.pixel_count, push.first_item + push.part_items) ||
        counters.unfinished != 0u)
        return;
    uint at = (item_pixel(item) - push.film_first_pixel) * PIXEL_WORDS;
    uvec4 head = film_words[at];
    uint before = head.x, samples = 1u << push.sample_shift;
    bool has_means = ACCUMULATION == ACCUMULATION_RUNNING;
    uvec2 counts = uvec2(has_means ? max(head.w, 1u) - 1u : 0u, 0u);
    counts.y = before - counts.x;
    // If there is a single sample, only its own half-buffer is accessed.
    uint first = samples > 1u ? 0u : half_of_sample(before);
    uint last = samples > 1u ? 1u : first;
    for (uint number = first; number <= last; number++) {
        uvec3 range = samples_of_half(before, samples, number);
        uint digits = add_samples(item, at, number, range, counts[number], head.y);
        if (ACCUMULATION == ACCUMULATION_BINNED)
            head[2u + number] = digits;
        if (number == 0u)
            counts.x += range.y > range.x ? (range.y - range.x + range.z - 1u) / range.z : 0u;
        if (HAS_AOV(AOVS_BY))
            add_classes(item, at, number, range);
    }
    if (HAS_AOV(AOVS_SUMMED))
        add_aovs(item, at);
    if (HAS_AOV(AOVS_BY))
        keep_brightest_sample(item, at);
    // The ids are those of the pixel's first sample.
    if (HAS_AOV(AOV_IDS) && before == 0u)
        film_words[at + PIXEL_WORDS - 1u] =
            load_radiance((first_slot(item << push.sample_shift) + 1u) * SLOT_WORDS - 1u);
    if (ACCUMULATION != ACCUMULATION_BINNED)
        head.zw = uvec2(FILM_HAS_FLOATS, has_means ? counts.x + 1u : 0u);
    head.x = before + samples;
    film_words[at] = head;
}
