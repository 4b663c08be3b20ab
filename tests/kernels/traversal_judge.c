#include "traversal_judge.h"

#include "kernel_fixture.h"

// Half an ulp of 1.
#define ROUNDING 0x1p-24

// --- the reference -------------------------------------------------------------------------------

static double nearest_of_sphere(const struct flat_shape *shape, const struct bvh_ray *ray)
{
    double f[3], closest[3];
    for (int c = 0; c < 3; c++)
        f[c] = ray->origin[c] - (double)shape->center[c];
    double a = vec3_dot(ray->direction, ray->direction), middle = -vec3_dot(f, ray->direction) / a;
    for (int c = 0; c < 3; c++)
        closest[c] = f[c] + middle * ray->direction[c];
    double chord2 = (double)shape->radius * (double)shape->radius - vec3_dot(closest, closest);
    if (chord2 < 0)
        return -1;
    double half_chord = sqrt(chord2 / a);
    return middle - half_chord > 0 ? middle - half_chord : middle + half_chord;
}

static double nearest_of_disc(const struct flat_shape *shape, const struct bvh_ray *ray)
{
    double normal[3], to_center[3], from_center[3];
    for (int c = 0; c < 3; c++) {
        normal[c] = (double)shape->normal[c];
        to_center[c] = (double)shape->center[c] - ray->origin[c];
    }
    double t = vec3_dot(to_center, normal) / vec3_dot(ray->direction, normal);
    for (int c = 0; c < 3; c++)
        from_center[c] = t * ray->direction[c] - to_center[c];
    return vec3_norm(from_center) <= (double)shape->radius ? t : -1; // also for a t that is NaN
}

static double intersect_shape(const void *context, uint32_t index, const struct bvh_ray *ray)
{
    const struct flat_shape *shape = &((const struct flat_scene *)context)->shapes[index];
    double t =
        shape->kind == SHAPE_SPHERE ? nearest_of_sphere(shape, ray) : nearest_of_disc(shape, ray);
    return t > 0 && t < ray->t_max ? t : -1;
}

// Transforms a ray's origin as kernels do, L (o - t), but without rounding.
static void to_object(const struct flat_instance *instance, double out[3][4])
{
    for (int row = 0; row < 3; row++) {
        out[row][3] = 0;
        for (int c = 0; c < 3; c++) {
            out[row][c] = (double)instance->to_object[row][c];
            out[row][3] -= out[row][c] * (double)instance->to_world[c][3];
        }
    }
}

bool reference_create(const struct renderer *r, struct arena *arena, struct reference *out)
{
    const struct flat_scene *flat = &r->flat;
    struct bvh_box *boxes = ARENA_NEW(arena, struct bvh_box, flat->shape_count);
    if (!boxes)
        return false;
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        for (int c = 0; c < 3; c++) {
            boxes[i].min[c] =
                nextafterf(flat->shapes[i].center[c] - flat->shapes[i].radius, -1e30f);
            boxes[i].max[c] = nextafterf(flat->shapes[i].center[c] + flat->shapes[i].radius, 1e30f);
        }
    }
    struct bvh_trace_instance *instances =
        ARENA_NEW(arena, struct bvh_trace_instance, flat->placed_count);
    if (!instances)
        return false;
    for (uint32_t i = 0; i < flat->placed_count; i++) {
        const struct flat_mesh *mesh = &flat->meshes[flat->instances[i].mesh];
        instances[i] = (struct bvh_trace_instance){
            .root = r->bvh.roots[flat->instances[i].mesh + 1],
            .first_triangle = mesh->first_triangle,
            .triangle_count = mesh->triangle_count,
        };
        to_object(&flat->instances[i], instances[i].to_object);
    }
    const void *vertices = flat->triangles;
    *out = (struct reference){
        .flat = flat,
        .boxes = boxes,
        .instances = instances,
        .geometry = {.triangle_vertices = vertices,
                     .triangle_stride = sizeof *flat->triangles,
                     .triangle_count = flat->world_triangle_count,
                     .shape_boxes = boxes,
                     .shape_count = flat->shape_count},
    };
    out->scene = (struct bvh_trace_scene){
        .bvh = &r->bvh,
        .geometry = &out->geometry,
        .instances = instances,
        .intersect_shape = intersect_shape,
        .shape_context = flat,
    };
    return true;
}

struct bvh_ray reference_ray(const struct probe_ray *ray, double t_max)
{
    struct bvh_ray out = {.t_max = t_max, .ignore = {UINT32_MAX, UINT32_MAX}};
    for (int c = 0; c < 3; c++) {
        out.origin[c] = (double)ray->origin[c];
        out.direction[c] = (double)ray->direction[c];
    }
    return out;
}

