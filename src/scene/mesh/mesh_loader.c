// Functions that the loaders of meshes share.
#include "scene/mesh/mesh_loader.h"

#include "base/file.h"
#include "base/hash.h"
#include "base/maths.h"
#include "scene/core/bounds.h"

#include <math.h>
#include <string.h>

bool mesh_open(struct scene *scene, struct arena *scratch, const char *path,
               struct text_reader *out, struct err *err)
{
    struct file_bytes bytes;
    if (!file_read(scratch, path, 0, &bytes, err))
        return false;
    scene->hash = hash_bytes(scene->hash, bytes.data, bytes.size);
    *out = text_open(path, &bytes);
    return true;
}

bool mesh_unit_normal(const float direction[3], float out[3])
{
    // In double precision no square of a float overflows, and only the square of zero is zero.
    double wide[3];
    vec3_widen(direction, wide);
    double length = vec3_norm(wide);
    bool is_valid = isfinite(length) && length > 0.0;
    for (int c = 0; c < 3; c++)
        out[c] = is_valid ? (float)(wide[c] / length) : 0.0f;
    return is_valid;
}

bool mesh_default_material(struct scene *scene, uint32_t given, bool has_colors, uint32_t *material,
                           struct err *err)
{
    *material = given;
    if (given != SCENE_NONE)
        return true;
    struct material *grey = scene_add_material(scene, material);
    if (!grey)
        return err_memory(err, "a material", sizeof *grey);
    grey->name = "default";
    for (int c = 0; c < 3 && has_colors; c++)
        grey->base_color[c] = 1.0f;
    return true;
}

// Above these limits flattening gives a mesh an origin of its own, and warns: see flatten_census.c.
#define ROUNDED_MESH_RATIO 16
#define ROUNDED_TRIANGLE_RATIO 65536

static bool is_rounded(const struct bounds *bounds, double ratio)
{
    double extent = 0, farthest = 0;
    for (int i = 0; i < 3; i++) {
        extent = fmax(extent, bounds->max[i] - bounds->min[i]);
        farthest = fmax(farthest, fmax(-bounds->min[i], bounds->max[i]));
    }
    return farthest > ratio * extent;
}

// Returns whether the corners are known to coincide. Without exact positions only equal indices
// count, because rounded positions may coincide where those in the file differ.
static bool is_point(const struct mesh *mesh, const uint32_t corners[3],
                     const struct bounds *bounds)
{
    bool is_one_vertex = corners[0] == corners[1] && corners[1] == corners[2];
    return is_one_vertex || (mesh->exact_positions && bounds_are_a_point(bounds));
}

bool mesh_is_rounded(const struct mesh *mesh)
{
    struct bounds whole = BOUNDS_EMPTY;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        struct bounds bounds = BOUNDS_EMPTY;
        for (int corner = 0; corner < 3; corner++) {
            double point[3];
            mesh_vertex(mesh, mesh->indices[t][corner], point);
            bounds_add_point(&bounds, point);
            bounds_add_point(&whole, point);
        }
        if (is_rounded(&bounds, ROUNDED_TRIANGLE_RATIO) &&
            !is_point(mesh, mesh->indices[t], &bounds))
            return true;
    }
    return !bounds_is_empty(&whole) && is_rounded(&whole, ROUNDED_MESH_RATIO);
}

void mesh_keep_exact(struct mesh *mesh, double (*exact)[3])
{
    bool says_more = false;
    for (uint32_t v = 0; v < mesh->vertex_count; v++)
        for (int i = 0; i < 3; i++)
            says_more |= exact[v][i] != (double)mesh->positions[v][i];
    mesh->exact_positions = exact;
    if (!says_more || !mesh_is_rounded(mesh))
        mesh->exact_positions = NULL;
}

bool triangle_list_reserve(struct triangle_list *list, uint64_t capacity, struct err *err)
{
    if (capacity <= list->capacity)
        return true;
    if (capacity > UINT32_MAX)
        return err_set(err, ERR_INPUT, "%llu triangles; expected at most 4294967295",
                       (unsigned long long)capacity);
    void *indices = arena_alloc(list->arena, (size_t)capacity, sizeof *list->indices);
    if (!indices)
        return err_memory(err, "triangles", capacity * sizeof *list->indices);
    if (list->count > 0)
        memcpy(indices, list->indices, list->count * sizeof *list->indices);
    list->indices = indices;
    list->capacity = (uint32_t)capacity;
    return true;
}

bool triangle_list_add(struct triangle_list *list, uint32_t a, uint32_t b, uint32_t c,
                       struct err *err)
{
    if (list->count == list->capacity) {
        uint64_t grown = list->capacity < 64 ? 64 : 2 * (uint64_t)list->capacity;
        if (list->capacity < UINT32_MAX && grown > UINT32_MAX)
            grown = UINT32_MAX;
        if (!triangle_list_reserve(list, grown, err))
            return false;
    }
    uint32_t *corners = list->indices[list->count++];
    corners[0] = a;
    corners[1] = b;
    corners[2] = c;
    return true;
}
