// Records in GPU memory, laid out so that std430 and C agree: 32-bit scalars only, in groups of
// four words. Kernels read most of them word by word through load_*() (lib/buffers.glsl), so the
// word index of each member is part of the contract.
#ifndef LAMPYRIS_SHARED_TYPES_H
#define LAMPYRIS_SHARED_TYPES_H

#include "bindings.h"
#include "film_sums.h"
#include "material.h"
#include "methods.h"

#ifdef GL_core_profile
#define RECORD(name) name
#define VEC3(name) vec3 name // with a scalar behind it: in uniform blocks arrays would be padded
#define SHARED_STATIC_ASSERT_SIZE(name, bytes)
#else
#include <stdint.h>
typedef uint32_t uint;
#define RECORD(name) struct name
#define VEC3(name) float name[3]
#define SHARED_STATIC_ASSERT_SIZE(name, bytes)                                                     \
    _Static_assert(sizeof(struct name) == (bytes), "std430 and C must agree")
#endif

#define NO_PRIMITIVE 0xffffffffu
#define NORMAL_FLAT 0x80008000u // gpu_normals.n0 of a triangle without shading normals
// A primitive word: a shape's index with this bit, or a triangle's place in leaf order.
#define PRIMITIVE_SHAPE 0x40000000u
// A delta light: its index with this bit. It is never hit, so that shadow rays may ignore it.
#define PRIMITIVE_LIGHT 0x20000000u
// This word stands for the environment as an emitter.
#define PRIMITIVE_ENVIRONMENT 0x10000000u
#define NO_EMITTER 0xffffffffu

// Three words of four; w's carry what shading needs, so that no index leads elsewhere.
struct gpu_triangle {
    float v0[3];
    uint id; // id in the flat scene: decides between hits at equal distance
    float v1[3];
    uint material; // a material word, see below
    float v2[3];
    uint emitter; // its number among the emitters, or NO_EMITTER; with MATERIAL_WORD_EDGES its
                  // place among the small triangles
};
SHARED_STATIC_ASSERT_SIZE(gpu_triangle, 48);

// A triangle of a lamp that is too small for where it is, about the lamp's middle and in a unit of
// the lamp's own.
struct gpu_small_triangle {
    float v0[3];
    uint first; // first triangle of its lamp, whose triangles are adjacent
    float edge1[3];
    uint count; // number of its lamp's triangles
    float edge2[3];
    uint emitter; // as of triangles
};
SHARED_STATIC_ASSERT_SIZE(gpu_small_triangle, 48);
#define SMALL_TRIANGLE_WORDS 3

// Attributes of a triangle: words of four in this order, those that the scene has; so many of them
// from one triangle to the next (attribute_words() in lib/attributes.glsl and render/attributes.h).
//   FEATURE_NORMALS   1: octahedral unit vectors, 2 x 16-bit snorm each, of the corners; 0
//   FEATURE_TANGENTS  1: the same for tangents; bit c of the last word: bitangent of corner c is
//                        -cross(normal, tangent), else +
//   FEATURE_UV0       2: u, v of three corners; 0, 0
//   FEATURE_UV1       2: the same
//   FEATURE_COLORS    2: RGBA of three corners as halves (2 uints each); 0, 0

// Bit n of GEOMETRY_* stands for kind n.
#define SHAPE_KIND_SPHERE 0u
#define SHAPE_KIND_DISC 1u
#define SHAPE_KIND_PLANE 2u // without end
#define SHAPE_KIND_QUAD 3u  // a parallelogram
#define SHAPE_KIND_BOX 4u   // with right angles, turned any way
#define SHAPE_KIND_CYLINDER 5u
#define SHAPE_KIND_TUBE 6u
#define SHAPE_KIND_SDF 7u
#define SHAPE_KIND_BIT(kind) (1u << (kind))
struct gpu_shape {
    float center[3]; // plane: a point of it; distance field: of its box
    float radius;    // box: half of its edge along cross(axis, other)
    float axis[3];   // disc, plane: unit normal; quad, box: half an edge; cylinder, tube: from the
                     // centre to an end
    uint kind_material; // kind in bits 28-31, a material word below
    uint emitter;       // as of triangles
    float other[3];     // quad, box: half of another edge; plane, cylinder, tube: a unit vector at
                        // right angles to the axis, where u is 0; distance field: as bits of the
                        // first, its number
};
SHARED_STATIC_ASSERT_SIZE(gpu_shape, 48);
#define SHAPE_WORDS 3
#define SHAPE_KIND_SHIFT 28

