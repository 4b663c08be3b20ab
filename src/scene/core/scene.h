// A scene as plain arrays. Loaders fill it; scene_flatten() turns it into what the BVH and the
// kernels take. Nothing here depends on Vulkan.
//
// Units: metres, radiance in W/(sr m^2) in linear Rec. 709 primaries, angles in radians.
// Right-handed world, any up axis; matrices are row-major, column vectors: p' = M p.
//
// Threads: any thread may call these functions, but only one at a time for the same scene.
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

#define SCENE_NONE UINT32_MAX // invalid index

// Positions and lengths are in metres. Objects may be 1e12 m away; the rest of the range is for
// cameras and lights around them.
#define SCENE_COORDINATE_MAX 1e13
// The smallest radius, height or range that a part of a scene may have.
#define SCENE_LENGTH_MIN 1e-18
#define SCENE_LENS_MAX_MM (1e3 * SCENE_COORDINATE_MAX) // radius of a camera's lens
#define SCENE_LENS_BLADES_MAX 64
#define SCENE_TURN_MAX 1e6 // rotation of an environment, degrees
// The largest and the smallest extent of a whole scene along an axis, metres.
#define SCENE_EXTENT_MAX (2 * SCENE_COORDINATE_MAX)
#define SCENE_EXTENT_MIN 1e-13
// This leaves a factor of 1e8 for sums over samples and for products with throughputs.
#define SCENE_RADIANCE_MAX 1e30 // W/(sr m^2)

