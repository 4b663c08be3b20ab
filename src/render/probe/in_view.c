#include "render/probe/in_view.h"

#include "base/maths.h"
#include "render/probe/emitter_shape.h"
#include "render/probe/ray_probe.h"
#include "render/projection.h"
#include "scene/core/light.h"
#include <math.h>
#include <stdlib.h>
#include <string.h>

// The maximum area, in pixels, of an emitter that samples may miss. With two samples per pixel, all
// samples miss a larger emitter with a probability below exp(-10).
static const double part_max = 5;

// For pixels within this distance, in pixels, of an emitter's centre, the part of each pixel that
// the emitter covers is computed separately.
static const double split_reach = 2;

static const double texel_excess = 16; // a texel counts as an emitter from this multiple of the
                                       // median texel on

// With these limits, 2 * 10^5 emitters take about 0.3 s on a CPU.
enum {
    LIGHTS_MAX = 1 << 14, // maximum number of pixels kept; they are the brightest
    FEW_LIGHTS = 4096,
    PROBES = 16,            // rays to each of at most FEW_LIGHTS groups
    PROBES_OF_MANY = 4,     // rays to each group if there are more
    PROBES_OF_HIDDEN = 256, // maximum number of rays to groups that no ray has reached
    RAYS_OF_HIDDEN = 1 << 17,
    RAYS_AT_ONCE = 1 << 14,
    PLACES_MIN = 4, // points for each emitter
    PLACES_MAX = 1024,
    PLACES_OF_ALL = 1 << 20,
};

// An emitter, or a part of one, assigned to the pixel that contains its centre.
struct candidate {
    uint64_t pixel;
    struct emitter_part emitter;
    float part;   // area in the image, in pixels
    float radius; // see struct small_light
};

// The candidates of one pixel.
struct group {
    struct small_light light;
    uint64_t pixel;
    size_t first, count; // index of the first candidate, and number of candidates
    double brightness;   // greatest channel of the candidates' total light
    double free;         // fraction of the group's probes that reached an emitter
};

struct search {
    const struct renderer *renderer;
    struct projection projection;
    double spread;      // radius by which the filter extends a pixel
    uint8_t *mask;      // becomes unseen_light.emitter_in_view
    size_t small_count; // number of emitters smaller than part_max
    float *light;       // for each pixel: sum of radiance times area of the emitters whose centres
                        // it contains
    struct candidate *candidates;
    size_t count, capacity;
    struct group *groups;
    size_t group_count;
    bool failed; // out of memory, set once
};

// --- where emitters are ------------------------------------------------------------------------

static void mark(struct search *search, double x, double y, double radius)
{
    const struct projection *p = &search->projection;
    double left = fmax(floor(x - radius), 0), right = fmin(ceil(x + radius), p->width);
    double top = fmax(floor(y - radius), 0), bottom = fmin(ceil(y + radius), p->height);
    for (double row = top; row < bottom && left < right; row++)
        memset(&search->mask[(uint64_t)row * p->width + (uint64_t)left], 1, (size_t)(right - left));
}

static void mark_all(struct search *search)
{
    memset(search->mask, 1, (size_t)search->projection.width * search->projection.height);
}

static void add_candidate(struct search *search, const struct candidate *candidate)
{
    if (search->count == search->capacity) {
        size_t capacity = search->capacity ? 2 * search->capacity : 256;
        void *larger = realloc(search->candidates, capacity * sizeof *search->candidates);
        if (!larger) {
            search->failed = true;
            return;
        }
        search->candidates = larger;
        search->capacity = capacity;
    }
    search->candidates[search->count++] = *candidate;
}

static void add_part(struct search *search, double x, double y, double part, double radius,
                     struct emitter_part emitter)
{
    const struct projection *p = &search->projection;
    if (part > 0 && x >= 0 && x < p->width && y >= 0 && y < p->height)
        add_candidate(search, &(struct candidate){
                                  .pixel = (uint64_t)y * p->width + (uint64_t)x,
                                  .emitter = emitter,
                                  .part = (float)part,
                                  .radius = (float)radius,
                              });
}

// Returns the Blackman-Harris window of lib/filter.glsl, as a density from -1 to 1.
static double window(double x)
{
    static const double a[] = {0.48829 / 0.35875, 0.14128 / 0.35875, 0.01168 / 0.35875};
    return x < 1 ? 0.5 * (1 + a[0] * cos(M_PI * x) + a[1] * cos(2 * M_PI * x) +
                          a[2] * cos(3 * M_PI * x))
                 : 0;
}

