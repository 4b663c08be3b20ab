// Defines the records in GPU memory. They consist of 32-bit scalars, in groups of four, so that
// std430 and C agree on their layout. Such a group is called a uvec4 word. Kernels read most
// records one uvec4 word at a time with load_*() (lib/buffers.glsl), so kernels depend on the uvec4
// word and the component of each member.
#ifndef LAMPYRIS_SHARED_TYPES_H
#define LAMPYRIS_SHARED_TYPES_H

#include "bindings.h"
#include "film_sums.h"
#include "material.h"
#include "methods.h"

#ifdef GL_core_profile
#define RECORD(name) name
// A vector must be followed by a scalar, because an array would be padded in uniform blocks.
#define VEC3(name) vec3 name
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
#define NORMAL_FLAT                                                                                \
    0x80008000u // first component of the normals of a triangle that has no shading normals
// A primitive word: the index of a shape with this bit, or the position of a triangle in leaf
// order.
#define PRIMITIVE_SHAPE 0x40000000u
// A delta light: its index with this bit. No ray can hit it, so shadow rays may ignore it.
#define PRIMITIVE_LIGHT 0x20000000u
// The environment as an emitter.
#define PRIMITIVE_ENVIRONMENT 0x10000000u
#define NO_EMITTER 0xffffffffu

// Three uvec4 words. Their w components have the data for shading, so that no further read is
// needed.
struct gpu_triangle {
    float v0[3];
    uint id; // id in the flat scene: decides between hits at equal distance
    float v1[3];
    uint material; // a material word, see below
    float v2[3];
    uint emitter; // emitter index, or NO_EMITTER; with MATERIAL_WORD_EDGES its index among the
                  // small triangles
};
SHARED_STATIC_ASSERT_SIZE(gpu_triangle, 48);

// A triangle of a lamp that is small relative to its coordinates. Coordinates are relative to the
// lamp's centre and in the lamp's own unit.
struct gpu_small_triangle {
    float v0[3];
    uint first; // first triangle of its lamp; a lamp's triangles are adjacent
    float edge1[3];
    uint count; // number of triangles of its lamp
    float edge2[3];
    uint emitter; // as in gpu_triangle
};
SHARED_STATIC_ASSERT_SIZE(gpu_small_triangle, 48);
#define SMALL_TRIANGLE_WORDS 3

// Attributes of a triangle: those uvec4 words that the scene has, in this order. ATTRIBUTE_WORDS
// in lib/attributes.glsl and attribute_words() in render/attributes.h are the number of these
// words.
//   FEATURE_NORMALS   1: octahedral unit vectors, 2 x 16-bit snorm each, of the corners; 0
//   FEATURE_TANGENTS  1: the same for tangents; bit c of the last word: bitangent of corner c is
//                        -cross(normal, tangent), else +
//   FEATURE_UV0       2: u, v of three corners; 0, 0
//   FEATURE_UV1       2: the same
//   FEATURE_COLORS    2: RGBA of three corners as halves (2 uints each); 0, 0

// The kind n corresponds to bit n of GEOMETRY_*.
#define SHAPE_KIND_SPHERE 0u
#define SHAPE_KIND_DISC 1u
#define SHAPE_KIND_PLANE 2u // infinite
#define SHAPE_KIND_QUAD 3u  // a parallelogram
#define SHAPE_KIND_BOX 4u   // with right angles, in any orientation
#define SHAPE_KIND_CYLINDER 5u
#define SHAPE_KIND_TUBE 6u
#define SHAPE_KIND_SDF 7u
#define SHAPE_KIND_BIT(kind) (1u << (kind))
struct gpu_shape {
    float center[3]; // plane: one of its points; distance field: centre of its box
    float radius;    // box: half of its edge along cross(axis, other)
    float axis[3];   // disc, plane: unit normal; quad, box: half an edge; cylinder, tube: from the
                     // centre to an end
    uint kind_material; // kind in bits 28-31, a material word below
    uint emitter;       // as in gpu_triangle
    float other[3];     // quad, box: half of another edge; plane, cylinder, open cylinder: a unit
                        // vector perpendicular to the axis, at which u is 0; distance field:
                        // other[0] has its index as bits
};
SHARED_STATIC_ASSERT_SIZE(gpu_shape, 48);
#define SHAPE_WORDS 3
#define SHAPE_KIND_SHIFT 28