bool reference_agrees(const struct reference *reference, const struct bvh_ray *ray,
                      const struct probe_hit *result, double extent)
{
    struct bvh_hit hit;
    bvh_trace_closest(&reference->scene, ray, &hit);
    bool missed = hit.primitive == UINT32_MAX;
    return result->primitive == hit.primitive &&
           (missed || (result->instance == hit.instance &&
                       fabs((double)result->t - hit.t) <= 1e-5 * hit.t + 1e-6 * extent));
}

// --- one primitive -------------------------------------------------------------------------------

enum certainty { SURE_MISS, DOUBTFUL, SURE_HIT };

// If there is a hit, it is at t +- tolerance.
struct judgement {
    enum certainty certainty;
    double t, tolerance;
    double refused; // a kernel may take a hit up to this distance for a rounding error, and report
                    // no hit
};

// The error bound of n successive roundings (Higham 2002, lemma 3.1).
static double gamma_n(int n)
{
    return n * ROUNDING / (1 - n * ROUNDING);
}

static double largest(double p[3][3], int c)
{
    return fmax(fabs(p[0][c]), fmax(fabs(p[1][c]), fabs(p[2][c])));
}

// Returns the bound of t's error (Pharr, Jakob, Humphreys 2023, section 6.8.7) up to which hits are
// refused, except for triangles that are completely in front. `p` has the sheared corners, with z
// in units of t; `speed` is the direction's largest component.
static double refused_distance(double p[3][3], const double weight[3], double speed)
{
    if (p[0][2] > 0 && p[1][2] > 0 && p[2][2] > 0)
        return 0;
    double x = largest(p, 0), y = largest(p, 1), z = largest(p, 2);
    double edge = fmax(fabs(weight[0]), fmax(fabs(weight[1]), fabs(weight[2])));
    double dx = gamma_n(5) * (x + z * speed), dy = gamma_n(5) * (y + z * speed);
    double edge_error = 2 * (gamma_n(2) * x * y + dy * x + dx * y);
    return 3 * (gamma_n(3) * edge * z + edge_error * z + gamma_n(3) * z * edge) /
           fabs(weight[0] + weight[1] + weight[2]);
}

// The test of Woop, Benthin, Wald 2013 as in lib/intersect_triangle.glsl. A difference of
// coordinates has one rounding error, the shear 5 (a division has 2.5 ulps by the Vulkan
// specification), a product and a difference one each: at most 10 of the largest coordinate
// relative to the origin, in each sheared coordinate. `slack` is the error of the ray itself.
struct slack {
    double origin, direction; // for each component
};

static struct judgement judge_triangle(const struct flat_triangle *triangle,
                                       const struct bvh_ray *ray, struct slack slack)
{
    const double *d = ray->direction;
    int z = 0;
    for (int axis = 1; axis < 3; axis++)
        z = fabs(d[axis]) > fabs(d[z]) ? axis : z;
    int x = (z + 1) % 3, y = (z + 2) % 3;
    double p[3][3], reach = 0, distance = 0;
    for (int i = 0; i < 3; i++) {
        double s[3];
        for (int c = 0; c < 3; c++) {
            s[c] = (double)triangle->v[i][c] - ray->origin[c];
            reach = fmax(reach, fabs(s[c]));
        }
        p[i][0] = s[x] - d[x] / d[z] * s[z];
        p[i][1] = s[y] - d[y] / d[z] * s[z];
        p[i][2] = s[z] / d[z];
        distance = fmax(distance, fabs(p[i][2]));
    }
    double speed = fabs(d[z]);
    double offset = 10 * ROUNDING * reach + 2 * slack.origin + 2 * reach * slack.direction / speed;

    double weight[3], error[3], sum = 0, sum_error = 0, t = 0, t_error = 0;
    bool sure_inside = true, positive = false, negative = false;
    for (int i = 0; i < 3; i++) {
        const double *a = p[(i + 1) % 3], *b = p[(i + 2) % 3];
        weight[i] = a[0] * b[1] - a[1] * b[0];
        error[i] = offset * (fabs(a[0]) + fabs(a[1]) + fabs(b[0]) + fabs(b[1]) + 2 * offset) +
                   2 * ROUNDING * (fabs(a[0] * b[1]) + fabs(a[1] * b[0]));
        positive = positive || weight[i] > error[i];
        negative = negative || weight[i] < -error[i];
        sure_inside = sure_inside && fabs(weight[i]) > error[i];
        sum += weight[i];
        sum_error += error[i];
        t += weight[i] * p[i][2];
    }
    if (positive && negative)
        return (struct judgement){.certainty = SURE_MISS};
    t /= sum;
    if (!(fabs(sum) > sum_error))
        return (struct judgement){DOUBTFUL, isfinite(t) ? t : 0, INFINITY};
    for (int i = 0; i < 3; i++)
        t_error += error[i] * fabs(p[i][2] - t) / (fabs(sum) - sum_error);
    // Three products and sums, a reciprocal, and the 7 rounding errors of the sheared z.
    return (struct judgement){sure_inside ? SURE_HIT : DOUBTFUL, t,
                              t_error + 20 * ROUNDING * distance +
                                  (slack.origin + distance * slack.direction) / speed,
                              refused_distance(p, weight, fabs(d[z]))};
}