// The shapes' buffer: struct gpu_shape, then at frame.instances struct gpu_instance, then at
// frame.sdfs struct gpu_sdf, then at frame.sdf_code the words of their programs (shared/sdf.h),
// then at frame.small_triangles struct gpu_small_triangle.

// A placed mesh that has a BVH of its own, among the BVH's nodes.
struct gpu_instance {
    float to_object[3][4]; // rows of its matrix; their fourths: what is subtracted before
    float to_world[3][4];
    uint root;     // node
    uint material; // word, in place of the triangles' own; or NO_MATERIAL
    uint id;       // id in the flat scene: at equal distances decides before triangles' ids
    uint flags;    // INSTANCE_*
};
SHARED_STATIC_ASSERT_SIZE(gpu_instance, 112);
#define INSTANCE_WORDS 7
#define INSTANCE_MIRRORED 1u // the transform turns the winding round
#define NO_MATERIAL 0xffffffffu
#define NO_INSTANCE 0xffffffffu

// A material word: index, class, and whether the surface may be not there.
#define MATERIAL_INDEX_MASK 0x00ffffffu
#define MATERIAL_CLASS_SHIFT 24 // 2 bits
#define MATERIAL_CLASS_MASK 3u
#define MATERIAL_WORD_ALPHA (1u << 27)
#define MATERIAL_WORD_EDGES (1u << 28) // a triangle whose v1 and v2 are edges from v0

// The materials' buffer: this header, then struct gpu_material for each material, and the sections
// that begin at these words of four.
struct gpu_material_header {
    uint textures;     // struct gpu_texture
    uint lights;       // struct gpu_light
    uint media;        // struct gpu_medium; medium m is record m - 1
    uint albedos;      // the tables of lib/albedo.glsl
    uint camera_media; // the stack of media that camera rays start in, see lib/media.glsl
    float camera_ior;  // index of refraction of the medium that they start in
    uint suns;         // struct gpu_sun
    uint sun_count;
};
SHARED_STATIC_ASSERT_SIZE(gpu_material_header, 32);
#define MATERIAL_HEADER_WORDS 2 // words of four

struct gpu_material {
    uint model_flags;   // MATERIAL_*
    uint first_texture; // first of its textures, which are adjacent
    uint texture_count;
    uint medium; // medium inside of it; 0: none
    float parameter[PARAMETER_COUNT];
};
SHARED_STATIC_ASSERT_SIZE(gpu_material, 192);
#define MATERIAL_WORDS 12

struct gpu_texture {
    uint texels; // the first one: in units of 16 bytes of the texels' buffer
    uint size;   // width in bits 0-15, height in 16-31
    uint flags;  // TEXTURE_*
    uint align_texture;
    float transform[2][4]; // s = row 0 . (u, v, 1), t = row 1 . (u, v, 1); the fourth is 0
};
SHARED_STATIC_ASSERT_SIZE(gpu_texture, 48);
#define TEXTURE_WORDS 3

// The medium inside of a closed surface.
struct gpu_medium {
    float extinction[3]; // 1/length, at most 3.4e38 in place of infinity
    float ior;
    uint priority;    // where media overlap, the highest one is there; 0: air
    float dispersion; // 20 / Abbe number
    uint align_medium[2];
};
SHARED_STATIC_ASSERT_SIZE(gpu_medium, 32);
#define MEDIUM_WORDS 2
#define MEDIA_MAX 255u // different ones in a scene: a stack of four is one word