// The shapes' buffer: struct gpu_shape; from frame.instances on struct gpu_instance; from
// frame.sdfs on struct gpu_sdf; from frame.sdf_code on the words of the fields' programs
// (shared/sdf.h); from frame.small_triangles on struct gpu_small_triangle.

// An instance of a mesh that has its own tree among the BVH's nodes.
struct gpu_instance {
    float to_object[3][4]; // rows of the matrix; fourth components: the vector that is subtracted
                           // first
    float to_world[3][4];
    uint root;     // root node of the mesh's tree
    uint material; // material word that replaces those of the triangles, or NO_MATERIAL
    uint id;       // id in the flat scene; at equal distances it decides before the triangles' ids
    uint flags;    // INSTANCE_*
};
SHARED_STATIC_ASSERT_SIZE(gpu_instance, 112);
#define INSTANCE_WORDS 7
#define INSTANCE_MIRRORED 1u // the transform reverses the orientation of triangles
#define NO_MATERIAL 0xffffffffu
#define NO_INSTANCE 0xffffffffu

// A material word: the material's index, its class, and whether its opacity may be below 1.
#define MATERIAL_INDEX_MASK 0x00ffffffu
#define MATERIAL_CLASS_SHIFT 24 // 2 bits
#define MATERIAL_CLASS_MASK 3u
#define MATERIAL_WORD_ALPHA (1u << 27)
#define MATERIAL_WORD_EDGES (1u << 28) // a triangle whose v1 and v2 are edges from v0

// The materials' buffer: this header, then struct gpu_material for each material, then the sections
// whose offsets, in uvec4 words, are in the header.
struct gpu_material_header {
    uint textures;     // struct gpu_texture
    uint lights;       // struct gpu_light
    uint media;        // struct gpu_medium; medium m is record m - 1
    uint albedos;      // the tables of lib/albedo.glsl
    uint camera_media; // stack of media in which camera rays begin, see lib/media.glsl
    float camera_ior;  // index of refraction of the medium in which camera rays begin
    uint suns;         // struct gpu_sun
    uint sun_count;
};
SHARED_STATIC_ASSERT_SIZE(gpu_material_header, 32);
#define MATERIAL_HEADER_WORDS 2 // uvec4 words

struct gpu_material {
    uint model_flags;   // MATERIAL_*
    uint first_texture; // first texture of the material; a material's textures are adjacent
    uint texture_count;
    uint medium; // number of the medium inside its surfaces; 0: none
    float parameter[PARAMETER_COUNT];
};
SHARED_STATIC_ASSERT_SIZE(gpu_material, 192);
#define MATERIAL_WORDS 12

struct gpu_texture {
    uint texels; // offset of the first texel in the texels' buffer, in units of 16 bytes
    uint size;   // width in bits 0-15, height in 16-31
    uint flags;  // TEXTURE_*
    uint align_texture;
    // s = row 0 . (u, v, 1), t = row 1 . (u, v, 1); for the fourth numbers see TEXTURE_GREEN.
    float transform[2][4];
};
SHARED_STATIC_ASSERT_SIZE(gpu_texture, 48);
#define TEXTURE_WORDS 3

// The medium inside of a closed surface.
struct gpu_medium {
    float extinction[3]; // 1/length; at most 3.4e38, which stands for infinity
    float ior;
    uint priority;    // if media overlap, that of the highest priority fills the space; 0: air
    float dispersion; // 20 / Abbe number
    uint align_medium[2];
};
SHARED_STATIC_ASSERT_SIZE(gpu_medium, 32);
#define MEDIUM_WORDS 2
#define MEDIA_MAX 255u // maximum number of different media in a scene: a stack of four is one word

