// Meshes of a scene file that need no other file: quad, box and procedural meshes.
#include "scene/json/load_json.h"

#include "scene/core/affine.h"
#include "scene/generate/generate.h"
#include <string.h>

// Larger meshes need several gigabytes. A message about the number is clearer than one about
// exhausted memory.
#define GENERATED_TRIANGLES_MAX 200000000

// The default number of cells per side of a patch. The resulting 16,000 triangles look smooth at a
// size of some hundred pixels.
#define TEAPOT_RESOLUTION 16

// Appends a mesh of convex quadrilaterals, and an instance of it. Each quadrilateral has its
// corners in order, the triangles 0 1 2 and 0 2 3, and texture coordinates for its corners.
// Positions are stored in double precision, because they may be far from the world's origin, and
// flattening may choose another origin.
static bool add_quadrilaterals(struct scene *scene, const char *name, uint32_t material,
                               const double (*corners)[3], const float (*uvs)[2], uint32_t count,
                               struct err *err)
{
    struct mesh mesh = {
        .name = name,
        .vertex_count = 4 * count,
        .triangle_count = 2 * count,
        .material = material,
    };
    struct arena *arena = &scene->arena;
    mesh.exact_positions = arena_alloc(arena, mesh.vertex_count, sizeof *mesh.exact_positions);
    mesh.positions = arena_alloc(arena, mesh.vertex_count, sizeof *mesh.positions);
    mesh.uvs[0] = arena_alloc(arena, mesh.vertex_count, sizeof *mesh.uvs[0]);
    mesh.indices = arena_alloc(arena, mesh.triangle_count, sizeof *mesh.indices);
    if (!mesh.exact_positions || !mesh.positions || !mesh.uvs[0] || !mesh.indices)
        return err_memory(err, "a mesh's vertices",
                          mesh.vertex_count * sizeof *mesh.exact_positions);
    memcpy(mesh.exact_positions, corners, mesh.vertex_count * sizeof *corners);
    memcpy(mesh.uvs[0], uvs, mesh.vertex_count * sizeof *uvs);
    for (uint32_t v = 0; v < mesh.vertex_count; v++)
        for (int i = 0; i < 3; i++)
            mesh.positions[v][i] = (float)corners[v][i];
    for (uint32_t t = 0; t < mesh.triangle_count; t++) {
        uint32_t *corner = mesh.indices[t], first = t / 2 * 4;
        corner[0] = first;
        corner[1] = first + 1 + t % 2;
        corner[2] = first + 2 + t % 2;
    }
    uint32_t index;
    return scene_append_mesh(scene, &mesh, &index, err) && scene_place_meshes(scene, index, 1, err);
}

// Texture coordinates of the corners, counter-clockwise from the lower left of the image.
static const float picture_corners[4][2] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};

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

// Computes the vertices corner, corner + u, corner + u + v, corner + v. The normal is along u x v.
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
    double vertices[4][3];
    if (!node_check_either(quad, "vertices", "corner", err))
        return false;
    bool has_vertices = node_member(quad, "vertices").value != NULL;
    if (has_vertices && (node_member(quad, "u").value || node_member(quad, "v").value))
        return node_fail(quad, err, "\"u\" and \"v\" require \"corner\" instead of \"vertices\"");
    bool analytic = false;
    if (!(has_vertices ? read_four_vertices : read_parallelogram)(quad, vertices, err) ||
        !load_json_is_analytic(quad, &analytic, err))
        return false;
    if (analytic)
        return load_json_analytic_quad(scene, quad, vertices, material, err);
    return add_quadrilaterals(scene, "quad", material, vertices, picture_corners, 1, err);
}

// --- box -----------------------------------------------------------------------------------------

bool load_json_box(struct scene *scene, const struct json_node *box, uint32_t material,
                   struct err *err)
{
    // Corner c takes max along x, y, z if bits 0, 1, 2 of c are set, else min. Each of the faces
    // -x, +x, -y, +y, -z, +z has its corners, counter-clockwise from outside, and the index of its
    // first corner in picture_corners. The sides show the texture upright, the top with its upper
    // edge at -z, the bottom with its upper edge at +z.
    static const struct {
        uint8_t corners[4], first;
    } faces[6] = {
        {{0, 4, 6, 2}, 0}, {{1, 3, 7, 5}, 1}, {{0, 1, 5, 4}, 0},
        {{2, 6, 7, 3}, 3}, {{0, 2, 3, 1}, 1}, {{4, 5, 7, 6}, 0},
    };
    double bounds[2][3], vertices[24][3];
    float uvs[24][2];
    bool analytic = false;
    if (!node_read_vector(box, "min", RANGE_COORDINATE, bounds[0], err) ||
        !node_read_vector(box, "max", RANGE_COORDINATE, bounds[1], err) ||
        !load_json_is_analytic(box, &analytic, err))
        return false;
    for (int i = 0; i < 3; i++)
        if (!(bounds[0][i] < bounds[1][i]))
            return node_fail(box, err, "max[%d] %.9g is not above min[%d] %.9g", i, bounds[1][i], i,
                             bounds[0][i]);
    if (analytic)
        return load_json_analytic_box(scene, box, bounds, material, err);
    for (unsigned v = 0; v < 24; v++) {
        unsigned corner = faces[v / 4].corners[v % 4];
        for (unsigned i = 0; i < 3; i++)
            vertices[v][i] = bounds[corner >> i & 1][i];
        memcpy(uvs[v], picture_corners[(faces[v / 4].first + v) % 4], sizeof uvs[v]);
    }
    return add_quadrilaterals(scene, "box", material, vertices, uvs, 6, err);
}

