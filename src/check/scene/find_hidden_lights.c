// Finds lights that shadow rays do not reach although no opaque surface is in the way, and lights
// to which no shadow rays are sent.
#include "check/scene/survey.h"

#include "base/hash.h"
#include "base/maths.h"
#include "flatten/flatten_census.h"
#include "render/probe/emitter_shape.h"
#include "render/tables/emitter_power.h"
#include "render/tables/emitters.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "shared/types.h"

enum aim {
    AIM_AT_POINTS, // delta lights
    AIM_AT_LAMPS,  // emitters with an area
    AIM_AT_SKY,    // directions towards the environment's image
};

// A light, or a part of a lamp or of the environment, at which shadow rays are directed.
struct target {
    bool is_delta; // the target is one of the scene's delta lights
    // True if scattered paths find this target, a direction of the environment, about as often as
    // shadow rays do.
    bool is_common;
    uint32_t light;  // index of the light in the scene, or SCENE_NONE
    uint32_t source; // index in survey->is_reached
    // Power, as in emitter_power.h, of all surfaces that the target represents; 0 for texels.
    double power;
    double radiance; // mean luminance; INFINITY for delta lights
    double each;     // number of surfaces that the target represents
    struct emitter_part part;
};

struct targets {
    struct target *items;
    double *sums; // cumulative powers, each including that of its own target
    uint32_t count;
    uint32_t rare; // number of targets that are not common
};

// If a lamp's mesh has more triangles than this, a part of them represents all.
#define TRIANGLES_MAX 4096u

static void list_lights(const struct survey *survey, bool delta, struct targets *out)
{
    const struct scene *scene = survey->scene;
    for (uint32_t i = 0; i < scene->light_count; i++) {
        bool is_sun = light_is_sun(&scene->lights[i]);
        if (scene->lights[i].hidden || is_sun == delta ||
            !(luminance(scene->lights[i].radiant) > 0))
            continue;
        const struct light light = flat_light(survey->flat, &scene->lights[i]);
        double angle = 2.0 * M_PI * versine(light.angular_radius);
        out->items[out->count++] =
            (struct target){.is_delta = !is_sun,
                            .light = i,
                            .source = i,
                            .power = light_power(&light, survey->flat),
                            .radiance = is_sun ? luminance(light.radiant) / angle : INFINITY,
                            .each = 1.0,
                            .part = {EMITTER_SUN, i}};
    }
}

// Adds a surface of a lamp, which represents `each` surfaces.
static void add_surface(const struct survey *survey, enum emitter_kind kind, uint32_t index,
                        uint32_t material, double area, uint32_t each, struct targets *out)
{
    double radiance = mean_radiance(survey->scene, &survey->scene->materials[material]);
    out->items[out->count++] = (struct target){.light = SCENE_NONE,
                                               .source = survey_lamp_source(survey, material),
                                               .power = each * radiance * area,
                                               .radiance = radiance,
                                               .each = each,
                                               .part = {kind, index}};
}

static void list_lamps(const struct survey *survey, struct targets *out)
{
    const struct scene *scene = survey->scene;
    const struct flat_scene *flat = survey->flat;
    uint32_t emissive = 0, k = 0;
    for (uint32_t i = 0; i < flat->shape_count; i++)
        if (flatten_emits(scene, flat->shapes[i].material) &&
            shape_is_emitter(flat->shapes[i].kind))
            add_surface(survey, EMITTER_SHAPE, i, flat->shapes[i].material,
                        shape_area(&flat->shapes[i]), 1, out);
    for (uint32_t i = 0; i < flat->world_triangle_count; i++)
        emissive += flatten_emits(scene, flat->triangles[i].material);
    uint32_t every = emissive / TRIANGLES_MAX + 1;
    for (uint32_t i = 0; i < flat->world_triangle_count && emissive > 0; i++)
        if (flatten_emits(scene, flat->triangles[i].material) && k++ % every == 0)
            add_surface(survey, EMITTER_TRIANGLE, i, flat->triangles[i].material,
                        triangle_area(flat, i), every, out);
}