struct gpu_light {
    float position[3]; // point, spot
    uint kind;
    float direction[3]; // spot, directional: unit direction in which light travels
    float pick_probability;
    float radiant[3];    // point, spot: radiance * length^2; directional: irradiance, W/m^2
    float inverse_range; // 1 / the distance at which the light ends, 1/length; 0: unlimited
    float spot_scale, spot_offset; // falloff: clamp(offset - scale * (1 - cos), 0, 1)^2
    float reach;                   // directional: length of shadow rays
    float versine; // directional: 1 - cos of the angular radius of a sun; 0: a delta light
    // Point and spot lights: see lib/profile.glsl.
    float profile_x[3]; // unit, orthogonal to the direction
    uint profile;       // offset of the profile in the materials' buffer, in uvec4 words; 0: none
};
SHARED_STATIC_ASSERT_SIZE(gpu_light, 80);
#define LIGHT_WORDS 5

// A directional light with an angular radius, for rays that may hit it.
struct gpu_sun {
    float direction[3]; // unit, towards the sun
    float versine;
    float radiance[3];
    float pick_probability;
};
SHARED_STATIC_ASSERT_SIZE(gpu_sun, 32);
#define SUN_WORDS 2

// An entry from which an emitter is selected; `primitive` is a primitive word. By power: a bin of
// Vose's alias table, which selects its own primitive if u < threshold, else its alias. Uniformly:
// all thresholds are 1.
struct gpu_emitter {
    float threshold;
    uint primitive;
    uint alias_primitive;
    uint align_emitter;
};
SHARED_STATIC_ASSERT_SIZE(gpu_emitter, 16);

// The header of the buffer of a light tree. Offsets of sections are in uvec4 words.
struct gpu_light_tree {
    uint root;     // the root, encoded as gpu_light_bounds.child; not defined if the tree is empty
    uint trails;   // struct gpu_light_trail, indexed by emitter
    uint infinite; // struct gpu_emitter: the bins of the infinitely far emitters
    uint infinite_count;
    float infinite_share; // probability of selecting an infinitely far emitter
    uint lamps;           // struct gpu_lamp, by number; only with LIGHT_CHOICE_ALL
    uint align_tree[2];
};
SHARED_STATIC_ASSERT_SIZE(gpu_light_tree, 32);
#define LIGHT_TREE_WORDS 2 // uvec4 words; pairs of struct gpu_light_bounds follow

// One of the two children in a node: bounds of its emitters and of the directions in which they
// emit.
struct gpu_light_bounds {
    float center[3];
    float radius;
    uint axis;    // octahedral
    uint cosines; // theta_o in bits 0-15, theta_e in 16-30, each a cosine from -1 to 1; the bit
                  // LIGHT_TWO_SIDED
    float power;  // fraction of the total power
    uint child;   // index of a pair, or LIGHT_LEAF and the word of a primitive
};
SHARED_STATIC_ASSERT_SIZE(gpu_light_bounds, 32);
#define LIGHT_PAIR_WORDS 4
#define LIGHT_LEAF 0x80000000u
#define LIGHT_TWO_SIDED 0x80000000u
#define LIGHT_COS_O_SCALE 65535.0
#define LIGHT_COS_E_SCALE 32767.0

// The path from the tree's root to an emitter: bit n is 1 if the second child is taken at level n.
struct gpu_light_trail {
    uint low, high;
    uint depth; // number of bits; LIGHT_NOWHERE: the emitter is not in the tree
    uint lamp;  // the emitter's lamp
};
SHARED_STATIC_ASSERT_SIZE(gpu_light_trail, 16);
#define LIGHT_NOWHERE 0xffffffffu

// A lamp: connected emitters, a single emitter, or one that is infinitely far.
struct gpu_lamp {
    uint child; // the child below which all emitters of the lamp are
    uint depth; // level of this child, the number of bits before it in a trail; LIGHT_NOWHERE: no
                // light
    uint align_lamp[2];
};
SHARED_STATIC_ASSERT_SIZE(gpu_lamp, 16);

