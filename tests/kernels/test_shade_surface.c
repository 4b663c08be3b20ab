// Tests shade_surface on hits of random rays: emission and its weight, the light sample in the
// shadow ray and its weight, the scattered path and Russian roulette are each computed again in
// double precision. Azimuths depend on the choice of a basis, and are taken from the result:
// test_sampling checks them.
#include "check/estimators.h"
#include "render/probe/ray_probe.h"
#include "solid_angle_reference.h"
#include "surface_reference.h"

enum { SLOTS = 4096 };

static struct gpu_path before[SLOTS], after[SLOTS];
static struct gpu_shadow_ray shadows[SLOTS];
static float radiance[SLOTS][4];
static bool has_shadow[SLOTS], goes_on[SLOTS];
static uint32_t queue[SLOTS];

// --- scenes --------------------------------------------------------------------------------------

enum { SMOOTH = 1, ENCLOSED = 2 };

// Makes a floor, a tilted mirror, and an emitter of each kind above. With ENCLOSED, all are in an
// emissive sphere.
static void make_scene(struct scene *scene, uint32_t kind)
{
    static const float floor[2][3][3] = {{{-2, 0, -2}, {2, 0, -2}, {2, 0, 2}},
                                         {{-2, 0, -2}, {2, 0, 2}, {-2, 0, 2}}};
    static const float mirror[1][3][3] = {{{-2, 0, -2}, {2, 0, -2}, {0, 2.5f, -1.5f}}};
    static const float lamp[1][3][3] = {{{-1.5f, 2, 0}, {-0.5f, 2, 0.5f}, {-1, 2.25f, 1}}};
    static const float bent[2][3][3] = {{{0.28f, 0.96f, 0}, {-0.28f, 0.96f, 0}, {0, 0.96f, 0.28f}},
                                        {{0.28f, 0.96f, 0}, {0, 0.96f, 0.28f}, {0, 0.96f, -0.28f}}};
    scene_start(scene, 64, 64);
    const struct material materials[] = {
        {.name = "floor", .base_color = {0.75f, 0.5f, 0.25f}},
        {.name = "mirror", .model = MATERIAL_MIRROR, .base_color = {0.9f, 0.8f, 0.7f}},
        {.name = "lamp", .base_color = {0.1f, 0.2f, 0.3f}, .emission = {8, 6, 4}},
        {.name = "bulb", .base_color = {0.5f, 0.5f, 0.5f}, .emission = {1, 2, 3}},
        {.name = "disc", .base_color = {0.4f, 0.4f, 0.4f}, .emission = {3, 2, 0}},
        {.name = "sky", .base_color = {0.3f, 0.3f, 0.3f}, .emission = {0.1f, 0.1f, 0.2f}},
    };
    uint32_t first = 0;
    for (size_t i = 0; i < sizeof materials / sizeof materials[0]; i++) {
        uint32_t index = add_material(scene, &materials[i]);
        first = i == 0 ? index : first;
    }
    add_smooth_triangles(scene, floor, kind & SMOOTH ? bent : NULL, 2, first);
    add_triangles(scene, mirror, 1, first + 1);
    add_triangles(scene, lamp, 1, first + 2);
    add_sphere(scene, (double[3]){0.75, 1.25, 0.5}, 0.4, first + 3);
    add_sphere(scene, (double[3]){1.5, 0.5, -0.5}, 0.3, first);
    add_disc(scene, (double[3]){0, 2.5, 0}, (double[3]){0.2, -1, 0.1}, 0.5, first + 4);
    if (kind & ENCLOSED)
        add_sphere(scene, (double[3]){0, 1, 0}, 6, first + 5);
    scene->settings.light_choice = LIGHT_CHOICE_POWER; // a single shadow ray, as in the reference
    scene->settings.max_bounces = 6;
    scene->settings.roulette_min_bounces = 2;
    scene->settings.seed = 1234567;
}

// --- running -------------------------------------------------------------------------------------

// Traces random rays, and makes paths of different lengths for their hits.
static bool trace_rays(struct renderer *r, struct err *err)
{
    static struct probe_ray rays[SLOTS];
    struct random random = {81};
    bool complete;
    double ms;
    for (uint32_t i = 0; i < SLOTS; i++) {
        random_direction(&random, rays[i].direction);
        rays[i].origin[0] = (float)random_between(&random, -1.5, 1.5);
        rays[i].origin[1] = (float)random_between(&random, 0.1, 2);
        rays[i].origin[2] = (float)random_between(&random, -0.5, 1.5);
    }
    if (!ray_probe_trace(r, KERNEL_intersect_closest, rays, SLOTS, NULL, &ms, &complete, err) ||
        !gpu_download(r->gpu, &r->buffers[BINDING_PATHS], 0, before, sizeof before, err))
        return false;
    for (uint32_t i = 0; i < SLOTS; i++) {
        // A third of the paths come from a mirror or the camera.
        before[i].bsdf_pdf = i % 3 == 0 ? 0.0f : (float)random_between(&random, 0.01, 0.3);
        for (int c = 0; c < 3; c++)
            before[i].throughput[c] = (float)random_between(&random, 0, 1.5);
    }
    return true;
}