// The number of directions towards the environment. They are sampled in proportion to its radiance,
// as in the renderer's table. If the radiance is k times the mean, the table selects a direction k
// times as often as scattered paths do, and the variance of the light that these paths estimate is
// about k times the square of that light.
#define SKY_TARGETS 1000u
#define RARE_MIN 16.0

static void list_row(const struct survey *survey, uint32_t row, double mean, double *passed,
                     struct targets *out)
{
    const struct environment *sky = &survey->scene->environment;
    double part = environment_texel_solid_angle(sky, row) / (4.0 * M_PI);
    for (uint32_t i = row * sky->width; i < (row + 1) * sky->width; i++) {
        struct target target = {.source = survey_sky_source(survey), .part = {EMITTER_TEXEL, i}};
        double radiance[3];
        emitter_radiance(&survey->job.renderer, target.part, radiance);
        double brightness = vec3_luminance(radiance) / mean;
        target.is_common = brightness < RARE_MIN;
        *passed += part * brightness;
        while (out->count < SKY_TARGETS && (out->count + 0.5) / SKY_TARGETS < *passed)
            out->items[out->count++] = target;
    }
}

static void list_sky(const struct survey *survey, struct targets *out)
{
    const struct environment *sky = &survey->scene->environment;
    double mean = environment_luminance(sky), passed = 0.0;
    for (uint32_t row = 0; row < sky->height; row++)
        list_row(survey, row, mean, &passed, out);
}

static bool list_targets(struct survey *survey, enum aim aim, struct targets *out, struct err *err)
{
    const struct scene *scene = survey->scene;
    uint32_t most = scene->light_count + survey->flat->shape_count + TRIANGLES_MAX + SKY_TARGETS;
    double sum = 0.0;
    out->items = ARENA_NEW(&survey->scratch, struct target, most);
    out->sums = ARENA_NEW(&survey->scratch, double, most);
    if (!out->items || !out->sums)
        return err_memory(err, "lights", most * sizeof *out->items);
    if (aim != AIM_AT_SKY)
        list_lights(survey, aim == AIM_AT_POINTS, out);
    if (aim == AIM_AT_LAMPS)
        list_lamps(survey, out);
    if (aim == AIM_AT_SKY && emitters_count(scene, survey->flat).environment > 0)
        list_sky(survey, out);
    for (uint32_t i = 0; i < out->count; i++) {
        out->rare += !out->items[i].is_common;
        out->sums[i] = sum += out->items[i].power;
    }
    return true;
}

// --- lines to targets ----------------------------------------------------------------------------

static void aim_at(const struct survey *survey, const struct target *target, const double from[3],
                   uint32_t seed, struct sightline *line)
{
    const struct light *light = target->is_delta ? &survey->scene->lights[target->light] : NULL;
    double place[3], way[3], center[3];
    line->length = INFINITY;
    if (light && light->kind == LIGHT_DIRECTIONAL) {
        for (int c = 0; c < 3; c++)
            line->direction[c] = -light->direction[c];
        return;
    }
    if (light) {
        flat_from_world(survey->flat, light->position, place);
    } else {
        emitter_center(&survey->job.renderer, target->part, center);
        vec3_subtract(center, from, way);
        vec3_normalize(way);
        emitter_place(&survey->job.renderer, target->part, way, seed % 16, 16, place);
        if (emitter_is_far(target->part)) {
            for (int c = 0; c < 3; c++)
                line->direction[c] = place[c];
            return;
        }
    }
    vec3_subtract(place, from, way);
    line->length = vec3_length(way) * SIGHTLINE_SHORT_OF;
    vec3_normalize(way);
    for (int c = 0; c < 3; c++)
        line->direction[c] = way[c];
}

// --- choice of targets ---------------------------------------------------------------------------

