#include "render/probe/replay.h"

#include "render/wave.h"
#include <string.h>

struct follower {
    struct renderer *r;
    struct arena *arena;
    struct replay *out;
    uint32_t capacity;
    float radiance[4];   // sum of the path's contributions after the last step
    bool shadow_pending; // the last vertex has shadow rays to trace
};

// Returns whether the path is in a queue. Only one path is in flight, in slot 0, so a queue
// contains it or is empty.
static bool in_queue(const struct follower *f, uint32_t queue)
{
    return f->r->counters->queue[queue].count != 0;
}

static struct replay_vertex *add_vertex(struct follower *f)
{
    struct replay *out = f->out;
    return arena_append(f->arena, &out->vertices, &out->vertex_count, &f->capacity,
                        sizeof *out->vertices, NULL);
}

static uint32_t flat_primitive(const struct renderer *r, uint32_t word, bool *is_shape)
{
    *is_shape = word & PRIMITIVE_SHAPE;
    return *is_shape ? word & ~PRIMITIVE_SHAPE : r->bvh.triangle_order[word];
}

// Returns the material of a path's vertex; the instance of a shared mesh may override it.
static const struct material *material_of(const struct renderer *r, const struct replay_vertex *v)
{
    uint32_t material = v->is_shape ? r->flat.shapes[v->primitive].material
                                    : r->flat.triangles[v->primitive].material;
    if (v->instance != NO_INSTANCE && r->flat.instances[v->instance].material != SCENE_NONE)
        material = r->flat.instances[v->instance].material;
    return &r->scene->materials[material];
}

// Returns the distance from a far camera at which a ray begins.
static double way_from_camera(const struct renderer *r, const float direction[3])
{
    double forward = 0.0;
    for (int c = 0; c < 3; c++)
        forward += (double)direction[c] * (double)r->frame.camera_forward[c];
    return r->frame.camera_start > 0.0f ? (double)r->frame.camera_start / forward : 0.0;
}

static bool read_hit(struct follower *f, uint32_t bounce, struct err *err)
{
    struct renderer *r = f->r;
    struct {
        struct gpu_path path;
        uint32_t instances[4];
        uint32_t weights[4]; // in place of `instances` if the scene has no instances
    } record;
    uint64_t bytes = 16 * PATH_WORDS_OF(r->specialization.geometry, r->specialization.integrator);
    if (!gpu_download(r->gpu, &r->buffers[BINDING_PATHS], 0, &record, bytes, err))
        return false;
    const struct gpu_path path = record.path;
    struct replay_vertex *v = add_vertex(f);
    if (!v)
        return err_memory(err, "replay", f->capacity * sizeof *v);
    v->bounce = bounce;
    memcpy(v->direction, path.direction, sizeof v->direction);
    memcpy(v->throughput, path.throughput, sizeof v->throughput);
    // Whitted's integrator stores a ray's depth in place of the density, and all its rays are delta
    // reflections or refractions.
    if (r->specialization.integrator != INTEGRATOR_WHITTED)
        v->bsdf_pdf = path.bsdf_pdf;
    double origin[3], before = bounce == 0 ? way_from_camera(r, path.direction) : 0.0;
    for (int c = 0; c < 3; c++) {
        origin[c] = (double)path.origin[c];
        v->position[c] = origin[c] + (double)path.t * (double)path.direction[c];
    }
    for (int c = 0; c < 3; c++)
        origin[c] -= before * (double)path.direction[c];
    flat_to_world(&r->flat, origin, origin);
    flat_to_world(&r->flat, v->position, v->position);
    for (int c = 0; c < 3; c++)
        v->origin[c] = (float)origin[c];
    v->t = (float)(((double)path.t + before) / r->flat.scale);
    bool is_hit = false;
    for (uint32_t c = 0; c < CLASS_COUNT; c++)
        is_hit |= in_queue(f, QUEUE_SURFACE + c);
    v->queue = is_hit ? "surface" : in_queue(f, QUEUE_MISS) ? "miss" : "none";
    if (is_hit) {
        v->primitive = flat_primitive(r, path.primitive, &v->is_shape);
        v->instance =
            r->specialization.geometry & GEOMETRY_INSTANCES ? record.instances[0] : NO_INSTANCE;
        v->material = material_of(r, v);
    }
    return true;
}

// Reads the radiance that the last step has added to the path.
static bool read_gain(struct follower *f, float gain[3], struct err *err)
{
    float now[4];
    if (!gpu_download(f->r->gpu, &f->r->buffers[BINDING_RADIANCE], 0, now, sizeof now, err))
        return false;
    for (int c = 0; c < 3; c++)
        gain[c] = now[c] - f->radiance[c];
    memcpy(f->radiance, now, sizeof now);
    return true;
}