static bool read_queue(struct renderer *r, uint32_t number, bool in_queue[SLOTS], struct err *err)
{
    uint32_t count = r->counters->queue[number].count;
    memset(in_queue, 0, SLOTS * sizeof *in_queue);
    if (!gpu_download(r->gpu, &r->buffers[BINDING_QUEUES], queue_offset(r, number), queue,
                      sizeof queue, err))
        return false;
    CHECK(count <= SLOTS, "%u in queue %u", count, number);
    for (uint32_t i = 0; i < count && i < SLOTS; i++) {
        bool fresh = queue[i] < SLOTS && !in_queue[queue[i]];
        CHECK(fresh, "slot %u in queue %u twice or out of range", queue[i], number);
        if (fresh)
            in_queue[queue[i]] = true;
    }
    return true;
}

// Shades the hits of trace_rays(), as the paths of `before`.
static bool shade(struct renderer *r, uint32_t bounce, struct err *err)
{
    struct gpu_buffer *buffers = r->buffers;
    bool nee = r->specialization.features & FEATURE_NEE;
    r->push.bounce = bounce;
    r->push.first_pixel = 77;
    r->push.first_sample = 12;
    r->push.sample_shift = 1;
    r->push.queue = QUEUE_SURFACE;
    r->push.first_item = 0;
    r->push.part_items = SLOTS;
    memset(radiance, 0, sizeof radiance);
    memset(has_shadow, 0, sizeof has_shadow);
    uint32_t next = QUEUE_RAYS + ((bounce + 1) & 1u);
    return gpu_upload(r->gpu, &buffers[BINDING_PATHS], 0, before, sizeof before, err) &&
           gpu_upload(r->gpu, &buffers[BINDING_RADIANCE], 0, radiance, sizeof radiance, err) &&
           run_kernel(r, &r->kernels[KERNEL_shade_surface], SLOTS, err) &&
           gpu_download(r->gpu, &buffers[BINDING_PATHS], 0, after, sizeof after, err) &&
           gpu_download(r->gpu, &buffers[BINDING_RADIANCE], 0, radiance, sizeof radiance, err) &&
           gpu_download(r->gpu, &buffers[BINDING_QUEUES], 0, r->counters, sizeof *r->counters,
                        err) &&
           read_queue(r, next, goes_on, err) &&
           (!nee ||
            (gpu_download(r->gpu, &buffers[BINDING_SHADOW_RAYS], 0, shadows, sizeof shadows, err) &&
             read_queue(r, QUEUE_SHADOW, has_shadow, err)));
}

// --- one hit -------------------------------------------------------------------------------------

struct hit {
    const struct renderer *r;
    uint32_t slot;
    struct surface_point s;
    double origin[3], direction[3], throughput[3]; // of the path
    double u_light[4], u_bsdf[4];
    double normal_error; // error of the shading normal's octahedral code, see test_precision
    bool interpolated;   // the shading normal is interpolated, so it may differ from the geometric
                         // one
};

static struct hit load_hit(const struct renderer *r, uint32_t slot)
{
    const struct gpu_path *path = &before[slot];
    struct hit h = {.r = r, .slot = slot, .s = surface_at(r, path)};
    for (int c = 0; c < 3; c++) {
        h.origin[c] = (double)path->origin[c];
        h.direction[c] = (double)path->direction[c];
        h.throughput[c] = (double)path->throughput[c];
    }
    const struct gpu_push *push = &r->push;
    uint32_t pixel = push->first_pixel + (slot >> push->sample_shift);
    uint32_t sample = push->first_sample + (slot & ((1u << push->sample_shift) - 1));
    uint32_t dimension = 1 + 3 * push->bounce;
    random_4d(pixel, sample, dimension, r->frame.seed, h.u_light);
    random_4d(pixel, sample, dimension + 1, r->frame.seed, h.u_bsdf);
    h.interpolated = r->flat.normals && !h.s.shape;
    h.normal_error = h.interpolated ? 7e-5 : 0;
    return h;
}

static bool is_close(double value, double expected, double relative)
{
    return fabs(value - expected) <= relative * fabs(expected) + 1e-12;
}

static bool is_mirror(const struct hit *h)
{
    return h->s.material->model == MATERIAL_MIRROR;
}

static bool has_feature(const struct hit *h, uint32_t feature)
{
    return h->r->specialization.features & feature;
}

