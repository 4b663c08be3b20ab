#include "bench.h"

#include <cglm/vec3.h>
#include <math.h>
#include <string.h>

// The hash PCG (O'Neill 2014) in the form of Jarzynski and Olano 2020.
static float uniform(uint32_t *state)
{
    uint32_t s = *state;
    *state = s * 747796405u + 2891336453u;
    uint32_t word = ((s >> ((s >> 28u) + 4u)) ^ s) * 277803737u;
    return (float)(((word >> 22u) ^ word) >> 8) * 0x1p-24f;
}

void rays_primary(const struct camera *camera, const double origin[3], uint32_t width,
                  uint32_t height, uint32_t samples, struct probe_ray *rays)
{
    uint32_t state = 1;
    float forward[3], up[3], right[3], real_up[3];
    for (int c = 0; c < 3; c++) {
        forward[c] = (float)camera->direction[c];
        up[c] = (float)camera->up[c];
    }
    glm_vec3_crossn(forward, up, right);
    glm_vec3_cross(right, forward, real_up);
    float half = tanf(0.5f * (float)camera->fov_y);
    for (uint32_t i = 0; i < width * height * samples; i++) {
        uint32_t pixel = i / samples;
        float x = ((float)(pixel % width) + uniform(&state)) / (float)width * 2.0f - 1.0f;
        float y = 1.0f - ((float)(pixel / width) + uniform(&state)) / (float)height * 2.0f;
        for (int c = 0; c < 3; c++) {
            rays[i].origin[c] = (float)(camera->position[c] - origin[c]);
            rays[i].direction[c] =
                forward[c] + half * (x * right[c] * (float)width / (float)height + y * real_up[c]);
        }
        glm_vec3_normalize(rays[i].direction);
    }
}

// Computes the hit point, moved off the surface by a ten-thousandth of the distance. Rays of a
// benchmark need not be exact, but must be the same for all programs. The normal faces the ray's
// origin.
static void leave_surface(const struct flat_scene *flat, const struct probe_ray *ray,
                          const struct probe_hit *hit, float point[3], float normal[3])
{
    const struct flat_triangle *triangle = &flat->triangles[hit->primitive];
    float e1[3], e2[3];
    for (int c = 0; c < 3; c++) {
        e1[c] = triangle->v[1][c] - triangle->v[0][c];
        e2[c] = triangle->v[2][c] - triangle->v[0][c];
    }
    glm_vec3_crossn(e1, e2, normal);
    float facing = 0.0f;
    for (int c = 0; c < 3; c++)
        facing += normal[c] * ray->direction[c];
    for (int c = 0; c < 3; c++) {
        normal[c] = facing > 0.0f ? -normal[c] : normal[c];
        point[c] = ray->origin[c] + hit->t * ray->direction[c] + 1e-4f * hit->t * normal[c];
    }
}

uint32_t rays_diffuse(const struct flat_scene *flat, const struct probe_ray *from,
                      const struct probe_hit *hits, uint32_t count, struct probe_ray *rays)
{
    uint32_t state = 2, made = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (hits[i].primitive == NO_PRIMITIVE)
            continue;
        struct probe_ray *ray = &rays[made++];
        float normal[3];
        leave_surface(flat, &from[i], &hits[i], ray->origin, normal);
        // A uniform point of the unit sphere about the normal's tip is cosine-distributed as seen
        // from the hit point.
        float z = 1.0f - 2.0f * uniform(&state), angle = 6.2831853f * uniform(&state);
        float radius = sqrtf(fmaxf(0.0f, 1.0f - z * z));
        const float point[3] = {radius * cosf(angle), radius * sinf(angle), z};
        for (int c = 0; c < 3; c++)
            ray->direction[c] = normal[c] + 0.9999f * point[c];
        glm_vec3_normalize(ray->direction);
    }
    return made;
}

uint32_t rays_shadow(const struct flat_scene *flat, const struct probe_ray *from,
                     const struct probe_hit *hits, uint32_t count, const float light[3][3],
                     struct probe_ray *rays)
{
    uint32_t state = 3, made = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (hits[i].primitive == NO_PRIMITIVE)
            continue;
        struct probe_ray *ray = &rays[made++];
        float normal[3];
        leave_surface(flat, &from[i], &hits[i], ray->origin, normal);
        float u = uniform(&state), v = uniform(&state);
        // The segment ends before the light, which is a surface, too.
        for (int c = 0; c < 3; c++)
            ray->direction[c] =
                0.999f * (light[0][c] + u * light[1][c] + v * light[2][c] - ray->origin[c]);
    }
    return made;
}
