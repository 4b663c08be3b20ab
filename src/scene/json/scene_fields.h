// Tables of the fields of materials, lights, cameras and environments in scene files, and of their
// representation in memory. They are used by "edits" and for writing scenes.
#ifndef LAMPYRIS_SCENE_JSON_SCENE_FIELDS_H
#define LAMPYRIS_SCENE_JSON_SCENE_FIELDS_H

#include "base/field.h"
#include "scene/core/scene.h"

#define SCENE_FIELDS_MAX 64

struct scene_fields {
    struct field list[SCENE_FIELDS_MAX];
    size_t count;
};

// Returns the field of one of material_parameters[].
struct field scene_parameter_field(uint32_t parameter);
// Lists all fields of a material that may be edited: the model ("type"), parameters, flags, medium.
void scene_material_fields(struct scene_fields *out);
// Lists the fields of a light. The first field is the kind. The key of `radiant` depends on the
// kind: "intensity" or "irradiance".
void scene_light_fields(uint32_t kind, struct scene_fields *out);
// Lists the fields that this camera uses. The fields of a lens of radius 0 are included if the
// focus distance is within 1e-9 to 1e9 m.
void scene_camera_fields(const struct camera *camera, struct scene_fields *out);

extern const struct field scene_placement_fields[4]; // about, move, turn_degrees, scale
// Members of struct shape: center, half_u, half_v.
extern const struct field scene_quad_fields[3];

extern const struct field scene_environment_fields[2]; // radiance, rotation
extern const struct field scene_gradient_fields[3];
extern const struct field scene_sky_fields[5];

// Members of struct scene_load_params: studio, ground, up.
extern const struct field scene_base_fields[3];
// A text member of scene_load_params: a name or an index within a glTF file.
struct scene_base_text {
    const char *key;
    size_t offset;
};
extern const struct scene_base_text scene_base_texts[3];

const char *scene_material_name(const struct scene *scene, uint32_t material);
const char *scene_light_name(const struct scene *scene, uint32_t light);

// Fields of cameras that load_json_camera() reads one by one, because other keys may replace them.
extern const struct field scene_fov_field, scene_aperture_field, scene_blade_rotation_field;

#endif
