// Turns what a film has of its half-buffers into sums, however it was accumulated.
#ifndef FILM_SUMS_GLSL
#define FILM_SUMS_GLSL

// The factors that make sums of what struct gpu_film_pixel has for its halves: 1, or the numbers of
// samples that the running means are of. By means_a and the samples of both halves.
vec2 sum_factors(uint means_a, uint samples)
{
    return means_a > 0u ? vec2(means_a - 1u, samples - (means_a - 1u)) : vec2(1.0);
}

#endif