// Returns the density of the pixel filter at an offset from a pixel's centre, per area of one
// pixel: see lib/filter.glsl.
static double filter_density(const struct renderer *r, double x, double y)
{
    double radius = (double)r->frame.filter_radius, u = fabs(x) / radius, v = fabs(y) / radius;
    double square = u * u + v * v, scale = 1 / (radius * radius);
    switch (r->scene->settings.filter) {
    case FILTER_TENT:
        return fmax(1 - u, 0) * fmax(1 - v, 0) * scale;
    case FILTER_GAUSSIAN:
        return square < 1 ? 4.5 / M_PI / 0.98889100346175773 * exp(-4.5 * square) * scale : 0;
    case FILTER_BLACKMAN_HARRIS:
        return window(u) * window(v) * scale;
    default:
        return u < 1 && v < 1 ? 0.25 * scale : 0;
    }
}

static bool project(const struct search *search, struct emitter_part emitter, const double place[3],
                    struct projected *at)
{
    return emitter_is_far(emitter) ? projection_find_far(&search->projection, place, at)
                                   : projection_find(&search->projection, place, at);
}

// Finds points of the image whose samples hit an emitter: points of the emitter, each displaced
// within its circle of confusion.
static uint32_t find_places(const struct search *search, struct emitter_part emitter,
                            const struct projected *middle, double (*out)[2])
{
    const struct renderer *r = search->renderer;
    size_t share = PLACES_OF_ALL / (search->small_count + 1);
    uint32_t count = share > PLACES_MAX ? PLACES_MAX : (uint32_t)share, found = 0;
    count = count < PLACES_MIN ? PLACES_MIN : count;
    for (uint32_t i = 0; i < count; i++) {
        struct projected at;
        double place[3];
        emitter_place(r, emitter, middle->direction, i, count, place);
        if (!project(search, emitter, place, &at))
            continue;
        // The points in the lens are ordered differently from those on the emitter, so that both
        // are independent.
        double radius = at.blur * sqrt(fmod((i + 0.5) * 0.6180339887498949, 1)), angle = 2.3 * i;
        out[found][0] = at.x + radius * cos(angle);
        out[found++][1] = at.y + radius * sin(angle);
    }
    return found;
}

// Computes for each of the few pixels that see an emitter how much of the pixel it covers: the mean
// density of the pixel's filter over the points of find_places().
static void split(struct search *search, const struct projected *at, double reach, double part,
                  struct emitter_part emitter)
{
    double places[PLACES_MAX][2];
    uint32_t count = find_places(search, emitter, at, places);
    for (double y = floor(at->y - reach); y <= at->y + reach; y++)
        for (double x = floor(at->x - reach); x <= at->x + reach; x++) {
            double sum = 0;
            for (uint32_t i = 0; i < count; i++)
                sum += filter_density(search->renderer, places[i][0] - x - 0.5,
                                      places[i][1] - y - 0.5);
            add_part(search, x, y, part * sum / count, 0, emitter);
        }
}

// Returns whether a sphere around a point is in front of the camera. An emitter whose sphere
// contains the camera may be visible anywhere in the image.
static bool is_in_front(struct search *search, const double center[3], double radius)
{
    double to[3];
    vec3_subtract(center, search->projection.position, to);
    double depth = search->projection.kind == CAMERA_PANORAMIC
                       ? vec3_length(to)
                       : vec3_dot(to, search->projection.forward);
    if (depth <= radius && depth > -radius)
        mark_all(search);
    return depth > radius;
}

// An emitter projected into the picture.
struct sight {
    struct projected at;
    double reach, part; // radius and area in the image, in pixels and square pixels
};

static bool find_sight(struct search *search, struct emitter_part emitter, struct sight *out)
{
    const struct renderer *r = search->renderer;
    const struct projection *p = &search->projection;
    double center[3], radius = emitter_radius(r, emitter);
    struct projected *at = &out->at;
    emitter_center(r, emitter, center);
    if (!emitter_is_far(emitter) && !is_in_front(search, center, radius))
        return false;
    if (!project(search, emitter, center, at))
        return false;
    out->reach = radius / at->pixel_size + at->blur + search->spread;
    out->part =
        emitter_area(r, emitter, at->direction) / at->pixel_area * emitter_opacity(r, emitter);
    return at->x + out->reach >= 0 && at->x - out->reach < p->width && at->y + out->reach >= 0 &&
           at->y - out->reach < p->height;
}