// --- generated meshes ----------------------------------------------------------------------------

bool load_json_read_generated(const struct json_node *generated, uint32_t *triangles,
                              struct err *err)
{
    uint64_t count = 0;
    if (!node_read_integer(generated, "triangles", 8, GENERATED_TRIANGLES_MAX, &count, err))
        return false;
    *triangles = (uint32_t)count;
    return true;
}

bool load_json_generated(struct scene *scene, const struct json_node *generated, uint32_t material,
                         struct err *err)
{
    uint32_t triangles, mesh;
    if (!load_json_read_generated(generated, &triangles, err))
        return false;
    if (!generate_blob(scene, triangles, material, &mesh, err))
        return node_prepend(generated, err);
    return scene_place_meshes(scene, mesh, 1, err);
}

bool load_json_read_teapot(const struct json_node *teapot, uint32_t *resolution, struct err *err)
{
    uint64_t cells = TEAPOT_RESOLUTION;
    if (!node_read_integer(teapot, "resolution", 1, TEAPOT_RESOLUTION_MAX, &cells, err))
        return false;
    *resolution = (uint32_t)cells;
    return true;
}

bool load_json_teapot(struct scene *scene, const struct json_node *teapot, uint32_t material,
                      struct err *err)
{
    uint32_t resolution, mesh;
    if (!load_json_read_teapot(teapot, &resolution, err))
        return false;
    if (!generate_teapot(scene, resolution, material, &mesh, err))
        return node_prepend(teapot, err);
    return scene_place_meshes(scene, mesh, 1, err);
}

bool load_json_read_torus(const struct json_node *node, struct torus *torus, struct err *err)
{
    const struct range tubes = {1e-6, 0.999, false};
    uint64_t segments = 128, tube_segments = 64;
    torus->tube = 0.25;
    if (!node_read_number(node, "tube", tubes, &torus->tube, err) ||
        !node_read_integer(node, "segments", 3, TORUS_SEGMENTS_MAX, &segments, err) ||
        !node_read_integer(node, "tube_segments", 3, TORUS_SEGMENTS_MAX, &tube_segments, err))
        return false;
    torus->segments = (uint32_t)segments;
    torus->tube_segments = (uint32_t)tube_segments;
    return true;
}

bool load_json_torus(struct scene *scene, const struct json_node *node, uint32_t material,
                     struct err *err)
{
    struct torus torus;
    uint32_t mesh;
    if (!load_json_read_torus(node, &torus, err))
        return false;
    if (!generate_torus(scene, &torus, material, &mesh, err))
        return node_prepend(node, err);
    return scene_place_meshes(scene, mesh, 1, err);
}

bool load_json_read_stadium(const struct json_node *node, struct stadium *stadium, struct err *err)
{
    uint64_t steps = 16, segments = 96;
    if (!node_read_integer(node, "steps", 1, STADIUM_STEPS_MAX, &steps, err) ||
        !node_read_integer(node, "segments", 3, STADIUM_SEGMENTS_MAX, &segments, err))
        return false;
    *stadium = (struct stadium){(uint32_t)steps, (uint32_t)segments};
    return true;
}

bool load_json_stadium(struct scene *scene, const struct json_node *node, uint32_t material,
                       struct err *err)
{
    struct stadium stadium;
    uint32_t mesh;
    if (!load_json_read_stadium(node, &stadium, err))
        return false;
    if (!generate_stadium(scene, &stadium, material, &mesh, err))
        return node_prepend(node, err);
    return scene_place_meshes(scene, mesh, 1, err);
}

bool load_json_read_figure(const struct json_node *node, enum figure *figure, uint32_t *triangles,
                           struct err *err)
{
    uint32_t choice = 0;
    if (!node_read_choice(node, "figure", figure_names, &choice, err))
        return false;
    uint64_t count = figure_triangles[choice];
    if (!node_read_integer(node, "triangles", FIGURE_TRIANGLES_MIN, FIGURE_TRIANGLES_MAX, &count,
                           err))
        return false;
    *figure = (enum figure)choice;
    *triangles = (uint32_t)count;
    return true;
}

bool load_json_figure(struct scene *scene, const struct json_node *node, uint32_t material,
                      struct err *err)
{
    enum figure figure;
    uint32_t triangles, mesh;
    if (!load_json_read_figure(node, &figure, &triangles, err))
        return false;
    if (!generate_figure(scene, figure, triangles, material, &mesh, err))
        return node_prepend(node, err);
    return scene_place_meshes(scene, mesh, 1, err);
}
