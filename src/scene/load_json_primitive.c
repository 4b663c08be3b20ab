// Shapes of a scene file that need no other file: quad, box, sphere, disc, generated mesh.
#include "load_json.h"

#include "affine.h"
#include "generate.h"
#include <string.h>

// Enough for any memory that a load may take; a clearer message than that it is exhausted.
#define GENERATED_TRIANGLES_MAX 200000000

// Appends a mesh and an instance of it. The numbers of the document are kept in double precision:
// they may be far from the origin in a world that is rebased later.
static bool add_polygons(struct scene *scene, const char *name, uint32_t material,
                         const double (*vertices)[3], uint32_t vertex_count,
                         const uint32_t (*triangles)[3], uint32_t triangle_count, struct err *err)
{
    double(*exact)[3] = arena_alloc(&scene->arena, vertex_count, sizeof *exact);
    float(*positions)[3] = arena_alloc(&scene->arena, vertex_count, sizeof *positions);
    uint32_t(*indices)[3] = arena_alloc(&scene->arena, triangle_count, sizeof *indices);
    if (!exact || !positions || !indices)
        return err_memory(err, "a mesh's vertices", vertex_count * sizeof *exact);
    memcpy(exact, vertices, vertex_count * sizeof *exact);
    memcpy(indices, triangles, triangle_count * sizeof *indices);
    for (uint32_t v = 0; v < vertex_count; v++)
        for (int i = 0; i < 3; i++)
            positions[v][i] = (float)vertices[v][i];
    const struct mesh mesh = {
        .name = name,
        .vertex_count = vertex_count,
        .triangle_count = triangle_count,
        .positions = positions,
        .exact_positions = exact,
        .indices = indices,
        .material = material,
    };
    uint32_t index;
    return scene_append_mesh(scene, &mesh, &index, err) && scene_place_meshes(scene, index, 1, err);
}

// --- quad ----------------------------------------------------------------------------------------

static bool read_four_vertices(const struct json_node *quad, double vertices[4][3], struct err *err)
{
    const struct json_node list = node_member(quad, "vertices");
    if (!node_check_array(&list, 4, 4, err))
        return false;
    for (size_t i = 0; i < 4; i++) {
        const struct json_node vertex = node_element(&list, i);
        if (!node_numbers(&vertex, 3, RANGE_COORDINATE, vertices[i], err))
            return false;
    }
    return true;
}

// corner, corner + u, corner + u + v, corner + v: the normal is along u x v.
static bool read_parallelogram(const struct json_node *quad, double vertices[4][3], struct err *err)
{
    double u[3], v[3];
    for (const char *const *key = (const char *const[]){"u", "v", NULL}; *key; key++)
        if (!node_member(quad, *key).value)
            return node_fail(quad, err, "\"%s\" is missing", *key);
    if (!node_read_vector(quad, "corner", RANGE_COORDINATE, vertices[0], err) ||
        !node_read_vector(quad, "u", RANGE_COORDINATE, u, err) ||
        !node_read_vector(quad, "v", RANGE_COORDINATE, v, err))
        return false;
    for (int i = 0; i < 3; i++) {
        vertices[1][i] = vertices[0][i] + u[i];
        vertices[2][i] = vertices[0][i] + u[i] + v[i];
        vertices[3][i] = vertices[0][i] + v[i];
    }
    return true;
}

bool load_json_quad(struct scene *scene, const struct json_node *quad, uint32_t material,
                    struct err *err)
{
    static const uint32_t triangles[2][3] = {{0, 1, 2}, {0, 2, 3}};
    double vertices[4][3];
    if (!node_check_either(quad, "vertices", "corner", err))
        return false;
    bool has_vertices = node_member(quad, "vertices").value != NULL;
    if (has_vertices && (node_member(quad, "u").value || node_member(quad, "v").value))
        return node_fail(quad, err, "\"u\" and \"v\" go with \"corner\", not with \"vertices\"");
    if (!(has_vertices ? read_four_vertices : read_parallelogram)(quad, vertices, err))
        return false;
    return add_polygons(scene, "quad", material, vertices, 4, triangles, 2, err);
}

// --- box -----------------------------------------------------------------------------------------

bool load_json_box(struct scene *scene, const struct json_node *box, uint32_t material,
                   struct err *err)
{
    // Corner c takes max along x, y, z where bits 0, 1, 2 of c are set. Counter-clockwise from
    // outside: -x, +x, -y, +y, -z, +z.
    static const uint32_t triangles[12][3] = {
        {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 1, 5}, {0, 5, 4},
        {2, 6, 7}, {2, 7, 3}, {0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6},
    };
    double bounds[2][3], vertices[8][3];
    if (!node_read_vector(box, "min", RANGE_COORDINATE, bounds[0], err) ||
        !node_read_vector(box, "max", RANGE_COORDINATE, bounds[1], err))
        return false;
    for (int i = 0; i < 3; i++)
        if (!(bounds[0][i] < bounds[1][i]))
            return node_fail(box, err, "max[%d] %.9g is not above min[%d] %.9g", i, bounds[1][i], i,
                             bounds[0][i]);
    for (unsigned corner = 0; corner < 8; corner++)
        for (unsigned i = 0; i < 3; i++)
            vertices[corner][i] = bounds[corner >> i & 1][i];
    return add_polygons(scene, "box", material, vertices, 8, triangles, 12, err);
}

// --- analytic shapes -----------------------------------------------------------------------------

static bool add_shape(struct scene *scene, const struct shape *shape, struct err *err)
{
    struct shape *added = scene_add_shape(scene, NULL);
    if (!added)
        return err_memory(err, "a shape", sizeof *added);
    *added = *shape;
    return true;
}

bool load_json_sphere(struct scene *scene, const struct json_node *sphere, uint32_t material,
                      struct err *err)
{
    struct shape shape = {.kind = SHAPE_SPHERE, .material = material};
    return node_read_vector(sphere, "center", RANGE_COORDINATE, shape.center, err) &&
           node_read_number(sphere, "radius", RANGE_RADIUS, &shape.radius, err) &&
           add_shape(scene, &shape, err);
}

bool load_json_disc(struct scene *scene, const struct json_node *disc, uint32_t material,
                    struct err *err)
{
    struct shape shape = {.kind = SHAPE_DISC, .material = material};
    if (!node_read_vector(disc, "center", RANGE_COORDINATE, shape.center, err) ||
        !node_read_number(disc, "radius", RANGE_RADIUS, &shape.radius, err) ||
        !node_read_vector(disc, "normal", RANGE_COORDINATE, shape.normal, err))
        return false;
    const struct json_node normal = node_member(disc, "normal");
    if (!vec3_normalize(shape.normal))
        return node_fail(&normal, err, "is zero; expected a direction");
    return add_shape(scene, &shape, err);
}

// --- generated mesh ------------------------------------------------------------------------------

bool load_json_generated(struct scene *scene, const struct json_node *generated, uint32_t material,
                         struct err *err)
{
    uint64_t triangles = 0;
    uint32_t mesh;
    if (!node_read_integer(generated, "triangles", 8, GENERATED_TRIANGLES_MAX, &triangles, err))
        return false;
    if (!generate_blob(scene, (uint32_t)triangles, material, &mesh, err))
        return node_prepend(generated, err);
    return scene_place_meshes(scene, mesh, 1, err);
}
