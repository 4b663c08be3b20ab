// A scene as plain arrays. Loaders fill them; scene_flatten() converts them for the BVH and the
// kernels. No Vulkan.
//
// Units: metres, radiance in W/(sr m^2) in linear Rec. 709 primaries, angles in radians. The world
// is right-handed, with any up axis. Matrices are row-major and multiply column vectors: p' = M p.
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

// Maximum |coordinate| and length, in metres. Objects may be up to 1e12 m away; the rest of the
// range is for cameras and lights around them.
#define SCENE_COORDINATE_MAX 1e13
// The minimum radius, height or range of any object, in metres.
#define SCENE_LENGTH_MIN 1e-18
#define SCENE_LENS_MAX_MM (1e3 * SCENE_COORDINATE_MAX) // maximum lens radius in mm
#define SCENE_LENS_BLADES_MAX 64
#define SCENE_TURN_MAX 1e6 // maximum rotation of an environment, degrees
// The maximum and minimum extent of a whole scene along an axis, in metres.
#define SCENE_EXTENT_MAX (2 * SCENE_COORDINATE_MAX)
#define SCENE_EXTENT_MIN 1e-13
// The maximum radiance. It leaves a factor of 1e8 for sums over samples and for products with
// throughputs.
#define SCENE_RADIANCE_MAX 1e30 // W/(sr m^2)

// A triangle mesh in its own space.
struct mesh {
    const char *name;
    uint32_t vertex_count;
    uint32_t triangle_count;
    float (*positions)[3];        // vertex_count elements
    double (*exact_positions)[3]; // `positions` before rounding; NULL: not known
    float (*normals)[3];          // unit vectors, or (0,0,0) where missing; NULL: none
    float (*tangents)[4];         // unit vectors and the bitangent's sign; NULL: none
    float (*uvs[2])[2];           // two sets, t points down; NULL: none
    float (*colors)[4];           // linear RGBA; NULL: none
    uint32_t (*indices)[3];       // triangle_count elements, each below vertex_count
    uint32_t *triangle_material;  // triangle_count elements; NULL: `material` for all
    uint32_t material;
};

struct instance {
    uint32_t mesh;
    uint32_t material;      // replaces the mesh's materials; SCENE_NONE: none
    double transform[3][4]; // mesh space to world
    bool hidden;            // omitted from the render
};

// The order is that of SHAPE_KIND_* in shaders/shared/types.h.
enum shape_kind {
    SHAPE_SPHERE,
    SHAPE_DISC,
    SHAPE_PLANE,    // infinite
    SHAPE_QUAD,     // a parallelogram
    SHAPE_BOX,      // perpendicular edges, any orientation
    SHAPE_CYLINDER, // closed by caps at both ends
    SHAPE_TUBE,     // an open cylinder, without caps
    SHAPE_SDF,      // a signed distance field
    SHAPE_KIND_COUNT
};

// An analytic shape in world space. Transforms are applied when it is loaded; a transform that
// would make it another kind of shape is an input error.
struct shape {
    enum shape_kind kind;
    uint32_t material;
    double center[3]; // plane: any point of it; distance field: centre of its box
    double normal[3]; // disc, plane: unit normal
    double radius;    // sphere, disc, cylinder, open cylinder: > 0
    // Quad: two half edges. Box: three perpendicular half edges, right-handed. Cylinders: [0] leads
    // from the centre to an end, [1] is the perpendicular unit vector at which u is 0. Plane: [1]
    // as for cylinders. Distance field: half edges of its box.
    double axes[3][3];
    uint32_t sdf; // index in scene.sdfs
    bool hidden;  // omitted from the render
};

// A signed distance field (shared/sdf.h), in the space of its description. Shapes of kind SHAPE_SDF
// place it in the world; see sdf_to_world().
struct gpu_sdf_instruction;
struct sdf {
    double min[3], max[3]; // bounding box in that space
    struct gpu_sdf_instruction *code;
    uint32_t count;   // number of instructions
    double lipschitz; // upper bound of the described field's gradient; the program's is at most 1
    double magnitude; // maximum |coordinate| that the program computes within the box
};