// The test of lib/intersect_shape.glsl. A sum of three products has 3 rounding errors, and each sum
// of absolute values is at most the product of the vectors' lengths. A division has 5.
static struct judgement judge_sphere(const struct flat_shape *shape, const struct bvh_ray *ray)
{
    double f[3], closest[3], radius = (double)shape->radius;
    for (int c = 0; c < 3; c++)
        f[c] = ray->origin[c] - (double)shape->center[c];
    double a = vec3_dot(ray->direction, ray->direction), middle = -vec3_dot(f, ray->direction) / a;
    for (int c = 0; c < 3; c++)
        closest[c] = f[c] + middle * ray->direction[c];
    double near = vec3_norm(closest), far = vec3_norm(f);
    double offset = 20 * ROUNDING * far; // error of the closest point
    double chord2 = radius * radius - near * near;
    double chord2_error =
        offset * (2 * near + offset) + 4 * ROUNDING * (radius * radius + near * near);
    if (chord2 < -chord2_error)
        return (struct judgement){.certainty = SURE_MISS};
    if (chord2 <= chord2_error)
        return (struct judgement){DOUBTFUL, middle,
                                  sqrt(2 * chord2_error / a) + 20 * ROUNDING * far / sqrt(a)};

    // The root with the larger magnitude is computed as a sum, the other one as the product divided
    // by it.
    double half = sqrt(chord2 / a);
    double error =
        chord2_error / (2 * sqrt((chord2 - chord2_error) * a)) + 20 * ROUNDING * far / sqrt(a);
    double larger = fabs(middle) + half;
    double product_error = 4 * ROUNDING * (far * far + radius * radius) / a;
    double smaller_error = (product_error + fabs(fabs(middle) - half) * error) / larger;
    double low = middle - half, high = middle + half;
    double low_error = middle > 0 ? smaller_error : error;
    double high_error = middle > 0 ? error : smaller_error;
    if (fabs(low) <= low_error) // either root may be the first one in front
        return (struct judgement){DOUBTFUL, high / 2, high / 2 + low_error + high_error};
    return low > 0 ? (struct judgement){SURE_HIT, low, low_error}
                   : (struct judgement){SURE_HIT, high, high_error};
}

static struct judgement judge_disc(const struct flat_shape *shape, const struct bvh_ray *ray)
{
    double normal[3], to_center[3], from_center[3], center[3];
    for (int c = 0; c < 3; c++) {
        normal[c] = (double)shape->normal[c];
        center[c] = (double)shape->center[c];
        to_center[c] = center[c] - ray->origin[c];
    }
    double slope = vec3_dot(ray->direction, normal), speed = vec3_norm(ray->direction);
    double slope_error = 4 * ROUNDING * speed;
    if (fabs(slope) <= slope_error)
        return (struct judgement){DOUBTFUL, 0, INFINITY};
    double t = vec3_dot(to_center, normal) / slope;
    double error = (5 * ROUNDING * vec3_norm(to_center) + fabs(t) * slope_error) /
                       (fabs(slope) - slope_error) +
                   6 * ROUNDING * fabs(t);
    for (int c = 0; c < 3; c++)
        from_center[c] = t * ray->direction[c] - to_center[c];
    double inside = (double)shape->radius - vec3_norm(from_center);
    double inside_error = error * speed + 4 * ROUNDING *
                                              (vec3_norm(ray->origin) + fabs(t) * speed +
                                               vec3_norm(center) + (double)shape->radius);
    enum certainty certainty = inside > inside_error    ? SURE_HIT
                               : inside < -inside_error ? SURE_MISS
                                                        : DOUBTFUL;
    return (struct judgement){certainty, t, error};
}

