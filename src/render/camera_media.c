#include "camera_media.h"

#include <math.h>

#define RAYS 3

struct probe {
    double origin[3];
    double directions[RAYS][3];
    // How often each ray leaves surfaces of each medium more than it enters them.
    int32_t left[RAYS][MEDIA_MAX + 1];
};

static void cross(const double a[3], const double b[3], double out[3])
{
    for (int i = 0; i < 3; i++)
        out[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static double dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// +1 where the ray leaves through the triangle's front, which is where its corners run
// counter-clockwise, -1 where it enters there, 0 for a miss (Moeller and Trumbore 1997).
static int crossing(const double origin[3], const double direction[3],
                    const struct flat_triangle *triangle)
{
    double e1[3], e2[3], from[3], p[3], q[3];
    for (int c = 0; c < 3; c++) {
        e1[c] = (double)triangle->v[1][c] - (double)triangle->v[0][c];
        e2[c] = (double)triangle->v[2][c] - (double)triangle->v[0][c];
        from[c] = origin[c] - (double)triangle->v[0][c];
    }
    cross(direction, e2, p);
    cross(from, e1, q);
    double determinant = dot(e1, p); // -(direction . normal)
    if (determinant == 0.0)
        return 0;
    double u = dot(from, p) / determinant, v = dot(direction, q) / determinant;
    double t = dot(e2, q) / determinant;
    if (u < 0.0 || v < 0.0 || u + v > 1.0 || t <= 0.0)
        return 0;
    return determinant < 0.0 ? 1 : -1;
}

static bool is_inside_sphere(const double origin[3], const struct flat_shape *shape)
{
    double square = 0.0;
    for (int c = 0; c < 3; c++) {
        double from = origin[c] - (double)shape->center[c];
        square += from * from;
    }
    return square < (double)shape->radius * (double)shape->radius;
}

static void probe_scene(struct probe *probe, const struct flat_scene *flat,
                        const struct gpu_material *materials)
{
    for (uint32_t i = 0; i < flat->triangle_count; i++) {
        uint32_t number = materials[flat->triangles[i].material].medium;
        for (int ray = 0; ray < RAYS && number > 0; ray++)
            probe->left[ray][number] +=
                crossing(probe->origin, probe->directions[ray], &flat->triangles[i]);
    }
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        uint32_t number = materials[shape->material].medium;
        if (number > 0 && shape->kind == SHAPE_SPHERE && is_inside_sphere(probe->origin, shape))
            for (int ray = 0; ray < RAYS; ray++)
                probe->left[ray][number]++;
    }
}

// The value that at least two of the three rays agree on, else none.
static int32_t majority(const struct probe *probe, uint32_t number)
{
    int32_t a = probe->left[0][number], b = probe->left[1][number], c = probe->left[2][number];
    return a == b || a == c ? a : b == c ? b : 0;
}

uint32_t camera_media_find(const struct shading_tables_params *p,
                           const struct gpu_material *materials)
{
    // Along the line of sight and to two sides of it, none along an axis of a symmetric scene.
    struct probe probe = {0};
    const double *d = p->camera->direction;
    for (int c = 0; c < 3; c++) {
        probe.origin[c] = (double)(float)(p->camera->position[c] - p->flat->origin[c]);
        probe.directions[0][c] = d[c] + 0.0123 * d[(c + 1) % 3] + 0.00456 * (c + 1);
        probe.directions[1][c] = d[(c + 1) % 3] + 0.345 * (c - 0.7);
        probe.directions[2][c] = d[(c + 2) % 3] - 0.234 * (c - 1.3);
    }
    probe_scene(&probe, p->flat, materials);
    uint32_t stack = 0;
    for (uint32_t number = 1; number <= MEDIA_MAX; number++)
        for (int32_t n = majority(&probe, number); n > 0; n--)
            stack = stack << 8 | number; // the highest ones stay
    return stack;
}