// Returns the luminance that a lamp's surface causes at a place without occlusion, from the solid
// angle and the cosine of its centre. If the horizon crosses the lamp, half of the solid angle
// above the horizon is used.
static double sent_by_surface(const struct survey *survey, const struct target *target,
                              const struct sighting *at)
{
    const struct renderer *r = &survey->job.renderer;
    double center[3], way[3], side = at->is_front ? 1.0 : -1.0;
    emitter_center(r, target->part, center);
    vec3_subtract(center, at->point, way);
    double distance = vec3_length(way);
    if (!vec3_normalize(way))
        return 0.0;
    double angle = emitter_area(r, target->part, way) / (distance * distance);
    double cosine = side * vec3_dot(way, at->normal);
    double above = fmin(cosine + fmin(emitter_radius(r, target->part) / distance, 1.0), 1.0);
    return target->each * target->radiance * fmin(angle, 2.0 * M_PI) *
           fmax(fmax(cosine, 0.5 * above), 0.0);
}

static double sent_by(const struct survey *survey, const struct target *target,
                      const struct sighting *at)
{
    double place[3], towards[3] = {0}, side = at->is_front ? 1.0 : -1.0;
    if (target->light == SCENE_NONE)
        return sent_by_surface(survey, target, at);
    flat_to_world(survey->flat, at->point, place);
    double sent = light_sent(&survey->scene->lights[target->light], place, towards);
    return sent * fmax(side * vec3_dot(towards, at->normal), 0.0);
}

// Returns the target at which the cumulative power reaches the given fraction, in [0, 1), of the
// total.
static uint32_t target_at(const struct targets *targets, double part)
{
    double power = part * targets->sums[targets->count - 1];
    uint32_t low = 0, high = targets->count - 1;
    while (low < high) {
        uint32_t middle = low + (high - low) / 2;
        if (targets->sums[middle] > power)
            high = middle;
        else
            low = middle + 1;
    }
    return low;
}

// The greatest number of targets whose light at a place is computed. If there are more, candidates
// are sampled in proportion to their power.
#define ASKED_MOST 64u

// The targets that light a place. If they were sampled, the light of each is divided by the
// expected number of times that it is selected, so that `sum` estimates the light of all targets.
struct candidates {
    uint32_t numbers[ASKED_MOST], count; // indices of the targets
    double sent[ASKED_MOST], sum;
};

static void add_candidate(struct candidates *list, uint32_t number, double sent)
{
    if (!(sent > 0.0))
        return;
    bool is_again = list->count > 0 && list->numbers[list->count - 1] == number;
    uint32_t at = is_again ? list->count - 1 : list->count;
    list->numbers[at] = number;
    list->sent[at] = (is_again ? list->sent[at] : 0.0) + sent;
    list->count = at + 1;
    list->sum += sent;
}

static void list_candidates(const struct survey *survey, const struct sighting *at, double random,
                            const struct targets *targets, struct candidates *out)
{
    bool asks_all = targets->count <= ASKED_MOST;
    uint32_t asked = asks_all ? targets->count : ASKED_MOST;
    double total = targets->sums[targets->count - 1];
    *out = (struct candidates){0};
    for (uint32_t i = 0; i < asked; i++) {
        uint32_t number = asks_all ? i : target_at(targets, (i + random) / asked);
        const struct target *target = &targets->items[number];
        double density = asks_all ? 1.0 : asked * target->power / total;
        if (density > 0.0)
            add_candidate(out, number, sent_by(survey, target, at) / density);
    }
}

// Returns a pseudo-random number in [0, 1) that depends only on the arguments.
static double random_of(uint32_t pixel, uint32_t number)
{
    const uint32_t key[2] = {pixel, number};
    return (double)(hash_bytes(HASH_INIT, key, sizeof key) >> 11) * 0x1p-53;
}