// --- weights -------------------------------------------------------------------------------------

static double mis_weight(const struct hit *h, double pdf, double other_pdf)
{
    switch (h->r->specialization.mis) {
    case MIS_BALANCE:
        return pdf / (pdf + other_pdf);
    case MIS_POWER_ANY:
        return 1 / (1 + pow(other_pdf / pdf, (double)h->r->frame.mis_exponent));
    default:
        return power_heuristic(pdf, other_pdf);
    }
}

// Returns whether a vertex after this many bounces sends shadow rays.
static bool connects(const struct hit *h, uint32_t bounces)
{
    return has_feature(h, FEATURE_NEE) &&
           (!has_feature(h, FEATURE_NEE_DEPTH) || bounces < h->r->frame.nee_depth);
}

static void mirror_direction(const struct hit *h, double out[3])
{
    for (int c = 0; c < 3; c++)
        out[c] = h->direction[c] - 2 * vec3_dot(h->direction, h->s.shading) * h->s.shading[c];
}

static double unlimited_density(const struct hit *h, const double wi[3], double cosine)
{
    double mirrored[3], n = (double)h->r->frame.direction_exponent;
    switch (h->r->specialization.directions) {
    case DIRECTIONS_SPHERE:
        return 0.25 / M_PI;
    case DIRECTIONS_HEMISPHERE:
        return 0.5 / M_PI;
    case DIRECTIONS_POWER_COSINE:
        mirror_direction(h, mirrored);
        return 0.125 * cosine / M_PI +
               0.875 * (n + 1) * 0.5 / M_PI * pow(fmax(0, vec3_dot(wi, mirrored)), n);
    default:
        return cosine / M_PI;
    }
}

// Returns the density with which a path continues in direction wi from a diffuse surface; cosine >
// 0.
static double density_onwards(const struct hit *h, const double wi[3], double cosine)
{
    double density = unlimited_density(h, wi, cosine);
    bool ends = has_feature(h, FEATURE_MIN_DENSITY) && density < (double)h->r->frame.min_density;
    return ends ? 0 : density;
}

// Returns the factor by which clamping scales a contribution.
static double clamp_scale(const struct hit *h, const double radiance_rgb[3])
{
    double most = fmax(radiance_rgb[0], fmax(radiance_rgb[1], radiance_rgb[2]));
    double limit = (double)h->r->frame.clamp_limit;
    return has_feature(h, FEATURE_CLAMP) && most > limit ? limit / most : 1;
}

// --- emission ------------------------------------------------------------------------------------

static void check_emission(const struct hit *h)
{
    double pdf = (double)before[h->slot].bsdf_pdf, weight = 1, expected_rgb[3];
    double pick = pick_density(h->r, h->s.material);
    // At the first bounce the test's paths have a density although no vertex precedes them.
    bool connected = has_feature(h, FEATURE_NEE) && (!has_feature(h, FEATURE_NEE_DEPTH) ||
                                                     h->r->push.bounce <= h->r->frame.nee_depth);
    if (connected && pdf > 0 && pick > 0)
        weight = has_feature(h, FEATURE_BSDF_HITS_EMITTERS)
                     ? mis_weight(h, pdf, light_density(h->r, h->origin, h->direction, &h->s))
                     : 0;
    for (int c = 0; c < 3; c++)
        expected_rgb[c] = h->throughput[c] * (double)h->s.material->emission[c] * weight;
    double scale = clamp_scale(h, expected_rgb);
    // If the surface is seen edge-on, the rounding of the cosine matters.
    double relative = 2e-5 + 4e-6 / fabs(vec3_dot(h->direction, h->s.geometric));
    for (int c = 0; c < 3; c++) {
        double expected = expected_rgb[c] * scale;
        CHECK(is_close((double)radiance[h->slot][c], expected, relative),
              "slot %u, %s: emission %.9g, not %.9g", h->slot, h->s.material->name,
              (double)radiance[h->slot][c], expected);
    }
}

// --- the light sample ----------------------------------------------------------------------------

// Computes the point of a triangle for these numbers, seen from `origin`.
static void triangle_sample(const struct flat_triangle *triangle, const double origin[3],
                            const double u[2], double out[3])
{
    double corners[3][3];
    for (int i = 0; i < 3; i++)
        for (int c = 0; c < 3; c++)
            corners[i][c] = (double)triangle->v[i][c] - origin[c];
    if (is_chosen_by_solid_angle(exact_solid_angle(corners))) {
        exact_seen_point(corners, u, out);
        for (int c = 0; c < 3; c++)
            out[c] += origin[c];
        return;
    }
    double root = sqrt(u[0]), b1 = root * (1 - u[1]), b2 = root * u[1];
    for (int c = 0; c < 3; c++)
        out[c] = (1 - b1 - b2) * (double)triangle->v[0][c] + b1 * (double)triangle->v[1][c] +
                 b2 * (double)triangle->v[2][c];
}

