// Choices between methods: each is a setting, in the order of the words that name it (see
// scene/core/settings.c), and a specialization constant of the kernels.
#ifndef LAMPYRIS_SHARED_METHODS_H
#define LAMPYRIS_SHARED_METHODS_H

// Integrators: the quantity that an image shows.
#define INTEGRATOR_PATH 0u
#define INTEGRATOR_DIRECT 1u // one scattering event
#define INTEGRATOR_AO 2u     // how much of the sky each surface sees within a distance
#define INTEGRATOR_WHITTED                                                                         \
    3u                      // Whitted 1979: perfect reflection and refraction, hard shadows, Phong
#define INTEGRATOR_BIDIR 4u // as INTEGRATOR_PATH, found by light paths too

// Sources of random numbers.
#define SAMPLER_SOBOL 0u      // Owen-scrambled Sobol (Burley 2020)
#define SAMPLER_PCG 1u        // independent: pcg4d
#define SAMPLER_LCG 2u        // independent: a linear congruential generator seeded by TEA
#define SAMPLER_STRATIFIED 3u // one point at random in each stratum
#define SAMPLER_GRID 4u       // the same without jitter: at the strata's centres
#define SAMPLER_BLUE_NOISE                                                                         \
    5u                  // one sequence for all pixels, dealt out so that errors are blue noise
#define SAMPLER_SINE 6u // fractions of sines, to be shown how bad they are

// Ranges of dimension numbers beyond the 3 * 2^20 + 1 of the longest camera path. They differ in
// bits that are low enough for pcg4d() to mix. Where inputs differ in bit 27 or above, outputs
// depend on each other: chi-square of 16 x 16 cells and 2^20 samples is up to 52 standard
// deviations off for bit 27 and 2e5 for bit 31, and below 4 up to bit 25 (measured; `kernels
// sampler` repeats it).
#define DIMENSIONS_OF_LIGHT_PATHS (1u << 23)
#define DIMENSIONS_OF_PIXELS (1u << 24)
#define DIMENSIONS_OF_ALL_LIGHTS (1u << 25)

// Ways in which the film sums samples.
#define ACCUMULATION_BINNED 0u  // sums that do not depend on the order (film_sums.h)
#define ACCUMULATION_SUM 1u     // a plain sum in single precision
#define ACCUMULATION_RUNNING 2u // a mean that each sample moves

// Ways in which the two half-buffers, from which the error is estimated, share the samples.
#define HALVES_INDEPENDENT 0u // each has a sequence of its own: the estimate is unbiased
#define HALVES_CONTIGUOUS 1u  // one sequence, first and second half: an upper bound

// Pixel filters, drawn from by importance.
#define FILTER_BOX 0u
#define FILTER_TENT 1u
#define FILTER_GAUSSIAN 2u
#define FILTER_BLACKMAN_HARRIS 3u

// Ways to place a sample in its pixel's filter; only these two dimensions are affected.
#define PIXEL_SAMPLING_SAMPLER 0u    // as the sampler says
#define PIXEL_SAMPLING_CENTRE 1u     // the pixel's centre
#define PIXEL_SAMPLING_GRID 2u       // at the centres of strata
#define PIXEL_SAMPLING_RANDOM 3u     // independent
#define PIXEL_SAMPLING_STRATIFIED 4u // at random in strata

// Filters between the texels of an environment's image.
#define ENVIRONMENT_FILTER_BILINEAR 0u
#define ENVIRONMENT_FILTER_NEAREST 1u // each texel is a patch of constant radiance

// Densities with which shadow rays choose directions towards an environment's image.
#define ENVIRONMENT_SAMPLING_LUMINANCE 0u
#define ENVIRONMENT_SAMPLING_COMPENSATED 1u // by what its luminance exceeds its mean by

#define CAMERA_PERSPECTIVE 0u
#define CAMERA_ORTHOGRAPHIC 1u
#define CAMERA_PANORAMIC 2u // all directions, in latitude and longitude

// Ways to choose the emitters that a vertex connects to.
#define LIGHT_CHOICE_AUTO 0u // a setting only: see render/tables/light_choice.h
#define LIGHT_CHOICE_UNIFORM 1u
#define LIGHT_CHOICE_POWER 2u
#define LIGHT_CHOICE_ALL 3u  // one of each lamp: CONSTANT_LIGHT_VERTICES; beyond, by the tree
#define LIGHT_CHOICE_TREE 4u // by what they may send here, through a light BVH

// Weights of the two techniques that find emitters.
#define MIS_POWER 0u
#define MIS_BALANCE 1u
#define MIS_NONE 2u      // those that can be connected to count when connected to only
#define MIS_POWER_ANY 3u // MIS_POWER with the exponent frame.mis_exponent; no choice of its own

// Ways to sample the direction in which a path leaves a surface that is not a delta.
#define DIRECTIONS_BSDF 0u
#define DIRECTIONS_SPHERE 1u
#define DIRECTIONS_HEMISPHERE 2u
#define DIRECTIONS_COSINE 3u
#define DIRECTIONS_POWER_COSINE 4u // about the mirrored direction

// Ways to sample microfacet normals.
#define NORMALS_VISIBLE 0u // by the distribution of visible normals (Heitz 2018)
#define NORMALS_NDF 1u     // by the full distribution D (Walter et al. 2007)

// Paths survive with ROULETTE_FACTOR times their throughput, or surely. The factor is measured: the
// error falls by more than the rays that it costs ("Roulette by depth" in docs/performance.md).
#define ROULETTE_THROUGHPUT 0u
#define ROULETTE_FACTOR 2.5
#define ROULETTE_CONSTANT 1u // one probability for all
#define ROULETTE_FRAME 2u    // a geometric depth for each sample number, shared by all pixels
#define ROULETTE_OFF 3u

// Formats of the BVH's nodes; chosen in bvh.h, not a setting.
#define NODES_QUANTISED 0u
#define NODES_FLOAT 1u

#endif