static double clamp_to(double x, uint32_t length)
{
    return fmin(fmax(floor(x), 0), length - 1.0);
}

static double find_greatest(const struct search *search, struct emitter_part emitter)
{
    double radiance[3];
    emitter_radiance(search->renderer, emitter, radiance);
    return fmax(radiance[0], fmax(radiance[1], radiance[2]));
}

// First pass: adds the light of a small emitter to the pixel that contains its centre.
static void count_emitter(struct search *search, struct emitter_part emitter)
{
    const struct projection *p = &search->projection;
    struct sight sight;
    if (!find_sight(search, emitter, &sight))
        return;
    mark(search, sight.at.x, sight.at.y, sight.reach + 1);
    uint64_t x = (uint64_t)clamp_to(sight.at.x, p->width);
    uint64_t y = (uint64_t)clamp_to(sight.at.y, p->height);
    if (!(sight.part < part_max))
        return;
    search->small_count++;
    search->light[y * p->width + x] += (float)(sight.part * find_greatest(search, emitter));
}

// Returns whether an emitter is one of many small parts of a larger emitter. The criterion is that
// the surrounding pixels have at least as much light as part_max pixels of this emitter's radiance.
static bool is_of_larger(const struct search *search, struct emitter_part emitter,
                         const struct sight *sight)
{
    const struct projection *p = &search->projection;
    double left = clamp_to(sight->at.x, p->width), top = clamp_to(sight->at.y, p->height);
    double light = 0;
    for (double y = fmax(top - 1, 0); y <= top + 1 && y < p->height; y++)
        for (double x = fmax(left - 1, 0); x <= left + 1 && x < p->width; x++)
            light += (double)search->light[(uint64_t)y * p->width + (uint64_t)x];
    return light >= part_max * find_greatest(search, emitter);
}

static void add_emitter(struct search *search, struct emitter_part emitter)
{
    const struct projection *p = &search->projection;
    struct sight sight;
    if (!find_sight(search, emitter, &sight) || !(sight.part < part_max) ||
        is_of_larger(search, emitter, &sight))
        return;
    if (sight.reach <= split_reach)
        split(search, &sight.at, sight.reach, sight.part, emitter);
    else
        add_part(search, clamp_to(sight.at.x, p->width), clamp_to(sight.at.y, p->height),
                 sight.part, sight.reach, emitter);
}

typedef void (*emitter_fn)(struct search *search, struct emitter_part emitter);

static bool emits(const struct search *search, uint32_t material)
{
    return material_emits(&search->renderer->scene->materials[material]);
}

static void visit_shape(struct search *search, uint32_t index, emitter_fn visit)
{
    if (search->renderer->flat.shapes[index].kind == SHAPE_PLANE)
        mark_all(search);
    else
        visit(search, (struct emitter_part){EMITTER_SHAPE, index});
}

static double greatest_of(const float texel[3])
{
    return (double)fmaxf(texel[0], fmaxf(texel[1], texel[2]));
}

// Returns the smallest power of two that exceeds the median of an image's texels.
static double find_median(const struct environment *environment, uint32_t count)
{
    enum { LEAST = -40, ORDERS = 160 };
    uint32_t counts[ORDERS] = {0}, below = 0;
    for (uint32_t i = 0; i < count; i++) {
        double texel = greatest_of(environment->texels[i]);
        int order = LEAST;
        if (texel > 0)
            frexp(texel, &order);
        counts[order < LEAST ? 0 : order - LEAST < ORDERS ? order - LEAST : ORDERS - 1]++;
    }
    int order = 0;
    while (order < ORDERS - 1 && (below += counts[order]) <= count / 2)
        order++;
    return ldexp(1, order + LEAST);
}

static void visit_texels(struct search *search, emitter_fn visit)
{
    const struct environment *environment = &search->renderer->scene->environment;
    uint32_t count = environment->present ? environment->width * environment->height : 0;
    double enough = count > 0 ? texel_excess * find_median(environment, count) : 0;
    for (uint32_t i = 0; i < count; i++)
        if (greatest_of(environment->texels[i]) > enough)
            visit(search, (struct emitter_part){EMITTER_TEXEL, i});
}

