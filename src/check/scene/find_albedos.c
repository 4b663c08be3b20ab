// Materials that reflect all light, or more than all: the latter is measured in a furnace, where a
// sphere of the material lies in even light of radiance 1 and must not be brighter than that.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "shared/material.h"
#include <string.h>

// --- all -----------------------------------------------------------------------------------------

static bool is_white(const struct survey *survey, uint32_t index)
{
    const struct material *m = &survey->scene->materials[index];
    bool is_diffuse =
        m->model == MATERIAL_LAMBERT ||
        (m->model == MATERIAL_PRINCIPLED && m->metallic < 1.0f && m->transmission < 1.0f);
    for (uint32_t c = 0; c < 3; c++)
        if (m->base_color[c] < 1.0f ||
            scene_parameter_is_textured(survey->scene, m, PARAMETER_BASE_COLOR + c))
            return false;
    return is_diffuse && survey->flat->material_used[index] && !survey->flat->colors &&
           !material_emits(m) && !(m->flags & MATERIAL_UNLIT);
}

static bool meets_white(const struct survey *survey, const struct sighting *at, const void *context)
{
    (void)survey;
    return ((const bool *)context)[at->material];
}

// Small things that are white light little.
#define WHITE_SHARE_MIN 0.01

static bool find_white(struct survey *survey, struct err *err)
{
    uint32_t materials = survey->scene->material_count, count = 0, first = 0;
    bool *white = ARENA_NEW(&survey->scratch, bool, materials);
    if (!white)
        return err_memory(err, "materials", materials);
    for (uint32_t i = 0; i < materials; i++) {
        white[i] = is_white(survey, i);
        first = white[i] && count++ == 0 ? i : first;
    }
    double share = count > 0 ? survey_share(survey, meets_white, white) : 0.0;
    if (share < WHITE_SHARE_MIN)
        return true;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "albedo-1",
            .level = FINDING_REMARK,
            .place = survey_material_name(survey, first),
            .figure = arena_printf(survey->arena, "%u of %u materials reflect all light diffusely",
                                   count, materials),
            .consequence = "Between such surfaces light never fades: closed rooms need many "
                           "bounces, and no real surface does this.",
            .remedy = "Use a \"base_color\" of at most 0.9; white paint has 0.8.",
            .share = share,
        },
        err);
}

// --- more than all -------------------------------------------------------------------------------

#define FURNACE_SAMPLES 64u
#define FURNACE_CELL 16u    // pixels of a sphere's square
#define FURNACE_COLUMNS 16u // squares in a row
#define FURNACE_RINGS 8u    // of equal area, from the middle to the rim
#define FURNACE_MOST 256u   // materials
#define FURNACE_DEPTH                                                                              \
    8.0               // from one sphere to the next along the line of sight: none lights another
#define GAIN_MIN 0.01 // beyond the noise

// Models whose parameters may gain; of all others reflectance is bounded by their ranges.
static bool may_gain(const struct survey *survey, uint32_t index)
{
    const struct material *m = &survey->scene->materials[index];
    uint32_t model = material_shading_model(m);
    return survey->flat->material_used[index] && !(m->flags & MATERIAL_UNLIT) &&
           (model == MATERIAL_PRINCIPLED || model == MATERIAL_PHONG ||
            model == MATERIAL_BLINN_PHONG || model == MATERIAL_MICROFACET);
}

struct furnace {
    struct scene scene;
    uint32_t sources[FURNACE_MOST]; // materials of the survey's scene
    uint32_t count;
};

static bool add_sphere(struct furnace *furnace, const struct material *source, uint32_t index)
{
    uint32_t number;
    struct material *material = scene_add_material(&furnace->scene, &number);
    struct shape *shape = scene_add_shape(&furnace->scene, NULL);
    if (!material || !shape)
        return false;
    *material = *source;
    material->texture_count = 0;
    material->flags &= ~(uint32_t)(MATERIAL_ALPHA_MASK | MATERIAL_ALPHA_BLEND);
    memset(material->emission, 0, sizeof material->emission);
    memset(material->extinction, 0, sizeof material->extinction);
    *shape = (struct shape){
        .kind = SHAPE_SPHERE,
        .material = number,
        .radius = 0.5,
        .center = {furnace->count % FURNACE_COLUMNS + 0.5,
                   -(furnace->count / FURNACE_COLUMNS + 0.5), -FURNACE_DEPTH * furnace->count},
    };
    furnace->sources[furnace->count++] = index;
    return true;
}

