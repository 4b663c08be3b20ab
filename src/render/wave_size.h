// The number of samples in a wave, chosen by measured speed. On CPU drivers small waves keep their
// records in the caches and large ones have fewer dispatches with few rays; which of both counts
// for more depends on the scene, on the processor and on what else it does. The image does not
// depend on it.
#ifndef LAMPYRIS_RENDER_WAVE_SIZE_H
#define LAMPYRIS_RENDER_WAVE_SIZE_H

#include <stdbool.h>
#include <stdint.h>

// The largest and the smallest wave that is tried, in samples.
#define WAVE_SIZE_MOST (1u << 18)
#define WAVE_SIZE_LEAST (1u << 14)

// A trial compares three stretches of waves: two of the present size, and one of another size
// between them.
struct wave_size {
    bool is_on;
    uint32_t now;                   // samples of a wave, the fastest as far as is known
    uint32_t most;                  // that the buffers hold
    uint32_t other;                 // the size on trial; 0: none
    bool grows;                     // the next trial is of a larger size
    uint32_t stretch;               // of the trial, 0 to 2; or stretches left until the next trial
    uint32_t pause;                 // stretches between two trials
    uint64_t samples;               // of the present stretch
    double ns, rays;                // of the present stretch
    double ns_a_ray[3];             // of the trial's stretches
    uint32_t least_used, most_used; // sizes that waves have had
};

// most: samples that the buffers hold. All waves have as many where the size is not tuned.
void wave_size_begin(struct wave_size *size, bool is_tuned, uint32_t most);
// Samples that the next wave should have.
uint32_t wave_size_samples(const struct wave_size *size);
// Reports what the last wave took.
void wave_size_learn(struct wave_size *size, uint64_t samples, double rays, double ns);

#endif
