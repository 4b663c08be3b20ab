// Declarations that the parts of the loader of .json scene files share. Internal to scene/.
// docs/scene-format.md describes the format.
#ifndef LAMPYRIS_SCENE_JSON_LOAD_JSON_H
#define LAMPYRIS_SCENE_JSON_LOAD_JSON_H

#include "json/json_node.h"
#include "scene/core/bounds.h"
#include "scene/core/scene.h"
#include "scene/generate/figure.h"
#include "scene/generate/generate.h"

// The maximum size of a scene file in bytes; meshes and images have their own files. jansson's tree
// needs up to about thirty times the size of the text, which the memory budget does not include.
#define LOAD_JSON_BYTES_MAX ((size_t)64 << 20)

struct json_loader {
    struct scene *scene;
    const struct scene_load_params *params;
    scene_load_fn load_base;
    const char *folder;      // folder of the scene file
    const json_t *trusted;   // values given with -D, whose paths are trusted
    json_t *material_names;  // object: index of each named material
    json_t *shape_names;     // object: index of each named shape in the list of shapes
    struct scene_base *base; // NULL unless the document has a "base"
};

// Applies the overrides to the document and replaces references "${NAME}". The values of overrides
// are appended to the array `trusted`, which shares them with the document.
bool load_json_apply_overrides(const struct json_node *document,
                               const struct scene_load_params *params, json_t *trusted,
                               struct err *err);
// Parses the value of an override as JSON; if that fails, the value is the text as a string.
// Returns NULL with *err set if the text is not UTF-8.
json_t *load_json_override_value(const char *text, struct err *err);
bool load_json_resolve_references(const struct json_node *document, struct err *err);

// The keys of the document, ended by NULL.
extern const char *const load_json_document_keys[];

// Reads a section of the document, at `node`.
typedef bool load_json_fn(struct json_loader *loader, const struct json_node *node,
                          struct err *err);
load_json_fn load_json_camera, load_json_film, load_json_settings, load_json_materials;
load_json_fn load_json_lights, load_json_environment, load_json_shapes, load_json_edits;
// Reads the section `key` if the document has it.
bool load_json_section(struct json_loader *loader, const struct json_node *document,
                       const char *key, load_json_fn *load, struct err *err);
// Reads a document with a "base". Its version has been checked already.
load_json_fn load_json_base;
// Appends a material's textures and sets the parameters that they scale. `owner` is the material's
// node.
bool load_json_textures(struct json_loader *loader, const struct json_node *owner,
                        struct material *material, struct err *err);
// Checks a spot light's cone and a sun's disc.
bool load_json_check_light(const struct json_node *node, const struct light *light,
                           struct err *err);

// Shapes that need no other file. Each function appends a shape in its own space: either an
// instance of a mesh, with the identity as its transform, or an analytic shape.
typedef bool load_json_shape_fn(struct scene *scene, const struct json_node *node,
                                uint32_t material, struct err *err);
load_json_shape_fn load_json_quad, load_json_box, load_json_sphere, load_json_disc;
load_json_shape_fn load_json_plane, load_json_cylinder, load_json_generated, load_json_teapot;
load_json_shape_fn load_json_torus, load_json_stadium, load_json_figure;
load_json_shape_fn load_json_phong_spheres; // uses materials of its own
load_json_shape_fn load_json_sdf;           // placed by its own transforms

// Read the parameters of generated meshes, for the functions above and load_json_check_memory().
bool load_json_read_generated(const struct json_node *generated, uint32_t *triangles,
                              struct err *err);
bool load_json_read_teapot(const struct json_node *teapot, uint32_t *resolution, struct err *err);
bool load_json_read_torus(const struct json_node *node, struct torus *torus, struct err *err);
bool load_json_read_figure(const struct json_node *node, enum figure *figure, uint32_t *triangles,
                           struct err *err);