// The state of one path: one cache line.
struct gpu_path {
    float origin[3];
    uint ignore;        // primitive on which the ray starts; if planar, it cannot be hit again
    float direction[3]; // unit
    float bsdf_pdf;     // density per solid angle of the direction; 0: a ray from the camera, or a
                        // delta sample
    float throughput[3];
    uint media; // stack of media around the ray, see lib/media.glsl
    float t;    // distance of the hit; not valid for misses
    float u, v;
    uint primitive;
};
SHARED_STATIC_ASSERT_SIZE(gpu_path, 64);
// Stride of paths' records, in uvec4 words. With instances there is one more word: the instance
// that was hit, that on which the ray starts (or NO_INSTANCE), 0, 0. With INTEGRATOR_BIDIR there is
// a last word for MIS weights: for a camera path Q of lib/bidir.glsl; for a light path two ratios
// of densities, the scale of its throughput, and the half-buffer to which it contributes.
#define PATH_WORDS_OF(geometry, integrator)                                                        \
    ((((geometry)&GEOMETRY_INSTANCES) != 0u ? 5u : 4u) +                                           \
     ((integrator) == INTEGRATOR_BIDIR ? 1u : 0u))
#define PATH_ORIGIN 0
#define PATH_DIRECTION 1
#define PATH_THROUGHPUT 2
#define PATH_HIT 3
#define PATH_INSTANCE 4

// A shadow ray: the segment origin + s * direction, s in (0, 1), and its contribution if nothing is
// hit.
struct gpu_shadow_ray {
    float origin[3];
    uint ignore_from;
    float direction[3]; // not normalised: extends to the sampled point
    uint ignore_to;
    float radiance[3];
    float light_pdf; // density per solid angle of the sampled direction, or the selection
                     // probability of a delta light, for replay. For a light path: the pixel, as
                     // bits
};
SHARED_STATIC_ASSERT_SIZE(gpu_shadow_ray, 48);
// Number of a shadow ray's uvec4 words. With instances there is one more: the instance on which
// the ray starts, 0, 0, 0.
#define SHADOW_WORDS_OF(geometry) (((geometry)&GEOMETRY_INSTANCES) != 0u ? 4u : 3u)
#define SHADOW_INSTANCE 3
#ifdef GL_core_profile
#define PATH_WORDS PATH_WORDS_OF(GEOMETRY, INTEGRATOR)
#define PATH_WEIGHTS (PATH_WORDS - 1u)
#define SHADOW_WORDS SHADOW_WORDS_OF(GEOMETRY)
#endif

// Number of 32-bit words of a suspended traversal before its stack (lib/suspend.glsl). With
// instances these include the current instance and that of the hit.
#define SUSPENDED_WORDS_OF(geometry) (((geometry)&GEOMETRY_INSTANCES) != 0u ? 10u : 8u)

// The sums of the two half-buffers. Unless the halves are contiguous, they receive a pixel's
// samples alternately, beginning when the film was last emptied. A sum has four words
// (film_sums.h): the bin of even digits, then that of odd ones, each with its low word first. With
// ACCUMULATION_SUM and ACCUMULATION_RUNNING the first of them is a float, and digits_a has
// FILM_HAS_FLOATS; digits_b is 0 for sums. For running means it is 1 + the number of samples in the
// means of half a; those of half b have the other samples.
struct gpu_film_pixel {
    uint samples; // number of samples in both halves
    uint dropped; // number of samples that lost a non-finite contribution
    uint digits_a;
    uint digits_b;
    uint sums_a[12]; // r, g, b
    uint sums_b[12];
};
SHARED_STATIC_ASSERT_SIZE(gpu_film_pixel, 112);
#define FILM_WORDS 7
#define FILM_HALF_WORDS 3u // uvec4 words for the sums of a half
// Number of groups of four sums of AOVs whose digits fit into one uvec4 word.
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
#define QUEUE_RAYS 0    // even bounces; QUEUE_RAYS + 1: odd bounces
#define QUEUE_SURFACE 2 // QUEUE_SURFACE + class with FEATURE_CLASSES; else this queue has all hits
#define QUEUE_MISS 6    // with FEATURE_ENVIRONMENT only
#define QUEUE_SHADOW 7  // only with FEATURE_NEE: slots with at least one shadow ray
// This queue and QUEUE_SUSPENDED + 1 are used alternately; only with FEATURE_SUSPEND.
#define QUEUE_SUSPENDED 8
#define QUEUE_COUNT 10

