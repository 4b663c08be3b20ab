// Copies a mesh from the caller's arrays, and checks it.
#include "scene/mesh/mesh_loader.h"

#include "base/hash.h"
#include "base/log.h"
#include <math.h>
#include <string.h>

// An array of `count` elements of `width` 32-bit numbers each.
struct numbers {
    const void *data;
    size_t stride;
    uint32_t count, width;
};

static void copy_element(const struct numbers *from, uint32_t i, void *to)
{
    size_t bytes = from->width * sizeof(float);
    size_t stride = from->stride ? from->stride : bytes;
    memcpy(to, (const char *)from->data + i * stride, bytes);
}

static bool copy_numbers(struct scene *scene, const struct numbers *from, const char *mesh,
                         const char *what, void *out, struct err *err)
{
    size_t bytes = from->width * sizeof(float);
    char *to = arena_alloc(&scene->arena, from->count, bytes);
    if (!to)
        return err_memory(err, what, from->count * bytes);
    for (uint32_t i = 0; i < from->count; i++) {
        if (!scene_goes_on(scene, i, err))
            return err_prepend(err, "mesh \"%s\"", mesh);
        copy_element(from, i, to + i * bytes);
    }
    scene->hash = hash_bytes(scene->hash, to, from->count * bytes);
    memcpy(out, &to, sizeof to);
    return true;
}

// Copies floats, which must be finite and at most `most` in magnitude.
static bool copy_floats(struct scene *scene, const struct numbers *from, const char *mesh,
                        const char *what, double most, void *out, struct err *err)
{
    float *values;
    if (!copy_numbers(scene, from, mesh, what, &values, err))
        return false;
    for (size_t i = 0, count = (size_t)from->count * from->width; i < count; i++)
        if (!(fabs((double)values[i]) <= most))
            return err_set(err, ERR_INPUT,
                           "mesh \"%s\": %s[%zu][%zu]: %.9g is outside [%.9g, %.9g]", mesh, what,
                           i / from->width, i % from->width, (double)values[i], -most, most);
    memcpy(out, &values, sizeof values);
    return true;
}

static bool copy_normals(struct scene *scene, const struct scene_array *array, struct mesh *mesh,
                         struct err *err)
{
    const struct numbers normals = {array->normals, array->normal_stride, array->vertex_count, 3};
    uint32_t bad = 0;
    if (!array->normals)
        return true;
    if (!copy_numbers(scene, &normals, array->name, "normals", &mesh->normals, err))
        return false;
    for (uint32_t i = 0; i < array->vertex_count; i++) {
        const float given[3] = {mesh->normals[i][0], mesh->normals[i][1], mesh->normals[i][2]};
        bad += !mesh_unit_normal(given, mesh->normals[i]);
    }
    if (bad > 0)
        log_warn("mesh \"%s\": %u normals are of length zero or not finite; geometric normals "
                 "replace them",
                 array->name, bad);
    return true;
}

static bool copy_attributes(struct scene *scene, const struct scene_array *array, struct mesh *mesh,
                            struct err *err)
{
    const uint32_t count = array->vertex_count;
    const struct numbers positions = {array->positions, array->position_stride, count, 3};
    const struct numbers uvs = {array->uvs, array->uv_stride, count, 2};
    const struct numbers colors = {array->colors, array->color_stride, count, 4};
    return copy_floats(scene, &positions, array->name, "positions", SCENE_COORDINATE_MAX,
                       &mesh->positions, err) &&
           copy_normals(scene, array, mesh, err) &&
           (!uvs.data || copy_floats(scene, &uvs, array->name, "uvs", SCENE_COORDINATE_MAX,
                                     &mesh->uvs[0], err)) &&
           (!colors.data || copy_floats(scene, &colors, array->name, "colors", SCENE_RADIANCE_MAX,
                                        &mesh->colors, err));
}

static bool number_vertices(struct scene *scene, struct mesh *mesh, struct err *err)
{
    mesh->indices = arena_alloc(&scene->arena, mesh->triangle_count, sizeof *mesh->indices);
    if (!mesh->indices)
        return err_memory(err, "triangles", mesh->triangle_count * sizeof *mesh->indices);
    for (uint32_t i = 0; i < mesh->triangle_count; i++)
        for (uint32_t k = 0; k < 3; k++)
            mesh->indices[i][k] = 3 * i + k;
    return true;
}

static bool copy_triangles(struct scene *scene, const struct scene_array *array, struct mesh *mesh,
                           struct err *err)
{
    const struct numbers from = {array->indices, array->index_stride, array->triangle_count, 3};
    if (!array->indices && array->triangle_count > array->vertex_count / 3)
        return err_set(err, ERR_INPUT,
                       "mesh \"%s\": %u triangles without indices need three vertices each; there "
                       "are %u",
                       array->name, array->triangle_count, array->vertex_count);
    if (!array->indices)
        return number_vertices(scene, mesh, err);
    if (!copy_numbers(scene, &from, array->name, "indices", &mesh->indices, err))
        return false;
    for (uint32_t i = 0; i < array->triangle_count; i++)
        for (uint32_t k = 0; k < 3; k++)
            if (mesh->indices[i][k] >= array->vertex_count)
                return err_set(
                    err, ERR_INPUT,
                    "mesh \"%s\": indices[%u][%u]: %u; expected less than %u, the number "
                    "of vertices",
                    array->name, i, k, mesh->indices[i][k], array->vertex_count);
    return true;
}

bool load_array(struct scene *scene, const struct scene_array *array, uint32_t default_material,
                uint32_t *index, struct err *err)
{
    struct mesh mesh = {
        .name = arena_strdup(&scene->arena, array->name),
        .vertex_count = array->vertex_count,
        .triangle_count = array->triangle_count,
    };
    if (!mesh.name)
        return err_memory(err, "a name", strlen(array->name) + 1);
    return copy_attributes(scene, array, &mesh, err) && copy_triangles(scene, array, &mesh, err) &&
           mesh_default_material(scene, default_material, mesh.colors, &mesh.material, err) &&
           scene_append_mesh(scene, &mesh, index, err);
}