static bool build_furnace(const struct survey *survey, struct furnace *furnace, struct err *err)
{
    struct scene *scene = &furnace->scene;
    scene->path = survey->scene->path;
    for (uint32_t i = 0; i < survey->scene->material_count && furnace->count < FURNACE_MOST; i++)
        if (may_gain(survey, i) && !add_sphere(furnace, &survey->scene->materials[i], i))
            return err_memory(err, "a furnace", 0);
    struct camera *camera = scene_add_camera(scene, NULL);
    if (!camera)
        return err_memory(err, "a furnace", 0);
    uint32_t rows = (furnace->count + FURNACE_COLUMNS - 1) / FURNACE_COLUMNS;
    *camera = (struct camera){
        .position = {0.5 * FURNACE_COLUMNS, -0.5 * rows, 2},
        .direction = {0, 0, -1},
        .up = {0, 1, 0},
        .kind = CAMERA_ORTHOGRAPHIC,
        .height = rows,
        .name = "",
    };
    scene->settings = settings_default();
    scene->settings.width = FURNACE_COLUMNS * FURNACE_CELL;
    scene->settings.height = rows * FURNACE_CELL;
    scene->settings.max_bounces = 64;
    scene->settings.spp = FURNACE_SAMPLES;
    scene->environment = (struct environment){.present = true, .radiance = {1, 1, 1}};
    return true;
}

struct gain {
    double most, noise; // of a ring's reflectance, and its standard error
    uint32_t ring;
};

// The ring of a sphere's square that a pixel is in; FURNACE_RINGS: none.
static uint32_t ring_of(uint32_t x, uint32_t y)
{
    double u = (x + 0.5) / (0.5 * FURNACE_CELL) - 1.0, v = (y + 0.5) / (0.5 * FURNACE_CELL) - 1.0;
    // Pixels at the rim see what is behind, too, which is no brighter than 1.
    double part = u * u + v * v;
    return part < 1.0 ? (uint32_t)(part * FURNACE_RINGS) : FURNACE_RINGS;
}

static struct gain gain_of(const struct film_image *film, uint32_t sphere)
{
    double sums[FURNACE_RINGS][3] = {{0}}, squares[FURNACE_RINGS][3] = {{0}};
    double counts[FURNACE_RINGS] = {0};
    uint32_t left = sphere % FURNACE_COLUMNS * FURNACE_CELL;
    uint32_t top = sphere / FURNACE_COLUMNS * FURNACE_CELL;
    for (uint32_t i = 0; i < FURNACE_CELL * FURNACE_CELL; i++) {
        uint32_t x = i % FURNACE_CELL, y = i / FURNACE_CELL, ring = ring_of(x, y);
        const float *mean = film->mean[(uint64_t)(top + y) * film->width + left + x];
        if (ring == FURNACE_RINGS)
            continue;
        counts[ring]++;
        for (int c = 0; c < 3; c++) {
            sums[ring][c] += (double)mean[c];
            squares[ring][c] += (double)mean[c] * (double)mean[c];
        }
    }
    struct gain gain = {0};
    for (uint32_t ring = 0; ring < FURNACE_RINGS; ring++)
        for (int c = 0; c < 3; c++) {
            double mean = sums[ring][c] / counts[ring];
            double variance = fmax(squares[ring][c] / counts[ring] - mean * mean, 0.0);
            if (mean > gain.most)
                gain = (struct gain){mean, sqrt(variance / (counts[ring] - 1.0)), ring};
        }
    return gain;
}

static bool add_gain(struct survey *survey, uint32_t material, const struct gain *gain,
                     struct err *err)
{
    // Rings have equal areas: sine squared of the angle from the normal.
    double from = asin(sqrt((double)gain->ring / FURNACE_RINGS)) / DEGREE;
    double to = asin(sqrt((gain->ring + 1.0) / FURNACE_RINGS)) / DEGREE;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "gains-light",
            .level = FINDING_WRONG,
            .place = survey_material_name(survey, material),
            .figure = arena_printf(survey->arena,
                                   "reflects %.3g of the light that falls on it, seen at %.0f to "
                                   "%.0f degrees",
                                   gain->most, from, to),
            .consequence = "It sends more light than it gets: surfaces near it are too bright, and "
                           "in closed rooms the picture has no limit.",
            .remedy = "Choose \"masking\": \"smith\" and \"diffuse\": \"coupled\", or lower "
                      "\"base_color\" and \"specular_color\".",
            .share = survey_share_of_material(survey, material),
        },
        err);
}

static bool heat_furnace(struct survey *survey, struct furnace *furnace, struct err *err)
{
    struct job job;
    struct arena arena = {0};
    struct film_image film;
    const struct job_params params = {
        .renderer = {.gpu = survey->params->renderer.gpu,
                     .progress = survey->params->renderer.progress},
        .scene = &furnace->scene,
        .progress = survey->params->renderer.progress,
    };
    if (!job_start(&params, &job, err))
        return false;
    bool ok = job_run(&job, err) && job_copy_film(&job, &arena, &film, err);
    for (uint32_t i = 0; ok && i < furnace->count; i++) {
        const struct gain gain = gain_of(&film, i);
        if (gain.most > 1.0 + GAIN_MIN + 4.0 * gain.noise)
            ok = add_gain(survey, furnace->sources[i], &gain, err);
    }
    arena_finish(&arena);
    job_finish(&job);
    return ok;
}

bool find_albedos(struct survey *survey, struct err *err)
{
    struct furnace furnace = {.scene = {.path = ""}};
    bool ok = find_white(survey, err) && build_furnace(survey, &furnace, err) &&
              (furnace.count == 0 || heat_furnace(survey, &furnace, err));
    scene_finish(&furnace.scene);
    return ok;
}