static void visit_emitters(struct search *search, emitter_fn visit)
{
    const struct scene *scene = search->renderer->scene;
    const struct flat_scene *flat = &search->renderer->flat;
    // Emissive meshes are never shared, so their triangles are all in world space.
    for (uint32_t i = 0; i < flat->world_triangle_count; i++)
        if (emits(search, flat->triangles[i].material))
            visit(search, (struct emitter_part){EMITTER_TRIANGLE, i});
    for (uint32_t i = 0; i < flat->shape_count; i++)
        if (emits(search, flat->shapes[i].material))
            visit_shape(search, i, visit);
    for (uint32_t i = 0; i < scene->light_count; i++)
        if (light_is_sun(&scene->lights[i]))
            visit(search, (struct emitter_part){EMITTER_SUN, i});
    visit_texels(search, visit);
}

// --- the candidates of one pixel -----------------------------------------------------------------

static int compare_numbers(uint64_t a, uint64_t b)
{
    return (a > b) - (a < b);
}

static int compare_candidates(const void *a, const void *b)
{
    const struct candidate *x = a, *y = b;
    int by_pixel = compare_numbers(x->pixel, y->pixel);
    int by_kind = compare_numbers(x->emitter.kind, y->emitter.kind);
    int by_index = compare_numbers(x->emitter.index, y->emitter.index);
    return by_pixel ? by_pixel : by_kind ? by_kind : by_index;
}

static int compare_pixels(const void *a, const void *b)
{
    const struct group *x = a, *y = b;
    return compare_numbers(x->pixel, y->pixel);
}

static int compare_brightness(const void *a, const void *b)
{
    const struct group *x = a, *y = b;
    return x->brightness != y->brightness
               ? (x->brightness < y->brightness) - (x->brightness > y->brightness)
               : compare_pixels(a, b);
}

// Represents a group by one light with the same total light. With the area of this light, the
// group's greatest radiance would give this total.
static void sum_up(const struct search *search, struct group *group)
{
    double light[3] = {0}, greatest = 0;
    for (size_t i = 0; i < group->count; i++) {
        const struct candidate *candidate = &search->candidates[group->first + i];
        double radiance[3], most = 0;
        emitter_radiance(search->renderer, candidate->emitter, radiance);
        for (int c = 0; c < 3; c++) {
            light[c] += (double)candidate->part * radiance[c];
            most = fmax(most, radiance[c]);
        }
        greatest = fmax(greatest, most);
        group->light.radius = fmaxf(group->light.radius, candidate->radius);
    }
    group->brightness = fmax(light[0], fmax(light[1], light[2]));
    double part = greatest > 0 ? group->brightness / greatest : 0;
    group->light.part = (float)part;
    for (int c = 0; c < 3; c++)
        group->light.radiance[c] = part > 0 ? (float)(light[c] / part) : 0;
}

static bool make_groups(struct search *search)
{
    uint32_t width = search->projection.width;
    qsort(search->candidates, search->count, sizeof *search->candidates, compare_candidates);
    search->groups = calloc(search->count, sizeof *search->groups);
    if (!search->groups)
        return false;
    for (size_t i = 0; i < search->count; i++) {
        uint64_t pixel = search->candidates[i].pixel;
        if (i == 0 || pixel != search->candidates[i - 1].pixel)
            search->groups[search->group_count++] = (struct group){
                .light = {.x = (uint32_t)(pixel % width), .y = (uint32_t)(pixel / width)},
                .pixel = pixel,
                .first = i};
        search->groups[search->group_count - 1].count++;
    }
    for (size_t i = 0; i < search->group_count; i++)
        sum_up(search, &search->groups[i]);
    return true;
}

// Keeps only the LIGHTS_MAX brightest groups.
static void choose_groups(struct search *search)
{
    size_t kept = 0;
    for (size_t i = 0; i < search->group_count; i++)
        if (search->groups[i].brightness > 0)
            search->groups[kept++] = search->groups[i];
    search->group_count = kept;
    if (kept <= LIGHTS_MAX)
        return;
    qsort(search->groups, kept, sizeof *search->groups, compare_brightness);
    search->group_count = LIGHTS_MAX;
    qsort(search->groups, LIGHTS_MAX, sizeof *search->groups, compare_pixels);
}

// --- occlusion -----------------------------------------------------------------------------------

// Returns the emitter of a probe: the probes of a group are distributed over its candidates.
static struct emitter_part emitter_of_probe(const struct search *search, const struct group *group,
                                            uint32_t probe, uint32_t probes)
{
    return search->candidates[group->first + probe * group->count / probes].emitter;
}

