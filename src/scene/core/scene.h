// A scene as plain arrays. Loaders fill it, scene_flatten() turns it into what the BVH and the
// kernels take. No Vulkan here.
//
// Units: metres, radiance in W/(sr m^2) in linear Rec. 709 primaries, angles in radians.
// Right-handed world, any up axis; matrices are row-major, column vectors: p' = M p.
//
// Threads: any, but one at a time for one scene.
#ifndef LAMPYRIS_SCENE_CORE_SCENE_H
#define LAMPYRIS_SCENE_CORE_SCENE_H

#include "base/arena.h"
#include "base/err.h"
#include "base/progress.h"
#include "scene/core/scene_material.h"
#include "scene/core/settings.h"
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#define SCENE_NONE UINT32_MAX // no index

// Positions and lengths, metres: objects of 1e12 m, with room around them for what looks at them
// and lights them.
#define SCENE_COORDINATE_MAX 1e13
#define SCENE_LENGTH_MIN 1e-18 // of parts of a scene that have an extent: radii, heights, ranges
#define SCENE_LENS_MAX_MM (1e3 * SCENE_COORDINATE_MAX) // radius of a camera's lens
#define SCENE_LENS_BLADES_MAX 64
#define SCENE_TURN_MAX 1e6 // rotations of environments, degrees
// The largest and the smallest size of all that is placed in a scene, along an axis, metres.
#define SCENE_EXTENT_MAX (2 * SCENE_COORDINATE_MAX)
#define SCENE_EXTENT_MIN 1e-13
// Leaves a factor of 1e8 for sums over samples and products with throughputs.
#define SCENE_RADIANCE_MAX 1e30 // W/(sr m^2)

// A triangle mesh in its own space.
struct mesh {
    const char *name;
    uint32_t vertex_count;
    uint32_t triangle_count;
    float (*positions)[3];        // vertex_count
    double (*exact_positions)[3]; // vertex_count, what `positions` round; or NULL: nothing better
    float (*normals)[3];          // vertex_count, unit length or (0,0,0) where missing; or NULL
    float (*tangents)[4];         // vertex_count, unit length and the bitangent's sign; or NULL
    float (*uvs[2])[2];           // two sets, vertex_count each, t downwards; or NULL
    float (*colors)[4];           // vertex_count, linear RGBA; or NULL
    uint32_t (*indices)[3];       // triangle_count, each below vertex_count
    uint32_t *triangle_material;  // triangle_count; or NULL: `material` for all
    uint32_t material;
};

struct instance {
    uint32_t mesh;
    uint32_t material;      // replaces the mesh's materials; SCENE_NONE keeps them
    double transform[3][4]; // mesh space to world
    bool hidden;            // left out of the render
};

// In the order of SHAPE_KIND_* in shaders/shared/types.h.
enum shape_kind {
    SHAPE_SPHERE,
    SHAPE_DISC,
    SHAPE_PLANE,    // without end
    SHAPE_QUAD,     // a parallelogram
    SHAPE_BOX,      // with right angles, turned any way
    SHAPE_CYLINDER, // closed
    SHAPE_TUBE,     // a cylinder without caps
    SHAPE_SDF,      // a signed distance field
    SHAPE_KIND_COUNT
};

// Analytic shapes, in world space (transforms are applied at load: those that keep a shape one of
// its kind; others are an input error that says so).
struct shape {
    enum shape_kind kind;
    uint32_t material;
    double center[3]; // plane: any point of it; distance field: of its box
    double normal[3]; // disc, plane: unit normal
    double radius;    // sphere, disc, cylinder, tube: > 0
    // Quad: half edges, two; box: three, at right angles, right-handed. Cylinder, tube: from the
    // centre to an end, and a unit vector across, where u is 0. Plane: [1] likewise. Distance
    // field: half edges of its box.
    double axes[3][3];
    uint32_t sdf; // index of scene.sdfs
    bool hidden;  // left out of the render
};