// Returns the candidate of rank `rank` in weighted sampling without replacement, with the
// candidates' light as weights, or list->count if there are fewer (Efraimidis, Spirakis 2006,
// "Weighted random sampling with a reservoir", algorithm A: candidates are ordered by u^(1 /
// weight) with uniform random numbers u).
static uint32_t candidate_at(const struct candidates *list, uint32_t pixel, uint32_t rank)
{
    double keys[ASKED_MOST];
    uint32_t first = list->count;
    for (uint32_t i = 0; i < list->count; i++)
        keys[i] = log(1.0 - random_of(pixel, list->numbers[i])) / list->sent[i];
    for (uint32_t k = 0; k <= rank && k < list->count; k++) {
        first = 0;
        for (uint32_t i = 1; i < list->count; i++)
            if (keys[i] > keys[first])
                first = i;
        if (k < rank)
            keys[first] = -INFINITY;
    }
    return rank < list->count ? first : list->count;
}

// --- occlusion -----------------------------------------------------------------------------------

// The light that targets send to a place.
struct place {
    double sent;    // light of all targets, without occlusion
    double asked;   // light of the targets that were tested, without occlusion
    double arrived; // part of `asked` that no opaque surface blocks
    double hidden;  // part of `arrived` that comes through glass
    double squares; // sum over hidden light of the light times its radiance
    bool is_known;  // all targets that light the place were tested
    struct sighting glass;
};

// The light that a line to a target represents, and the index of the camera's line at whose end it
// starts.
struct aimed {
    const struct target *target;
    double sent;
    uint32_t from;
};

// Results of the lines to targets.
struct tally {
    uint32_t places; // number of places that can be lit, over all rounds
    uint32_t open;   // number of lines that no opaque surface blocks
    // For the environment: lines through glass to rare targets; otherwise: places with missing
    // light.
    uint32_t behind;
    double arrived, hidden; // sums of these members over all places
    struct sighting glass;  // glass in front of the first place in `touched`, or else of any place
    bool is_named;          // `glass` is in front of a place in `touched`
    uint8_t *touched;       // a flag for each place whose light is missing
    struct place *at;       // one for each of the camera's lines
};

// The number of lines from each place. In a room most of the environment is occluded, so that some
// of several lines should pass through a window. If there are more lamps than lines, a part of the
// lamps represents all.
#define ROUNDS 8u

// Selects a target for a line from a place, a different one in each round. Returns false if none is
// left. The targets in the environment have equal light, so one of them is selected uniformly.
static bool choose_target(const struct survey *survey, enum aim aim, const struct sighting *at,
                          uint32_t round, const struct targets *targets, struct place *place,
                          struct aimed *aimed)
{
    struct candidates list;
    if (aim == AIM_AT_SKY) {
        uint32_t number = (uint32_t)(random_of(aimed->from, round) * targets->count);
        aimed->target = &targets->items[number];
        return true;
    }
    list_candidates(survey, at, random_of(aimed->from, UINT32_MAX), targets, &list);
    uint32_t chosen = candidate_at(&list, aimed->from, round);
    place->sent = list.sum;
    place->is_known = targets->count <= ASKED_MOST && list.count <= ROUNDS;
    if (chosen == list.count)
        return false;
    aimed->target = &targets->items[list.numbers[chosen]];
    aimed->sent = list.sent[chosen];
    place->asked += aimed->sent;
    return true;
}

// Starts a line from a place to a target. Returns false if the target is behind the surface.
static bool begin_line(const struct survey *survey, const struct sighting *at, uint32_t round,
                       const struct aimed *aimed, struct sightline *line)
{
    *line = (struct sightline){.from = at};
    aim_at(survey, aimed->target, at->point, (uint32_t)(16.0 * random_of(round, aimed->from)),
           line);
    // Both sides of a surface reflect; the one that is visible counts.
    double side = at->is_front ? 1.0 : -1.0;
    return side * vec3_dot(line->direction, at->normal) > 0.0;
}

