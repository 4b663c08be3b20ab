// Defines binding numbers, ids of specialization constants, and feature bits, for C and GLSL.
#ifndef LAMPYRIS_SHARED_BINDINGS_H
#define LAMPYRIS_SHARED_BINDINGS_H

// Storage buffers. Each buffer that kernels only read is also bound as a uniform texel buffer of
// RGBA32_UINT at TEXEL_BINDING(number): on some drivers these reads are several times as fast.
#define BINDING_NODES 0       // struct bvh_node or bvh_node_float
#define BINDING_TRIANGLES 1   // struct gpu_triangle, leaf order
#define BINDING_ATTRIBUTES 2  // attributes of triangles' corners, in leaf order: see types.h
#define BINDING_SHAPES 3      // struct gpu_shape
#define BINDING_MATERIALS 4   // struct gpu_material_header, then the sections to which it refers
#define BINDING_EMITTERS 5    // struct gpu_emitter, or a light tree: struct gpu_light_tree
#define BINDING_ENVIRONMENT 6 // see render/tables/environment_table.h
#define BINDING_TEXELS 7      // texels of all textures
#define BINDING_PATHS 8       // struct gpu_path for each slot of the wave
#define BINDING_SHADOW_RAYS 9 // struct gpu_shadow_ray for each slot
#define BINDING_RADIANCE 10   // radiance of each slot's path: vec4, then AOVs, see aov.h
#define BINDING_QUEUES 11     // struct gpu_counters, then slot indices: see lib/buffers.glsl
#define BINDING_SORT 12       // struct gpu_sort
#define BINDING_FILM 13       // struct gpu_film_pixel
#define BINDING_RESOLVED 14   // struct gpu_resolved_pixel
#define BINDING_SUSPENDED 15  // suspended traversals, one for each slot
#define BINDING_COUNT 16

#define TEXEL_BINDING_FIRST 16
#define TEXEL_BINDING_COUNT 12
#define TEXEL_BINDING(binding) (TEXEL_BINDING_FIRST + (binding))
#define UNIFORM_BINDING_FRAME 28 // struct gpu_frame

// From this binding on, storage buffers have the parts of scene buffers beyond the range of a
// storage buffer. The constant PARTS has their number for each buffer; the parts of a buffer,
// except its first, are adjacent.
#define BINDING_PARTS 29
// For each binding up to BINDING_TEXELS the constant PARTS has, in PARTS_BITS bits, the number of
// the buffer's parts after the first one.
#define PARTS_BITS 4
#define PARTS_OF(parts, binding) (((parts) >> (PARTS_BITS * (binding))) & 15u)

// Specialization constants, in the order of struct specialization (render/specialize.h).
#define CONSTANT_FEATURES 0
#define CONSTANT_WORKGROUP 1
#define CONSTANT_STACK_ENTRIES 2
#define CONSTANT_ITERATION_BUDGET 3
#define CONSTANT_INTERLEAVE 4
#define CONSTANT_LOBES 5    // LOBE_* of the class that a kernel shades, or of all materials
#define CONSTANT_QUEUES 6   // bit mask of the queues in use
#define CONSTANT_EMITTERS 7 // EMITTER_* at which shadow rays may be aimed
#define CONSTANT_AOVS 8     // requested AOV_*
// Constants of shared/methods.h.
#define CONSTANT_INTEGRATOR 9
#define CONSTANT_SAMPLER 10
#define CONSTANT_HALVES 11
#define CONSTANT_FILTER 12
#define CONSTANT_CAMERA 13
#define CONSTANT_LIGHT_CHOICE 14
#define CONSTANT_LIGHT_RAYS 15 // maximum number of shadow rays of a vertex
#define CONSTANT_MIS 16
#define CONSTANT_DIRECTIONS 17
#define CONSTANT_ROULETTE 18
#define CONSTANT_NODES 19
#define CONSTANT_GEOMETRY 20 // GEOMETRY_*
#define CONSTANT_SDF 21      // SDF_*: operations in the scene's distance fields
#define CONSTANT_PARTS 22
#define CONSTANT_PART_SHIFT 23 // a part has 2^PART_SHIFT uvec4 words
#define CONSTANT_ENVIRONMENT_FILTER 24
#define CONSTANT_PIXEL_SAMPLING 25
#define CONSTANT_LEAF_INDEX_BITS 26 // number of index bits in a triangle leaf's word: see bvh/bvh.h
#define CONSTANT_NORMALS 27
#define CONSTANT_RADIANCE_SCALING 28 // whether refraction scales radiance
#define CONSTANT_ACCUMULATION 29
#define CONSTANT_ROUNDING 30 // ROUNDING_*
// Entries of a thread's stack that are in shared memory: lib/stack.glsl.
#define CONSTANT_STACK_SHARED 31
// With LIGHT_CHOICE_ALL: the number of vertices of a path, from its beginning, that send a shadow
// ray to each lamp.
#define CONSTANT_LIGHT_VERTICES 32
#define CONSTANT_WINDOW 33 // 1: the film is a window of the picture, see picture_pixel()
#define CONSTANT_COUNT 34