// A signed distance field: see shared/sdf.h. Its own space is that of its description; where it is
// in the world its shapes say (sdf_to_world() in sdf.h).
struct gpu_sdf_instruction;
struct sdf {
    double min[3], max[3]; // its box, in its own space
    struct gpu_sdf_instruction *code;
    uint32_t count;   // of instructions
    double lipschitz; // most that the described field falls in a metre; the program's: at most 1
    double magnitude; // largest |coordinate| that the program's arithmetic meets within the box
};

struct camera {
    double position[3];
    double direction[3];   // unit, where it looks
    double up[3];          // not parallel to direction; need not be orthogonal to it
    uint32_t kind;         // CAMERA_*
    double fov_y;          // perspective: vertical field of view, radians, in (0, pi)
    double height;         // orthographic: of what is seen, metres
    double lens_radius;    // 0: a pinhole. Metres
    double focus_distance; // along the direction, metres, > 0 with a lens
    uint32_t lens_blades;  // of the aperture, at least 3; 0: round
    double lens_rotation;  // of the blades, radians
    const char *name;
};

// The sun of a sky: becomes a light when the scene is complete.
struct environment_sun {
    double direction[3];   // unit, in which its light travels
    float irradiance[3];   // on a surface that faces it, W/m^2
    double angular_radius; // 0: none
    uint32_t light;        // of scene.lights, what it became, plus 1; 0: nothing so far
};

struct sky;
struct environment_gradient;

// The light that arrives where a ray leaves the scene. With an image, radiance multiplies it.
struct environment {
    bool present;
    float radiance[3];      // constant radiance, or the factor on the image
    double rotation;        // about +Y, radians, see environment.h
    uint32_t width, height; // 0 x 0: constant
    float (*texels)[3];     // latitude-longitude, row 0 at the top (+Y), see environment.h
    struct environment_sun sun;
    uint64_t zeroed; // texels of the file that were negative or not finite, and are black
    // Where the texels came from, for those who write it down: at most one of them. None: constant.
    const char *file; // as seen from the working directory
    const struct sky *sky;
    const struct environment_gradient *gradient;
};

struct scene_base;
struct placed_object;

// A path as it stands in an override, and as seen from the working directory.
struct scene_path {
    const char *text, *path;
};

// The axis of the world that points up, for what is added to a model.
enum scene_up { SCENE_UP_Y, SCENE_UP_X, SCENE_UP_Z };
extern const char *const scene_up_names[]; // "y", "x", "z", NULL

// The light of a scene that brings none, see studio.h.
enum scene_studio {
    SCENE_STUDIO_OFF,  // an even environment
    SCENE_STUDIO_AUTO, // models: the studio; scene files of our own that have a camera: as above
    SCENE_STUDIO_ON,   // the studio, in place of the environment, whatever else there is
};
extern const char *const scene_studio_names[]; // "off", "auto", "on", NULL
enum scene_ground {
    SCENE_GROUND_AUTO, // with the studio, unless a camera of the file is below
    SCENE_GROUND_ON,
    SCENE_GROUND_OFF,
};
extern const char *const scene_ground_names[]; // "auto", "on", "off", NULL

