// Finds materials that reflect all light, or more light than they receive. The latter is measured
// in a furnace: a sphere of the material in a constant environment of radiance 1 must not be
// brighter than 1.
#include "check/scene/survey.h"

#include "base/hash.h"
#include "base/maths.h"
#include "scene/core/texture_load.h"
#include "shared/material.h"
#include <string.h>

// --- materials that reflect all light ------------------------------------------------------------

// Returns whether more than half of the texture's texels leave all three channels of the base
// colour unchanged.
static bool keeps_white(const struct scene *scene, const struct texture *texture)
{
    const struct texture_image *image = &scene->images[texture->image];
    uint64_t count = (uint64_t)image->width * image->height, white = 0;
    for (uint64_t i = 0; i < count; i++) {
        float texel[4];
        bool keeps = true;
        texture_texel(image, i, texel);
        for (uint32_t p = PARAMETER_BASE_COLOR; p < PARAMETER_BASE_COLOR + 3; p++)
            keeps = keeps && (!texture_scales_parameter(texture, p) ||
                              texel[texture_channel(texture, p)] >= 1.0f);
        white += keeps;
    }
    return 2 * white > count;
}

static bool is_white(const struct survey *survey, uint32_t index)
{
    const struct scene *scene = survey->scene;
    const struct material *m = &scene->materials[index];
    bool is_diffuse =
        m->model == MATERIAL_LAMBERT ||
        (m->model == MATERIAL_PRINCIPLED && m->metallic < 1.0f && m->transmission < 1.0f);
    for (uint32_t c = 0; c < 3; c++)
        if (m->base_color[c] < 1.0f)
            return false;
    if (!is_diffuse || !survey->flat->material_used[index] || survey->flat->colors ||
        material_emits(m) || (m->flags & MATERIAL_UNLIT))
        return false;
    for (uint32_t i = 0; i < m->texture_count; i++)
        if (!keeps_white(scene, &scene->textures[m->first_texture + i]))
            return false;
    return true;
}

static bool meets_white(const struct survey *survey, const struct sighting *at, const void *context)
{
    (void)survey;
    return ((const bool *)context)[at->material];
}

// White objects that cover a smaller share of the image have little effect.
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
    const uint8_t *touched = count > 0 ? survey_touched(survey, meets_white, white) : NULL;
    double share = survey_share(survey, touched);
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
            .consequence = "Such surfaces absorb no light, so closed rooms need many bounces; real "
                           "surfaces absorb some.",
            .remedy = "Use a \"base_color\" of at most 0.9; white paint reflects about 0.8.",
            .share = share,
            .pixels = touched,
        },
        err);
}

// --- materials that gain light -------------------------------------------------------------------

#define FURNACE_SAMPLES 64u
#define FURNACE_CELL 16u    // side, in pixels, of the square in the image that shows one sphere
#define FURNACE_COLUMNS 16u // squares in a row of the image
#define FURNACE_RINGS 8u    // rings of equal area on a sphere, from the centre to the rim
#define FURNACE_MOST 256u   // materials that are measured in one image
// The distance between spheres along the viewing direction, so that none lights another one.
#define FURNACE_DEPTH 8.0
#define GAIN_MIN 0.01 // a smaller gain is not distinguished from noise

// Returns whether the material's model can gain energy. In all other models the ranges of the
// parameters exclude a gain.
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
    uint32_t sources[FURNACE_MOST]; // index of each sphere's material in the survey's scene
    uint32_t count;
};

// Returns the texture at whose brightest texel the material is measured: that of the base colour,
// else of the specular colour, else any other that scales a parameter; NULL if there is none.
static const struct texture *find_leading(const struct scene *scene, const struct material *m)
{
    static const uint32_t groups[] = {GROUP_BASE, GROUP_SPECULAR};
    if (m->texture_count == 0)
        return NULL;
    const struct texture *textures = &scene->textures[m->first_texture], *any = NULL;
    for (size_t g = 0; g < sizeof groups / sizeof *groups; g++)
        for (uint32_t i = 0; i < m->texture_count; i++)
            for (uint32_t c = 0; c < 3; c++)
                if (texture_scales_parameter(&textures[i], 4 * groups[g] + c))
                    return &textures[i];
    for (uint32_t i = 0; i < m->texture_count && !any; i++)
        any = texture_is_scale(&textures[i]) ? &textures[i] : NULL;
    return any;
}

