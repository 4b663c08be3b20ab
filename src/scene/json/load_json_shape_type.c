// The types of shapes in scene files, and the keys that each type has.
#include "scene/json/load_json.h"

static const char *const type_names[SHAPE_TYPE_COUNT] = {
    "mesh",     "quad",      "box",           "sphere", "disc",    "plane",
    "cylinder", "generated", "teapot",        "torus",  "stadium", "sdf",
    "scatter",  "instance",  "phong_spheres", "figure", NULL};

#define EVERY_SHAPE "name", "transform", "hidden", "visible"

// The keys of each type, including "type".
static const struct {
    const char *required[6], *optional[11];
} type_keys[SHAPE_TYPE_COUNT] = {
    [SHAPE_TYPE_MESH] = {{"type"}, {EVERY_SHAPE, "material", "fit", "file", "array"}},
    [SHAPE_TYPE_QUAD] = {{"type", "material"}, {EVERY_SHAPE, "vertices", "corner", "u", "v", "as"}},
    [SHAPE_TYPE_BOX] = {{"type", "material", "min", "max"}, {EVERY_SHAPE, "as"}},
    [SHAPE_TYPE_SPHERE] = {{"type", "material", "radius"},
                           {EVERY_SHAPE, "center", "as", "subdivision"}},
    [SHAPE_TYPE_DISC] = {{"type", "material", "radius", "normal"}, {EVERY_SHAPE, "center"}},
    [SHAPE_TYPE_PLANE] = {{"type", "material", "normal"}, {EVERY_SHAPE, "point"}},
    [SHAPE_TYPE_CYLINDER] = {{"type", "material", "radius"},
                             {EVERY_SHAPE, "from", "to", "center", "axis", "height", "caps"}},
    [SHAPE_TYPE_GENERATED] = {{"type", "material", "triangles"}, {EVERY_SHAPE}},
    [SHAPE_TYPE_TEAPOT] = {{"type", "material"}, {EVERY_SHAPE, "resolution"}},
    [SHAPE_TYPE_TORUS] = {{"type", "material"}, {EVERY_SHAPE, "tube", "segments", "tube_segments"}},
    [SHAPE_TYPE_STADIUM] = {{"type", "material"}, {EVERY_SHAPE, "steps", "segments"}},
    [SHAPE_TYPE_SDF] = {{"type", "material", "field"}, {EVERY_SHAPE, "bounds"}},
    [SHAPE_TYPE_SCATTER] = {{"type", "count", "disc_radius", "radius", "materials"},
                            {EVERY_SHAPE, "seed", "as", "subdivision"}},
    [SHAPE_TYPE_INSTANCE] = {{"type", "of"}, {EVERY_SHAPE, "material"}},
    [SHAPE_TYPE_PHONG_SPHERES] = {{"type", "count", "seed", "radius", "disc_radius"},
                                  {EVERY_SHAPE}},
    [SHAPE_TYPE_FIGURE] = {{"type", "material", "figure"}, {EVERY_SHAPE, "triangles", "fit"}},
    [SHAPE_TYPE_STREW] = {{"type", "of", "count"},
                          {EVERY_SHAPE, "disc_radius", "size", "seed", "scale", "tilt_degrees"}},
};

bool load_json_shape_type(const struct json_node *node, uint32_t *type, struct err *err)
{
    if (!json_is_object(node->value))
        return node_unexpected(node, "an object", err);
    if (!node_member(node, "type").value)
        return node_fail(node, err, "\"type\" is missing");
    if (!node_read_choice(node, "type", type_names, type, err))
        return false;
    if (*type == SHAPE_TYPE_SCATTER && node_member(node, "of").value)
        *type = SHAPE_TYPE_STREW;
    return node_check_object(node, type_keys[*type].required, type_keys[*type].optional, err);
}