struct scene {
    struct arena arena;              // owns everything below
    const struct progress *progress; // while it is loaded; NULL: nobody listens
    const char *path;                // as given on the command line
    struct material *materials;
    uint32_t material_count; // at least 1: loaders add a grey default where a file has none
    struct mesh *meshes;
    uint32_t mesh_count;
    struct instance *instances;
    uint32_t instance_count;
    struct shape *shapes;
    uint32_t shape_count;
    struct sdf *sdfs;
    uint32_t sdf_count;
    struct camera *cameras;   // as in the file; the first is used unless chosen otherwise
    uint32_t camera_count;    // after scene_load at least 1: a model without one is framed
    uint32_t animation_count; // of a glTF file
    double animation_seconds; // the last key of the one that poses it, or else of the first
    bool camera_is_framed; // cameras[0] was made up: scene_frame_camera fits it to another picture
    bool is_model;         // not of our own format, or its base is not
    bool is_empty;   // neither a triangle with an area nor a shape nor an environment of its own
    bool is_hidden;  // all of its surfaces are, and there is no environment of its own
    bool has_studio; // its light was made up
    double weak_emission;                // that it has nevertheless, see studio.h
    bool has_ground;                     // the last shape was made up
    bool has_own_exposure, has_own_tone; // the file says so
    bool exposure_is_replaced;           // it was made for another environment than --env brings
    bool is_strict;                      // a missing image is an error
    uint32_t missing_image_count;        // pink
    enum scene_up up;
    struct texture_image *images;
    uint32_t image_count;
    struct texture *textures; // those of one material are adjacent
    uint32_t texture_count;
    struct light *lights; // without extent
    uint32_t light_count;
    struct placed_object *placed; // objects that were placed anew, see placement.h
    uint32_t placed_count;
    const struct light_profile *profiles; // the latest that was read; see ies.h
    struct environment environment;
    struct settings settings; // defaults, overridden by the file
    uint64_t hash;            // of the file's bytes and of all files it names, and of the overrides
    // The loader says here what it did on its own, for the report: "no camera in the file: framed
    // from the front"
    const char **notes;
    uint32_t note_count;
    // For those who write the scene down again: which strings in the overrides were read as paths,
    // and what a file with a "base" says of it (scene_edits.h); NULL: it stands for itself.
    struct scene_path *override_paths;
    uint32_t override_path_count, override_path_capacity;
    const struct scene_base *base;
    // Room in the arrays above; only the scene_add_ functions and scene_note touch these.
    uint32_t material_capacity, mesh_capacity, instance_capacity, shape_capacity, camera_capacity;
    uint32_t note_capacity, image_capacity, texture_capacity, light_capacity, sdf_capacity;
    uint32_t placed_capacity;
};

struct scene_override {
    const char *key;   // dotted path into the document, or the name of one of its "define"s
    const char *value; // JSON, or else taken as a string
};

struct scene_load_params {
    const char *path; // .json (our format), .gltf, .glb, .obj, .ply; by extension, case-insensitive
    const struct scene_override *overrides; // -D key=value; our JSON format only
    uint32_t override_count;
    const char *text; // what the file would hold, of our format only: `path` is but its name then
    bool allow_outside_paths; // let files name files outside their own folder
    // The overrides come from a file in this folder: paths in them are relative to it, and confined
    // to it. NULL: they are the user's own.
    const char *override_folder;
    uint32_t base_depth; // of files whose "base" this one is
    // These replace the file's environment, see environment.h and sky.h; where all are NULL nothing
    // does.
    const char *environment_file;
    const float *environment_radiance; // 3
    const struct sky *environment_sky;
    double environment_rotation;        // in addition, radians
    const double *environment_strength; // a further factor; NULL: 1
    enum scene_studio studio;           // 0: off, for those who measure
    enum scene_ground ground;
    enum scene_up up;
    bool is_strict; // an image that is not there is an error, not pink
    // glTF only.
    // Time of the pose: of animation 0, or the one named below. NULL: the nodes as they are without
    // animation, or the beginning of the animation where one is named.
    const double *at_seconds;
    const char *animation;  // by name or index; NULL: the first
    const char *scene_name; // by name or index; NULL: the file's default
    const char *variant;    // of KHR_materials_variants, by name; NULL: none
    const struct progress *progress;
};

// Loads, checks, frames a camera where there is none and adds light where there is none, which a
// note says. On failure *out is finished and {0}; err names file, place, value and what was
// expected.
bool scene_load(const struct scene_load_params *params, struct scene *out, struct err *err);
// Loads on top of whatever is in *scene, without what scene_load sets beforehand.
bool scene_load_into(struct scene *scene, const struct scene_load_params *params, struct err *err);
void scene_finish(struct scene *scene); // accepts NULL and {0}