struct gpu_light {
    float position[3]; // point, spot
    uint kind;
    float direction[3]; // unit, in which light travels: spot, directional
    float pick_probability;
    float radiant[3];    // point, spot: radiance * length^2; directional: irradiance, W/m^2
    float inverse_range; // 1 / the distance beyond which there is no light, 1/length; 0: unlimited
    float spot_scale, spot_offset; // falloff: clamp(offset - scale * (1 - cos), 0, 1)^2
    float reach;                   // directional: the length of shadow rays
    float versine; // directional: 1 - cos of the angular radius of a sun; 0: a delta light
    // Point, spot: see lib/profile.glsl.
    float profile_x[3]; // unit, orthogonal to the direction
    uint profile;       // its first word of four in the materials' buffer; 0: none
};
SHARED_STATIC_ASSERT_SIZE(gpu_light, 80);
#define LIGHT_WORDS 5

// A directional light with an angular radius, for the rays that see it.
struct gpu_sun {
    float direction[3]; // unit, towards it
    float versine;
    float radiance[3];
    float pick_probability;
};
SHARED_STATIC_ASSERT_SIZE(gpu_sun, 32);
#define SUN_WORDS 2

// An emitter to choose, by its primitive's word. By power: a bin of Vose's alias table, with
// u < threshold the bin's own primitive, else its alias. Uniformly: thresholds are 1.
struct gpu_emitter {
    float threshold;
    uint primitive;
    uint alias_primitive;
    uint align_emitter;
};
SHARED_STATIC_ASSERT_SIZE(gpu_emitter, 16);

// The buffer of a tree of emitters begins with this header; sections begin at words of four.
struct gpu_light_tree {
    uint root;     // the root's word as a child; not defined if the tree is empty
    uint trails;   // struct gpu_light_trail, by the number of an emitter
    uint infinite; // struct gpu_emitter: the bins of the infinitely far emitters
    uint infinite_count;
    float infinite_share; // probability to choose an infinitely far emitter
    uint lamps;           // struct gpu_lamp, by number; only with LIGHT_CHOICE_ALL
    uint align_tree[2];
};
SHARED_STATIC_ASSERT_SIZE(gpu_light_tree, 32);
#define LIGHT_TREE_WORDS 2 // then pairs of struct gpu_light_bounds

// Half of a node: where a child's emitters are and where they send light.
struct gpu_light_bounds {
    float center[3];
    float radius;
    uint axis;    // octahedral
    uint cosines; // theta_o in bits 0-15, theta_e in 16-30, each from -1 to 1; LIGHT_TWO_SIDED
    float power;  // fraction of the power of all
    uint child;   // a pair's number, or LIGHT_LEAF and the word of a primitive
};
SHARED_STATIC_ASSERT_SIZE(gpu_light_bounds, 32);
#define LIGHT_PAIR_WORDS 4
#define LIGHT_LEAF 0x80000000u
#define LIGHT_TWO_SIDED 0x80000000u
#define LIGHT_COS_O_SCALE 65535.0
#define LIGHT_COS_E_SCALE 32767.0

// The way down the tree to an emitter: bit n says whether the n-th child on it is the second one.
struct gpu_light_trail {
    uint low, high;
    uint depth; // bits; LIGHT_NOWHERE: not in the tree
    uint lamp;  // the emitter's lamp
};
SHARED_STATIC_ASSERT_SIZE(gpu_light_trail, 16);
#define LIGHT_NOWHERE 0xffffffffu

// A lamp: emitters that hang together, or one that stands alone, or is infinitely far.
struct gpu_lamp {
    uint child; // all its emitters are below this child
    uint depth; // depth of this child: bits of a trail; LIGHT_NOWHERE: it sends nothing
    uint align_lamp[2];
};
SHARED_STATIC_ASSERT_SIZE(gpu_lamp, 16);

