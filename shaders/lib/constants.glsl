// Declares the specialization constants: values that are fixed for a scene and a device.
#ifndef CONSTANTS_GLSL
#define CONSTANTS_GLSL

#include "lib/numbers.glsl"
#include "shared/bindings.h"
#include "shared/material.h"
#include "shared/methods.h"

layout(constant_id = CONSTANT_FEATURES) const uint FEATURES = 0u;
layout(local_size_x_id = CONSTANT_WORKGROUP) in;
layout(constant_id = CONSTANT_STACK_ENTRIES) const uint STACK_ENTRIES = 96u;
layout(constant_id = CONSTANT_ITERATION_BUDGET) const uint ITERATION_BUDGET = 0xffffffffu;
layout(constant_id = CONSTANT_INTERLEAVE) const uint INTERLEAVE = 1u;
layout(constant_id = CONSTANT_LOBES) const uint LOBES = 0u;
layout(constant_id = CONSTANT_QUEUES) const uint QUEUES = 0u;
layout(constant_id = CONSTANT_EMITTERS) const uint EMITTERS = 0u;
layout(constant_id = CONSTANT_AOVS) const uint AOVS = 0u;
layout(constant_id = CONSTANT_INTEGRATOR) const uint INTEGRATOR = INTEGRATOR_PATH;
layout(constant_id = CONSTANT_SAMPLER) const uint SAMPLER = SAMPLER_PCG;
layout(constant_id = CONSTANT_HALVES) const uint HALVES = HALVES_INDEPENDENT;
layout(constant_id = CONSTANT_FILTER) const uint FILTER = FILTER_BOX;
layout(constant_id = CONSTANT_CAMERA) const uint CAMERA = CAMERA_PERSPECTIVE;
layout(constant_id = CONSTANT_LIGHT_CHOICE) const uint LIGHT_CHOICE = LIGHT_CHOICE_POWER;
layout(constant_id = CONSTANT_LIGHT_RAYS) const uint LIGHT_RAYS = 1u;
layout(constant_id = CONSTANT_LIGHT_VERTICES) const uint LIGHT_VERTICES = 0u;
layout(constant_id = CONSTANT_MIS) const uint MIS = MIS_POWER;
layout(constant_id = CONSTANT_DIRECTIONS) const uint DIRECTIONS = DIRECTIONS_BSDF;
layout(constant_id = CONSTANT_ROULETTE) const uint ROULETTE = ROULETTE_THROUGHPUT;
layout(constant_id = CONSTANT_NODES) const uint NODES = NODES_QUANTISED;
layout(constant_id = CONSTANT_GEOMETRY) const uint GEOMETRY = 0u;
layout(constant_id = CONSTANT_SDF) const uint SDF = 0u;
layout(constant_id = CONSTANT_PARTS) const uint PARTS = 0u;
layout(constant_id = CONSTANT_PART_SHIFT) const uint PART_SHIFT = 31u;
layout(constant_id = CONSTANT_ENVIRONMENT_FILTER) const uint ENVIRONMENT_FILTER =
    ENVIRONMENT_FILTER_BILINEAR;
layout(constant_id = CONSTANT_PIXEL_SAMPLING) const uint PIXEL_SAMPLING = PIXEL_SAMPLING_SAMPLER;
layout(constant_id = CONSTANT_LEAF_INDEX_BITS) const uint LEAF_INDEX_BITS = 29u;
layout(constant_id = CONSTANT_NORMALS) const uint NORMALS = NORMALS_VISIBLE;
layout(constant_id = CONSTANT_RADIANCE_SCALING) const uint RADIANCE_SCALING = 1u;
layout(constant_id = CONSTANT_ACCUMULATION) const uint ACCUMULATION = ACCUMULATION_BINNED;
layout(constant_id = CONSTANT_ROUNDING) const uint ROUNDING_MODE = ROUNDING_NEAREST;
layout(constant_id = CONSTANT_STACK_SHARED) const uint STACK_SHARED = 0u;
layout(constant_id = CONSTANT_WINDOW) const uint WINDOW = 0u;

// These are constant expressions, so the code of a feature that is off is removed.
#define HAS(feature) ((FEATURES & (feature)) != 0u)
#define HAS_GEOMETRY(geometry) ((GEOMETRY & (geometry)) != 0u)
#define HAS_SDF(operation) ((SDF & (operation)) != 0u)
#define HAS_LOBE(lobe) ((LOBES & (lobe)) != 0u)
#define HAS_EMITTER(emitters) ((EMITTERS & (emitters)) != 0u)
#define HAS_AOV(aovs) ((AOVS & (aovs)) != 0u)

// The bound of one relative rounding error, as in Higham 2002, section 2.2: half a unit in the last
// place of 1, or a whole unit if the device does not promise to round sums and products to nearest.
#define ROUNDING_OF_NEAREST 5.9604644775390625e-8
#define ROUNDING_OF_ANY 1.1920928955078125e-7
#define IS_NEAREST (ROUNDING_MODE == ROUNDING_NEAREST)
#define ROUNDING (IS_NEAREST ? ROUNDING_OF_NEAREST : ROUNDING_OF_ANY)
// The bound on the relative error of n roundings in a row (Higham 2002, lemma 3.1).
#define GAMMA_OF(n, rounding) (float(n) * rounding / (1.0 - float(n) * rounding))
#define GAMMA(n)                                                                                   \
    (IS_NEAREST ? GAMMA_OF(n, ROUNDING_OF_NEAREST) : GAMMA_OF(n, ROUNDING_OF_ANY))

#endif