struct camera {
    double position[3];
    double direction[3];   // unit vector in which the camera looks
    double up[3];          // not parallel to direction; need not be orthogonal to it
    uint32_t kind;         // CAMERA_*
    double fov_y;          // perspective: vertical field of view, radians, in (0, pi)
    double height;         // orthographic: height of the visible region, metres
    double lens_radius;    // metres; 0: a pinhole
    double focus_distance; // distance along `direction`, metres; > 0 with a lens
    uint32_t lens_blades;  // blades of the aperture, at least 3; 0: a round aperture
    double lens_rotation;  // rotation of the blades, radians
    const char *name;
};

// The sun of a sky. When the scene is complete, it becomes a light.
struct environment_sun {
    double direction[3];   // unit vector in which its light travels
    float irradiance[3];   // on a surface facing the sun, W/m^2
    double angular_radius; // radians; 0: there is no sun
    uint32_t light;        // 1 + index in scene.lights of its light; 0: it has none yet
};

struct sky;
struct environment_gradient;

// The light that arrives from infinitely far away, which escaping rays find. `radiance` multiplies
// the image, if there is one.
struct environment {
    bool present;
    float radiance[3];      // constant radiance, or a factor on the image
    double rotation;        // about +Y, radians; see environment.h
    uint32_t width, height; // 0 x 0: constant radiance
    float (*texels)[3];     // latitude-longitude, row 0 at the top (+Y); see environment.h
    struct environment_sun sun;
    uint64_t zeroed; // number of texels of the file that were negative or not finite, and became 0
    // The source of the texels, for writing scene files. At most one of these is set; if none is,
    // the environment is constant.
    const char *file; // relative to the working directory
    const struct sky *sky;
    const struct environment_gradient *gradient;
};

struct scene_base;
struct placed_object;

// A path as written in an override, and the same path relative to the working directory.
struct scene_path {
    const char *text, *path;
};

// The up axis of the world, for light and ground that are added to a model.
enum scene_up { SCENE_UP_Y, SCENE_UP_X, SCENE_UP_Z };
extern const char *const scene_up_names[]; // "y", "x", "z", NULL

// The light for a scene that has none of its own; see studio.h.
enum scene_studio {
    SCENE_STUDIO_OFF,  // a constant environment
    SCENE_STUDIO_AUTO, // ON for models, OFF for .json scenes with a camera
    SCENE_STUDIO_ON,   // the studio always replaces the environment
};
extern const char *const scene_studio_names[]; // "off", "auto", "on", NULL
enum scene_ground {
    // Adds a ground if the studio's light is added, unless a model's camera is below the ground or
    // a .json scene has a camera.
    SCENE_GROUND_AUTO,
    SCENE_GROUND_ON,
    SCENE_GROUND_OFF,
};
extern const char *const scene_ground_names[]; // "auto", "on", "off", NULL

struct scene {
    struct arena arena;              // owns all data of the scene
    const struct progress *progress; // listener while the scene is loaded; NULL: none
    const char *path;                // as given on the command line
    struct material *materials;
    uint32_t material_count; // at least 1: loaders add a grey default if a file has none
    struct mesh *meshes;
    uint32_t mesh_count;
    struct instance *instances;
    uint32_t instance_count;
    struct shape *shapes;
    uint32_t shape_count;
    struct sdf *sdfs;
    uint32_t sdf_count;
    struct camera *cameras;   // as in the file; the first is used unless another is chosen
    uint32_t camera_count;    // at least 1 after scene_load
    uint32_t animation_count; // number of animations in a glTF file
    double animation_seconds; // time of the last key of the selected or else the first animation
    bool camera_is_framed;    // the loader added cameras[0]; see scene_frame_camera
    bool is_model;            // the file, or its base, is in another format than this program's
    bool is_empty;            // no triangle with an area, no shape and no environment of its own
    bool is_hidden;           // all surfaces are hidden, and there is no environment of its own
    bool has_studio;          // the studio's light was added
    double weak_emission;     // *emission of scene_is_lit() if it is too weak, else 0
    bool has_ground;          // the last shape is an added ground
    bool has_own_exposure, has_own_tone; // the file sets them
    bool exposure_is_replaced;           // the file's exposure was meant for an environment that
                                         // --env replaces
    bool is_strict;                      // missing images are errors
    uint32_t missing_image_count;        // number of images that are replaced by pink
    enum scene_up up;
    struct texture_image *images;
    uint32_t image_count;
    struct texture *textures; // the textures of one material are adjacent
    uint32_t texture_count;
    struct light *lights;
    uint32_t light_count;
    struct placed_object *placed; // placed objects, see placement.h
    uint32_t placed_count;
    // The light profile that was read last; the others follow by `next`, see ies.h.
    const struct light_profile *profiles;
    struct environment environment;
    struct settings settings; // the defaults, overridden by the file
    uint64_t hash;            // hash of the file, of all files that it names, and of the overrides
    // The loader's notes on what it added or changed, for the report, such as "no camera in the
    // file: framed from the front".
    const char **notes;
    uint32_t note_count;
    // For writing scene files: the strings of overrides that were read as paths, and the base and
    // edits of a file with a "base" (scene_edits.h). `base` is NULL if the file has none.
    struct scene_path *override_paths;
    uint32_t override_path_count, override_path_capacity;
    const struct scene_base *base;
    // Capacities of the arrays above, for the scene_add_ functions and scene_note() only.
    uint32_t material_capacity, mesh_capacity, instance_capacity, shape_capacity, camera_capacity;
    uint32_t note_capacity, image_capacity, texture_capacity, light_capacity, sdf_capacity;
    uint32_t placed_capacity;
};

