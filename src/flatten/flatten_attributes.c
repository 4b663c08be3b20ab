// Normals, tangents, texture coordinates and colours of flattened triangles.
#include "flatten/flatten_attributes.h"

#include "scene/core/affine.h"
#include <math.h>

// --- what is needed ------------------------------------------------------------------------------

static bool uses(const struct texture *texture, uint32_t use)
{
    return (texture->flags >> TEXTURE_USE_SHIFT & 3u) == use;
}

static uint32_t uv_set(const struct texture *texture)
{
    return texture->flags & TEXTURE_UV1 ? 1 : 0;
}

// The attributes that a material uses, and the set of texture coordinates from which its tangents
// are computed if a mesh has none.
struct material_needs {
    bool uvs[2], tangents;
    uint32_t tangent_set;
};

static struct material_needs material_needs(const struct scene *scene, uint32_t index)
{
    const struct material *material = &scene->materials[index];
    struct material_needs needs = {.tangents = material->anisotropic > 0};
    for (uint32_t i = 0; i < material->texture_count; i++) {
        const struct texture *texture = &scene->textures[material->first_texture + i];
        needs.uvs[uv_set(texture)] = true;
        if (uses(texture, TEXTURE_USE_NORMAL))
            needs.tangent_set = uv_set(texture);
        needs.tangents |=
            uses(texture, TEXTURE_USE_NORMAL) || uses(texture, TEXTURE_USE_ANISOTROPY);
    }
    return needs;
}

uint32_t attributes_tangent_set(const struct scene *scene, uint32_t material)
{
    return material_needs(scene, material).tangent_set;
}

uint32_t attributes_of_material(const struct scene *scene, uint32_t material)
{
    struct material_needs needs = material_needs(scene, material);
    return needs.uvs[0] | needs.uvs[1] << 1 | needs.tangents << 2 | needs.tangent_set << 3;
}

uint32_t instance_material(const struct mesh *mesh, const struct instance *instance,
                           uint32_t triangle)
{
    return instance->material != SCENE_NONE ? instance->material
           : mesh->triangle_material        ? mesh->triangle_material[triangle]
                                            : mesh->material;
}

void attributes_census(const struct scene *scene, const struct instance *instance,
                       struct attribute_needs *needs)
{
    const struct mesh *mesh = &scene->meshes[instance->mesh];
    uint32_t known = SCENE_NONE; // consecutive triangles often share a material
    if (mesh->triangle_count == 0)
        return;
    needs->normals |= mesh->normals != NULL;
    needs->colors |= mesh->colors != NULL;
    uint32_t count = instance->material == SCENE_NONE ? mesh->triangle_count : 1;
    for (uint32_t t = 0; t < count; t++) {
        uint32_t index = instance_material(mesh, instance, t);
        if (index == known)
            continue;
        known = index;
        struct material_needs material = material_needs(scene, index);
        for (int set = 0; set < 2; set++)
            needs->uvs[set] |= material.uvs[set] && mesh->uvs[set];
        needs->tangents |= material.tangents && (mesh->tangents || mesh->uvs[material.tangent_set]);
    }
}

uint64_t attributes_bytes(const struct attribute_needs *needs)
{
    const struct flat_scene *flat = NULL;
    return (needs->normals ? sizeof *flat->normals : 0) +
           (needs->tangents ? sizeof *flat->tangents : 0) +
           (needs->uvs[0] ? sizeof *flat->uvs[0] : 0) + (needs->uvs[1] ? sizeof *flat->uvs[1] : 0) +
           (needs->colors ? sizeof *flat->colors : 0);
}

bool attributes_reserve(const struct attribute_needs *needs, size_t count, struct arena *arena,
                        struct flat_scene *flat, struct err *err)
{
    bool ok = true;
    if (needs->normals)
        ok = (flat->normals = arena_alloc(arena, count, sizeof *flat->normals)) && ok;
    if (needs->tangents)
        ok = (flat->tangents = arena_alloc(arena, count, sizeof *flat->tangents)) && ok;
    for (int set = 0; set < 2; set++)
        if (needs->uvs[set])
            ok = (flat->uvs[set] = arena_alloc(arena, count, sizeof *flat->uvs[set])) && ok;
    if (needs->colors)
        ok = (flat->colors = arena_alloc(arena, count, sizeof *flat->colors)) && ok;
    return ok || err_memory(err, "vertex attributes", count * attributes_bytes(needs));
}

// --- one triangle --------------------------------------------------------------------------------

static void place_normal(const struct placement *placement, uint32_t vertex,
                         const double geometric[3], float out[3])
{
    double normal[3] = {geometric[0], geometric[1], geometric[2]};
    if (placement->mesh->normals) {
        const float *given = placement->mesh->normals[vertex];
        double turned[3];
        for (int i = 0; i < 3; i++)
            turned[i] = placement->normals[i][0] * (double)given[0] +
                        placement->normals[i][1] * (double)given[1] +
                        placement->normals[i][2] * (double)given[2];
        if (vec3_normalize(turned))
            for (int i = 0; i < 3; i++)
                normal[i] = turned[i];
    }
    for (int i = 0; i < 3; i++)
        out[i] = (float)normal[i];
}

