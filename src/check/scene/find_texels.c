// Finds missing images, texels with invalid values, and single texels that are as bright as a sun.
#include "check/scene/survey.h"

#include "base/maths.h"
#include "scene/core/emission.h"
#include "scene/core/environment.h"
#include "scene/core/texture_load.h"
#include "shared/material.h"

#define HALF_MAX 65504.0f // the greatest finite number of half precision (IEEE 754-2008)

static bool is_sky(const struct survey *survey)
{
    return survey->scene->environment.present;
}

static const uint8_t *touched_by_sky(struct survey *survey)
{
    uint8_t *flags = survey_flags(survey);
    for (uint32_t i = 0; flags && i < survey->line_count; i++)
        flags[i] = survey->lines[i].is_open;
    return flags;
}

static bool reads_image(const struct survey *survey, const struct sighting *at, const void *context)
{
    const struct scene *scene = survey->scene;
    const struct material *material = &scene->materials[at->material];
    for (uint32_t i = 0; i < material->texture_count; i++)
        if (scene->textures[material->first_texture + i].image == *(const uint32_t *)context)
            return true;
    return false;
}

// Returns the channels of the image, as bits, that scale a parameter that is limited to 1, in a
// material that is used.
static uint32_t list_cut_channels(const struct survey *survey, uint32_t index)
{
    const struct scene *scene = survey->scene;
    uint32_t channels = 0;
    for (uint32_t m = 0; m < scene->material_count; m++) {
        const struct material *material = &scene->materials[m];
        for (uint32_t i = 0; survey->flat->material_used[m] && i < material->texture_count; i++) {
            const struct texture *texture = &scene->textures[material->first_texture + i];
            if (texture->image != index || texture_group(texture) == GROUP_EMISSION)
                continue;
            for (uint32_t p = 4 * texture_group(texture), c = 0; c < 4; c++)
                if (texture_scales_parameter(texture, p + c))
                    channels |= 1u << texture_channel(texture, p + c);
        }
    }
    return channels;
}

static uint64_t count_cut(const struct texture_image *image, uint32_t channels)
{
    uint64_t count = 0;
    for (uint64_t i = 0; i < (uint64_t)image->width * image->height; i++) {
        float texel[4];
        bool is_cut = false;
        texture_texel(image, i, texel);
        for (uint32_t c = 0; c < 4; c++)
            is_cut = is_cut || ((channels >> c & 1u) && texel[c] > 1.0f);
        count += is_cut;
    }
    return count;
}

