// What the OBJ and PLY loaders share.
#include "mesh_loader.h"

#include <math.h>
#include <string.h>

bool mesh_unit_normal(const float direction[3], float out[3])
{
    // In double precision no square of a float overflows, and none but zero's is zero.
    double x = (double)direction[0], y = (double)direction[1], z = (double)direction[2];
    double length = sqrt(x * x + y * y + z * z);
    bool is_valid = isfinite(length) && length > 0.0;
    out[0] = is_valid ? (float)(x / length) : 0.0f;
    out[1] = is_valid ? (float)(y / length) : 0.0f;
    out[2] = is_valid ? (float)(z / length) : 0.0f;
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

bool triangle_list_reserve(struct triangle_list *list, uint64_t capacity, struct err *err)
{
    if (capacity <= list->capacity)
        return true;
    if (capacity > UINT32_MAX)
        return err_set(err, ERR_INPUT, "%llu triangles, expected at most 4294967295",
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
