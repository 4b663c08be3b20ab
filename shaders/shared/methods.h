// Defines the choices of methods. Each is a setting, whose values are in the order of their names
// (see scene/core/settings.c), and a specialization constant of the kernels.
#ifndef LAMPYRIS_SHARED_METHODS_H
#define LAMPYRIS_SHARED_METHODS_H

// Integrators: the quantity that is computed.
#define INTEGRATOR_PATH 0u
#define INTEGRATOR_DIRECT 1u // paths have one scattering event
#define INTEGRATOR_AO 2u     // fraction of the sky that is visible within a distance
#define INTEGRATOR_WHITTED                                                                         \
    3u                      // Whitted 1979: perfect reflection and refraction, hard shadows, Phong
#define INTEGRATOR_BIDIR 4u // as INTEGRATOR_PATH, with light paths in addition
#define INTEGRATOR_AUTO 5u  // no kernel has this value: see settings_integrator()

// Sources of random numbers.
#define SAMPLER_SOBOL 0u      // Owen-scrambled Sobol (Burley 2020)
#define SAMPLER_PCG 1u        // independent: pcg4d
#define SAMPLER_LCG 2u        // independent: a linear congruential generator seeded by TEA
#define SAMPLER_STRATIFIED 3u // one random point in each stratum
#define SAMPLER_GRID 4u       // one point at the centre of each stratum
#define SAMPLER_BLUE_NOISE 5u // one sequence for all pixels, assigned so that errors are blue noise
#define SAMPLER_SINE 6u       // fractions of sines, as an example of a bad generator

// First numbers of ranges of dimensions, beyond the 3 * 2^20 + 1 dimensions of the longest camera
// path. They differ in bits that are low enough for pcg4d() to mix. If inputs differ in bit 27 or
// above, outputs depend on each other: with 16 x 16 cells and 2^20 samples, chi-square deviates by
// up to 52 standard deviations for bit 27 and 2e5 for bit 31, and by less than 4 up to bit 25
// (measured; `kernels sampler` repeats it).
#define DIMENSIONS_OF_LIGHT_PATHS (1u << 23)
#define DIMENSIONS_OF_PIXELS (1u << 24)
#define DIMENSIONS_OF_ALL_LIGHTS (1u << 25)

// Methods of summing samples in the film.
#define ACCUMULATION_BINNED 0u  // sums that do not depend on the order (film_sums.h)
#define ACCUMULATION_SUM 1u     // a plain sum in single precision
#define ACCUMULATION_RUNNING 2u // a running mean

// Divisions of the samples between the two half-buffers, from which the error is estimated.
#define HALVES_INDEPENDENT 0u // one sequence for each half-buffer: the error estimate is unbiased
#define HALVES_CONTIGUOUS 1u  // halves of one sequence: the error estimate is an upper bound

// Pixel filters, which are sampled by importance.
#define FILTER_BOX 0u
#define FILTER_TENT 1u
#define FILTER_GAUSSIAN 2u
#define FILTER_BLACKMAN_HARRIS 3u

// Methods of placing a sample in its pixel's filter. They affect only the two dimensions of this
// position.
#define PIXEL_SAMPLING_SAMPLER 0u    // by the sampler
#define PIXEL_SAMPLING_CENTRE 1u     // the pixel's centre
#define PIXEL_SAMPLING_GRID 2u       // at the centres of strata
#define PIXEL_SAMPLING_RANDOM 3u     // independent random points
#define PIXEL_SAMPLING_STRATIFIED 4u // at random points in strata

// Interpolation of the environment's image between texels.
#define ENVIRONMENT_FILTER_BILINEAR 0u
#define ENVIRONMENT_FILTER_NEAREST 1u // each texel is a patch of constant radiance

// The density with which shadow rays sample directions towards an environment's image.
#define ENVIRONMENT_SAMPLING_LUMINANCE 0u
// The density is proportional to the excess of the image's luminance over its mean.
#define ENVIRONMENT_SAMPLING_COMPENSATED 1u

#define CAMERA_PERSPECTIVE 0u
#define CAMERA_ORTHOGRAPHIC 1u
#define CAMERA_PANORAMIC 2u // all directions, in latitude and longitude

// Light sampling strategies, which select the emitters for a vertex's shadow rays.
#define LIGHT_CHOICE_AUTO 0u // only as a setting: see render/tables/light_choice.h
#define LIGHT_CHOICE_UNIFORM 1u
#define LIGHT_CHOICE_POWER 2u
// Selects one emitter of each lamp for the first vertices of a path (CONSTANT_LIGHT_VERTICES), and
// one emitter by the tree for the other vertices.
#define LIGHT_CHOICE_ALL 3u
#define LIGHT_CHOICE_TREE 4u // by a bound on the contribution to the vertex, from a light BVH

// MIS weights of the strategies that find emitters: shadow rays and paths that hit an emitter.
#define MIS_POWER 0u
#define MIS_BALANCE 1u
#define MIS_NONE 2u      // emitters that shadow rays can sample are found by shadow rays only
#define MIS_POWER_ANY 3u // MIS_POWER with the exponent frame.mis_exponent; not a setting of its own

// Strategies of sampling the direction in which a path leaves a surface, except for delta lobes.
#define DIRECTIONS_BSDF 0u
#define DIRECTIONS_SPHERE 1u
#define DIRECTIONS_HEMISPHERE 2u
#define DIRECTIONS_COSINE 3u
#define DIRECTIONS_POWER_COSINE 4u // a power of the cosine with the mirror direction

// Strategies of sampling microfacet normals.
#define NORMALS_VISIBLE 0u // by the distribution of visible normals (Heitz 2018)
#define NORMALS_NDF 1u     // by the full distribution D (Walter et al. 2007)

// The probability of survival is ROULETTE_FACTOR times the throughput, or 1 if that is greater. The
// factor is measured: the error falls by more than the additional rays cost ("Roulette by depth" in
// docs/performance.md).
#define ROULETTE_THROUGHPUT 0u
#define ROULETTE_FACTOR 2.5
#define ROULETTE_CONSTANT 1u // the same probability for all paths
// A geometrically distributed depth for each sample number, shared by all pixels.
#define ROULETTE_FRAME 2u
#define ROULETTE_OFF 3u

// Formats of BVH nodes. The format is not a setting: see bvh/bvh.h for its selection.
#define NODES_QUANTISED 0u
#define NODES_FLOAT 1u

#endif