// One path in flight: one cache line.
struct gpu_path {
    float origin[3];
    uint ignore;        // the primitive the ray starts on; planar ones cannot be hit again
    float direction[3]; // unit
    float bsdf_pdf; // solid-angle density that chose the direction; 0: camera or perfectly specular
    float throughput[3];
    uint media; // the stack of media it is in, see lib/media.glsl
    float t;    // distance of the hit; not valid for misses
    float u, v;
    uint primitive;
};
SHARED_STATIC_ASSERT_SIZE(gpu_path, 64);
// Words of four from one path's record to the next. With instances it has one more: the instance
// that was hit and that on which the ray starts, or NO_INSTANCE; 0, 0. With INTEGRATOR_BIDIR the
// last one has what weights are made of: of a camera path Q of lib/bidir.glsl; of a light path two
// ratios of densities, the scale of its throughput, and the half of the film that it adds to.
#define PATH_WORDS_OF(geometry, integrator)                                                        \
    ((((geometry)&GEOMETRY_INSTANCES) != 0u ? 5u : 4u) +                                           \
     ((integrator) == INTEGRATOR_BIDIR ? 1u : 0u))
#define PATH_ORIGIN 0
#define PATH_DIRECTION 1
#define PATH_THROUGHPUT 2
#define PATH_HIT 3
#define PATH_INSTANCE 4

// The segment origin + s * direction, s in (0, 1), and what arrives when nothing is in between.
struct gpu_shadow_ray {
    float origin[3];
    uint ignore_from;
    float direction[3]; // not normalised: reaches to the sampled point
    uint ignore_to;
    float radiance[3];
    float light_pdf; // solid-angle density of the sampled direction, or the selection probability
                     // of a delta light; for replay. Of a light path: the pixel, as bits
};
SHARED_STATIC_ASSERT_SIZE(gpu_shadow_ray, 48);
// Words of a shadow ray that the scene has. With instances there is one more: the instance on which
// the ray starts; 0, 0, 0.
#define SHADOW_WORDS_OF(geometry) (((geometry)&GEOMETRY_INSTANCES) != 0u ? 4u : 3u)
#define SHADOW_INSTANCE 3
#ifdef GL_core_profile
#define PATH_WORDS PATH_WORDS_OF(GEOMETRY, INTEGRATOR)
#define PATH_WEIGHTS (PATH_WORDS - 1u)
#define SHADOW_WORDS SHADOW_WORDS_OF(GEOMETRY)
#endif

// A suspended traversal, in words: these, then its stack (lib/suspend.glsl). With instances the one
// that it is in, and that of the hit.
#define SUSPENDED_WORDS_OF(geometry) (((geometry)&GEOMETRY_INSTANCES) != 0u ? 10u : 8u)

// The sums of the two half-buffers: unless the halves are contiguous, a pixel's samples go to one
// and the other in turn from when the film was last emptied. A sum has four words (film_sums.h):
// its bin of even digits, then that of odd ones, each with its low word first. ACCUMULATION_SUM and
// ACCUMULATION_RUNNING have a float in the first of them, and FILM_HAS_FLOATS in digits_a;
// digits_b then is 1 + how many samples the means of half a are of, and those of b of the others;
// 0: they are sums.
struct gpu_film_pixel {
    uint samples; // both halves
    uint dropped; // samples with a non-finite contribution left out
    uint digits_a;
    uint digits_b;
    uint sums_a[12]; // r, g, b
    uint sums_b[12];
};
SHARED_STATIC_ASSERT_SIZE(gpu_film_pixel, 112);
#define FILM_WORDS 7
#define FILM_HALF_WORDS 3u // words of four: the sums of a half
// One word of four holds the digits of this many groups of four sums of the layers.
#define FILM_GROUPS_A_WORD 4u