// Checks that the sampled point is on its emitter, and at the place that the numbers determine, as
// far as precision permits.
static void check_light_point(const struct hit *h, uint32_t primitive, const double origin[3],
                              const double point[3])
{
    const struct flat_scene *flat = &h->r->flat;
    if (!(primitive & PRIMITIVE_SHAPE)) {
        double expected[3], off = 0;
        triangle_sample(&flat->triangles[h->r->bvh.triangle_order[primitive]], origin,
                        &h->u_light[1], expected);
        for (int c = 0; c < 3; c++)
            off = fmax(off, fabs(point[c] - expected[c]));
        CHECK(off <= 2e-6, "slot %u: %g off the point of the triangle", h->slot, off);
        return;
    }
    const struct flat_shape *shape = &flat->shapes[primitive & ~PRIMITIVE_SHAPE];
    double from_center[3], normal[3], to_center[3], to_point[3], radius = (double)shape->radius;
    for (int c = 0; c < 3; c++) {
        from_center[c] = point[c] - (double)shape->center[c];
        to_center[c] = (double)shape->center[c] - origin[c];
        to_point[c] = point[c] - origin[c];
        normal[c] = (double)shape->normal[c];
    }
    double wanted_radius = shape->kind == SHAPE_SPHERE ? radius : radius * sqrt(h->u_light[1]);
    CHECK(fabs(vec3_norm(from_center) - wanted_radius) <= 4e-6 * (1 + radius),
          "slot %u: %.9g from the centre, not %.9g", h->slot, vec3_norm(from_center),
          wanted_radius);
    if (shape->kind == SHAPE_DISC) {
        CHECK(fabs(vec3_dot(from_center, normal)) <= 4e-6, "slot %u: off the disc", h->slot);
        return;
    }
    double sine = radius / vec3_norm(to_center);
    if (sine >= 1)
        return;
    double cosine = vec3_dot(to_point, to_center) / (vec3_norm(to_point) * vec3_norm(to_center));
    double expected = h->u_light[1] * (1 - sqrt(1 - sine * sine));
    CHECK(fabs(1 - cosine - expected) <= 1e-5, "slot %u: 1 - cos %.9g in the cone, not %.9g",
          h->slot, 1 - cosine, expected);
    CHECK(vec3_dot(from_center, to_center) <= 1e-5, "slot %u: the far side of the sphere", h->slot);
}

// Returns the emitter that the table gives for u, as the kernel computes it.
static uint32_t picked_emitter(const struct renderer *r, const struct gpu_emitter *table, double u)
{
    float scaled = (float)u * (float)r->tables.emitters.count;
    uint32_t bin = (uint32_t)scaled < r->tables.emitters.count ? (uint32_t)scaled
                                                               : r->tables.emitters.count - 1;
    return scaled - (float)bin < table[bin].threshold ? table[bin].primitive
                                                      : table[bin].alias_primitive;
}

// Returns the point as a surface point seen from the shadow ray's origin.
static struct surface_point light_surface(const struct renderer *r, uint32_t primitive,
                                          const double origin[3], const double wi[3],
                                          double distance)
{
    struct gpu_path path = {.primitive = primitive, .t = (float)distance};
    for (int c = 0; c < 3; c++) {
        path.origin[c] = (float)origin[c];
        path.direction[c] = (float)wi[c];
    }
    struct surface_point out = surface_at(r, &path);
    out.distance = distance;
    return out;
}

static void check_shadow_ray(const struct hit *h)
{
    const struct gpu_shadow_ray *ray = &shadows[h->slot];
    double origin[3], to_light[3], point[3], wi[3];
    for (int c = 0; c < 3; c++) {
        origin[c] = (double)ray->origin[c];
        to_light[c] = (double)ray->direction[c];
        point[c] = origin[c] + to_light[c];
    }
    double distance = vec3_norm(to_light);
    for (int c = 0; c < 3; c++)
        wi[c] = to_light[c] / distance;
    check_light_point(h, ray->ignore_to, origin, point);
    CHECK(ray->ignore_from == before[h->slot].primitive, "slot %u", h->slot);

    struct surface_point light = light_surface(h->r, ray->ignore_to, origin, wi, distance);
    double pdf = light_density(h->r, origin, wi, &light);
    double cosine = vec3_dot(wi, h->s.shading), cos_light = fabs(vec3_dot(wi, light.geometric));
    double relative =
        1e-4 + (h->normal_error + 4e-6) / fabs(cosine) + 4e-6 / cos_light + 4e-6 / distance;
    CHECK(is_close((double)ray->light_pdf, pdf, relative), "slot %u, %s: pdf %.9g, not %.9g",
          h->slot, light.material->name, (double)ray->light_pdf, pdf);
    CHECK(cosine > -h->normal_error && vec3_dot(wi, h->s.geometric) > -1e-6, "slot %u: behind",
          h->slot);
    double weight = has_feature(h, FEATURE_BSDF_HITS_EMITTERS)
                        ? mis_weight(h, pdf, density_onwards(h, wi, fmax(0, cosine)))
                        : 1;
    for (int c = 0; c < 3; c++) {
        double expected = h->throughput[c] * (double)h->s.material->base_color[c] / M_PI *
                          (double)light.material->emission[c] * cosine * weight / pdf;
        CHECK(is_close((double)ray->radiance[c], expected, 3 * relative),
              "slot %u, %s: %.9g arrives, not %.9g", h->slot, light.material->name,
              (double)ray->radiance[c], expected);
    }
}