// The places in the code at which non-finite contributions are detected.
#define SITE_MISS 0
#define SITE_EMISSION 1
#define SITE_SHADOW 2
#define SITE_THROUGHPUT 3
#define SITE_COUNT 4
#define NONFINITE_RECORDS 32

#define DISPATCH_PARTS 64

// Counters of FEATURE_STEPS, for rays to the nearest hit and for shadow rays.
#define STEPS_CLOSEST 0 // nodes visited; + 1: primitives tested
#define STEPS_SHADOW 2  // nodes visited; + 1: primitives tested
#define STEPS_COUNT 4

#define CLAMP_UNITS 1024.0f
// Limit of the units of one contribution, 2^38, so that the sum over a wave stays below 2^64.
#define CLAMP_UNITS_MOST 2.74877907e11f

struct gpu_dispatch {
    uint x, y, z;
    uint items;
};

// The length of a queue, in a cache line of its own, so that subgroups of a kernel that fills
// several queues contend only for the same queue. GPUs have lines of 64 or 128 bytes.
struct gpu_queue {
    uint count;
    uint align_queue[31];
};
SHARED_STATIC_ASSERT_SIZE(gpu_queue, 128);

struct gpu_counters {
    RECORD(gpu_queue) queue[QUEUE_COUNT];
    uint surface_hits[CLASS_COUNT][2]; // 64 bits each
    uint media_lost; // paths that entered more media than the stack holds, or left a medium that
                     // they had not entered
    uint clamped;    // number of clamped contributions, with FEATURE_CLAMP
    uint clamped_light[2]; // luminance that the clamped contributions lost, in limit / CLAMP_UNITS:
                           // 64 bits
    uint closest_rays[2];  // 64 bits, low word first
    uint shadow_rays[2];
    uint steps[STEPS_COUNT][2];
    uint unfinished; // rays that exceeded their budget without FEATURE_SUSPEND: the results are
                     // void
    uint suspended;  // number of continued traversals
    uint nonfinite[SITE_COUNT];
    uint nonfinite_records; // number of claims on the following records; may exceed
                            // NONFINITE_RECORDS
    uint sparse;            // paths, or branches of split paths, that FEATURE_MIN_DENSITY ended
    uint branches;          // branches that paths gained by splitting, with FEATURE_MIN_DENSITY
    RECORD(gpu_dispatch) dispatch[QUEUE_COUNT * DISPATCH_PARTS];
    uint nonfinite_record[NONFINITE_RECORDS * 4]; // pixel, sample, site, bounce
    uint align_counters[31];                      // makes the following data begin at a cache line
};
SHARED_STATIC_ASSERT_SIZE(gpu_counters, 12288);
// Offset in bytes of the slot indices in the buffer of BINDING_QUEUES.
#define QUEUES_OFFSET sizeof(struct gpu_counters)

// The counts and places of a sort of rays (lib/sort.glsl). The scene has 2^SORT_CELL_BITS cells
// along each axis.
#define SORT_CELL_BITS 3
#define SORT_KEYS (8 << 3 * SORT_CELL_BITS) // 8 octants times the number of cells
struct gpu_sort {
    uint count[SORT_KEYS]; // number of rays with each key; 0 between sorts
    uint place[SORT_KEYS]; // for each key, the place of the next ray in the sorted queue
};
SHARED_STATIC_ASSERT_SIZE(gpu_sort, 32768);

