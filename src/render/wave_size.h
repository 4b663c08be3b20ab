// Chooses the number of samples in a wave by measured speed. On CPU drivers small waves keep their
// records in the caches, while large ones have fewer dispatches with few rays. Which effect is
// stronger depends on the scene, the processor and its other work. The image does not depend on the
// size.
#ifndef LAMPYRIS_RENDER_WAVE_SIZE_H
#define LAMPYRIS_RENDER_WAVE_SIZE_H

#include <stdbool.h>
#include <stdint.h>

// The largest and the smallest wave that are tried, in samples.
#define WAVE_SIZE_MOST (1u << 18)
#define WAVE_SIZE_LEAST (1u << 14)

// A trial compares three stretches of waves: the first and the last have the current size, the
// second has another one.
struct wave_size {
    bool is_on;
    uint32_t now;       // samples of a wave: the fastest size so far
    uint32_t most;      // maximum samples of a wave that the buffers hold
    uint32_t other;     // the size on trial; 0: none
    bool grows;         // the next trial is of a larger size
    uint32_t stretch;   // index of the trial's current stretch, 0 to 2; or number of stretches
                        // until the next trial
    uint32_t pause;     // stretches between two trials
    uint64_t samples;   // samples in the present stretch
    double ns, rays;    // time and number of rays of the present stretch
    double ns_a_ray[3]; // time per ray in each stretch of the trial
    uint32_t least_used, most_used; // the smallest and the largest size used
};

// Sets the initial size. most: the number of samples that the buffers hold; if the size is not
// tuned, every wave has that many.
void wave_size_begin(struct wave_size *size, bool is_tuned, uint32_t most);
// Returns the number of samples that the next wave should have.
uint32_t wave_size_samples(const struct wave_size *size);
// Passes the measurements of the last wave.
void wave_size_learn(struct wave_size *size, uint64_t samples, double rays, double ns);

#endif
