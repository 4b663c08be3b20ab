// The difference images of `lampyris compare`.
#include "cli/compare/compare.h"

#include "base/file.h"
#include "report/color_scale.h"
#include <math.h>

static bool is_flip(enum error_map map)
{
    return map == ERROR_MAP_FLIP || map == ERROR_MAP_HDR_FLIP;
}

const char *compare_map_words(enum error_map map)
{
    static const char *const words[ERROR_MAP_TOTAL] = {
        [ERROR_MAP_RELATIVE] = "|x - r| / (|r| + 0.01)",
        [ERROR_MAP_SQUARED] = "(x - r)^2 / (r^2 + 0.01)",
        [ERROR_MAP_SMAPE] = "2 |x - r| / (|x| + |r| + 1e-6)",
        [ERROR_MAP_FLIP] = "FLIP of display values",
        [ERROR_MAP_HDR_FLIP] = "the greatest FLIP over the exposures",
    };
    return words[map];
}

// Computes three numbers per pixel, which are equal if the map has only one; NaN if there is no
// value.
static void fill_values(enum error_map map, const struct picture_pair *pair, const float *flip,
                        float (*out)[3])
{
    uint64_t count = (uint64_t)pair->width * pair->height;
    enum error_map finite = is_flip(map) ? ERROR_MAP_RELATIVE : map;
    error_map_values(finite, pair->image, pair->reference, count, out);
    for (uint64_t i = 0; i < count && is_flip(map); i++)
        for (int c = 0; c < 3; c++)
            out[i][c] = isnan(out[i][c]) ? out[i][c] : flip[i];
}

static bool write_numbers(const struct image_write_params *params, enum error_map map,
                          const struct image *values, struct err *err)
{
    static const char *const colors[] = {"R", "G", "B", NULL};
    static const char *const one[] = {"Y", NULL};
    struct image none = {values->width, values->height, NULL};
    struct image_layer layer = {.name = error_map_names[map],
                                .values = values->pixels,
                                .channels = colors,
                                .type = IMAGE_LAYER_FULL};
    if (is_flip(map)) {
        // This map has one number per pixel, so the numbers are moved to the front of the array.
        float *plane = &values->pixels[0][0];
        for (uint64_t i = 0; i < (uint64_t)values->width * values->height; i++)
            plane[i] = values->pixels[i][0];
        layer.channels = one;
    }
    struct image_write_params numbers = *params;
    numbers.image = &none;
    numbers.layers = &layer;
    numbers.layer_count = 1;
    return image_write(&numbers, err);
}

// Writes false colours. They are display values, but the image must have linear values.
static bool write_colors(const struct image_write_params *params, enum error_map map,
                         const struct image *values, struct arena *arena, struct err *err)
{
    uint64_t count = (uint64_t)values->width * values->height;
    struct image picture;
    error_map_picture(map, (const float(*)[3])values->pixels, count, values->pixels);
    if (!color_scale_append(map, values, arena, &picture))
        return err_memory(err, "the difference picture", count * sizeof *picture.pixels);
    for (uint64_t i = 0; i < (uint64_t)picture.width * picture.height; i++)
        for (int k = 0; k < 3; k++)
            picture.pixels[i][k] = image_srgb_to_linear(picture.pixels[i][k]);
    struct image_write_params colors = *params;
    colors.image = &picture;
    return image_write(&colors, err);
}

bool compare_write_map(const struct comparison *c, const struct compared *picture,
                       const struct picture_pair *pair, const float *flip, struct arena *arena,
                       struct err *err)
{
    enum error_map map = c->options->compare.map;
    struct image values = {.width = pair->width, .height = pair->height};
    uint64_t count = (uint64_t)pair->width * pair->height;
    values.pixels = arena_alloc(arena, count, sizeof *values.pixels);
    if (!values.pixels)
        return err_memory(err, "the difference picture", count * sizeof *values.pixels);
    fill_values(map, pair, flip, values.pixels);
    const struct image_attribute attributes[] = {
        {"lampyris:map", compare_map_words(map)},
        {"lampyris:image", picture->path},
        {"lampyris:reference", c->reference_path},
    };
    struct image_write_params params = {.path = picture->map,
                                        .attributes = attributes,
                                        .attribute_count = sizeof attributes / sizeof *attributes};
    return path_has_extension(picture->map, "exr")
               ? write_numbers(&params, map, &values, err)
               : write_colors(&params, map, &values, arena, err);
}