// Returns 1 if there must be a shadow ray, 0 if there must be none, and -1 if both are correct.
static int wants_shadow_ray(const struct hit *h, uint32_t emitter)
{
    if (!connects(h, h->r->push.bounce) || h->r->push.bounce >= h->r->frame.max_bounces ||
        is_mirror(h))
        return 0;
    const struct flat_scene *flat = &h->r->flat;
    double point[3], wi[3], extent = 0;
    if (emitter & PRIMITIVE_SHAPE) {
        const struct flat_shape *shape = &flat->shapes[emitter & ~PRIMITIVE_SHAPE];
        extent = (double)shape->radius;
        for (int c = 0; c < 3; c++)
            point[c] = (double)shape->center[c];
    } else {
        triangle_sample(&flat->triangles[h->r->bvh.triangle_order[emitter]], h->s.position,
                        &h->u_light[1], point);
    }
    for (int c = 0; c < 3; c++)
        wi[c] = point[c] - h->s.position[c];
    double margin = extent + (1e-5 + 2 * h->normal_error) * (1 + vec3_norm(wi));
    double lower = fmin(vec3_dot(wi, h->s.geometric), vec3_dot(wi, h->s.shading));
    return lower > margin ? 1 : lower < -margin ? 0 : -1;
}

// --- scattering ----------------------------------------------------------------------------------

// Returns the probability that the path continues; 1 before Russian roulette begins.
static double survival(const struct hit *h)
{
    double most = 0;
    for (int c = 0; c < 3; c++)
        most = fmax(most, h->throughput[c] * (double)h->s.material->base_color[c]);
    bool plays =
        has_feature(h, FEATURE_ROULETTE) && h->r->push.bounce >= h->r->frame.roulette_min_bounces;
    if (!plays)
        return 1;
    return h->r->specialization.roulette == ROULETTE_THROUGHPUT
               ? fmin(1, ROULETTE_FACTOR * most)
               : (double)h->r->frame.roulette_survival;
}

// Returns the random number of Russian roulette; with roulette by frames it is the same for all
// pixels.
static double survival_number(const struct hit *h)
{
    const struct gpu_push *push = &h->r->push;
    double u[4];
    if (h->r->specialization.roulette != ROULETTE_FRAME)
        return h->u_light[3];
    random_4d(UINT32_MAX, push->first_sample + (h->slot & ((1u << push->sample_shift) - 1)),
              1 + 3 * push->bounce, h->r->frame.seed, u);
    return u[3];
}

// Returns the cosine that the numbers determine; NaN if it depends on the choice of a basis.
static double cosine_onwards(const struct hit *h)
{
    double u = h->u_bsdf[0];
    switch (h->r->specialization.directions) {
    case DIRECTIONS_SPHERE:
        return 1 - 2 * u;
    case DIRECTIONS_HEMISPHERE:
        return 1 - u;
    case DIRECTIONS_POWER_COSINE:
        return h->u_bsdf[3] < 0.125 ? sqrt(1 - u) : NAN;
    default:
        return sqrt(1 - u);
    }
}

// The new origin must be beside the surface, on the direction's side.
static void check_new_origin(const struct hit *h, const double direction[3])
{
    double off[3], from_plane[3];
    for (int c = 0; c < 3; c++) {
        off[c] = (double)after[h->slot].origin[c] - h->s.position[c];
        from_plane[c] = (double)after[h->slot].origin[c] - h->s.plane_point[c];
    }
    double side = vec3_dot(direction, h->s.geometric);
    double height = vec3_dot(from_plane, h->s.geometric);
    if (h->s.shape && h->s.shape->kind == SHAPE_SPHERE) {
        // The geometric normal may point inwards.
        double outwards = vec3_dot(from_plane, h->s.geometric) > 0 ? 1 : -1;
        height = outwards * (vec3_norm(from_plane) - (double)h->s.shape->radius);
    }
    CHECK(vec3_norm(off) <= 1e-5, "slot %u: the origin is %g away", h->slot, vec3_norm(off));
    // The origin may be exactly in the plane, for an axis-parallel plane at 0.
    CHECK(height * side >= 0, "slot %u, %s: the origin is on the wrong side by %g", h->slot,
          h->s.material->name, height);
}

