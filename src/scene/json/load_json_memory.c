// Computes a lower bound of the memory for the shapes of a scene file, before any shape is made.
#include "scene/json/load_json.h"

#include "base/ascii.h"
#include "base/file.h"
#include "base/memory.h"
#include "scene/generate/phong_spheres.h"
#include "scene/generate/scatter.h"
#include <string.h>

// A lower bound of the memory that an element of the list needs. If an element names a file, or
// places spheres at random, only the memory that it certainly needs is counted.
struct needs {
    uint64_t bytes;   // for meshes
    uint64_t passing; // memory that is needed only while loading
    uint64_t instances, shapes;
    // Additional capacity that is reserved but may stay unused.
    uint64_t spare_instances, spare_shapes;
};

struct needs_list {
    struct needs *items; // one for each element so far
    json_t *names;       // object: index of each named element
    // For all elements so far: bytes of meshes, elements of the scene's arrays, and the capacity
    // that these arrays need.
    uint64_t bytes, instances, shapes, instance_room, shape_room;
    uint64_t peak; // maximum memory in bytes so far
};

// --- one shape -----------------------------------------------------------------------------------

// The loader reports errors in the document. Here the readers' messages are dropped, and erroneous
// elements count as nothing.

static struct needs one_instance(bool is_readable, uint64_t bytes)
{
    return is_readable ? (struct needs){.bytes = bytes, .instances = 1} : (struct needs){0};
}

static uint64_t subdivided_bytes(const struct json_node *node)
{
    struct err dropped = {0};
    uint64_t subdivision = SCATTER_SUBDIVISION;
    return node_read_integer(node, "subdivision", 0, SCATTER_SUBDIVISION_MAX, &subdivision,
                             &dropped)
               ? generate_icosphere_bytes((uint32_t)subdivision)
               : 0;
}

static bool is_analytic(const struct json_node *node, bool otherwise)
{
    struct err dropped = {0};
    bool analytic = otherwise;
    return load_json_is_analytic(node, &analytic, &dropped) && analytic;
}

static struct needs sphere_needs(const struct json_node *node)
{
    return is_analytic(node, true) ? (struct needs){.shapes = 1}
                                   : one_instance(true, subdivided_bytes(node));
}

static struct needs flat_sided_needs(const struct json_node *node)
{
    return is_analytic(node, false) ? (struct needs){.shapes = 1} : one_instance(true, 0);
}

// Counts one mesh file. Only the contents of a glTF file determine how many instances it has.
static struct needs mesh_needs(const struct json_node *node)
{
    struct err dropped = {0};
    const char *file = NULL;
    if (!node_read_string(node, "file", &file, &dropped) || !file)
        return (struct needs){0};
    const char *extension = path_extension(file);
    bool is_gltf = ascii_equal(extension, "gltf") || ascii_equal(extension, "glb");
    return one_instance(!is_gltf, 0);
}

static struct needs generated_needs(const struct json_node *node)
{
    struct err dropped = {0};
    uint32_t triangles = 0;
    bool ok = load_json_read_generated(node, &triangles, &dropped);
    return one_instance(ok, generate_blob_bytes(triangles));
}

static struct needs teapot_needs(const struct json_node *node)
{
    struct err dropped = {0};
    uint32_t resolution = 0;
    bool ok = load_json_read_teapot(node, &resolution, &dropped);
    return one_instance(ok, generate_teapot_bytes(resolution));
}

static struct needs torus_needs(const struct json_node *node)
{
    struct err dropped = {0};
    struct torus torus = {0};
    bool ok = load_json_read_torus(node, &torus, &dropped);
    return one_instance(ok, generate_torus_bytes(&torus));
}

static struct needs stadium_needs(const struct json_node *node)
{
    struct err dropped = {0};
    struct stadium stadium = {0};
    bool ok = load_json_read_stadium(node, &stadium, &dropped);
    return one_instance(ok, generate_stadium_bytes(&stadium));
}

// Counts the minimum, because it is not known in advance how many spheres find a place.
static struct needs scatter_needs(const struct json_node *node)
{
    struct err dropped = {0};
    uint64_t count = 0;
    const char *as = json_string_value(node_member(node, "as").value);
    if (!node_read_integer(node, "count", 1, SCATTER_COUNT_MAX, &count, &dropped))
        return (struct needs){0};
    return (struct needs){
        .bytes = as && strcmp(as, "triangles") == 0 ? subdivided_bytes(node) : 0,
        .passing = scatter_spheres_bytes((uint32_t)count),
    };
}

static struct needs figure_needs(const struct json_node *node)
{
    struct err dropped = {0};
    enum figure figure = FIGURE_SKULL;
    uint32_t triangles = 0;
    bool ok = load_json_read_figure(node, &figure, &triangles, &dropped);
    return one_instance(ok, generate_figure_bytes(triangles));
}

static struct needs phong_spheres_needs(const struct json_node *node)
{
    struct err dropped = {0};
    uint64_t count = 0;
    if (!node_read_integer(node, "count", 1, PHONG_SPHERES_COUNT_MAX, &count, &dropped))
        return (struct needs){0};
    return (struct needs){.passing = count * sizeof(struct phong_sphere)};
}

// --- copies --------------------------------------------------------------------------------------

static const struct needs *find(const struct needs_list *list, const json_t *name)
{
    const json_t *index =
        json_is_string(name) ? json_object_get(list->names, json_string_value(name)) : NULL;
    return index ? &list->items[json_integer_value(index)] : NULL;
}