struct gpu_resolved_pixel {
    float mean_a[3];
    uint samples;
    float mean_b[3];
    uint dropped;
};
SHARED_STATIC_ASSERT_SIZE(gpu_resolved_pixel, 32);
#define RESOLVED_WORDS 2

// Queues of slot indices.
#define QUEUE_RAYS 0      // even bounces; QUEUE_RAYS + 1: odd bounces
#define QUEUE_SURFACE 2   // + class, with FEATURE_CLASSES; else the first one for all
#define QUEUE_MISS 6      // with FEATURE_ENVIRONMENT only
#define QUEUE_SHADOW 7    // with FEATURE_NEE only: slots with some shadow ray
#define QUEUE_SUSPENDED 8 // + 1: the other one, by turns; with FEATURE_SUSPEND only
#define QUEUE_COUNT 10

// The sites at which non-finite contributions are found.
#define SITE_MISS 0
#define SITE_EMISSION 1
#define SITE_SHADOW 2
#define SITE_THROUGHPUT 3
#define SITE_COUNT 4
#define NONFINITE_RECORDS 32

#define DISPATCH_PARTS 64

// FEATURE_STEPS counts these of rays to the nearest hit and of shadow rays.
#define STEPS_CLOSEST 0 // nodes visited; + 1: primitives tested
#define STEPS_SHADOW 2  // the same
#define STEPS_COUNT 4

#define CLAMP_UNITS 1024.0f
#define CLAMP_UNITS_MOST 2.74877907e11f // for one contribution, 2^38: a wave's sum stays below 2^64

struct gpu_dispatch {
    uint x, y, z;
    uint items;
};

// A queue's length in a cache line of its own: the subgroups of a kernel that fills several queues
// then wait for each other at each alone. GPUs have lines of 64 and of 128 bytes.
struct gpu_queue {
    uint count;
    uint align_queue[31];
};
SHARED_STATIC_ASSERT_SIZE(gpu_queue, 128);

struct gpu_counters {
    RECORD(gpu_queue) queue[QUEUE_COUNT];
    uint surface_hits[CLASS_COUNT][2]; // 64 bits each
    uint
        media_lost; // paths that entered more media than the stack holds, or left one never entered
    uint clamped;   // contributions, with FEATURE_CLAMP
    uint clamped_light[2]; // what they lost: 64 bits, CLAMP_UNITS a limit
    uint closest_rays[2];  // 64 bits, low word first
    uint shadow_rays[2];
    uint steps[STEPS_COUNT][2];
    uint unfinished; // rays that ran out of budget without FEATURE_SUSPEND: results void
    uint suspended;  // continuations in all
    uint nonfinite[SITE_COUNT];
    uint nonfinite_records; // how many of the following were claimed (may exceed their number)
    uint sparse;            // paths, or branches of them, that FEATURE_MIN_DENSITY has ended
    uint branches;          // that paths got where they split, with FEATURE_MIN_DENSITY
    RECORD(gpu_dispatch) dispatch[QUEUE_COUNT * DISPATCH_PARTS];
    uint nonfinite_record[NONFINITE_RECORDS * 4]; // pixel, sample, site, bounce
    uint align_counters[31];                      // what is behind them begins with a cache line
};
SHARED_STATIC_ASSERT_SIZE(gpu_counters, 12288);
// Bytes before the slot indices in the buffer of BINDING_QUEUES.
#define QUEUES_OFFSET sizeof(struct gpu_counters)

// The counts and places of a sort of rays (lib/sort.glsl), which has 2^SORT_CELL_BITS cells along
// each axis.
#define SORT_CELL_BITS 3
#define SORT_KEYS (8 << 3 * SORT_CELL_BITS) // 8 octants of so many cells
struct gpu_sort {
    uint count[SORT_KEYS]; // rays that have a key; 0 when no sort is under way
    uint place[SORT_KEYS]; // in the sorted queue, of the next ray that has it
};
SHARED_STATIC_ASSERT_SIZE(gpu_sort, 32768);