static void check_next_path(const struct hit *h)
{
    const struct gpu_path *path = &after[h->slot];
    double direction[3], mirrored[3], q = survival(h);
    double pdf, part = 1,
                relative = 1e-6; // `part` is the fraction of the reflectance that this direction
                                 // represents
    uint32_t directions = h->r->specialization.directions;
    bool fits = directions == DIRECTIONS_BSDF || directions == DIRECTIONS_COSINE;
    for (int c = 0; c < 3; c++)
        direction[c] = (double)path->direction[c];
    CHECK(fabs(vec3_norm(direction) - 1) <= 1e-6, "slot %u: not a unit vector", h->slot);
    if (is_mirror(h)) {
        mirror_direction(h, mirrored);
        double off = 0;
        for (int c = 0; c < 3; c++)
            off = fmax(off, fabs(direction[c] - mirrored[c]));
        CHECK(off <= 2e-6 + 2 * h->normal_error && path->bsdf_pdf == 0.0f,
              "slot %u: reflected %g off, pdf %g", h->slot, off, (double)path->bsdf_pdf);
    } else {
        double cosine = cosine_onwards(h), actual = vec3_dot(direction, h->s.shading);
        CHECK(isnan(cosine) || fabs(actual - cosine) <= 2e-6 + h->normal_error,
              "slot %u: cos %.9g, not %.9g", h->slot, actual, cosine);
        cosine = isnan(cosine) ? actual : cosine;
        pdf = density_onwards(h, direction, cosine);
        CHECK(fabs((double)path->bsdf_pdf - pdf) <= (fits ? 1e-6 : 1e-5 + 1e-4 * pdf),
              "slot %u: pdf %.9g, not %.9g", h->slot, (double)path->bsdf_pdf, pdf);
        part = fits ? 1 : cosine / M_PI / pdf;
        relative = fits ? 1e-6 : 1e-4 + (h->normal_error + 4e-6) / cosine;
    }
    for (int c = 0; c < 3; c++) {
        double expected = h->throughput[c] * (double)h->s.material->base_color[c] * part / q;
        CHECK(is_close((double)path->throughput[c], expected, relative),
              "slot %u: throughput %.9g, not %.9g", h->slot, (double)path->throughput[c], expected);
    }
    CHECK(vec3_dot(direction, h->s.geometric) > 0, "slot %u: through the surface", h->slot);
    CHECK(path->ignore == before[h->slot].primitive, "slot %u: ignores 0x%x", h->slot,
          path->ignore);
    check_new_origin(h, direction);
}

// Returns 1, 0, or -1 for either, if a bent normal may direct the path into the surface.
static int wants_next_path(const struct hit *h)
{
    if (h->r->push.bounce >= h->r->frame.max_bounces)
        return 0;
    if (survival_number(h) >= survival(h))
        return 0;
    double cosine = cosine_onwards(h);
    bool certain = !h->interpolated && (is_mirror(h) || fabs(cosine) > 1e-5);
    if (has_feature(h, FEATURE_MIN_DENSITY) && !is_mirror(h)) {
        double least = (double)h->r->frame.min_density * M_PI;
        if (cosine < least - 1e-5)
            return 0;
        certain = certain && cosine > least + 1e-5;
    }
    return !certain ? -1 : is_mirror(h) || cosine > 0 ? 1 : 0;
}

// --- all of it -----------------------------------------------------------------------------------

struct tally {
    uint32_t hits, emitting, shadow_rays, next_paths;
};

static struct tally check_slots(const struct renderer *r, const struct gpu_emitter *emitters)
{
    struct tally tally = {0};
    for (uint32_t slot = 0; slot < SLOTS; slot++) {
        if (before[slot].primitive == NO_PRIMITIVE) {
            CHECK(!goes_on[slot] && !has_shadow[slot], "slot %u was not hit", slot);
            continue;
        }
        struct hit h = load_hit(r, slot);
        uint32_t emitter = picked_emitter(r, emitters, h.u_light[0]);
        int shadow = wants_shadow_ray(&h, emitter), next = wants_next_path(&h);
        check_emission(&h);
        CHECK(shadow < 0 || shadow == has_shadow[slot], "slot %u, %s: shadow ray %d, not %d", slot,
              h.s.material->name, has_shadow[slot], shadow);
        CHECK(next < 0 || next == goes_on[slot], "slot %u, %s: goes on %d, not %d", slot,
              h.s.material->name, goes_on[slot], next);
        if (has_shadow[slot]) {
            CHECK(shadows[slot].ignore_to == emitter, "slot %u: emitter 0x%x, not 0x%x", slot,
                  shadows[slot].ignore_to, emitter);
            check_shadow_ray(&h);
        }
        if (goes_on[slot])
            check_next_path(&h);
        tally.hits++;
        tally.emitting += radiance[slot][0] > 0.0f;
        tally.shadow_rays += has_shadow[slot];
        tally.next_paths += goes_on[slot];
    }
    return tally;
}