struct scene_override {
    const char *key;   // path in the document, with dots, or the name of an entry of "define"
    const char *value; // JSON; text that is not valid JSON is a string
};

// A mesh in arrays that the caller owns; {"type": "mesh", "array": NAME} in a scene file places it.
// Numbers have the machine's representation and any alignment. Strides are distances in bytes; 0:
// elements without gaps.
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
    const void *indices; // three uint32_t for each triangle; NULL: triangle i has vertices 3 i to 3
                         // i + 2
    size_t index_stride; // from one triangle to the next
};

struct scene_load_params {
    const char *path; // .json (this program's format), .gltf, .glb, .obj, .ply or .stl, in upper or
                      // lower case
    const struct scene_override *overrides; // -D key=value; for .json only
    uint32_t override_count;
    const char *text; // replaces the contents of a .json file; `path` then only names it
    const struct scene_array *arrays; // meshes that a .json file may place
    uint32_t array_count;
    bool allow_outside_paths; // files may name files outside of their own folder
    // The overrides come from a file in this folder: paths in them are relative to this folder and
    // must lie in it. NULL: the overrides come from the user.
    const char *override_folder;
    uint32_t base_depth; // length of the chain of "base" files that leads to this one
    // Replacements of the file's environment; see environment.h and sky.h. If all three are NULL,
    // the file's environment is kept.
    const char *environment_file;
    const float *environment_radiance; // 3 components
    const struct sky *environment_sky;
    double environment_rotation;        // added to the environment's rotation, radians
    const double *environment_strength; // additional factor on the environment's radiance; NULL: 1
    enum scene_studio studio;           // 0 (off) for measurements
    enum scene_ground ground;
    enum scene_up up;
    bool is_strict; // missing images are errors instead of pink
    // This and the next three members only apply to glTF. The time, in seconds, at which
    // `animation` is evaluated. NULL: the beginning of `animation`; if that is NULL, too, the nodes
    // are not animated.
    const double *at_seconds;
    const char *animation;  // name or index; NULL: the first
    const char *scene_name; // name or index; NULL: the file's default
    const char *variant;    // name of a variant of KHR_materials_variants; NULL: none
    const struct progress *progress;
};

// Loads and checks a scene. If it has no camera or no light, these are added, with notes. On
// failure *out is finished and {0}, and *err names the file, the place, the value and what was
// expected.
bool scene_load(const struct scene_load_params *params, struct scene *out, struct err *err);
// Loads a file into *scene, which the caller has initialised.
bool scene_load_into(struct scene *scene, const struct scene_load_params *params, struct err *err);
void scene_finish(struct scene *scene); // accepts NULL and {0}

// Moves the camera that was added to a scene without one, so that the whole scene, without the
// ground, fills the image of settings.width x settings.height. Call it again when these change.
// Does not move cameras of the file.
void scene_frame_camera(struct scene *scene);

