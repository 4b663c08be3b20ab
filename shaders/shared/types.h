// Records in GPU memory, laid out so that std430 and C agree: 32-bit scalars only, in groups of
// four words. Kernels read most of them word by word through load_*() (lib/buffers.glsl), so the
// word index of each member is part of the contract.
#ifndef LAMPYRIS_SHARED_TYPES_H
#define LAMPYRIS_SHARED_TYPES_H

#ifdef GL_core_profile
#define RECORD(name) name
#define SHARED_STATIC_ASSERT_SIZE(name, bytes)
#else
#include <stdint.h>
typedef uint32_t uint;
#define RECORD(name) struct name
#define SHARED_STATIC_ASSERT_SIZE(name, bytes)                                                     \
    _Static_assert(sizeof(struct name) == (bytes), "std430 and C must agree")
#endif

#define NO_PRIMITIVE 0xffffffffu
#define NORMAL_FLAT 0x80008000u // gpu_normals.n0 of a triangle without shading normals
// A primitive word: a shape's index with this bit, or a triangle's place in leaf order.
#define PRIMITIVE_SHAPE 0x40000000u

// Three words of four; w's carry what shading needs, so that no index leads elsewhere.
struct gpu_triangle {
    float v0[3];
    uint id; // of the flat scene: decides between hits at equal distance
    float v1[3];
    uint material;
    float v2[3];
    uint align_v2;
};
SHARED_STATIC_ASSERT_SIZE(gpu_triangle, 48);

// Octahedral unit vectors, 2 x 16-bit snorm each.
struct gpu_normals {
    uint n0, n1, n2;
    uint align_normals;
};
SHARED_STATIC_ASSERT_SIZE(gpu_normals, 16);

#define SHAPE_KIND_SPHERE 0u
#define SHAPE_KIND_DISC 1u
struct gpu_shape {
    float center[3];
    float radius;
    float normal[3];
    uint kind_material; // kind in bits 28-31, material below
};
SHARED_STATIC_ASSERT_SIZE(gpu_shape, 32);
#define SHAPE_KIND_SHIFT 28
#define SHAPE_MATERIAL_MASK 0x0fffffffu

#define MATERIAL_KIND_DIFFUSE 0u
#define MATERIAL_KIND_MIRROR 1u
struct gpu_material {
    float base_color[3];
    uint kind;
    float emission[3];
    // Density, a unit area, with which next-event estimation picks a point on an emitter of this
    // material: luminance / sum of (luminance * area) over all emitters. 0: never picked.
    float pick_density;
};
SHARED_STATIC_ASSERT_SIZE(gpu_material, 32);

// Vose's alias table: with u < threshold the bin's own primitive, else its alias.
struct gpu_emitter {
    float threshold;
    uint primitive;
    uint alias_primitive;
    uint align_emitter;
};
SHARED_STATIC_ASSERT_SIZE(gpu_emitter, 16);

// One path in flight: one cache line.
struct gpu_path {
    float origin[3];
    uint ignore;        // the primitive the ray starts on; planar ones cannot be hit again
    float direction[3]; // unit
    float bsdf_pdf; // solid-angle density that chose the direction; 0: camera or perfectly specular
    float throughput[3];
    uint align_throughput;
    float t; // of the hit; not valid for misses
    float u, v;
    uint primitive;
};
SHARED_STATIC_ASSERT_SIZE(gpu_path, 64);
#define PATH_WORDS 4 // of four
#define PATH_ORIGIN 0
#define PATH_DIRECTION 1
#define PATH_THROUGHPUT 2
#define PATH_HIT 3

// The segment origin + s * direction, s in (0, 1), and what arrives when nothing is in between.
struct gpu_shadow_ray {
    float origin[3];
    uint ignore_from;
    float direction[3]; // not normalised: reaches to the sampled point
    uint ignore_to;
    float radiance[3];
    float light_pdf; // solid-angle density of the sampled direction: for replay
};
SHARED_STATIC_ASSERT_SIZE(gpu_shadow_ray, 48);
#define SHADOW_WORDS 3

// Compensated sums (Kahan 1965) of the two half-buffers: sample s belongs to half s & 1. The value
// of a sum is sum - lost.
struct gpu_film_pixel {
    float sum_a[3];
    uint samples; // both halves
    float lost_a[3];
    uint dropped; // samples with a non-finite contribution left out
    float sum_b[3];
    uint align_b;
    float lost_b[3];
    uint align_lost_b;
};
SHARED_STATIC_ASSERT_SIZE(gpu_film_pixel, 64);
#define FILM_WORDS 4

struct gpu_resolved_pixel {
    float mean_a[3];
    uint samples;
    float mean_b[3];
    uint dropped;
};
SHARED_STATIC_ASSERT_SIZE(gpu_resolved_pixel, 32);

// Queues of slot indices.
#define QUEUE_RAYS 0 // even bounces; QUEUE_RAYS + 1: odd bounces
#define QUEUE_SURFACE 2
#define QUEUE_MISS 3      // with FEATURE_ENVIRONMENT only
#define QUEUE_SHADOW 4    // with FEATURE_NEE only
#define QUEUE_SUSPENDED 5 // + 1: the other one, by turns; with FEATURE_SUSPEND only
#define QUEUE_COUNT 7

// Where a non-finite contribution came from.
#define SITE_MISS 0
#define SITE_EMISSION 1
#define SITE_SHADOW 2
#define SITE_THROUGHPUT 3
#define SITE_COUNT 4
#define NONFINITE_RECORDS 32

#define DISPATCH_PARTS 64

struct gpu_dispatch {
    uint x, y, z;
    uint items;
};

struct gpu_counters {
    uint queue[8];        // QUEUE_COUNT used
    uint closest_rays[2]; // 64 bits, low word first
    uint shadow_rays[2];
    uint unfinished; // rays that ran out of budget without FEATURE_SUSPEND: results void
    uint suspended;  // continuations in all
    uint nonfinite[SITE_COUNT];
    uint nonfinite_records; // how many of the following were claimed (may exceed their number)
    uint align_records;
    RECORD(gpu_dispatch) dispatch[QUEUE_COUNT * DISPATCH_PARTS];
    uint nonfinite_record[NONFINITE_RECORDS * 4]; // pixel, sample, site, bounce
};

// Push constants: what changes from dispatch to dispatch, and what is small and the same for all.
struct gpu_push {
    float camera_position[3];
    uint width;
    float camera_forward[3]; // unit
    uint height;
    float camera_right[3]; // scaled: to the image's right edge at distance 1
    uint seed;
    float camera_up[3]; // to the upper edge
    uint bounce;
    float environment[3];  // radiance, or the factor on the image's
    uint environment_size; // width in bits 0-15, height in 16-31
    uint wave_slots;       // capacity of a queue and of the path arrays
    uint first_pixel;      // of the image, of this wave
    uint pixel_count;      // of this wave
    uint first_sample;
    uint sample_shift; // a wave holds pixel_count << sample_shift paths, a pixel's samples adjacent
    uint queue;        // that the kernel consumes, or a mask for prepare_dispatch
    uint first_item;   // of the queue, for this part of a split dispatch
    uint part_items;   // items a part has at most
    uint max_bounces;
    uint roulette_min_bounces;
    uint emitter_count;
    uint film_first_pixel; // pixel that the bound range of the film begins with
};
SHARED_STATIC_ASSERT_SIZE(gpu_push, 128);

#endif