// Moves the camera of a scene that came without one to where all of it, the ground aside, fills the
// picture of settings.width x settings.height: to be called again when these change. Does nothing
// to cameras of the file.
void scene_frame_camera(struct scene *scene);

// Adds "TEXT" to scene->notes; false when out of memory.
bool scene_note(struct scene *scene, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Reports how much is done of a part of the file that takes long; fails with ERR_STOPPED when asked
// to stop.
bool scene_loading(const struct scene *scene, double fraction, struct err *err);
// Fails with ERR_STOPPED when asked to stop, without a report, for turn `i` of a loop: see
// progress_stops_at().
bool scene_goes_on(const struct scene *scene, uint64_t i, struct err *err);

// --- what the loaders share (scene_load.c calls exactly one of these by extension) ---------------
// Each appends to *scene (already initialised with defaults, arena and path set) and continues
// scene->hash over the bytes of every file that it reads.
// `load_base`, which is scene_load_into, loads the file that a document's "base" names.
typedef bool (*scene_load_fn)(struct scene *scene, const struct scene_load_params *params,
                              struct err *err);
bool load_json(struct scene *scene, const struct scene_load_params *params, scene_load_fn load_base,
               struct err *err);
bool load_gltf(struct scene *scene, const struct scene_load_params *params, struct err *err);
// OBJ and PLY, also used by load_json for {"type": "mesh", "file": …}. On success one mesh, *index,
// and the materials it needs were appended; no instances are added. `path` is trusted: confine it
// before. default_material: for triangles without one; SCENE_NONE: append a grey one when needed.
bool load_obj(struct scene *scene, const char *path, uint32_t default_material,
              bool allow_outside_paths, uint32_t *index, struct err *err);
bool load_ply(struct scene *scene, const char *path, uint32_t default_material, uint32_t *index,
              struct err *err);
// glTF as a mesh inside our JSON format: appends meshes, materials and, through `place` (3x4), the
// instances and lights of the default scene's nodes; cameras of the file are ignored here.
bool load_gltf_into(struct scene *scene, const char *path, const double place[3][4],
                    bool allow_outside_paths, struct err *err);

// Growing arrays in the scene's arena; return the new element (zeroed, but for names, which are "")
// or NULL when out of memory. *index receives its index when not NULL. An earlier element's address
// is void after a call: the array may have moved.
struct material *scene_add_material(struct scene *scene, uint32_t *index);
struct mesh *scene_add_mesh(struct scene *scene, uint32_t *index);
struct instance *scene_add_instance(struct scene *scene, uint32_t *index);
// Room for so many more at once, where doubling would copy much.
bool scene_reserve_instances(struct scene *scene, uint64_t more);
bool scene_reserve_shapes(struct scene *scene, uint64_t more);
struct shape *scene_add_shape(struct scene *scene, uint32_t *index);
struct sdf *scene_add_sdf(struct scene *scene, uint32_t *index);
struct camera *scene_add_camera(struct scene *scene, uint32_t *index);
struct texture_image *scene_add_image(struct scene *scene, uint32_t *index);
struct texture *scene_add_texture(struct scene *scene, uint32_t *index);
struct light *scene_add_light(struct scene *scene, uint32_t *index);
struct scene_path *scene_add_override_path(struct scene *scene);
struct placed_object *scene_add_placed(struct scene *scene);

// Returns whether some texture of the material scales this parameter, PARAMETER_*, so that it may
// be less.
bool scene_parameter_is_textured(const struct scene *scene, const struct material *material,
                                 uint32_t parameter);

// Appends a copy of *mesh; its arrays live in the scene's arena already.
bool scene_append_mesh(struct scene *scene, const struct mesh *mesh, uint32_t *index,
                       struct err *err);

// One instance, at its own coordinates and with its own materials, of each of `count` meshes.
bool scene_place_meshes(struct scene *scene, uint32_t first_mesh, uint32_t count, struct err *err);

#endif