// Appends a formatted text to scene->notes. Returns false when out of memory.
bool scene_note(struct scene *scene, const char *format, ...) __attribute__((format(printf, 2, 3)));

// Reports the progress of a long part of loading, a fraction in [0, 1]. Fails with ERR_STOPPED when
// the listener wants to stop.
bool scene_loading(const struct scene *scene, double fraction, struct err *err);
// Polls for a stop at iteration `i` of a loop, without a report (see progress_stops_at). Fails with
// ERR_STOPPED when the listener wants to stop.
bool scene_goes_on(const struct scene *scene, uint64_t i, struct err *err);

// --- loaders (scene_load() calls one of them, chosen by extension) -------------------------------
// Each loader appends to *scene, whose defaults, arena and path are set, and continues scene->hash
// over the bytes of every file that it reads. `load_base` loads the file that a document names as
// its "base"; it is scene_load_into.
typedef bool (*scene_load_fn)(struct scene *scene, const struct scene_load_params *params,
                              struct err *err);
bool load_json(struct scene *scene, const struct scene_load_params *params, scene_load_fn load_base,
               struct err *err);
bool load_gltf(struct scene *scene, const struct scene_load_params *params, struct err *err);
// Load OBJ, PLY and STL; load_json also calls these for {"type": "mesh", "file": …}. On success
// they have appended one mesh, *index, and the materials that it needs, but no instances. `path` is
// trusted, because the caller has checked it. default_material is for triangles without a material;
// SCENE_NONE: a grey one is appended if needed.
bool load_obj(struct scene *scene, const char *path, uint32_t default_material,
              bool allow_outside_paths, uint32_t *index, struct err *err);
bool load_ply(struct scene *scene, const char *path, uint32_t default_material, uint32_t *index,
              struct err *err);
bool load_stl(struct scene *scene, const char *path, uint32_t default_material, uint32_t *index,
              struct err *err);
// Returns whether the path has the extension of one of these formats.
bool is_mesh_file(const char *path);
// Returns the end of a message about a file of another format: "; PROGRAM can export it as glTF" if
// such a program is known, else "".
const char *mesh_file_hint(const char *path);
// Sets ERR_INPUT for a file with an unknown extension and returns false. The message lists the
// known extensions.
bool scene_unknown_extension(const char *path, struct err *err);
// Loads an OBJ, PLY or STL file, according to its extension.
bool load_mesh_by_extension(struct scene *scene, const char *path, uint32_t default_material,
                            bool allow_outside_paths, uint32_t *index, struct err *err);
// Appends a mesh from the caller's arrays, which are checked and copied.
bool load_array(struct scene *scene, const struct scene_array *array, uint32_t default_material,
                uint32_t *index, struct err *err);
// Loads a glTF file as a shape of a .json scene: appends its meshes and materials, and the
// instances and lights of its default scene, transformed by `place` (3x4). The file's cameras are
// ignored.
bool load_gltf_into(struct scene *scene, const char *path, const double place[3][4],
                    bool allow_outside_paths, struct err *err);

// Append elements to arrays in the scene's arena. They return the new element, or NULL when out of
// memory. Its members are 0, except that names are "", materials have the values of
// material_init(), and a texture's transform is the identity. *index becomes its index if `index`
// is not NULL. Pointers to earlier elements become invalid, because the array may move.
struct material *scene_add_material(struct scene *scene, uint32_t *index);
struct mesh *scene_add_mesh(struct scene *scene, uint32_t *index);
struct instance *scene_add_instance(struct scene *scene, uint32_t *index);
// Reserve room for this many more elements at once, so that they are not copied repeatedly.
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

// Returns whether a texture of the material scales this parameter (PARAMETER_*), so that its value
// may vary below the constant.
bool scene_parameter_is_textured(const struct scene *scene, const struct material *material,
                                 uint32_t parameter);

// Appends a copy of *mesh, whose arrays must already live in the scene's arena.
bool scene_append_mesh(struct scene *scene, const struct mesh *mesh, uint32_t *index,
                       struct err *err);

// Adds one instance, with the identity as its transform and the mesh's own materials, for each of
// `count` meshes.
bool scene_place_meshes(struct scene *scene, uint32_t first_mesh, uint32_t count, struct err *err);

#endif