// Push constants, which may change with each dispatch.
struct gpu_push {
    uint bounce;
    uint first_pixel; // index in the image of this wave's first pixel
    uint pixel_count; // number of pixels of this wave
    uint first_sample;
    uint sample_shift; // a wave has pixel_count << sample_shift paths; those of a pixel are
                       // adjacent
    uint queue;        // queue that the kernel processes, or for prepare_dispatch a mask of queues
    uint first_item;   // first item of this part of a divided dispatch
    uint part_items;   // maximum number of items of a part
    uint film_first_pixel; // first pixel of the bound range of the film
    uint light_ray;        // index of the shadow ray in its slot
    uint align_push[2];
};
SHARED_STATIC_ASSERT_SIZE(gpu_push, 48);

// The uniform block: values that are the same for all dispatches of a render. Lengths and
// positions, here and in all records, are in the flat scene's unit (flatten/flatten.h).
struct gpu_frame {
    VEC3(camera_position); // centre of the image at distance camera_start
    uint width;            // width of the film, which is the picture or a window of it
    VEC3(camera_forward);  // unit
    uint height;
    VEC3(camera_right); // from the centre to the right edge of the image; perspective: at distance
                        // 1; orthographic: a length; panoramic: unit
    uint seed;
    VEC3(camera_up); // from the centre to the upper edge, in the unit of camera_right
    uint max_bounces;
    VEC3(environment);     // radiance, or the factor of the image's radiance
    uint environment_size; // width in bits 0-15, height in 16-31
    float environment_cos; // cosine and sine of the environment's rotation about +Y
    float environment_sin;
    float environment_pick; // probability of selecting the environment, unless it depends on the
                            // position
    uint emitter_count;
    uint wave_slots;   // capacity of a queue and of the path arrays
    uint samples;      // planned number of samples per pixel; 0: not known
    uint nee_depth;    // number of vertices of a path that may send shadow rays
    float clamp_limit; // maximum of a contribution's largest component
    uint roulette_min_bounces;
    uint roulette_max_bounces; // maximum depth with ROULETTE_FRAME
    float roulette_survival;
    float direction_exponent; // only for DIRECTIONS_POWER_COSINE
    float lens_radius;
    float focus_distance; // from the camera to the plane in focus
    float lens_rotation;  // rotation of the aperture's blades, radians
    uint lens_blades;     // 0: round aperture
    float filter_radius;  // pixels
    float ao_distance;
    float metre;             // metres per unit of length: a power of two
    float environment_reach; // length of shadow rays to the environment
    VEC3(ambient);           // INTEGRATOR_WHITTED: mean radiance of the environment
    uint pending_rays;       // INTEGRATOR_WHITTED: entries of a slot's stack
    uint instances;          // offsets, in uvec4 words, of sections of the shapes' buffer
    uint sdfs;
    uint sdf_code;
    // Values for FEATURE_FAR_CAMERA; without it, camera_start is 0 and lens_at_start is 1.
    float camera_start;      // distance along the line of sight from the camera to where camera
                             // rays begin
    float lens_at_start;     // relative size of the lens where camera rays begin: 1 - camera_start
                             // / focus_distance
    uint small_triangles;    // offset of a section, as `instances`
    uint pixel_strata;       // strata along a side of a pixel, for PIXEL_SAMPLING_GRID and
                             // _STRATIFIED
    float mis_exponent;      // only for MIS_POWER_ANY
    float min_density;       // minimum density of a direction, 1/sr, with FEATURE_MIN_DENSITY
    uint split_lobes;        // number of vertices at which paths split, with FEATURE_SPLIT_LOBES
    float environment_floor; // subtracted from luminances of the environment's image for sampling
    uint picture_width;
    VEC3(cells_begin); // grid for sorting rays: lowest corner of the scene
    uint picture_height;
    VEC3(cells_a_length); // grid for sorting rays: number of cells per unit of length
    uint window_first;    // number in the picture of the first pixel of the film
    VEC3(scene_center);   // INTEGRATOR_BIDIR: centre of the sphere at which infinitely far emitters
                          // send light paths
    float scene_radius;
};
SHARED_STATIC_ASSERT_SIZE(gpu_frame, 272);

#endif