static bool find_cut(struct survey *survey, uint32_t index, struct err *err)
{
    const struct texture_image *image = &survey->scene->images[index];
    uint64_t count =
        image->greatest > 1.0f ? count_cut(image, list_cut_channels(survey, index)) : 0;
    if (count == 0)
        return true;
    const uint8_t *touched = survey_touched(survey, reads_image, &index);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "texels-above-1",
            .level = FINDING_REMARK,
            .place = arena_printf(survey->arena, "image %s", image->name),
            .figure = arena_printf(survey->arena, "%llu of %llu texels are above 1, up to %.3g",
                                   (unsigned long long)count,
                                   (unsigned long long)image->width * image->height,
                                   (double)image->greatest),
            .consequence =
                "They count as 1, because the parameters that they scale must stay in their range.",
            .remedy = "Scale the image to [0, 1], and use \"emission\" for light.",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

static bool find_zeroed(struct survey *survey, uint32_t index, struct err *err)
{
    const struct texture_image *image = &survey->scene->images[index];
    if (image->zeroed == 0)
        return true;
    const uint8_t *touched = survey_touched(survey, reads_image, &index);
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "texels",
            .level = FINDING_WRONG,
            .place = arena_printf(survey->arena, "image %s", image->name),
            .figure = arena_printf(survey->arena, "%llu of %llu texels are negative or not finite",
                                   (unsigned long long)image->zeroed,
                                   (unsigned long long)image->width * image->height),
            .consequence = "They count as black.",
            .remedy = "Repair the image in the program that made it.",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

// Returns whether a material in use has the image as a normal map.
static bool is_normal_map(const struct survey *survey, uint32_t index)
{
    const struct scene *scene = survey->scene;
    for (uint32_t m = 0; m < scene->material_count; m++) {
        const struct material *material = &scene->materials[m];
        for (uint32_t i = 0; survey->flat->material_used[m] && i < material->texture_count; i++) {
            const struct texture *texture = &scene->textures[material->first_texture + i];
            if (texture->image == index &&
                (texture->flags >> TEXTURE_USE_SHIFT & 3u) == TEXTURE_USE_NORMAL)
                return true;
        }
    }
    return false;
}

// Counts texels that are normals (with a length of about 1) and point below the surface by more
// than a step of 8 bits. Black texels between the parts of an atlas are not normals.
static uint64_t count_below(const struct texture_image *image)
{
    uint64_t count = 0;
    for (uint64_t i = 0; i < (uint64_t)image->width * image->height; i++) {
        float texel[4];
        double square = 0.0;
        texture_texel(image, i, texel);
        for (int c = 0; c < 3; c++)
            square += (2.0 * (double)texel[c] - 1.0) * (2.0 * (double)texel[c] - 1.0);
        count += texel[2] < 0.5f - 1.0f / 255.0f && fabs(square - 1.0) < 0.5;
    }
    return count;
}

// If a smaller share of the texels or of the image is affected, the texels are probably at seams.
#define BELOW_MIN 0.01

static bool find_below(struct survey *survey, uint32_t index, struct err *err)
{
    const struct texture_image *image = &survey->scene->images[index];
    uint64_t all = (uint64_t)image->width * image->height;
    uint64_t count = is_normal_map(survey, index) ? count_below(image) : 0;
    if (!((double)count >= BELOW_MIN * (double)all) || count == 0)
        return true;
    const uint8_t *touched = survey_touched(survey, reads_image, &index);
    double share = survey_share(survey, touched);
    if (share < BELOW_MIN)
        return true;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "normals",
            .level = FINDING_REMARK,
            .place = arena_printf(survey->arena, "image %s", image->name),
            .figure = arena_printf(survey->arena,
                                   "%llu of %llu texels of a normal map point below the surface",
                                   (unsigned long long)count, (unsigned long long)all),
            .consequence = "They are turned to the visible side, which changes the relief.",
            .remedy = "Use a map in tangent space, whose blue channel is above 0.5.",
            .share = share,
            .pixels = touched,
        },
        err);
}

static bool is_missing(const struct survey *survey, const struct sighting *at, const void *context)
{
    (void)context;
    return material_is_missing(&survey->scene->materials[at->material]);
}

// Reports the images that were missing; the loader has already removed them from the materials.
static bool find_missing(struct survey *survey, struct err *err)
{
    const struct scene *scene = survey->scene;
    uint32_t first = 0;
    if (scene->missing_image_count == 0)
        return true;
    while (!scene->images[first].is_missing)
        first++;
    const uint8_t *touched = survey_touched(survey, is_missing, NULL);
    return survey_add(survey,
                      &(struct scene_finding){
                          .name = "missing-image",
                          .level = FINDING_WRONG,
                          .place = scene->images[first].name,
                          .figure = arena_printf(survey->arena, "%u of %u images are missing",
                                                 scene->missing_image_count, scene->image_count),
                          .consequence = "The surfaces that use them are pink.",
                          .remedy = "Put the files where the scene names them.",
                          .share = survey_share(survey, touched),
                          .pixels = touched,
                      },
                      err);
}

// --- the environment -----------------------------------------------------------------------------

static const char *sky_place(const struct survey *survey)
{
    const char *file = survey->scene->environment.file;
    return file ? arena_printf(survey->arena, "environment %s", file) : "the environment";
}

static bool find_unusable(struct survey *survey, struct err *err)
{
    const struct environment *sky = &survey->scene->environment;
    if (sky->zeroed == 0)
        return true;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "texels",
            .level = FINDING_WRONG,
            .place = sky_place(survey),
            .figure = arena_printf(survey->arena, "%llu of %llu texels are negative or not finite",
                                   (unsigned long long)sky->zeroed,
                                   (unsigned long long)sky->width * sky->height),
            .consequence = "They count as black; if a sun has overflowed half precision, its light "
                           "is missing.",
            .remedy =
                "Repair the image in the program that made it, or store it in single precision.",
            .share = 1.0,
        },
        err);
}

// The texel that emits most, and the light of all texels.
struct sun_texel {
    uint32_t column, row;
    double light, all;
};