static struct needs instance_needs(const struct needs_list *list, const struct json_node *node)
{
    const struct needs *original = find(list, node_member(node, "of").value);
    if (!original)
        return (struct needs){0};
    return (struct needs){.instances = original->instances, .shapes = original->shapes};
}

static uint64_t least(uint64_t a, uint64_t b)
{
    return a < b ? a : b;
}

static uint64_t most(uint64_t a, uint64_t b)
{
    return a > b ? a : b;
}

// Counts scattered copies. Each copy is one of several kinds, and capacity is reserved for the kind
// with the most elements.
static struct needs strew_needs(const struct needs_list *list, const struct json_node *node)
{
    struct err dropped = {0};
    const json_t *of = node_member(node, "of").value;
    size_t kinds = json_is_array(of) ? json_array_size(of) : 1;
    struct needs low = {.instances = UINT64_MAX, .shapes = UINT64_MAX}, high = {0};
    uint64_t count = 0;
    if (kinds == 0 || !node_read_integer(node, "count", 1, STREW_COUNT_MAX, &count, &dropped))
        return (struct needs){0};
    for (size_t i = 0; i < kinds; i++) {
        const struct needs *kind = find(list, json_is_array(of) ? json_array_get(of, i) : of);
        if (!kind)
            return (struct needs){0};
        low.instances = least(low.instances, kind->instances);
        low.shapes = least(low.shapes, kind->shapes);
        high.instances = most(high.instances, kind->instances);
        high.shapes = most(high.shapes, kind->shapes);
    }
    if (count * (high.instances + high.shapes) > STREW_COUNT_MAX)
        return (struct needs){0}; // rejected later
    return (struct needs){
        .instances = count * low.instances,
        .shapes = count * low.shapes,
        .spare_instances = count * (high.instances - low.instances),
        .spare_shapes = count * (high.shapes - low.shapes),
    };
}

// --- the list ------------------------------------------------------------------------------------

static struct needs needs_of(const struct needs_list *list, const struct json_node *node)
{
    struct err dropped = {0};
    uint32_t type;
    if (!load_json_shape_type(node, &type, &dropped))
        return (struct needs){0};
    switch ((enum shape_type)type) {
    case SHAPE_TYPE_MESH:
        return mesh_needs(node);
    case SHAPE_TYPE_QUAD:
    case SHAPE_TYPE_BOX:
        return flat_sided_needs(node);
    case SHAPE_TYPE_SPHERE:
        return sphere_needs(node);
    case SHAPE_TYPE_DISC:
    case SHAPE_TYPE_PLANE:
    case SHAPE_TYPE_CYLINDER:
    case SHAPE_TYPE_SDF:
        return (struct needs){.shapes = 1};
    case SHAPE_TYPE_GENERATED:
        return generated_needs(node);
    case SHAPE_TYPE_TEAPOT:
        return teapot_needs(node);
    case SHAPE_TYPE_TORUS:
        return torus_needs(node);
    case SHAPE_TYPE_STADIUM:
        return stadium_needs(node);
    case SHAPE_TYPE_SCATTER:
        return scatter_needs(node);
    case SHAPE_TYPE_FIGURE:
        return figure_needs(node);
    case SHAPE_TYPE_PHONG_SPHERES:
        return phong_spheres_needs(node);
    case SHAPE_TYPE_INSTANCE:
        return instance_needs(list, node);
    case SHAPE_TYPE_STREW:
        return strew_needs(list, node);
    case SHAPE_TYPE_COUNT:
        break;
    }
    return (struct needs){0};
}

static void add(struct needs_list *list, const struct needs *needs)
{
    list->bytes += needs->bytes;
    list->instances += needs->instances;
    list->shapes += needs->shapes;
    list->instance_room = most(list->instance_room, list->instances + needs->spare_instances);
    list->shape_room = most(list->shape_room, list->shapes + needs->spare_shapes);
    uint64_t now = list->bytes + needs->passing + list->instance_room * sizeof(struct instance) +
                   list->shape_room * sizeof(struct shape);
    list->peak = most(list->peak, now);
}

static bool add_all(struct needs_list *list, const struct json_node *shapes, struct err *err)
{
    static const char what[] = "all shapes; this shape is the first that does not fit";
    size_t count = json_array_size(shapes->value), refused = count;
    for (size_t i = 0; i < count; i++) {
        const struct json_node node = node_element(shapes, i);
        const json_t *name = json_object_get(node.value, "name");
        list->items[i] = needs_of(list, &node);
        add(list, &list->items[i]);
        if (refused == count && !memory_check(list->peak, what, err))
            refused = i;
        if (json_is_string(name) && json_object_set_new(list->names, json_string_value(name),
                                                        json_integer((json_int_t)i)) != 0)
            return err_memory(err, "a name", json_string_length(name));
    }
    const struct json_node first = node_element(shapes, refused);
    return refused == count || memory_check(list->peak, what, err) || node_prepend(&first, err);
}

bool load_json_check_memory(const struct json_node *shapes, struct err *err)
{
    size_t count = json_array_size(shapes->value);
    struct arena scratch = {0};
    struct needs_list list = {
        .items = ARENA_NEW(&scratch, struct needs, count),
        .names = json_object(),
    };
    bool ok = list.items && list.names
                  ? add_all(&list, shapes, err)
                  : err_memory(err, "the list of shapes", count * sizeof *list.items);
    json_decref(list.names);
    arena_finish(&scratch);
    return ok;
}
