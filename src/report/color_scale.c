#include "report/color_scale.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

// Sizes in units of the scale. A unit is 1 pixel for images up to 511 pixels wide, 2 pixels up to
// 767, 3 pixels up to 1023, and 4 pixels for wider images.
enum { GAP = 4, BAR = 8, TICK = 2, GLYPH_ROWS = 5, GLYPH_ADVANCE = 4, MARGIN = 10 };
enum { STRIP = GAP + BAR + TICK + 1 + GLYPH_ROWS + GAP, LEAST_WIDTH = 160, UNIT_MAX = 4 };

static const float background[3] = {0.2f, 0.2f, 0.2f}, ink[3] = {0.9f, 0.9f, 0.9f};

struct canvas {
    struct image *image;
    uint32_t top, unit; // y of the strip below the image, and pixels per unit
};

// Fills a rectangle of the strip. x and width are in pixels; y and height are in units from the
// strip's top.
static void fill(const struct canvas *c, uint32_t x, uint32_t width, uint32_t y, uint32_t height,
                 const float color[3])
{
    for (uint32_t j = 0; j < height * c->unit; j++)
        for (uint32_t i = x; i < x + width && i < c->image->width; i++) {
            uint64_t row = c->top + y * c->unit + j;
            memcpy(c->image->pixels[row * c->image->width + i], color, 3 * sizeof *color);
        }
}

// Returns the rows of a glyph from the top, each as an octal digit whose three bits are pixels.
static uint32_t glyph(char letter)
{
    static const char letters[] = "0123456789e-.";
    static const uint32_t rows[] = {075557, 026227, 071747, 071717, 055711, 074717, 074757,
                                    071111, 075757, 075717, 035743, 000700, 000002};
    const char *found = strchr(letters, letter);
    return found && *found ? rows[found - letters] : 0;
}

static void write_centred(const struct canvas *c, uint32_t x, const char *text)
{
    uint32_t width = ((uint32_t)strlen(text) * GLYPH_ADVANCE - 1) * c->unit;
    uint32_t left = x > width / 2 ? x - width / 2 : 0;
    for (; *text; text++, left += GLYPH_ADVANCE * c->unit)
        for (uint32_t row = 0; row < GLYPH_ROWS; row++)
            for (uint32_t column = 0; column < 3; column++)
                if (glyph(*text) >> (3 * (GLYPH_ROWS - 1 - row) + 2 - column) & 1)
                    fill(c, left + column * c->unit, c->unit, GAP + BAR + TICK + 1 + row, 1, ink);
}

static void draw_bar(const struct canvas *c, uint32_t left, uint32_t width)
{
    float palette[ERROR_MAP_COLORS][3];
    error_map_palette(palette);
    for (uint32_t i = 0; i < width; i++) {
        double level = i / (double)(width - 1);
        fill(c, left + i, 1, GAP, BAR, palette[(int)(level * (ERROR_MAP_COLORS - 1) + 0.5)]);
    }
}

// Draws one tick per decade on a logarithmic scale, or one per fifth of the range on a linear one.
static void draw_ticks(const struct canvas *c, enum error_map map, uint32_t left, uint32_t width)
{
    struct error_scale scale = error_map_scale(map);
    int ticks = scale.is_logarithmic ? (int)lround(log10(scale.high / scale.low)) : 5;
    for (int i = 0; i <= ticks; i++) {
        char label[32];
        int decade = (int)lround(log10(scale.high)) - ticks + i;
        if (!scale.is_logarithmic)
            snprintf(label, sizeof label, "%g", scale.low + (scale.high - scale.low) * i / ticks);
        else if (decade == 0)
            snprintf(label, sizeof label, "1");
        else
            snprintf(label, sizeof label, "1e%d", decade);
        uint32_t x = left + (uint32_t)lround((width - 1) * (i / (double)ticks));
        fill(c, x, c->unit, GAP + BAR, TICK, ink);
        write_centred(c, x + c->unit / 2, label);
    }
}

bool color_scale_append(enum error_map map, const struct image *picture, struct arena *arena,
                        struct image *out)
{
    uint32_t width = picture->width < LEAST_WIDTH ? LEAST_WIDTH : picture->width;
    uint32_t unit = width / 256 < 1 ? 1 : width / 256 > UNIT_MAX ? UNIT_MAX : width / 256;
    *out = (struct image){width, picture->height + STRIP * unit, NULL};
    uint64_t count = (uint64_t)out->width * out->height;
    out->pixels = arena_alloc(arena, count, sizeof *out->pixels);
    if (!out->pixels)
        return false;
    for (uint64_t i = 0; i < count; i++)
        memcpy(out->pixels[i], background, sizeof background);
    for (uint32_t y = 0; y < picture->height; y++)
        memcpy(out->pixels[(uint64_t)y * width], picture->pixels[(uint64_t)y * picture->width],
               picture->width * sizeof *out->pixels);
    struct canvas canvas = {out, picture->height, unit};
    draw_bar(&canvas, MARGIN * unit, width - 2 * MARGIN * unit);
    draw_ticks(&canvas, map, MARGIN * unit, width - 2 * MARGIN * unit);
    return true;
}