// Push constants: what changes from dispatch to dispatch.
struct gpu_push {
    uint bounce;
    uint first_pixel; // number in the image of this wave's first pixel
    uint pixel_count; // pixels of this wave
    uint first_sample;
    uint sample_shift; // a wave holds pixel_count << sample_shift paths, a pixel's samples adjacent
    uint queue;        // the queue that the kernel consumes, or a mask for prepare_dispatch
    uint first_item;   // first item in the queue, for this part of a split dispatch
    uint part_items;   // items a part has at most
    uint film_first_pixel; // pixel that the bound range of the film begins with
    uint light_ray;        // which of a slot's shadow rays
    uint align_push[2];
};
SHARED_STATIC_ASSERT_SIZE(gpu_push, 48);

// The uniform block: what is small and the same for all dispatches of a render. Lengths, here and
// in all records, are in the unit of the flat scene (flatten/flatten.h), as positions are.
struct gpu_frame {
    VEC3(camera_position); // where the middle of the picture is at camera_start
    uint width;
    VEC3(camera_forward); // unit
    uint height;
    VEC3(camera_right); // to the right edge: at distance 1, orthographic a length, panoramic unit
    uint seed;
    VEC3(camera_up); // to the upper edge
    uint max_bounces;
    VEC3(environment);     // radiance, or the factor on the image's
    uint environment_size; // width in bits 0-15, height in 16-31
    float environment_cos; // cosine of the angle by which it is turned about +Y
    float environment_sin;
    float environment_pick; // the probability to connect to it, where that does not depend on where
    uint emitter_count;
    uint wave_slots;   // capacity of a queue and of the path arrays
    uint samples;      // a pixel, as planned; 0: not known
    uint nee_depth;    // vertices that send shadow rays
    float clamp_limit; // limit for a contribution's largest component
    uint roulette_min_bounces;
    uint roulette_max_bounces; // cap of the depth with ROULETTE_FRAME
    float roulette_survival;
    float direction_exponent; // only for DIRECTIONS_POWER_COSINE
    float lens_radius;
    float focus_distance; // from the camera to the plane in focus
    float lens_rotation;  // rotation of the aperture's blades, radians
    uint lens_blades;     // 0: round
    float filter_radius;  // pixels
    float ao_distance;
    float metre;             // metres a unit of length: a power of two
    float environment_reach; // the length of shadow rays to it
    VEC3(ambient);           // INTEGRATOR_WHITTED: what is around the scene, on average
    uint pending_rays;       // INTEGRATOR_WHITTED: entries of a slot's stack
    uint instances;          // words of four at which sections of the shapes' buffer begin
    uint sdfs;
    uint sdf_code;
    // FEATURE_FAR_CAMERA; else 0 and 1.
    float camera_start;      // along the line of sight, how far from the camera its rays begin
    float lens_at_start;     // how large the lens is there: 1 - camera_start / focus_distance
    uint small_triangles;    // as `instances`
    uint pixel_strata;       // a side of a pixel, of PIXEL_SAMPLING_GRID and _STRATIFIED
    float mis_exponent;      // only for MIS_POWER_ANY
    float min_density;       // least density of a direction, 1/sr, with FEATURE_MIN_DENSITY
    uint split_lobes;        // vertices at which paths split, with FEATURE_SPLIT_LOBES
    float environment_floor; // subtracted from the luminances that its image is sampled by
    uint align_frame;
    VEC3(cells_begin); // where rays are sorted by cells: the scene's lowest corner,
    uint align_cells;
    VEC3(cells_a_length); // and how many cells there are in a unit of length
    uint align_cells_1;
    VEC3(scene_center); // INTEGRATOR_BIDIR: of the sphere that infinitely far light is aimed at
    float scene_radius;
};
SHARED_STATIC_ASSERT_SIZE(gpu_frame, 272);

#endif