// Aims one of `probes` rays at a group, and returns the distance to the emitter, up to which the
// ray must be free; infinity for an infinitely far one.
static double aim_probe(const struct search *search, const struct group *group, uint32_t probe,
                        uint32_t probes, struct probe_ray *ray)
{
    const struct renderer *r = search->renderer;
    struct emitter_part emitter = emitter_of_probe(search, group, probe, probes);
    struct projected at;
    double place[3], length = INFINITY;
    emitter_center(r, emitter, place);
    project(search, emitter, place, &at);
    emitter_place(r, emitter, at.direction, probe, probes, place);
    project(search, emitter, place, &at);
    // The ray must be free up to the nearest possible point of the emitter, less the rounding error
    // of the ray.
    if (!emitter_is_far(emitter))
        length = at.distance * (1 - 0x1p-20) -
                 (emitter.kind == EMITTER_SHAPE ? emitter_radius(r, emitter) : 0);
    *ray = (struct probe_ray){0};
    for (int c = 0; c < 3; c++) {
        ray->origin[c] = (float)at.origin[c];
        ray->direction[c] = (float)at.direction[c];
    }
    return length;
}

// Returns whether a probe reached its emitter. A distance field fills only a part of its box, so
// its probe must have hit the field itself.
static bool is_free(const struct renderer *r, struct emitter_part emitter,
                    const struct probe_hit *hit, double length)
{
    if (emitter.kind == EMITTER_SHAPE && r->flat.shapes[emitter.index].kind == SHAPE_SDF)
        return hit->primitive == (PRIMITIVE_SHAPE | emitter.index);
    return hit->primitive == NO_PRIMITIVE || (double)hit->t >= length;
}

struct probes {
    struct probe_ray *rays;
    struct probe_hit *hits;
    double *lengths;
};

// Traces some of the probes, from number `first` on. All groups' probes are numbered consecutively,
// `each` for one group.
static bool probe_some(struct renderer *r, struct search *search, struct group **groups,
                       uint32_t first, uint32_t count, uint32_t each, const struct probes *probes,
                       struct err *err)
{
    bool complete;
    double ms;
    for (uint32_t i = 0; i < count; i++)
        probes->lengths[i] = aim_probe(search, groups[(first + i) / each], (first + i) % each, each,
                                       &probes->rays[i]);
    if (!ray_probe_trace(r, KERNEL_intersect_closest, probes->rays, count, probes->hits, &ms,
                         &complete, err))
        return false;
    for (uint32_t i = 0; i < count; i++) {
        struct group *group = groups[(first + i) / each];
        struct emitter_part emitter = emitter_of_probe(search, group, (first + i) % each, each);
        group->free += (double)is_free(r, emitter, &probes->hits[i], probes->lengths[i]) / each;
    }
    return true;
}

// Traces `each` probes for each of `count` groups.
static bool probe_all(struct renderer *r, struct search *search, struct group **groups,
                      size_t count, uint32_t each, struct err *err)
{
    struct arena scratch = {0};
    uint32_t all = (uint32_t)count * each;
    uint32_t batch = r->plan.wave_slots < RAYS_AT_ONCE ? r->plan.wave_slots : RAYS_AT_ONCE;
    const struct probes probes = {ARENA_NEW(&scratch, struct probe_ray, batch),
                                  ARENA_NEW(&scratch, struct probe_hit, batch),
                                  ARENA_NEW(&scratch, double, batch)};
    bool ok = (probes.rays && probes.hits && probes.lengths) ||
              err_memory(err, "rays", batch * sizeof *probes.rays);
    for (uint32_t first = 0; ok && first < all; first += batch) {
        uint32_t left = all - first;
        ok = probe_some(r, search, groups, first, left < batch ? left : batch, each, &probes, err);
    }
    arena_finish(&scratch);
    return ok;
}

// Traces few rays to each group first, and then many to the groups that no ray has reached, because
// a sun may be visible through a small gap between leaves.
static bool probe_twice(struct renderer *r, struct search *search, struct group **groups,
                        struct err *err)
{
    size_t hidden = 0;
    for (size_t i = 0; i < search->group_count; i++)
        groups[i] = &search->groups[i];
    if (!probe_all(r, search, groups, search->group_count,
                   search->group_count <= FEW_LIGHTS ? PROBES : PROBES_OF_MANY, err))
        return false;
    for (size_t i = 0; i < search->group_count; i++)
        if (!(search->groups[i].free > 0))
            groups[hidden++] = &search->groups[i];
    size_t each = RAYS_OF_HIDDEN / (hidden + 1);
    each = each < PROBES_OF_HIDDEN ? each : PROBES_OF_HIDDEN;
    return hidden == 0 || each == 0 || probe_all(r, search, groups, hidden, (uint32_t)each, err);
}