// Finds the centre of the brightest texel, with coordinates in [0, 1]. Values above 1 count as 1.
static void find_brightest(const struct texture_image *image, double place[2])
{
    double most = -1.0;
    for (uint64_t i = 0; i < (uint64_t)image->width * image->height; i++) {
        float texel[4];
        double sum = 0.0;
        texture_texel(image, i, texel);
        for (int c = 0; c < 3; c++)
            sum += fmin((double)texel[c], 1.0);
        if (sum <= most)
            continue;
        most = sum;
        uint64_t column = i % image->width, row = i / image->width;
        place[0] = ((double)column + 0.5) / image->width;
        place[1] = ((double)row + 0.5) / image->height;
    }
}

static bool lies_alike(const struct texture *a, const struct texture *b)
{
    bool alike = !((a->flags ^ b->flags) & TEXTURE_UV1);
    for (int row = 0; row < 2; row++)
        for (int column = 0; column < 3; column++)
            alike = alike && a->transform[row][column] == b->transform[row][column];
    return alike;
}

// Adds an image of constant value: the value of `from` at `place`, or its mean if `place` is NULL.
static bool add_even_image(struct scene *scene, const struct texture_image *from,
                           const double *place, uint32_t *index, struct err *err)
{
    float(*texel)[4] = arena_alloc(&scene->arena, 1, sizeof *texel);
    struct texture_image *image = scene_add_image(scene, index);
    if (!texel || !image)
        return err_memory(err, "a furnace", 0);
    memcpy(*texel, from->mean, sizeof *texel);
    if (place)
        texture_texel(from,
                      (uint64_t)(place[1] * from->height) * from->width +
                          (uint64_t)(place[0] * from->width),
                      *texel);
    *image = (struct texture_image){
        .name = from->name,
        .width = 1,
        .height = 1,
        .texels = texel,
        .hash = hash_bytes(HASH_INIT, texel, sizeof *texel),
    };
    return true;
}

// Gives the sphere textures of constant value: the value of the source's texture where the leading
// texture is brightest, or its mean if it is mapped differently.
static bool add_textures(struct furnace *furnace, const struct scene *from,
                         const struct material *source, struct material *material, struct err *err)
{
    const struct texture *leading = find_leading(from, source);
    double place[2] = {0};
    material->texture_count = 0;
    if (!leading)
        return true;
    find_brightest(&from->images[leading->image], place);
    for (uint32_t i = 0; i < source->texture_count; i++) {
        const struct texture *texture = &from->textures[source->first_texture + i];
        struct texture even = {.flags = texture->flags};
        if (!texture_is_scale(texture) || texture_group(texture) == GROUP_EMISSION)
            continue;
        if (!add_even_image(&furnace->scene, &from->images[texture->image],
                            lies_alike(texture, leading) ? place : NULL, &even.image, err) ||
            !material_add_texture(&furnace->scene, material, &even, err))
            return false;
    }
    return true;
}

static void raise_color(float most[3], const float color[3])
{
    for (int c = 0; c < 3; c++)
        most[c] = fmaxf(most[c], color[c]);
}

static void raise_to_corners(float most[3], const struct flat_scene *flat, uint32_t triangle)
{
    for (int corner = 0; corner < 3; corner++)
        raise_color(most, flat->colors[triangle][corner]);
}

// Finds the greatest vertex colours with which each material is used; shapes have the colour 1. The
// scene must have vertex colours.
static bool list_colors(struct survey *survey, float (**out)[3], struct err *err)
{
    static const float white[3] = {1.0f, 1.0f, 1.0f};
    const struct flat_scene *flat = survey->flat;
    size_t count = survey->scene->material_count, meshes = flat->mesh_count;
    float(*most)[3] = arena_alloc(&survey->scratch, count + meshes, sizeof *most);
    if (!most)
        return err_memory(err, "colours", (count + meshes) * sizeof *most);
    float(*of_mesh)[3] = most + count;
    for (uint32_t i = 0; i < flat->world_triangle_count; i++)
        raise_to_corners(most[flat->triangles[i].material], flat, i);
    for (uint32_t m = 0; m < meshes; m++) {
        const struct flat_mesh *mesh = &flat->meshes[m];
        for (uint32_t k = 0; k < mesh->triangle_count; k++) {
            uint32_t i = mesh->first_triangle + k;
            raise_to_corners(of_mesh[m], flat, i);
            if (mesh->is_own_material_used)
                raise_to_corners(most[flat->triangles[i].material], flat, i);
        }
    }
    for (uint32_t i = 0; i < flat->placed_count; i++)
        if (flat->instances[i].material != SCENE_NONE)
            raise_color(most[flat->instances[i].material], of_mesh[flat->instances[i].mesh]);
    for (uint32_t i = 0; i < flat->shape_count; i++)
        raise_color(most[flat->shapes[i].material], white);
    *out = most;
    return true;
}

