// Images that are written as files beside a report.
#include "report/html.h"

#include "metrics/metrics.h"
#include <math.h>

// Reduces false colours, which are display values, to few colours and converts them to linear
// values.
static void linearize(struct image *image)
{
    const float steps = 16; // number of steps of each component
    uint64_t count = (uint64_t)image->width * image->height;
    for (uint64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            image->pixels[i][k] = image_srgb_to_linear(roundf(image->pixels[i][k] * steps) / steps);
}

bool html_keep_difference(struct html_page *page, const char *name, const struct image *image,
                          const struct image *reference, struct err *err)
{
    uint64_t count = (uint64_t)image->width * image->height;
    if (!page->keeps_parts)
        return true;
    struct image map = {image->width, image->height,
                        arena_alloc(page->arena, count, sizeof *map.pixels)};
    if (!map.pixels)
        return err_memory(err, "an error map", count * sizeof *map.pixels);
    metrics_difference_picture((const float(*)[3])image->pixels,
                               (const float(*)[3])reference->pixels, count, map.pixels);
    linearize(&map);
    struct html_page plain = *page;
    page->exposure_stops = 0;
    page->tone = TONE_NONE;
    bool ok = html_keep_picture(page, name, &map, err);
    page->exposure_stops = plain.exposure_stops;
    page->tone = plain.tone;
    return ok;
}