static struct sun_texel brightest_texel(const struct environment *sky)
{
    struct sun_texel brightest = {0};
    for (uint32_t row = 0; row < sky->height; row++) {
        double solid_angle = environment_texel_solid_angle(sky, row);
        for (uint32_t column = 0; column < sky->width; column++) {
            double light = solid_angle * luminance(sky->texels[(size_t)row * sky->width + column]);
            brightest.all += light;
            if (light <= brightest.light)
                continue;
            brightest.light = light;
            brightest.column = column;
            brightest.row = row;
        }
    }
    return brightest;
}

// A texel is reported as a sun if it emits at least this share of all light and is at least this
// many times as bright as the mean of the others. The form of such a texel is visible in shadows.
#define SUN_PART_MIN 0.1
#define SUN_BRIGHTNESS_MIN 100.0
// In an image with fewer texels, no texel counts as small.
#define TEXELS_MIN 64

static bool find_sun_texel(struct survey *survey, struct err *err)
{
    const struct environment *sky = &survey->scene->environment;
    bool is_dark = fmaxf(fmaxf(sky->radiance[0], sky->radiance[1]), sky->radiance[2]) <= 0.0f;
    if (is_dark || sky->width == 0 || (uint64_t)sky->width * sky->height < TEXELS_MIN)
        return true;
    const struct sun_texel sun = brightest_texel(sky);
    double solid_angle = environment_texel_solid_angle(sky, sun.row);
    double part = sun.light / sun.all;
    double rest = (sun.all - sun.light) / (4.0 * M_PI - solid_angle);
    if (!(part >= SUN_PART_MIN) || !(sun.light / solid_angle >= SUN_BRIGHTNESS_MIN * rest))
        return true;
    double size = sqrt(solid_angle) * 180.0 / M_PI;
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "one-texel-sun",
            .level = FINDING_SLOW,
            .place = sky_place(survey),
            .figure = arena_printf(survey->arena,
                                   "texel (%u, %u), %.2g degrees wide, emits %.0f %% of all light",
                                   sun.column, sun.row, size, 100.0 * part),
            .consequence = "Shadows are as soft as those of a light of the texel's width, not of "
                           "the sun (0.53 degrees), and paths by gloss and glass hit it by chance.",
            .remedy = "Paint over it and add a directional light with an angular diameter, or use "
                      "a larger image.",
            .share = 1.0,
        },
        err);
}

static bool add_overflow(struct survey *survey, const char *place, double greatest,
                         const uint8_t *touched, struct err *err)
{
    return survey_add(
        survey,
        &(struct scene_finding){
            .name = "beyond-half",
            .level = FINDING_REMARK,
            .place = place,
            .figure = arena_printf(survey->arena, "radiance of up to %.3g", greatest),
            .consequence =
                "Pictures written with --half cannot represent it: their greatest value is 65504.",
            .remedy = "Write EXR files in single precision, which is the default.",
            .share = survey_share(survey, touched),
            .pixels = touched,
        },
        err);
}

static bool find_overflow(struct survey *survey, struct err *err)
{
    const struct environment *sky = &survey->scene->environment;
    const uint8_t *touched = touched_by_sky(survey);
    float greatest = sky->width > 0 ? environment_greatest(sky) : 0.0f;
    return greatest <= HALF_MAX || survey_share(survey, touched) == 0.0 ||
           add_overflow(survey, sky_place(survey), (double)greatest, touched, err);
}

// --- images of lamps -----------------------------------------------------------------------------

// Returns the texture with which material m emits the image, if it is in use; otherwise NULL.
static const struct texture *find_emission(const struct survey *survey, uint32_t m, uint32_t image)
{
    const struct scene *scene = survey->scene;
    const struct material *material = &scene->materials[m];
    for (uint32_t i = 0; survey->flat->material_used[m] && i < material->texture_count; i++) {
        const struct texture *texture = &scene->textures[material->first_texture + i];
        if (texture->image == image && texture_is_scale(texture) &&
            texture_group(texture) == GROUP_EMISSION && material_emits(material))
            return texture;
    }
    return NULL;
}

static bool find_lamp_overflow(struct survey *survey, uint32_t m, uint32_t index, struct err *err)
{
    float greatest[3];
    greatest_radiance(survey->scene, &survey->scene->materials[m], greatest);
    float radiance = fmaxf(fmaxf(greatest[0], greatest[1]), greatest[2]);
    const uint8_t *touched = radiance > HALF_MAX ? survey_touched_by_material(survey, m) : NULL;
    const char *place = arena_printf(survey->arena, "image %s", survey->scene->images[index].name);
    return survey_share(survey, touched) == 0.0 ||
           add_overflow(survey, place, (double)radiance, touched, err);
}

