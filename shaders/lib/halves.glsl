// Divides samples between the two half-buffers, from which the error is estimated, and finds the
// sequence of a sample and its index in that sequence. render/film.c implements the same rule.
#ifndef HALVES_GLSL
#define HALVES_GLSL

#include "lib/buffers.glsl"

struct sequence_place {
    uint sequence; // 0 or 1
    uint index;    // index of the sample in the sequence
    uint count;    // samples planned for the sequence; 0: not known
};

sequence_place place_in_sequence(uint sample_index)
{
    if (HALVES == HALVES_CONTIGUOUS)
        return sequence_place(0u, sample_index, frame.samples);
    uint parity = sample_index & 1u;
    // If a single sample is planned, the second half has a count of 1 rather than 0, because it may
    // receive samples beyond the plan.
    uint count = max(frame.samples / 2u + (frame.samples & ~parity & 1u), min(frame.samples, 1u));
    return sequence_place(parity, sample_index >> 1u, count);
}

// Returns the half, 0 or 1, that receives a pixel's next sample if the film has `samples` samples
// of that pixel. It does not depend on the sample's number: an emptied film begins with half 0
// again.
uint half_of_sample(uint samples)
{
    if (HALVES == HALVES_CONTIGUOUS)
        return samples < frame.samples - frame.samples / 2u ? 0u : 1u;
    return samples & 1u;
}

// Returns which of a pixel's next `count` samples half `number` receives if the film has `samples`
// samples: from x to before y, in steps of z.
uvec3 samples_of_half(uint samples, uint count, uint number)
{
    if (HALVES == HALVES_CONTIGUOUS) {
        uint planned = frame.samples - frame.samples / 2u;
        uint to_first = min(planned - min(samples, planned), count);
        return number == 0u ? uvec3(0u, to_first, 1u) : uvec3(to_first, count, 1u);
    }
    return uvec3((samples ^ number) & 1u, count, 2u);
}

// Returns how many of the first `samples` samples belong to half 0.
uint samples_of_first_half(uint samples)
{
    if (HALVES == HALVES_CONTIGUOUS)
        return min(samples, frame.samples - frame.samples / 2u);
    return samples - samples / 2u;
}

#endif