// Value of CONSTANT_LIGHT_VERTICES for all vertices.
#define ALL_VERTICES 0xffffffffu

// The device's rounding of sums and products: to the nearest float if that mode can be requested,
// otherwise to either neighbour, which is all that Vulkan guarantees.
#define ROUNDING_ANY 0
#define ROUNDING_NEAREST 1

// Features that a scene, its settings and a device need. Kernels test these bits of one
// specialization constant, so that the code of other features is removed.
#define FEATURE_TRIANGLES (1u << 0)
#define FEATURE_FAR_CAMERA (1u << 1)  // camera rays begin near the scene, see frame.camera_start
#define FEATURE_SPLIT_LOBES (1u << 2) // paths split at their first vertices, see lib/split.glsl
#define FEATURE_NORMALS (1u << 3)     // interpolated shading normals
#define FEATURE_LENS (1u << 4)        // camera rays begin at points of an aperture
#define FEATURE_CLASSES (1u << 5)     // surface hits are sorted by class
#define FEATURE_EMISSION (1u << 6)    // some surface emits light
#define FEATURE_CLAMP (1u << 7)       // the largest component of contributions is limited
#define FEATURE_MIN_DENSITY (1u << 8) // paths end if the density of their next direction is too low
#define FEATURE_NEE_DEPTH (1u << 9)   // only the first vertices of a path send shadow rays
#define FEATURE_NEE (1u << 10)        // shadow rays to emitters
#define FEATURE_BSDF_HITS_EMITTERS (1u << 11) // emission found by BSDF sampling counts
#define FEATURE_ENVIRONMENT (1u << 12)
#define FEATURE_ENVIRONMENT_IMAGE (1u << 13)
#define FEATURE_ROULETTE (1u << 14)
#define FEATURE_JITTER (1u << 15)
#define FEATURE_TEXTURES (1u << 16)
#define FEATURE_TEXELS_FLOAT (1u << 17) // some texture has texels of four floats
#define FEATURE_TEXELS_CODES (1u << 18) // some texture has texels of four 8-bit codes
#define FEATURE_UV0 (1u << 19)
#define FEATURE_UV1 (1u << 20)
#define FEATURE_TANGENTS (1u << 21)
#define FEATURE_COLORS (1u << 22) // vertex colours, which scale base colour and opacity
#define FEATURE_ALPHA (1u << 23)  // some material has opacity < 1
// The following features depend on the device rather than on the scene.
#define FEATURE_TEXEL_SCENE (1u << 24) // scene buffers are read as texel buffers
#define FEATURE_TEXEL_STATE (1u << 25) // path state is read as texel buffers
#define FEATURE_BALLOT (1u << 26)      // queue slots are reserved by subgroup ballot
// The following feature depends on the dispatch: a traversal that exceeds its budget saves its
// state, and continues later.
#define FEATURE_SUSPEND (1u << 27)
#define FEATURE_STEPS (1u << 31) // steps of traversals are counted
// The following features depend on the scene.
#define FEATURE_MEDIA (1u << 28) // some surfaces bound a medium: refraction, absorption
#define FEATURE_NORMAL_MAPS (1u << 29)
#define FEATURE_TILES (1u << 30) // tiles of the image have sample counts of their own