// Settings that differ from the defaults.
struct method {
    uint32_t mis, directions, roulette;
    uint32_t nee_depth; // 0: all
    float clamp_limit, min_density;
    float mis_exponent; // 0: the usual one
};

// Ends the test if there is no device.
static void check_method(uint32_t kind, enum light_estimator estimator, uint32_t bounce,
                         const struct method *method)
{
    struct setup setup;
    struct err err = {0};
    struct gpu_emitter emitters[16] = {{0}};
    make_scene(&setup.scene, kind);
    struct settings *settings = &setup.scene.settings;
    set_estimator(settings, estimator);
    settings->mis = method->mis ? method->mis : settings->mis;
    settings->directions = method->directions;
    settings->roulette = method->roulette;
    settings->nee_depth = method->nee_depth ? method->nee_depth : UINT32_MAX;
    settings->clamp_limit = method->clamp_limit;
    settings->min_density = method->min_density;
    settings->mis_exponent = method->mis_exponent > 0 ? method->mis_exponent : 2;
    OPEN_SETUP(&setup, SLOTS);
    struct renderer *r = &setup.r;
    bool ok = r->plan.wave_slots >= SLOTS && r->tables.emitters.count <= 16 &&
              trace_rays(r, &err) &&
              (!r->buffers[BINDING_EMITTERS].handle ||
               gpu_download(r->gpu, &r->buffers[BINDING_EMITTERS], 0, emitters,
                            r->tables.emitters.count * sizeof emitters[0], &err)) &&
              shade(r, bounce, &err);
    REQUIRE(ok, "%s", err.msg);
    struct tally tally = check_slots(r, emitters);
    printf("  %u hits, %u emitting, %u shadow rays, %u go on\n", tally.hits, tally.emitting,
           tally.shadow_rays, tally.next_paths);
    bool last = bounce >= setup.scene.settings.max_bounces;
    CHECK(tally.hits > SLOTS / 8 && tally.emitting > SLOTS / 32, "%u hits, %u emitting", tally.hits,
          tally.emitting);
    CHECK(last == (tally.next_paths == 0), "%u go on", tally.next_paths);
    bool silent = last || estimator == ESTIMATOR_BSDF || bounce >= settings->nee_depth;
    CHECK(silent == (tally.shadow_rays == 0), "%u shadow rays", tally.shadow_rays);
    CHECK((method->clamp_limit > 0) == (r->counters->clamped > 0), "%u clamped",
          r->counters->clamped);
    CHECK((method->min_density > 0) == (r->counters->sparse > 0), "%u ended", r->counters->sparse);
    setup_close(&setup);
}

static void check_scene(uint32_t kind, enum light_estimator estimator, uint32_t bounce)
{
    check_method(kind, estimator, bounce, &(struct method){0});
}

TEST(first_bounce)
{
    check_scene(0, ESTIMATOR_MIS, 0);
}

TEST(shading_normals)
{
    check_scene(SMOOTH, ESTIMATOR_MIS, 1);
}

TEST(inside_of_an_emitter)
{
    check_scene(ENCLOSED, ESTIMATOR_MIS, 0);
}

TEST(other_estimators)
{
    check_scene(ENCLOSED, ESTIMATOR_NEE, 1);
    check_scene(ENCLOSED, ESTIMATOR_BSDF, 1);
}

TEST(roulette)
{
    check_scene(0, ESTIMATOR_MIS, 2);
    check_scene(0, ESTIMATOR_MIS, 5);
}

TEST(last_bounce)
{
    check_scene(ENCLOSED | SMOOTH, ESTIMATOR_MIS, 6);
}

TEST(balance_heuristic)
{
    check_method(0, ESTIMATOR_MIS, 0, &(struct method){.mis = MIS_BALANCE});
}

TEST(exponents_of_the_power_heuristic)
{
    check_method(0, ESTIMATOR_MIS, 0, &(struct method){.mis_exponent = 0.5f});
    check_method(SMOOTH, ESTIMATOR_MIS, 1, &(struct method){.mis_exponent = 3.5f});
    check_method(0, ESTIMATOR_MIS, 0, &(struct method){.mis_exponent = 40});
}