// If the device is lost, no rays can be traced: emitters that were not probed count as visible.
static bool probe_groups(struct renderer *r, struct search *search, struct err *err)
{
    struct group **groups = calloc(search->group_count + 1, sizeof *groups);
    bool ok = groups || err_memory(err, "emitters in view", search->group_count);
    ok = ok && probe_twice(r, search, groups, err);
    free(groups);
    if (!ok)
        return r->gpu->lost;
    for (size_t i = 0; i < search->group_count; i++)
        search->groups[i].light.part *= (float)search->groups[i].free;
    return true;
}

// --- entry point ---------------------------------------------------------------------------------

// Compacts the mask from the pixels of the whole picture to those of the film.
static void cut_mask(const struct renderer *r, uint8_t *mask)
{
    for (uint32_t y = 0; y < r->frame.height; y++)
        memmove(&mask[(size_t)y * r->frame.width],
                &mask[r->frame.window_first + (size_t)y * r->frame.picture_width], r->frame.width);
}

// Converts the pixel of an emitter from the picture to the film. Returns whether the film has it.
static bool is_in_film(const struct renderer *r, struct small_light *light)
{
    // Pixels left of the window or above it wrap around.
    light->x -= r->window.x;
    light->y -= r->window.y;
    return light->x < r->frame.width && light->y < r->frame.height;
}

static bool keep(struct renderer *r, struct search *search)
{
    struct in_view *in_view = &r->in_view;
    struct small_light *lights = malloc((search->group_count + 1) * sizeof *lights);
    if (!lights)
        return false;
    *in_view = (struct in_view){.is_known = true, .lights = lights, .mask = search->mask};
    search->mask = NULL;
    cut_mask(r, in_view->mask);
    for (size_t i = 0; i < search->group_count; i++)
        if (search->groups[i].light.part > 0 && is_in_film(r, &search->groups[i].light))
            lights[in_view->count++] = search->groups[i].light;
    return true;
}

static bool find(struct renderer *r, struct err *err)
{
    const uint32_t width = r->frame.picture_width, height = r->frame.picture_height;
    struct search search = {
        .renderer = r,
        .spread = fmax((double)r->frame.filter_radius - 0.5, 0),
        .mask = calloc(width, height),
        .light = calloc((size_t)width * height, sizeof(float)),
    };
    bool ok = search.mask && search.light;
    projection_make(&r->camera, &r->flat, width, height, &search.projection);
    if (ok && r->specialization.integrator != INTEGRATOR_AO) {
        visit_emitters(&search, count_emitter);
        visit_emitters(&search, add_emitter);
    }
    ok = ok && !search.failed && (search.count == 0 || make_groups(&search));
    if (ok)
        choose_groups(&search);
    else
        err_memory(err, "emitters in view", (uint64_t)width * height);
    ok = ok && probe_groups(r, &search, err) &&
         (keep(r, &search) || err_memory(err, "emitters in view", search.group_count));
    free(search.groups);
    free(search.candidates);
    free(search.light);
    free(search.mask);
    return ok;
}

bool renderer_find_unseen(struct renderer *r, struct arena *arena, struct unseen_light *out,
                          struct err *err)
{
    if (!r->in_view.is_known && !find(r, err))
        return false;
    const struct in_view *in_view = &r->in_view;
    uint64_t pixels = (uint64_t)r->frame.width * r->frame.height;
    struct small_light *lights = ARENA_NEW(arena, struct small_light, in_view->count + 1);
    uint8_t *mask = ARENA_NEW(arena, uint8_t, pixels);
    if (!lights || !mask)
        return err_memory(err, "emitters in view", pixels);
    memcpy(lights, in_view->lights, in_view->count * sizeof *lights);
    memcpy(mask, in_view->mask, pixels);
    *out = (struct unseen_light){
        .by_chance = (double)r->brightest_by_chance,
        .small = lights,
        .small_count = in_view->count,
        .emitter_in_view = mask,
    };
    return true;
}