// Returns whether a line reaches its target, and sets *surfaces to the number of surfaces through
// which it passes. The target on a sphere is a point of the visible side, so the line may hit the
// lamp itself just before it.
static bool arrives(const struct survey *survey, const struct sightline *line, uint32_t *surfaces)
{
    *surfaces = line->is_open ? line->count : line->count - 1;
    return line->is_open ||
           material_emits(&survey->scene->materials[line->steps[*surfaces].material]);
}

static void note_line(const struct survey *survey, const struct sightline *line,
                      const struct aimed *aimed, struct tally *tally)
{
    struct place *place = &tally->at[aimed->from];
    uint32_t surfaces;
    tally->open += line->is_open;
    if (!arrives(survey, line, &surfaces))
        return;
    survey->is_reached[line->is_open ? aimed->target->source
                                     : survey_lamp_source(survey, line->steps[surfaces].material)] =
        true;
    place->arrived += aimed->sent;
    if (surfaces == 0 || aimed->target->is_common)
        return;
    if (place->hidden == 0.0)
        place->glass = tally->glass = line->steps[0];
    place->hidden += aimed->sent;
    place->squares += aimed->sent * aimed->target->radiance;
}

// Traces one line from each place that can be lit. `lines` must have room for survey->line_count
// entries, and `aimed` for one more.
static bool trace_round(struct survey *survey, enum aim aim, const struct targets *targets,
                        uint32_t round, struct sightline *lines, struct aimed *aimed,
                        struct tally *tally, struct err *err)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < survey->line_count; i++) {
        const struct sighting *at = sightline_lit_place(survey, &survey->lines[i]);
        tally->places += at != NULL;
        aimed[count] = (struct aimed){.sent = 1.0, .from = i};
        count += at &&
                 choose_target(survey, aim, at, round, targets, &tally->at[i], &aimed[count]) &&
                 begin_line(survey, at, round, &aimed[count], &lines[count]);
    }
    if (!sightlines_trace(survey, lines, count, err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        note_line(survey, &lines[i], &aimed[i], tally);
    return true;
}

static void touch(struct tally *tally, uint32_t place, uint32_t count)
{
    if (tally->at[place].hidden > 0.0 && !tally->is_named)
        tally->glass = tally->at[place].glass;
    tally->is_named |= tally->at[place].hidden > 0.0;
    tally->behind += count;
    tally->touched[place] = 1;
}

// If glass hides less than this fraction of the light on a white surface, no light is considered
// missing.
#define MISSED_MIN 0.01

// The light of lamps at a place, or its mean over several places, and the light of the pixel.
struct lamp_light {
    double arrived, hidden, squares, seen;
    uint32_t count;
};

static void add_light(const struct survey *survey, const struct tally *tally, uint32_t i,
                      struct lamp_light *sum)
{
    const struct place *place = &tally->at[i];
    if (!(place->asked > 0.0))
        return;
    double scale = place->sent / place->asked;
    sum->arrived += scale * place->arrived;
    sum->hidden += scale * place->hidden;
    sum->squares += scale * place->squares;
    sum->seen += M_PI * luminance(survey->job.film.mean[i]);
    sum->count++;
}

// If only a few of very many lamps are tested, a tested lamp behind glass seems to contribute much
// of the light. Then the places within this many pixels are evaluated together.
#define NEAR_PIXELS 4u

static struct lamp_light light_at(const struct survey *survey, const struct tally *tally,
                                  uint32_t i)
{
    uint32_t width = survey->job.renderer.frame.width, height = survey->job.renderer.frame.height;
    uint32_t reach = tally->at[i].is_known ? 0 : NEAR_PIXELS, column = i % width, row = i / width;
    struct lamp_light sum = {0};
    for (uint32_t y = row - (row < reach ? row : reach); y <= row + reach && y < height; y++)
        for (uint32_t x = column - (column < reach ? column : reach);
             x <= column + reach && x < width; x++)
            add_light(survey, tally, y * width + x, &sum);
    return sum;
}

// Counts the places at which light through glass is missing and few paths find it. A path that is
// scattered by the cosine finds the radiance L with the probability p; the variance of its estimate
// of all such light is about sum(p L^2).
static void count_places(const struct survey *survey, struct tally *tally)
{
    for (uint32_t i = 0; i < survey->line_count; i++) {
        const struct lamp_light sum = light_at(survey, tally, i);
        double light = fmax(sum.arrived, sum.seen);
        if (!(tally->at[i].arrived > 0.0))
            continue;
        tally->arrived += sum.arrived / sum.count;
        tally->hidden += sum.hidden / sum.count;
        if (sum.hidden > MISSED_MIN * (sum.hidden + sum.seen) &&
            M_PI * sum.squares * sum.count >= RARE_MIN * light * light)
            touch(tally, i, 1);
    }
}

static void count_lines(const struct survey *survey, struct tally *tally)
{
    for (uint32_t i = 0; i < survey->line_count; i++)
        if (tally->at[i].hidden > 0.0)
            touch(tally, i, (uint32_t)tally->at[i].hidden);
}

#define SKY_LINES_MIN 10u

// Computes the share of the image whose light is behind glass. For the environment it is a share of
// the lines that leave the scene.
static bool share_behind_glass(struct survey *survey, enum aim aim, const struct targets *targets,
                               double *share, struct tally *tally, struct err *err)
{
    uint32_t count = survey->line_count;
    struct sightline *lines = ARENA_NEW(&survey->scratch, struct sightline, count);
    struct aimed *aimed = ARENA_NEW(&survey->scratch, struct aimed, count + 1);
    *tally = (struct tally){.touched = survey_flags(survey),
                            .at = ARENA_NEW(&survey->scratch, struct place, count)};
    if (!lines || !aimed || !tally->touched || !tally->at)
        return err_memory(err, "lines to lights", count * sizeof *lines);
    for (uint32_t i = 0; i < ROUNDS; i++)
        if (!trace_round(survey, aim, targets, i, lines, aimed, tally, err))
            return false;
    (aim == AIM_AT_SKY ? count_lines : count_places)(survey, tally);
    *share = (double)tally->behind / count;
    if (aim == AIM_AT_SKY)
        *share = tally->behind < SKY_LINES_MIN ? 0.0
                                               : (double)tally->places * tally->behind /
                                                     ((double)tally->open * ROUNDS * count);
    return true;
}

// A smaller share of the image could be due to the shadow of a small object.
#define SHARE_MIN 0.01

// The texts of the finding for each kind of target.
static const struct words {
    const char *name;
    enum finding_level level;
    const char *consequence, *remedy;
} words_of[] = {
    [AIM_AT_POINTS] = {"light-lost", FINDING_WRONG,
                       "Only shadow rays find delta lights, and glass blocks shadow rays, so their "
                       "light is missing there.",
                       "Replace the lights by small spheres, or give them an angular diameter."},
    [AIM_AT_LAMPS] = {"light-by-chance", FINDING_SLOW,
                      "Glass blocks shadow rays, so only paths that hit these lamps by chance find "
                      "their light there.",
                      "Make the lamps larger, or remove the glass."},
    [AIM_AT_SKY] = {"light-by-chance", FINDING_SLOW,
                    "Glass blocks shadow rays, so only paths that have these directions by chance "
                    "find their light there.",
                    "Remove the glass, or use an environment with less contrast."},
};

static const char *describe_targets(struct survey *survey, enum aim aim,
                                    const struct targets *targets, const struct tally *tally)
{
    const char *plural = targets->count == 1 ? "" : "s";
    if (aim != AIM_AT_SKY)
        return arena_printf(
            survey->arena,
            "%u %s%s%s; glass blocks %.3g %% of the direct light from there on visible surfaces",
            targets->count, aim == AIM_AT_POINTS ? "delta light" : "lamp", plural,
            aim == AIM_AT_POINTS ? "" : " or parts of lamps",
            100.0 * tally->hidden / tally->arrived);
    return arena_printf(survey->arena,
                        "%.0f %% of the environment's light comes from directions at least %.0f "
                        "times as bright as its mean",
                        100.0 * targets->rare / targets->count, RARE_MIN);
}

static bool find_behind_glass(struct survey *survey, enum aim aim, struct err *err)
{
    const struct words *words = &words_of[aim];
    struct targets targets = {0};
    struct tally tally;
    double share;
    if (!list_targets(survey, aim, &targets, err))
        return false;
    // An environment image of low contrast is not tested. It is assumed to light the scene.
    survey->is_reached[survey_sky_source(survey)] |= aim == AIM_AT_SKY && targets.rare == 0;
    if (targets.rare == 0)
        return true;
    if (!share_behind_glass(survey, aim, &targets, &share, &tally, err))
        return false;
    if (share < SHARE_MIN)
        return true;
    const char *object = survey_object_name(survey, tally.glass.object);
    const char *material = survey_material_name(survey, tally.glass.material);
    return survey_add(survey,
                      &(struct scene_finding){
                          .name = words->name,
                          .level = words->level,
                          .place = object && material ? arena_printf(survey->arena, "behind %s, %s",
                                                                     object, material)
                                                      : NULL,
                          .figure = describe_targets(survey, aim, &targets, &tally),
                          .consequence = words->consequence,
                          .remedy = words->remedy,
                          .share = share,
                          .pixels = tally.touched,
                      },
                      err);
}

// --- lamps that get no shadow rays ---------------------------------------------------------------

static bool add_unaimed(struct survey *survey, const char *place, const char *figure,
                        const char *remedy, struct err *err)
{
    return survey_add(survey,
                      &(struct scene_finding){
                          .name = "lamp-unaimed",
                          .level = FINDING_SLOW,
                          .place = place,
                          .figure = figure,
                          .consequence = "Paths find this light by chance alone.",
                          .remedy = remedy,
                          .share = NAN,
                      },
                      err);
}

static bool find_unaimed(struct survey *survey, struct err *err)
{
    const struct scene *scene = survey->scene;
    const struct flat_scene *flat = survey->flat;
    for (uint32_t i = 0; i < flat->shape_count; i++) {
        const struct flat_shape *shape = &flat->shapes[i];
        uint32_t object = scene->instance_count + shape->source;
        if (!flatten_emits(scene, shape->material) || shape_is_emitter(shape->kind))
            continue;
        return add_unaimed(survey, survey_object_name(survey, object),
                           "an emitter of a kind to which no shadow rays are sent",
                           "Use a quad, a disc, a sphere or a mesh in its place.", err);
    }
    return true;
}

// Adds the finding for the setting nee = off, with which paths find all lamps by chance.
static bool add_unaimed_lamps(struct survey *survey, struct err *err)
{
    const struct emitter_counts counts = emitters_count(survey->scene, survey->flat);
    if (emitters_total(&counts) == 0 || survey->settings.max_bounces == 0)
        return true;
    return add_unaimed(survey, "setting nee, off", "no shadow rays are sent to any lamp",
                       "Leave the setting at its default.", err);
}

bool find_hidden_lights(struct survey *survey, struct err *err)
{
    const struct settings *settings = &survey->settings;
    if (settings_integrator(settings) != INTEGRATOR_PATH &&
        settings_integrator(settings) != INTEGRATOR_DIRECT)
        return true;
    if (!settings->nee)
        return add_unaimed_lamps(survey, err);
    survey->is_reached = ARENA_NEW(&survey->scratch, bool, survey_source_count(survey));
    survey->sky_floor = (double)survey->job.renderer.tables.emitters.environment_floor;
    if (!survey->is_reached)
        return err_memory(err, "lights", survey_source_count(survey));
    return find_behind_glass(survey, AIM_AT_POINTS, err) &&
           find_behind_glass(survey, AIM_AT_LAMPS, err) &&
           find_behind_glass(survey, AIM_AT_SKY, err) && find_unaimed(survey, err);
}
