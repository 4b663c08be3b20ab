// One thread adds the samples of one pixel to the film, in ascending order and compensated, so that
// neither the wave's size nor the number of samples changes what a sum is worth. For comparison
// also in a plain sum or as a running mean, whose value depends on the number of samples.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/halves.glsl"
#include "lib/queue.glsl"
#include "lib/radiance.glsl"

layout(std430, set = 0, binding = BINDING_FILM) buffer film_block {
    uvec4 film_words[];
};

struct compensated {
    vec3 sum;
    vec3 lost; // what the sum holds too much
};

const uint SUM_WORDS = AOV_SUM_WORDS(AOVS);
const uint PIXEL_WORDS = AOV_FILM_WORDS(AOVS);

// Kahan 1965, "Further remarks on reducing truncation errors".
void add(inout compensated c, vec3 value)
{
    precise vec3 y = value - c.lost;
    precise vec3 t = c.sum + y;
    precise vec3 lost = (t - c.sum) - y;
    c.sum = t;
    c.lost = lost;
}

void add(inout vec4 sum, inout vec4 lost, vec4 value)
{
    precise vec4 y = value - lost;
    precise vec4 t = sum + y;
    precise vec4 rounded = (t - sum) - y;
    sum = t;
    lost = rounded;
}

// Sample number `count` of a half, from 1.
void accumulate(inout compensated c, vec3 value, uint count)
{
    if (ACCUMULATION == ACCUMULATION_SUM) {
        precise vec3 sum = c.sum + value;
        c.sum = sum;
    } else if (ACCUMULATION == ACCUMULATION_RUNNING) {
        precise vec3 mean = c.sum + (value - c.sum) / float(count);
        c.sum = mean;
    } else {
        add(c, value);
    }
}

// A word of the records of a sample's slots: their sum, in ascending order.
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

// The AOVs of an item's samples, four floats after the other. `at`: of the pixel's record.
void add_aovs(uint item, uint at)
{
    uint samples = 1u << push.sample_shift;
    for (uint word = 0u; word < SUM_WORDS; word++) {
        vec4 sum = uintBitsToFloat(film_words[at + FILM_WORDS + word]);
        vec4 lost = uintBitsToFloat(film_words[at + FILM_WORDS + SUM_WORDS + word]);
        for (uint i = 0u; i < samples; i++)
            add(sum, lost, load_sample((item << push.sample_shift) + i, 1u + word));
        film_words[at + FILM_WORDS + word] = floatBitsToUint(sum);
        film_words[at + FILM_WORDS + SUM_WORDS + word] = floatBitsToUint(lost);
    }
}

// Adds what each class of --error-by has brought, in sums of the samples of either half. `first` is
// the number of samples that the pixel had before.
void add_classes(uint item, uint at, uint first)
{
    uint samples = 1u << push.sample_shift;
    for (uint number = 0u; number < AOV_CLASSES(AOVS); number++) {
        uint word = at + AOV_FILM_CLASSES_AT(AOVS) + 4u * number;
        compensated halves[2];
        for (uint h = 0u; h < 2u; h++)
            halves[h] = compensated(uintBitsToFloat(film_words[word + 2u * h].xyz),
                                    uintBitsToFloat(film_words[word + 2u * h + 1u].xyz));
        for (uint i = 0u; i < samples; i++) {
            vec3 light = load_sample((item << push.sample_shift) + i,
                                     AOV_SLOT_CLASSES_AT(AOVS) + number).rgb;
            if (half_of_sample(first + i) == 0u)
                add(halves[0], light);
            else
                add(halves[1], light);
        }
        for (uint h = 0u; h < 2u; h++) {
            film_words[word + 2u * h] = uvec4(floatBitsToUint(halves[h].sum), 0u);
            film_words[word + 2u * h + 1u] = uvec4(floatBitsToUint(halves[h].lost), 0u);
        }
    }
}

// Keeps the brightest contribution; of some that are as bright that of the lowest sample, and of
// its first branch.
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

void main()
{
    uint item = item_index();
    if (item >= min(push.pixel_count, push.first_item + push.part_items) ||
        counters.unfinished != 0u)
        return;
    uint at = (item_pixel(item) - push.film_first_pixel) * PIXEL_WORDS;
    uvec4 words[FILM_WORDS];
    for (uint i = 0u; i < FILM_WORDS; i++)
        words[i] = film_words[at + i];
    compensated halves[2];
    halves[0] = compensated(uintBitsToFloat(words[0].xyz), uintBitsToFloat(words[1].xyz));
    halves[1] = compensated(uintBitsToFloat(words[2].xyz), uintBitsToFloat(words[3].xyz));

    uint samples = 1u << push.sample_shift;
    bool has_means = ACCUMULATION == ACCUMULATION_RUNNING;
    uint count_a = has_means ? max(words[2].w, 1u) - 1u : 0u;
    uint count_b = words[0].w - count_a;
    for (uint i = 0u; i < samples; i++) {
        vec4 radiance = load_sample((item << push.sample_shift) + i, 0u);
#ifdef PLANTED_FILM_FACTOR // tests of tests only: is a film that gains light found?
        radiance.rgb *= PLANTED_FILM_FACTOR;
#endif
        if (half_of_sample(words[0].w + i) == 0u)
            accumulate(halves[0], radiance.rgb, ++count_a);
        else
            accumulate(halves[1], radiance.rgb, ++count_b);
        // Samples are counted, not their branches.
        words[1].w += HAS(FEATURE_SPLIT_LOBES) ? min(uint(radiance.w), 1u) : uint(radiance.w);
    }

    if (HAS_AOV(AOVS_SUMMED))
        add_aovs(item, at);
    if (HAS_AOV(AOVS_BY)) {
        add_classes(item, at, words[0].w);
        keep_brightest_sample(item, at);
    }
    // The ids are those of the first sample that the pixel gets.
    if (HAS_AOV(AOV_IDS) && words[0].w == 0u)
        film_words[at + PIXEL_WORDS - 1u] =
            load_radiance((first_slot(item << push.sample_shift) + 1u) * SLOT_WORDS - 1u);
    film_words[at] = uvec4(floatBitsToUint(halves[0].sum), words[0].w + samples);
    film_words[at + 1u] = uvec4(floatBitsToUint(halves[0].lost), words[1].w);
    film_words[at + 2u] = uvec4(floatBitsToUint(halves[1].sum), has_means ? count_a + 1u : 0u);
    film_words[at + 3u] = uvec4(floatBitsToUint(halves[1].lost), 0u);
}