// Finds the texel that emits most, assuming that all texels cover equal areas. Its row is counted
// from the top.
static struct sun_texel brightest_lamp_texel(const struct texture_image *image,
                                             const struct texture *texture, const float emission[3])
{
    struct sun_texel brightest = {0};
    for (uint64_t i = 0; i < (uint64_t)image->width * image->height; i++) {
        float texel[4], sent[3];
        texture_texel(image, i, texel);
        for (uint32_t c = 0; c < 3; c++) {
            uint32_t parameter = PARAMETER_EMISSION + c;
            bool is_scaled = texture_scales_parameter(texture, parameter);
            sent[c] = emission[c] * (is_scaled ? texel[texture_channel(texture, parameter)] : 1.0f);
        }
        double light = luminance(sent);
        brightest.all += light;
        if (light <= brightest.light)
            continue;
        brightest.light = light;
        brightest.column = (uint32_t)(i % image->width);
        brightest.row = (uint32_t)(i / image->width);
    }
    return brightest;
}

// The number of points on the lamp from which the lit region is determined.
#define PLACES 64u

static bool find_lamp_texel(struct survey *survey, uint32_t m, const struct texture *texture,
                            struct err *err)
{
    const struct scene *scene = survey->scene;
    const struct texture_image *image = &scene->images[texture->image];
    double texels = (double)image->width * image->height;
    uint8_t *lit;
    // An image with values in [0, 1], such as the image of a display or of indicator lights, has
    // little contrast.
    if (texels < TEXELS_MIN || image->greatest <= 1.0f)
        return true;
    const struct sun_texel sun = brightest_lamp_texel(image, texture, scene->materials[m].emission);
    double part = sun.light / sun.all, rest = (sun.all - sun.light) / (texels - 1.0);
    if (!(part >= SUN_PART_MIN) || !(sun.light >= SUN_BRIGHTNESS_MIN * rest))
        return true;
    struct sightline *lines = ARENA_NEW(&survey->scratch, struct sightline, PLACES);
    struct sighting *places = ARENA_NEW(&survey->scratch, struct sighting, PLACES);
    if (!lines || !places)
        return err_memory(err, "places on lamps", PLACES * sizeof *lines);
    uint32_t count = lamp_places_take(survey, m, PLACES, lines);
    for (uint32_t i = 0; i < count; i++)
        places[i] = lines[i].steps[0];
    if (!survey_lit_from(survey, places, count, &lit, err))
        return false;
    return survey_share(survey, lit) == 0.0 ||
           survey_add(survey,
                      &(struct scene_finding){
                          .name = "one-texel-lamp",
                          .level = FINDING_SLOW,
                          .place = arena_printf(survey->arena, "image %s", image->name),
                          .figure = arena_printf(
                              survey->arena,
                              "texel (%u, %u) of %u x %u emits %.0f %% of the image's light",
                              sun.column, sun.row, image->width, image->height, 100.0 * part),
                          .consequence = "Shadow rays sample the lamp uniformly and seldom hit its "
                                         "bright part: isolated bright pixels appear late.",
                          .remedy = "Paint over it, or replace it by a separate lamp.",
                          .share = survey_share(survey, lit),
                          .pixels = lit,
                      },
                      err);
}

// The first material that emits the image represents all materials that do.
static bool find_lamp_texels(struct survey *survey, uint32_t index, struct err *err)
{
    for (uint32_t m = 0; m < survey->scene->material_count; m++) {
        const struct texture *texture = find_emission(survey, m, index);
        if (texture)
            return find_lamp_overflow(survey, m, index, err) &&
                   find_lamp_texel(survey, m, texture, err);
    }
    return true;
}

bool find_texels(struct survey *survey, struct err *err)
{
    if (!find_missing(survey, err))
        return false;
    for (uint32_t i = 0; i < survey->scene->image_count; i++)
        if (!find_zeroed(survey, i, err) || !find_cut(survey, i, err) ||
            !find_below(survey, i, err) || !find_lamp_texels(survey, i, err))
            return false;
    return !is_sky(survey) || (find_unusable(survey, err) && find_sun_texel(survey, err) &&
                               find_overflow(survey, err));
}