bool load_json_read_stadium(const struct json_node *node, struct stadium *stadium, struct err *err);

// The types of elements in the list of shapes.
enum shape_type {
    SHAPE_TYPE_MESH,
    SHAPE_TYPE_QUAD,
    SHAPE_TYPE_BOX,
    SHAPE_TYPE_SPHERE,
    SHAPE_TYPE_DISC,
    SHAPE_TYPE_PLANE,
    SHAPE_TYPE_CYLINDER,
    SHAPE_TYPE_GENERATED,
    SHAPE_TYPE_TEAPOT,
    SHAPE_TYPE_TORUS,
    SHAPE_TYPE_STADIUM,
    SHAPE_TYPE_SDF,
    SHAPE_TYPE_SCATTER,
    SHAPE_TYPE_INSTANCE,
    SHAPE_TYPE_PHONG_SPHERES,
    SHAPE_TYPE_FIGURE,
    SHAPE_TYPE_STREW, // "scatter" with "of"; follows the types that have names
    SHAPE_TYPE_COUNT,
};
// Reads "type" and checks that the element has the keys of that type.
bool load_json_shape_type(const struct json_node *node, uint32_t *type, struct err *err);
// Checks a lower bound of the memory that all shapes of the list need against the budget, before
// any shape is made. Fails with ERR_BUDGET if it is exceeded, naming the first shape that does not
// fit.
bool load_json_check_memory(const struct json_node *shapes, struct err *err);

// Reads whether "as" is "analytic" or "triangles". Without the key, *analytic is unchanged.
bool load_json_is_analytic(const struct json_node *object, bool *analytic, struct err *err);
bool load_json_analytic_quad(struct scene *scene, const struct json_node *quad,
                             const double vertices[4][3], uint32_t material, struct err *err);
bool load_json_analytic_box(struct scene *scene, const struct json_node *box,
                            const double bounds[2][3], uint32_t material, struct err *err);

// Reads a "transform": one step, or a list of steps that are composed.
bool load_json_transform(const struct json_node *transform, double out[3][4], struct err *err);
// Applies a transform to an analytic shape. Fails at `node` if the result is not a shape of the
// same kind.
bool load_json_move_shape(const struct json_node *node, const double m[3][4], struct shape *shape,
                          struct err *err);

// Adds scattered spheres, which have materials of their own.
load_json_fn load_json_scatter;

// Finds the part of the scene that a named shape became. `parts` has the parts of all earlier
// shapes in the list.
bool load_json_find_part(const struct json_loader *loader, const struct json_node *name,
                         const struct scene_part *parts, struct scene_part *out, struct err *err);
// Adds scattered copies of named shapes.
bool load_json_strew(struct json_loader *loader, const struct json_node *scatter,
                     const struct scene_part *parts, struct err *err);

// Reads the index of the material that "material" names; SCENE_NONE if the key is absent.
bool load_json_material_name(const struct json_loader *loader, const struct json_node *object,
                             uint32_t *material, struct err *err);

// Reads a unit vector: "direction", or the direction from `position` to "target". If `position` is
// NULL, "target" is not permitted.
bool load_json_direction(const struct json_node *object, const double position[3],
                         double direction[3], struct err *err);

// Returns the path given by the string at `key`. It must lie in the scene file's folder unless it
// came from the command line or the user permits other folders. Returns NULL with *err set on
// failure. The path lives in the scene's arena.
const char *load_json_path(struct json_loader *loader, const struct json_node *object,
                           const char *key, struct err *err);

// Ranges that several sections use.
extern const struct range RANGE_UNIT;       // [0, 1]
extern const struct range RANGE_RADIANCE;   // [0, SCENE_RADIANCE_MAX]
extern const struct range RANGE_COORDINATE; // +-SCENE_COORDINATE_MAX
extern const struct range RANGE_RADIUS;     // SCENE_LENGTH_MIN to SCENE_COORDINATE_MAX

#endif