static struct replay_light light_of(const struct renderer *r, const struct gpu_shadow_ray *ray,
                                    uint32_t number)
{
    struct replay_light light = {.ray = number, .pdf = ray->light_pdf, .occluded = true};
    for (int c = 0; c < 3; c++)
        light.point[c] = (float)((double)ray->direction[c] / r->flat.scale);
    memcpy(light.radiance, ray->radiance, sizeof light.radiance);
    light.is_point = !(ray->ignore_to & PRIMITIVE_SHAPE) && (ray->ignore_to & PRIMITIVE_LIGHT);
    light.is_environment =
        ray->ignore_to == PRIMITIVE_ENVIRONMENT || ray->ignore_to == NO_PRIMITIVE;
    if (light.is_point)
        light.primitive = ray->ignore_to & ~PRIMITIVE_LIGHT;
    else if (!light.is_environment)
        light.primitive = flat_primitive(r, ray->ignore_to, &light.is_shape);
    return light;
}

// Reads the shadow rays of a vertex, except those without a contribution. It is called after the
// kernel of each class; the result of the last call is kept.
static bool read_connections(struct follower *f, struct replay_vertex *v, uint32_t bounce,
                             struct err *err)
{
    const struct renderer *r = f->r;
    uint32_t rays = wave_shadow_launches(r, bounce + 1);
    uint64_t stride = 16 * SHADOW_WORDS_OF(r->specialization.geometry);
    v->light_count = 0;
    v->lights = ARENA_NEW(f->arena, struct replay_light, rays);
    if (!v->lights)
        return err_memory(err, "connections", rays * sizeof *v->lights);
    for (uint32_t i = 0; i < rays; i++) {
        struct gpu_shadow_ray ray;
        if (!gpu_download(r->gpu, &r->buffers[BINDING_SHADOW_RAYS], i * stride, &ray, sizeof ray,
                          err))
            return false;
        if (ray.radiance[0] != 0.0f || ray.radiance[1] != 0.0f || ray.radiance[2] != 0.0f)
            v->lights[v->light_count++] = light_of(r, &ray, i);
    }
    return true;
}

static bool read_shadow(struct follower *f, uint32_t ray, struct err *err)
{
    float gain[3];
    if (!f->shadow_pending)
        return true;
    if (!read_gain(f, gain, err))
        return false;
    struct replay_vertex *v = &f->out->vertices[f->out->vertex_count - 1];
    bool arrives = gain[0] != 0.0f || gain[1] != 0.0f || gain[2] != 0.0f;
    for (uint32_t i = 0; i < v->light_count; i++)
        if (v->lights[i].ray == ray && arrives)
            v->lights[i].occluded = false;
    return true;
}

static bool read_shading(struct follower *f, enum kernel_id kernel, uint32_t bounce,
                         struct err *err)
{
    struct replay_vertex *v = &f->out->vertices[f->out->vertex_count - 1];
    float gain[3];
    if (!read_gain(f, gain, err))
        return false;
    for (int c = 0; c < 3; c++)
        v->gained[c] += gain[c];
    f->shadow_pending = kernel != KERNEL_shade_miss && in_queue(f, QUEUE_SHADOW);
    return !f->shadow_pending || read_connections(f, v, bounce, err);
}

static bool after(void *context, const struct wave_step *step, struct err *err)
{
    struct follower *f = context;
    enum kernel_id kernel = step->kernel;
    uint32_t bounce = step->bounce;
    uint32_t rays = QUEUE_RAYS + (bounce & 1u);
    bool is_sort = kernel >= KERNEL_sort_count && kernel <= KERNEL_sort_scatter;
    if (kernel == KERNEL_generate_rays || is_sort)
        return true;
    if (kernel == KERNEL_intersect_shadow)
        return read_shadow(f, step->light_ray, err);
    if (f->r->counters->dispatch[rays * DISPATCH_PARTS].items == 0)
        return true; // the path has ended
    return kernel == KERNEL_intersect_closest ? read_hit(f, bounce, err)
                                              : read_shading(f, kernel, bounce, err);
}

bool renderer_replay(struct renderer *r, uint32_t x, uint32_t y, uint64_t sample,
                     struct arena *arena, struct replay *out, struct err *err)
{
    *out = (struct replay){0};
    if (r->specialization.split_lobes > 0)
        return err_set(
            err, ERR_INPUT,
            "--pixel follows only paths that do not split, but split_lobes is %u; expected "
            "--split-lobes 0",
            r->scene->settings.split_lobes);
    struct follower f = {.r = r, .arena = arena, .out = out};
    struct wave wave = {
        .first_pixel = (uint64_t)y * r->frame.width + x,
        .pixel_count = 1,
        .first_sample = sample,
    };
    const struct wave_observer observer = {.after = after, .context = &f};
    if (!wave_trace_steps(r, &wave, &observer, err))
        return false;
    memcpy(out->radiance, f.radiance, sizeof out->radiance);
    out->dropped = f.radiance[3] != 0.0f;
    return true;
}