// Kinds of geometry other than triangles.
#define GEOMETRY_SPHERES (1u << 0)
#define GEOMETRY_DISCS (1u << 1)
#define GEOMETRY_PLANES (1u << 2)
#define GEOMETRY_QUADS (1u << 3)
#define GEOMETRY_BOXES (1u << 4)
#define GEOMETRY_CYLINDERS (1u << 5) // closed
#define GEOMETRY_TUBES (1u << 6)     // cylinders without caps
#define GEOMETRY_SDFS (1u << 7)      // signed distance fields
#define GEOMETRY_SHAPES ((1u << 8) - 1u)
#define GEOMETRY_LARGE_SPHERES (1u << 8) // spheres whose equation needs more than single precision
#define GEOMETRY_INSTANCES (1u << 9)     // instances of meshes that have their own BVH
#define GEOMETRY_DUPLICATES (1u << 10)   // some triangle is in more than one leaf
// Some triangles are small relative to their coordinates.
#define GEOMETRY_SMALL_TRIANGLES (1u << 11)
#define GEOMETRY_END (1u << 12)

// Kinds of emitters at which shadow rays are aimed.
#define EMITTER_TRIANGLES (1u << 0)
#define EMITTER_SPHERES (1u << 1)
#define EMITTER_DISCS (1u << 2)
#define EMITTER_LIGHTS (1u << 3)      // delta lights: point, spot and directional
#define EMITTER_SUNS (1u << 4)        // directional lights with an angular diameter
#define EMITTER_PROFILES (1u << 5)    // delta lights have profiles
#define EMITTER_ENVIRONMENT (1u << 6) // image of the environment
#define EMITTER_QUADS (1u << 7)
#define EMITTER_BOXES (1u << 8)
#define EMITTER_CYLINDERS (1u << 9)
#define EMITTER_TUBES (1u << 10)
#define EMITTERS_SHAPES                                                                            \
    (EMITTER_SPHERES | EMITTER_DISCS | EMITTER_QUADS | EMITTER_BOXES | EMITTER_CYLINDERS |         \
     EMITTER_TUBES)
#define EMITTERS_LIGHTS (EMITTER_LIGHTS | EMITTER_SUNS)
#define EMITTERS_ALL                                                                               \
    (EMITTER_TRIANGLES | EMITTERS_SHAPES | EMITTERS_LIGHTS | EMITTER_PROFILES | EMITTER_ENVIRONMENT)

// AOVs of the first surface that a camera ray hits.
#define AOV_ALBEDO (1u << 0)
#define AOV_NORMAL (1u << 1)
#define AOV_NORMAL_GEOMETRIC (1u << 2)
#define AOV_DEPTH (1u << 3)
#define AOV_POSITION (1u << 4)
#define AOV_IDS (1u << 5)
// Parts of the radiance: after none, one, and more scattering events.
#define AOV_EMISSION (1u << 6)
#define AOV_DIRECT (1u << 7)
#define AOV_INDIRECT (1u << 8)
// Every film has the data of the following AOVs.
#define AOV_SAMPLES (1u << 9)
#define AOV_VARIANCE (1u << 10)
#define AOV_HALVES (1u << 11)
#define AOV_ALPHA (1u << 12) // fraction of samples that hit a surface
// The following AOV is measured on camera rays.
#define AOV_STEPS (1u << 13) // nodes visited and primitives tested until the first hit
#define AOV_END (1u << 14)
// The following bits are not AOVs but requests of --error-by, see aov.h.
#define AOV_BY_PART (1u << 14)
#define AOV_BY_BOUNCE (1u << 15)
#define AOV_BY_EMITTER (1u << 16)

#endif
