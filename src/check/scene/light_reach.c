// Finds the part of the image that light from given places reaches, directly or by reflection.
#include "check/scene/survey.h"

#include "base/maths.h"
#include <string.h>

// The maximum number of surfaces along a path. Light that needs more of them is a small part of the
// total.
#define BOUNCES_MAX 4u
// The number of lines to places, per pixel and bounce.
#define ROUNDS 8u

// The current ends of the paths of a round, one for each line of the camera.
struct reach {
    struct sighting *at;
    bool *goes_on;
    struct sightline *lines; // has room for one line per path
    uint32_t *pixels;        // the pixels of `lines`
    uint8_t *flags;
};

static uint32_t bounces_of(const struct settings *settings)
{
    uint32_t most = settings->integrator == INTEGRATOR_AO       ? 0
                    : settings->integrator == INTEGRATOR_DIRECT ? 1
                                                                : BOUNCES_MAX;
    return settings->max_bounces < most ? settings->max_bounces : most;
}

static void begin_round(const struct survey *survey, struct reach *reach)
{
    for (uint32_t i = 0; i < survey->line_count; i++) {
        const struct sighting *at = sightline_lit_place(survey, &survey->lines[i]);
        reach->goes_on[i] = at && !reach->flags[i];
        if (reach->goes_on[i])
            reach->at[i] = *at;
    }
}

// Starts a line to a point just above a place, on the side from which the line comes, so that a
// surface that covers the place blocks it. Returns false if the start is in the plane of the
// place's surface or behind it.
static bool aim_at(const struct sighting *at, const struct sighting *place, struct sightline *line)
{
    double way[3], rounding = sighting_rounding(place->point);
    vec3_subtract(place->point, at->point, way);
    double height = -copysign(SIGHTING_HEIGHT * rounding, vec3_dot(way, place->normal));
    for (int c = 0; c < 3; c++)
        way[c] += height * place->normal[c];
    double above = vec3_dot(way, at->normal) * (at->is_front ? 1.0 : -1.0);
    *line = (struct sightline){.from = at, .length = vec3_length(way)};
    vec3_normalize(way);
    memcpy(line->direction, way, sizeof line->direction);
    return above > rounding + sighting_rounding(at->point);
}

// Flags the paths from whose ends one of the places is visible.
static bool connect(struct survey *survey, struct reach *reach, const struct sighting *places,
                    uint32_t place_count, uint32_t number, struct err *err)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < survey->line_count; i++) {
        const struct sighting *place = &places[(i + number) % place_count];
        reach->pixels[count] = i;
        count += reach->goes_on[i] && aim_at(&reach->at[i], place, &reach->lines[count]);
    }
    if (!sightlines_trace(survey, reach->lines, count, err))
        return false;
    for (uint32_t i = 0; i < count; i++)
        reach->flags[reach->pixels[i]] |= reach->lines[i].is_open;
    return true;
}

// Continues a path in a random direction to the next surface.
static bool scatter(struct survey *survey, struct reach *reach, uint32_t number, struct err *err)
{
    uint32_t count = 0;
    for (uint32_t i = 0; i < survey->line_count; i++) {
        const struct sighting *at = &reach->at[i];
        double outward[3];
        if (!reach->goes_on[i] || reach->flags[i])
            continue;
        for (int c = 0; c < 3; c++)
            outward[c] = at->is_front ? at->normal[c] : -at->normal[c];
        reach->lines[count] = (struct sightline){.from = at, .length = INFINITY};
        sighting_scatter(outward, i + survey->line_count * number, reach->lines[count].direction);
        reach->pixels[count++] = i;
    }
    if (!sightlines_trace(survey, reach->lines, count, err))
        return false;
    memset(reach->goes_on, 0, survey->line_count * sizeof *reach->goes_on);
    for (uint32_t i = 0; i < count; i++) {
        const struct sighting *at = sightline_lit_place(survey, &reach->lines[i]);
        reach->goes_on[reach->pixels[i]] = at != NULL;
        if (at)
            reach->at[reach->pixels[i]] = *at;
    }
    return true;
}

bool survey_lit_from(struct survey *survey, const struct sighting *places, uint32_t count,
                     uint8_t **flags, struct err *err)
{
    struct arena scratch = {0};
    uint32_t bounces = bounces_of(&survey->settings), lines = survey->line_count;
    struct reach reach = {
        .at = ARENA_NEW(&scratch, struct sighting, lines),
        .goes_on = ARENA_NEW(&scratch, bool, lines),
        .lines = ARENA_NEW(&scratch, struct sightline, lines),
        .pixels = ARENA_NEW(&scratch, uint32_t, (size_t)lines + 1),
        .flags = survey_flags(survey),
    };
    bool ok = reach.at && reach.goes_on && reach.lines && reach.pixels && reach.flags;
    if (!ok)
        err_memory(err, "lines to lamps", lines * sizeof *reach.lines);
    for (uint32_t round = 0; ok && round < ROUNDS && count > 0; round++) {
        begin_round(survey, &reach);
        for (uint32_t bounce = 0; ok && bounce < bounces; bounce++) {
            uint32_t number = round * BOUNCES_MAX + bounce;
            ok = connect(survey, &reach, places, count, number, err) &&
                 scatter(survey, &reach, number, err);
        }
    }
    *flags = reach.flags;
    arena_finish(&scratch);
    return ok;
}