// Multiplies the spheres' colours by the greatest vertex colours of their materials.
static bool color_spheres(struct survey *survey, struct furnace *furnace, struct err *err)
{
    float(*most)[3];
    if (!survey->flat->colors)
        return true;
    if (!list_colors(survey, &most, err))
        return false;
    for (uint32_t i = 0; i < furnace->count; i++) {
        const struct shape *sphere = &furnace->scene.shapes[i];
        struct material *material = &furnace->scene.materials[sphere->material];
        for (int c = 0; c < 3; c++)
            material->base_color[c] *= most[furnace->sources[i]][c];
    }
    return true;
}

static bool add_sphere(struct furnace *furnace, const struct scene *from, uint32_t index,
                       struct err *err)
{
    const struct material *source = &from->materials[index];
    uint32_t number;
    struct material *material = scene_add_material(&furnace->scene, &number);
    struct shape *shape = scene_add_shape(&furnace->scene, NULL);
    if (!material || !shape)
        return err_memory(err, "a furnace", 0);
    *material = *source;
    if (!add_textures(furnace, from, source, material, err))
        return false;
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

// Adds spheres for as many materials from *next on as fit; sets *next to the first material that
// remains.
static bool build_furnace(struct survey *survey, uint32_t *next, struct furnace *furnace,
                          struct err *err)
{
    struct scene *scene = &furnace->scene;
    scene->path = survey->scene->path;
    for (; *next < survey->scene->material_count && furnace->count < FURNACE_MOST; ++*next)
        if (may_gain(survey, *next) && !add_sphere(furnace, survey->scene, *next, err))
            return false;
    if (!color_spheres(survey, furnace, err))
        return false;
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
    double most, noise; // reflectance of the brightest ring, and its standard error
    uint32_t ring;
};

// Returns the index of the ring, in the square of a sphere, that contains a pixel; FURNACE_RINGS if
// the pixel is outside of the sphere.
static uint32_t ring_of(uint32_t x, uint32_t y)
{
    double u = (x + 0.5) / (0.5 * FURNACE_CELL) - 1.0, v = (y + 0.5) / (0.5 * FURNACE_CELL) - 1.0;
    // Pixels at the rim also show the background, which is not brighter than 1.
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
    // The rings have equal areas, so their limits are equidistant in the squared sine of the angle
    // to the normal.
    double from = asin(sqrt((double)gain->ring / FURNACE_RINGS)) / DEGREE;
    double to = asin(sqrt((gain->ring + 1.0) / FURNACE_RINGS)) / DEGREE;
    const uint8_t *touched = survey_touched_by_material(survey, material);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "gains-light",
            .level = FINDING_WRONG,
            .place = survey_material_name(survey, material),
            .figure = arena_printf(survey->arena,
                                   "reflects %.3g times the light that it receives, at viewing "
                                   "angles from %.0f to %.0f degrees",
                                   gain->most, from, to),
            .consequence =
                "It reflects more light than it receives: surfaces near it are too bright, and "
                "in closed rooms the image does not converge.",
            .remedy = "Choose \"masking\": \"smith\" and \"diffuse\": \"coupled\", or lower "
                      "\"base_color\" and \"specular_color\".",
            .share = survey_share(survey, touched),
            .pixels = touched,
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

static bool find_gains(struct survey *survey, uint32_t *next, struct err *err)
{
    struct furnace furnace = {.scene = {.path = ""}};
    bool ok = build_furnace(survey, next, &furnace, err) &&
              (furnace.count == 0 || heat_furnace(survey, &furnace, err));
    scene_finish(&furnace.scene);
    return ok;
}

bool find_albedos(struct survey *survey, struct err *err)
{
    uint32_t next = 0;
    bool ok = find_white(survey, err);
    while (ok && next < survey->scene->material_count &&
           !progress_should_stop(survey->params->renderer.progress))
        ok = find_gains(survey, &next, err);
    return ok;
}