// Gets texture coordinates, replacing missing and non-finite ones by 0.
static void place_uv(const struct mesh *mesh, int set, uint32_t vertex, float out[2])
{
    for (int i = 0; i < 2; i++) {
        float given = mesh->uvs[set] ? mesh->uvs[set][vertex][i] : 0;
        out[i] = isfinite(given) ? given : 0;
    }
}

static void place_color(const struct mesh *mesh, uint32_t vertex, float out[4])
{
    for (int i = 0; i < 4; i++)
        out[i] = mesh->colors ? mesh->colors[vertex][i] : 1;
}

// The orientation of the texture on the surface.
struct uv_frame {
    double tangent[3]; // unit vector, towards increasing u
    double down[3];    // direction of increasing v, not normalised
};

// Computes the directions of the derivatives of position by u and v. p(u, v) is linear: with e1 =
// u1 p_u + v1 p_v and e2 likewise, p_u = (v2 e1 - v1 e2) / (u1 v2 - u2 v1) and p_v = (u1 e2 - u2
// e1) / (u1 v2 - u2 v1). If the texture coordinates are degenerate, the direction is that of an
// edge.
static struct uv_frame uv_frame(const struct flat_triangle *triangle, const float uv[3][2])
{
    double e[2][3], d[2][2];
    struct uv_frame frame;
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 3; i++)
            e[k][i] = (double)triangle->v[k + 1][i] - (double)triangle->v[0][i];
        for (int i = 0; i < 2; i++)
            d[k][i] = (double)uv[k + 1][i] - (double)uv[0][i];
    }
    double sign = copysign(1, d[0][0] * d[1][1] - d[1][0] * d[0][1]);
    for (int i = 0; i < 3; i++) {
        frame.tangent[i] = sign * (d[1][1] * e[0][i] - d[0][1] * e[1][i]);
        frame.down[i] = sign * (d[0][0] * e[1][i] - d[1][0] * e[0][i]);
    }
    if (d[0][0] * d[1][1] == d[1][0] * d[0][1] || !vec3_normalize(frame.tangent))
        for (int i = 0; i < 3; i++) {
            frame.tangent[i] = e[0][i];
            frame.down[i] = -e[1][i];
        }
    vec3_normalize(frame.tangent); // not zero, because the triangle has an area
    return frame;
}

// Transforms a mesh's tangent. Tangents lie in the surface, so the matrix itself transforms them. A
// reflection reverses cross(normal, tangent), so the sign changes.
static bool place_tangent(const struct placement *placement, uint32_t vertex, float out[4])
{
    if (!placement->mesh->tangents)
        return false;
    const float *given = placement->mesh->tangents[vertex];
    const double tangent[3] = {(double)given[0], (double)given[1], (double)given[2]};
    double turned[3];
    affine_vector(placement->instance->transform, tangent, turned);
    if (!vec3_normalize(turned))
        return false;
    for (int i = 0; i < 3; i++)
        out[i] = (float)turned[i];
    out[3] = (given[3] < 0) != placement->is_mirrored ? -1.0f : 1.0f;
    return true;
}

// Computes a tangent from the texture's orientation. The bitangent points up in the texture (glTF
// 2.0, section 3.9.3: +Y is up), where v is smaller.
static void derive_tangent(const struct uv_frame *frame, const double normal[3], float out[4])
{
    double bitangent[3];
    vec3_cross(normal, frame->tangent, bitangent);
    for (int i = 0; i < 3; i++)
        out[i] = (float)frame->tangent[i];
    out[3] = vec3_dot(bitangent, frame->down) > 0 ? -1.0f : 1.0f;
}

static void place_tangents(struct flat_scene *flat, const struct scene *scene,
                           const struct placement *placement, const uint32_t vertices[3],
                           const double geometric[3])
{
    uint32_t index = flat->triangle_count;
    const struct flat_triangle *triangle = &flat->triangles[index];
    int set = (int)material_needs(scene, triangle->material).tangent_set;
    float uv[3][2];
    for (int corner = 0; corner < 3; corner++)
        place_uv(placement->mesh, set, vertices[corner], uv[corner]);
    struct uv_frame frame = uv_frame(triangle, uv);
    for (int corner = 0; corner < 3; corner++) {
        double normal[3] = {geometric[0], geometric[1], geometric[2]};
        float *out = flat->tangents[index][corner];
        for (int i = 0; i < 3 && flat->normals; i++)
            normal[i] = (double)flat->normals[index][corner][i];
        if (!place_tangent(placement, vertices[corner], out))
            derive_tangent(&frame, normal, out);
    }
}

void attributes_place(struct flat_scene *flat, const struct scene *scene,
                      const struct placement *placement, const uint32_t vertices[3],
                      const double geometric[3])
{
    uint32_t index = flat->triangle_count;
    for (int corner = 0; corner < 3; corner++) {
        if (flat->normals)
            place_normal(placement, vertices[corner], geometric, flat->normals[index][corner]);
        for (int set = 0; set < 2; set++)
            if (flat->uvs[set])
                place_uv(placement->mesh, set, vertices[corner], flat->uvs[set][index][corner]);
        if (flat->colors)
            place_color(placement->mesh, vertices[corner], flat->colors[index][corner]);
    }
    if (flat->tangents)
        place_tangents(flat, scene, placement, vertices, geometric);
}