// A triangle mesh in its own space.
struct mesh {
    const char *name;
    uint32_t vertex_count;
    uint32_t triangle_count;
    float (*positions)[3];        // vertex_count
    double (*exact_positions)[3]; // vertex_count; `positions` before they were rounded; or NULL:
                                  // not known
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

// The order is that of SHAPE_KIND_* in shaders/shared/types.h.
enum shape_kind {
    SHAPE_SPHERE,
    SHAPE_DISC,
    SHAPE_PLANE,    // infinite
    SHAPE_QUAD,     // a parallelogram
    SHAPE_BOX,      // its edges are perpendicular; it may have any orientation
    SHAPE_CYLINDER, // closed by caps at both ends
    SHAPE_TUBE,     // an open cylinder, without caps
    SHAPE_SDF,      // a signed distance field
    SHAPE_KIND_COUNT
};

// An analytic shape in world space. Transforms are applied when it is loaded; a transform that
// would turn it into another kind of shape is an input error.
struct shape {
    enum shape_kind kind;
    uint32_t material;
    double center[3]; // plane: any point of it; distance field: centre of its box
    double normal[3]; // disc, plane: unit normal
    double radius;    // sphere, disc, cylinder, open cylinder: > 0
    // Quad: two half edges. Box: three perpendicular half edges, right-handed. Cylinder and open
    // cylinder: [0] leads from the centre to an end, [1] is the unit vector across at which u is 0.
    // Plane: [1] likewise. Distance field: half edges of its box.
    double axes[3][3];
    uint32_t sdf; // index of scene.sdfs
    bool hidden;  // left out of the render
};

// A signed distance field, see shared/sdf.h, in the space of its description. Its shapes place it
// in the world (sdf_to_world() in sdf.h).
struct gpu_sdf_instruction;
struct sdf {
    double min[3], max[3]; // its box, in that space
    struct gpu_sdf_instruction *code;
    uint32_t count;   // number of instructions
    double lipschitz; // upper bound of the gradient's length of the described field; the program's
                      // is at most 1
    double magnitude; // largest |coordinate| that the program computes within the box
};

struct camera {
    double position[3];
    double direction[3];   // unit vector in which the camera looks
    double up[3];          // not parallel to direction; need not be orthogonal to it
    uint32_t kind;         // CAMERA_*
    double fov_y;          // perspective: vertical field of view, radians, in (0, pi)
    double height;         // orthographic: height of the visible region, metres
    double lens_radius;    // radius of the lens, metres; 0: a pinhole
    double focus_distance; // along the direction, metres, > 0 with a lens
    uint32_t lens_blades;  // number of blades of the aperture, at least 3; 0: a round one
    double lens_rotation;  // rotation of the blades, radians
    const char *name;
};

// The sun of a sky. It becomes a light when the scene is complete.
struct environment_sun {
    double direction[3];   // unit vector in which its light travels
    float irradiance[3];   // on a surface that faces the sun, W/m^2
    double angular_radius; // 0: there is no sun
    uint32_t light;        // index in scene.lights of the light that it became, plus 1; 0: it is no
                           // light yet
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
    uint64_t zeroed; // number of texels of the file that were negative or not finite, and were set
                     // to black
    // The source of the texels, for writers of scene files. At most one of these is set; if none
    // is, the environment is constant.
    const char *file; // relative to the working directory
    const struct sky *sky;
    const struct environment_gradient *gradient;
};

struct scene_base;
struct placed_object;

// A path as it is written in an override, and relative to the working directory.
struct scene_path {
    const char *text, *path;
};

// The axis of the world that points up, for light and ground that are added to a model.
enum scene_up { SCENE_UP_Y, SCENE_UP_X, SCENE_UP_Z };
extern const char *const scene_up_names[]; // "y", "x", "z", NULL

// The light of a scene that has none of its own, see studio.h.
enum scene_studio {
    SCENE_STUDIO_OFF,  // a constant environment
    SCENE_STUDIO_AUTO, // models get the studio; scene files of our own format with a camera get OFF
    SCENE_STUDIO_ON,   // the studio replaces the environment in every case
};
extern const char *const scene_studio_names[]; // "off", "auto", "on", NULL
enum scene_ground {
    SCENE_GROUND_AUTO, // together with the studio, unless a camera of the file is below the ground
    SCENE_GROUND_ON,
    SCENE_GROUND_OFF,
};
extern const char *const scene_ground_names[]; // "auto", "on", "off", NULL

struct scene {
    struct arena arena;              // owns everything below
    const struct progress *progress; // notified while the scene is loaded; NULL: no listener
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
    uint32_t camera_count;    // at least 1 after scene_load: a framed camera is added to a model
                              // without one
    uint32_t animation_count; // number of animations of a glTF file
    double animation_seconds; // time of the last key of the animation in use, or else of the first
                              // animation
    bool camera_is_framed; // cameras[0] was added by the loader: scene_frame_camera fits it to the
                           // size of the image
    bool is_model;         // the file, or the base of the file, is not of our own format
    bool is_empty;   // there is no triangle with an area, no shape and no environment of its own
    bool is_hidden;  // all surfaces are hidden, and there is no environment of its own
    bool has_studio; // the studio's light was added
    double weak_emission;                // light of its own that is too weak to count, see studio.h
    bool has_ground;                     // the last shape is the ground that was added
    bool has_own_exposure, has_own_tone; // the file sets them
    bool exposure_is_replaced;           // the file's exposure was meant for the environment that
                                         // --env replaces
    bool is_strict;                      // a missing image is an error
    uint32_t missing_image_count;        // number of images that are shown in pink
    enum scene_up up;
    struct texture_image *images;
    uint32_t image_count;
    struct texture *textures; // the textures of one material are adjacent
    uint32_t texture_count;
    struct light *lights; // punctual and directional lights; see struct light
    uint32_t light_count;
    struct placed_object *placed; // objects with a new placement, see placement.h
    uint32_t placed_count;
    const struct light_profile *profiles; // the profile that was read last; the others follow by
                                          // `next`, see ies.h
    struct environment environment;
    struct settings settings; // the defaults, overridden by the file
    uint64_t hash; // hash of the bytes of the file and of all files that it names, and of the
                   // overrides
    // The loader's remarks on what it added or changed, for the report: "no camera in the file:
    // framed from the front"
    const char **notes;
    uint32_t note_count;
    // For writers of scene files: the strings of the overrides that were read as paths, and the
    // edits of a file with a "base" (scene_edits.h). base is NULL if the file has none.
    struct scene_path *override_paths;
    uint32_t override_path_count, override_path_capacity;
    const struct scene_base *base;
    // Capacities of the arrays above. Only the scene_add_ functions and scene_note use them.
    uint32_t material_capacity, mesh_capacity, instance_capacity, shape_capacity, camera_capacity;
    uint32_t note_capacity, image_capacity, texture_capacity, light_capacity, sdf_capacity;
    uint32_t placed_capacity;
};

struct scene_override {
    const char *key;   // dotted path into the document, or the name of an entry of "define"
    const char *value; // JSON; text that is not valid JSON is taken as a string
};

// A mesh in arrays of the caller's, which {"type": "mesh", "array": NAME} places in a scene file.
// Numbers are in the machine's representation; strides are distances in bytes, 0: without gaps. Any
// alignment will do.
struct scene_array {
    const char *name;
    uint32_t vertex_count, triangle_count;
    const void *positions; // three floats each
    size_t position_stride;
    const void *normals; // three floats each, of any length; NULL: none
    size_t normal_stride;
    const void *uvs; // two floats each, t downwards; NULL: none
    size_t uv_stride;
    const void *colors; // four floats each, linear RGBA; NULL: none
    size_t color_stride;
    const void *indices; // three uint32_t a triangle; NULL: vertices 3 i to 3 i + 2
    size_t index_stride; // from triangle to triangle
};

struct scene_load_params {
    const char *path; // .json (our format), .gltf, .glb, .obj, .ply; by extension, case-insensitive
    const struct scene_override *overrides; // -D key=value; our JSON format only
    uint32_t override_count;
    const char *text; // replaces the file's contents; our own format only. `path` is then only a
                      // name
    const struct scene_array *arrays; // meshes that the file may name; our own format only
    uint32_t array_count;
    bool allow_outside_paths; // files may name files outside of their own folder
    // The overrides come from a file in this folder: paths in them are relative to it and confined
    // to it. NULL: they come from the user.
    const char *override_folder;
    uint32_t base_depth; // number of files that name this one, directly or not, as their "base"
    // These replace the file's environment, see environment.h and sky.h. If all are NULL, it is
    // kept.
    const char *environment_file;
    const float *environment_radiance; // 3
    const struct sky *environment_sky;
    double environment_rotation;        // is added to the environment's rotation, radians
    const double *environment_strength; // a further factor on the environment's radiance; NULL: 1
    enum scene_studio studio;           // 0: off, for measurements
    enum scene_ground ground;
    enum scene_up up;
    bool is_strict; // a missing image is an error instead of pink
    // The following apply to glTF only.
    // Time of the pose in animation 0, or in the animation named below. NULL: the nodes as they are
    // without animation, or the beginning of the named animation.
    const double *at_seconds;
    const char *animation;  // name or index; NULL: the first
    const char *scene_name; // name or index; NULL: the file's default
    const char *variant;    // name of a variant of KHR_materials_variants; NULL: none
    const struct progress *progress;
};

// Loads and checks a scene. If it has no camera, one is framed; if it has no light, light is added;
// notes say so. On failure *out is finished and {0}, and err names file, place, value and what was
// expected.
bool scene_load(const struct scene_load_params *params, struct scene *out, struct err *err);
// Adds a file to *scene, without initialising *scene as scene_load does.
bool scene_load_into(struct scene *scene, const struct scene_load_params *params, struct err *err);
void scene_finish(struct scene *scene); // accepts NULL and {0}

// Moves the camera that was added to a scene without one so that the whole scene, without the
// ground, fills the image of settings.width x settings.height. Call it again when these change.
// Cameras of the file are not moved.
void scene_frame_camera(struct scene *scene);

// Adds the formatted text to scene->notes. Returns false when out of memory.
bool scene_note(struct scene *scene, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Reports the fraction that is done of a long part of loading. Fails with ERR_STOPPED when the
// listener wants to stop.
bool scene_loading(const struct scene *scene, double fraction, struct err *err);
// Fails with ERR_STOPPED, without a report, when the listener wants to stop at iteration `i` of a
// loop: see progress_stops_at().
bool scene_goes_on(const struct scene *scene, uint64_t i, struct err *err);

// --- what the loaders share (scene_load.c calls exactly one of these by extension) ---------------
// Each loader appends to *scene, whose defaults, arena and path are set, and continues scene->hash
// over the bytes of every file that it reads.
// `load_base` loads the file that a document names as its "base"; it is scene_load_into.
typedef bool (*scene_load_fn)(struct scene *scene, const struct scene_load_params *params,
                              struct err *err);
bool load_json(struct scene *scene, const struct scene_load_params *params, scene_load_fn load_base,
               struct err *err);
bool load_gltf(struct scene *scene, const struct scene_load_params *params, struct err *err);
// OBJ, PLY and STL; load_json also calls these for {"type": "mesh", "file": …}. On success one mesh,
// *index, and the materials that it needs were appended, but no instances. `path` is trusted: the
// caller confines it. default_material is for triangles without one; SCENE_NONE: append a grey one
// when it is needed.
bool load_obj(struct scene *scene, const char *path, uint32_t default_material,
              bool allow_outside_paths, uint32_t *index, struct err *err);
bool load_ply(struct scene *scene, const char *path, uint32_t default_material, uint32_t *index,
              struct err *err);
bool load_stl(struct scene *scene, const char *path, uint32_t default_material, uint32_t *index,
              struct err *err);
// Returns whether the extension is that of one of these formats.
bool is_mesh_file(const char *path);
// Returns the end of a message about a file of another format: "; PROGRAM can export it as glTF"
// where a program is known that can, else "".
const char *mesh_file_hint(const char *path);
// Loads a file of one of these formats, which its extension names.
bool load_mesh_by_extension(struct scene *scene, const char *path, uint32_t default_material,
                    bool allow_outside_paths, uint32_t *index, struct err *err);
// Copies the arrays likewise.
bool load_array(struct scene *scene, const struct scene_array *array, uint32_t default_material,
                uint32_t *index, struct err *err);
// Loads glTF as a mesh of our JSON format: appends meshes and materials and, transformed by `place`
// (3x4), the instances and lights of the nodes of the default scene. Cameras of the file are
// ignored.
bool load_gltf_into(struct scene *scene, const char *path, const double place[3][4],
                    bool allow_outside_paths, struct err *err);

// These grow arrays in the scene's arena. They return the new element, zeroed except that names are
// "", or NULL when out of memory; *index receives its index if it is not NULL. Pointers to earlier
// elements become invalid, because the array may move.
struct material *scene_add_material(struct scene *scene, uint32_t *index);
struct mesh *scene_add_mesh(struct scene *scene, uint32_t *index);
struct instance *scene_add_instance(struct scene *scene, uint32_t *index);
// Reserves room for this many more elements at once, so that they are not copied repeatedly.
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

// Returns whether a texture of the material scales this parameter, PARAMETER_*, so that its value
// may vary below the constant.
bool scene_parameter_is_textured(const struct scene *scene, const struct material *material,
                                 uint32_t parameter);

// Appends a copy of *mesh; its arrays live in the scene's arena already.
bool scene_append_mesh(struct scene *scene, const struct mesh *mesh, uint32_t *index,
                       struct err *err);

// Adds one instance, with the identity as its transform and with the mesh's own materials, for each
// of `count` meshes.
bool scene_place_meshes(struct scene *scene, uint32_t first_mesh, uint32_t count, struct err *err);

#endif