// Paths end in unlikely directions. Light from there counts in full where shadow rays find it.
TEST(least_densities)
{
    check_method(0, ESTIMATOR_MIS, 0, &(struct method){.min_density = 0.15f});
    check_method(SMOOTH, ESTIMATOR_MIS, 1, &(struct method){.min_density = 0.02f});
    check_method(ENCLOSED, ESTIMATOR_BSDF, 1, &(struct method){.min_density = 0.2f});
}

// The weights use the density from which directions are sampled.
TEST(other_directions)
{
    check_method(0, ESTIMATOR_MIS, 0, &(struct method){.directions = DIRECTIONS_SPHERE});
    check_method(SMOOTH, ESTIMATOR_MIS, 1, &(struct method){.directions = DIRECTIONS_HEMISPHERE});
    check_method(0, ESTIMATOR_MIS, 1, &(struct method){.directions = DIRECTIONS_COSINE});
    check_method(0, ESTIMATOR_MIS, 0, &(struct method){.directions = DIRECTIONS_POWER_COSINE});
}

// Tests the last vertex that sends shadow rays and the first that does not: emission that rays from
// the former hit is weighted, and emission that others hit counts in full.
TEST(shadow_rays_by_depth)
{
    for (uint32_t bounce = 0; bounce < 4; bounce++)
        check_method(ENCLOSED, ESTIMATOR_MIS, bounce, &(struct method){.nee_depth = 2});
}

TEST(other_roulettes)
{
    check_method(0, ESTIMATOR_MIS, 1, &(struct method){.roulette = ROULETTE_CONSTANT});
    check_method(0, ESTIMATOR_MIS, 4, &(struct method){.roulette = ROULETTE_CONSTANT});
    check_method(0, ESTIMATOR_MIS, 3, &(struct method){.roulette = ROULETTE_FRAME});
    check_method(0, ESTIMATOR_MIS, 4, &(struct method){.roulette = ROULETTE_FRAME});
    check_method(0, ESTIMATOR_MIS, 4, &(struct method){.roulette = ROULETTE_OFF});
}

TEST(clamped_emission)
{
    check_method(0, ESTIMATOR_MIS, 0, &(struct method){.clamp_limit = 1.5f});
}

// A contribution that is not finite is not added, but counted and marked, and ends the path.
TEST(nonfinite_throughput)
{
    struct setup setup;
    struct err err = {0};
    make_scene(&setup.scene, ENCLOSED);
    set_estimator(&setup.scene.settings, ESTIMATOR_BSDF);
    OPEN_SETUP(&setup, SLOTS);
    bool ok = trace_rays(&setup.r, &err);
    uint32_t hits = 0, emitting = 0;
    for (uint32_t i = 0; i < SLOTS && ok; i++) {
        if (before[i].primitive == NO_PRIMITIVE)
            continue;
        before[i].throughput[i % 3] = i % 2 ? INFINITY : NAN;
        struct surface_point s = surface_at(&setup.r, &before[i]);
        const float *e = s.material->emission;
        hits++;
        emitting += e[0] > 0.0f || e[1] > 0.0f || e[2] > 0.0f;
    }
    ok = ok && shade(&setup.r, 0, &err);
    REQUIRE(ok, "%s", err.msg);
    const uint32_t *count = setup.r.counters->nonfinite;
    CHECK(count[SITE_EMISSION] == emitting && emitting > 0, "%u, not %u", count[SITE_EMISSION],
          emitting);
    CHECK(count[SITE_THROUGHPUT] == hits, "%u, not %u", count[SITE_THROUGHPUT], hits);
    for (uint32_t i = 0; i < SLOTS; i++) {
        float mark = before[i].primitive == NO_PRIMITIVE ? 0.0f : 1.0f;
        CHECK(!goes_on[i] && radiance[i][0] == 0.0f && radiance[i][1] == 0.0f &&
                  radiance[i][2] == 0.0f && radiance[i][3] == mark,
              "slot %u goes on, has radiance, or is marked %g", i, (double)radiance[i][3]);
    }
    setup_close(&setup);
}

TEST_MAIN(TEST_CASE(first_bounce), TEST_CASE(shading_normals), TEST_CASE(inside_of_an_emitter),
          TEST_CASE(other_estimators), TEST_CASE(roulette), TEST_CASE(last_bounce),
          TEST_CASE(balance_heuristic), TEST_CASE(exponents_of_the_power_heuristic),
          TEST_CASE(least_densities), TEST_CASE(other_directions), TEST_CASE(shadow_rays_by_depth),
          TEST_CASE(other_roulettes), TEST_CASE(clamped_emission), TEST_CASE(nonfinite_throughput))