static double sum_of_products(const double m[4], const double v[3])
{
    return fabs(m[0] * v[0]) + fabs(m[1] * v[1]) + fabs(m[2] * v[2]);
}

// Transforms the ray to an instance's space. The rounding errors are those of a difference and of
// sums of three products.
static struct bvh_ray ray_of_instance(const struct flat_instance *instance,
                                      const struct bvh_ray *ray, struct slack *slack)
{
    struct bvh_ray out = *ray;
    double m[3][4], from[3];
    to_object(instance, m);
    *slack = (struct slack){0};
    for (int c = 0; c < 3; c++)
        from[c] = ray->origin[c] - (double)instance->to_world[c][3];
    for (int row = 0; row < 3; row++) {
        out.origin[row] = vec3_dot(m[row], from);
        out.direction[row] = vec3_dot(m[row], ray->direction);
        slack->origin = fmax(slack->origin, gamma_n(4) * sum_of_products(m[row], from));
        slack->direction =
            fmax(slack->direction, gamma_n(3) * sum_of_products(m[row], ray->direction));
    }
    return out;
}

static struct judgement judge(const struct flat_scene *flat, uint32_t primitive, uint32_t instance,
                              const struct bvh_ray *ray)
{
    struct slack slack = {0};
    if (instance != NO_INSTANCE) {
        const struct bvh_ray own = ray_of_instance(&flat->instances[instance], ray, &slack);
        return judge_triangle(&flat->triangles[primitive], &own, slack);
    }
    if (!(primitive & PRIMITIVE_SHAPE))
        return judge_triangle(&flat->triangles[primitive], ray, slack);
    const struct flat_shape *shape = &flat->shapes[primitive & ~PRIMITIVE_SHAPE];
    return shape->kind == SHAPE_SPHERE ? judge_sphere(shape, ray) : judge_disc(shape, ray);
}

// --- a result ------------------------------------------------------------------------------------

// Visits every primitive: those of world space first, then those of each instance.
struct visit {
    uint32_t next, instance, primitive;
};
#define VISIT_START ((struct visit){0, NO_INSTANCE, 0})

static bool visit_next(const struct flat_scene *flat, struct visit *v)
{
    uint32_t i = v->next++, triangles = flat->world_triangle_count;
    if (v->instance == NO_INSTANCE) {
        v->primitive = i < triangles ? i : PRIMITIVE_SHAPE | (i - triangles);
        if (i < triangles + flat->shape_count)
            return true;
        i = 0;
        v->next = 1;
    }
    // There are no instances of empty meshes.
    if (v->instance == NO_INSTANCE ||
        i >= flat->meshes[flat->instances[v->instance].mesh].triangle_count) {
        v->instance++; // from NO_INSTANCE to 0
        v->next = 1;
        i = 0;
        if (v->instance == flat->placed_count)
            return false;
    }
    v->primitive = flat->meshes[flat->instances[v->instance].mesh].first_triangle + i;
    return true;
}

// Returns whether a primitive is certainly hit in (0, t_max).
static bool certain_hit_before(const struct flat_scene *flat, const struct bvh_ray *ray,
                               double t_max)
{
    for (struct visit v = VISIT_START; visit_next(flat, &v);) {
        struct judgement j = judge(flat, v.primitive, v.instance, ray);
        if (j.certainty == SURE_HIT && j.t - j.tolerance > j.refused && j.t + j.tolerance < t_max)
            return true;
    }
    return false;
}

bool judge_closest(const struct flat_scene *flat, const struct probe_ray *ray,
                   const struct probe_hit *hit)
{
    const struct bvh_ray exact = reference_ray(ray, INFINITY);
    if (hit->primitive == NO_PRIMITIVE)
        return !certain_hit_before(flat, &exact, INFINITY);
    struct judgement j = judge(flat, hit->primitive, hit->instance, &exact);
    return j.certainty != SURE_MISS && fabs((double)hit->t - j.t) <= j.tolerance &&
           !certain_hit_before(flat, &exact, (double)hit->t);
}

bool judge_occluded(const struct flat_scene *flat, const struct probe_ray *ray, bool occluded)
{
    const struct bvh_ray exact = reference_ray(ray, 1);
    if (!occluded)
        return !certain_hit_before(flat, &exact, 1);
    for (struct visit v = VISIT_START; visit_next(flat, &v);) {
        struct judgement j = judge(flat, v.primitive, v.instance, &exact);
        if (j.certainty != SURE_MISS && j.t + j.tolerance > 0 && j.t - j.tolerance < 1)
            return true;
    }
    return false;
}
