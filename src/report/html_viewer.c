#include "report/html_viewer.h"

#include "base/log.h"
#include "json/json_parse.h"
#include "metrics/error_map.h"
#include "metrics/metrics.h"
#include "report/json_out.h"
#include <math.h>
#include <string.h>

// If the values of all images together take at most this many bytes as floats, they are stored as
// floats. In the page, as PNG files in base 91, they take at most 1.23 times as much. Noise takes
// nearly that much, because it cannot be compressed.
#define FLOATS_MAX (UINT64_C(8) << 20)
// If the images take more bytes than this as halves, two bits of each half are rounded away. Noise
// cannot be compressed, so this keeps a page with four images of 1280 x 720 pixels near 20 MB. The
// remaining 9 bits of precision are three decimal digits.
#define ALL_BITS_MAX (UINT64_C(16) << 20)
// If the images take more bytes than this as halves, their resolution is reduced. Five images of
// 1920 x 1080 pixels keep their resolution.
#define HALVES_MAX (UINT64_C(64) << 20)

static uint64_t component_count(const struct html_viewer_params *params, uint32_t reduction)
{
    uint64_t width = (params->width + reduction - 1) / reduction;
    uint64_t height = (params->height + reduction - 1) / reduction;
    return 3 * width * height * params->count;
}

static uint32_t choose_reduction(const struct html_viewer_params *params)
{
    uint32_t reduction = 1;
    while (component_count(params, reduction) * sizeof(uint16_t) > HALVES_MAX)
        reduction++;
    return reduction;
}

static uint32_t choose_bits(const struct html_viewer_params *params, uint32_t reduction)
{
    return component_count(params, reduction) * sizeof(float) <= FLOATS_MAX ? 32 : 16;
}

// Returns the number of decimal digits that the values in the page have.
static uint32_t choose_digits(const struct html_viewer_params *params, uint32_t reduction)
{
    if (choose_bits(params, reduction) == 32)
        return 9;
    return component_count(params, reduction) * sizeof(uint16_t) <= ALL_BITS_MAX ? 4 : 3;
}

// Base 91 takes 16 bytes for 13, and the stream that receives them takes up to twice their size
// while it grows. Maps of FLIP have one byte per component.
uint64_t html_viewer_bytes(const struct html_viewer_params *params)
{
    uint32_t reduction = choose_reduction(params);
    uint64_t bytes = choose_bits(params, reduction) / 8 + 1;
    return component_count(params, reduction) * bytes * 16 / 13 * 2;
}

// --- the description of the viewer ---------------------------------------------------------------

static json_t *maps_json(void)
{
    static const char *const words[ERROR_MAP_TOTAL] = {
        [ERROR_MAP_RELATIVE] = "relative: |x \xe2\x88\x92 r| / (|r| + 0.01)",
        [ERROR_MAP_SQUARED] = "squared: (x \xe2\x88\x92 r)\xc2\xb2 / (r\xc2\xb2 + 0.01)",
        [ERROR_MAP_SMAPE] = "SMAPE: 2 |x \xe2\x88\x92 r| / (|x| + |r|)",
        [ERROR_MAP_FLIP] = "FLIP",
        [ERROR_MAP_HDR_FLIP] = "HDR-FLIP",
    };
    json_t *maps = json_array();
    for (int m = 0; m < ERROR_MAP_TOTAL; m++) {
        struct error_scale scale = error_map_scale((enum error_map)m);
        json_array_append_new(maps,
                              json_pack("{s:s, s:s, s:f, s:f, s:b}", "name", error_map_names[m],
                                        "words", words[m], "low", scale.low, "high", scale.high,
                                        "log", scale.is_logarithmic));
    }
    return maps;
}

static json_t *palette_json(void)
{
    float palette[ERROR_MAP_COLORS][3];
    json_t *colors = json_array();
    error_map_palette(palette);
    for (int i = 0; i < ERROR_MAP_COLORS; i++)
        json_array_append_new(colors, json_pack("[i, i, i]", image_quantize(palette[i][0]),
                                                image_quantize(palette[i][1]),
                                                image_quantize(palette[i][2])));
    return colors;
}

bool html_viewer_begin(struct html_page *page, const struct html_viewer_params *params,
                       struct html_viewer *out, struct err *err)
{
    uint32_t reduction = choose_reduction(params);
    *out = (struct html_viewer){
        .page = page,
        .width = (params->width + reduction - 1) / reduction,
        .height = (params->height + reduction - 1) / reduction,
        .reduction = reduction,
        .bits = choose_bits(params, reduction),
        .digits = choose_digits(params, reduction),
        .source_width = params->width,
        .number = page->viewers++,
        .pictures = json_array(),
    };
    out->spec = json_pack("{s:i, s:i, s:i, s:i, s:i, s:i, s:i, s:f, s:s, s:f, s:f, s:o, s:o, s:O}",
                          "width", (int)out->width, "height", (int)out->height, "reduction",
                          (int)reduction, "sourceWidth", (int)params->width, "sourceHeight",
                          (int)params->height, "bits", (int)out->bits, "digits", (int)out->digits,
                          "exposure", (double)params->exposure_stops, "tone",
                          params->tone == TONE_ACES ? "aces" : "none", "epsilon",
                          METRICS_RELMSE_EPSILON, "smapeEpsilon", METRICS_SMAPE_EPSILON, "maps",
                          maps_json(), "palette", palette_json(), "pictures", out->pictures);
    if (!out->spec)
        return err_memory(err, "a viewer", 0);
    fprintf(page->out, "<section class=\"viewer\" id=\"viewer-%u\" aria-label=\"pictures\">\n",
            out->number);
    fputs("<noscript><p class=\"note\">The pictures need JavaScript.</p></noscript>\n", page->out);
    if (reduction > 1)
        log_warn("the report shows pictures of %u x %u pixels instead of %u x %u: each pixel is "
                 "the mean of %u x %u pixels; errors are computed from the original pictures",
                 out->width, out->height, params->width, params->height, reduction, reduction);
    return true;
}

// --- images --------------------------------------------------------------------------------------

// Returns the mean over the square of source pixels that one pixel of the page represents.
static float reduced(const struct html_viewer *v, const float *values, uint32_t stride,
                     uint32_t source_height, uint32_t x, uint32_t y)
{
    uint32_t x_end = (x + 1) * v->reduction, y_end = (y + 1) * v->reduction;
    x_end = x_end < v->source_width ? x_end : v->source_width;
    y_end = y_end < source_height ? y_end : source_height;
    double sum = 0;
    uint64_t count = 0;
    for (uint32_t j = y * v->reduction; j < y_end; j++)
        for (uint32_t i = x * v->reduction; i < x_end; i++, count++)
            sum += (double)values[((uint64_t)j * v->source_width + i) * stride];
    return (float)(sum / (double)count);
}

// Computes the 32-bit FNV-1a hash. With it the page verifies the values that it has decoded,
// because some browsers alter the pixels of canvases on purpose.
static uint32_t hash_codes(const uint8_t *codes, size_t count)
{
    uint32_t hash = 0x811c9dc5u;
    for (size_t i = 0; i < count; i++)
        hash = (hash ^ codes[i]) * 0x01000193u;
    return hash;
}

// Writes a plane of bytes as a PNG, which is lossless and small, and which all browsers decode
// fast.
static bool put_plane(struct html_viewer *v, const uint8_t *codes, const char *name,
                      struct arena *arena, json_t *sums, struct err *err)
{
    uint8_t *png;
    size_t size;
    if (!image_encode_codes(codes, v->width, v->height, arena, &png, &size, err))
        return false;
    fprintf(v->page->out, "<script type=\"text/plain\" id=\"pixels-%u-%zu-%s\">", v->number,
            json_array_size(v->pictures), name);
    html_base91(v->page, png, size);
    fputs("</script>\n", v->page->out);
    json_object_set_new(sums, name,
                        json_integer(hash_codes(codes, 3 * (size_t)v->width * v->height)));
    return true;
}

// Rounds a half to a multiple of four units in the last place. Infinity and NaN are unchanged. A
// value that would be rounded up to infinity becomes the greatest finite half.
static uint32_t round_half_bits(uint32_t half)
{
    const uint32_t sign = half & 0x8000u, magnitude = half & 0x7fffu, greatest = 0x7bffu;
    if (magnitude > greatest)
        return half;
    const uint32_t rounded = (magnitude + 2u) & ~3u;
    return sign | (rounded > greatest ? greatest : rounded);
}

// Returns the bits that represent a component in the page.
static uint32_t bits_of(const struct html_viewer *v, float value)
{
    uint32_t bits;
    if (v->bits == 16)
        return v->digits == 3 ? round_half_bits(half_from_float(value)) : half_from_float(value);
    memcpy(&bits, &value, sizeof bits);
    return bits;
}

// Writes the components as planes of bytes, least significant bytes first. Bytes of the same
// significance are similar in neighbouring pixels, so they compress better.
static bool put_planes(struct html_viewer *v, const float (*pixels)[3], uint32_t source_height,
                       uint8_t *codes, struct arena *arena, json_t *sums, struct err *err)
{
    for (uint32_t byte = 0; byte < v->bits / 8; byte++) {
        uint64_t i = 0;
        for (uint32_t y = 0; y < v->height; y++)
            for (uint32_t x = 0; x < v->width; x++)
                for (int k = 0; k < 3; k++) {
                    float value = reduced(v, &pixels[0][k], 3, source_height, x, y);
                    codes[i++] = (uint8_t)(bits_of(v, value) >> 8 * byte);
                }
        const char name[2] = {(char)('0' + byte), '\0'};
        if (!put_plane(v, codes, name, arena, sums, err))
            return false;
    }
    return true;
}

// Returns the code of FLIP (red) or HDR-FLIP (green), in steps of 1/255, or of 1/31 if the images
// are stored as halves. Maps of noisy images do not compress, and so few shades of false colours
// are enough.
static uint8_t flip_code(const struct html_viewer *v, float value)
{
    const float steps = v->bits == 16 ? 31.0f : 255.0f;
    return image_quantize(roundf(value * steps) / steps);
}

static bool put_flip(struct html_viewer *v, const struct html_viewer_picture *picture,
                     uint32_t source_height, uint8_t *codes, struct arena *arena, json_t *sums,
                     struct err *err)
{
    const float *maps[2] = {picture->flip, picture->hdr_flip};
    uint64_t i = 0;
    for (uint32_t y = 0; y < v->height; y++)
        for (uint32_t x = 0; x < v->width; x++) {
            for (int m = 0; m < 2; m++)
                codes[i++] = flip_code(v, reduced(v, maps[m], 1, source_height, x, y));
            codes[i++] = 0;
        }
    return put_plane(v, codes, "flip", arena, sums, err);
}

bool html_viewer_add(struct html_viewer *v, const struct html_viewer_picture *picture,
                     struct err *err)
{
    uint32_t source_height = (uint32_t)json_integer_value(json_object_get(v->spec, "sourceHeight"));
    size_t bytes = 3 * (size_t)v->width * v->height;
    struct arena arena = {0};
    uint8_t *codes = arena_alloc(&arena, bytes, 1);
    json_t *sums = json_object();
    bool ok = codes || err_memory(err, "a report's picture", bytes);
    ok = ok && put_planes(v, picture->pixels, source_height, codes, &arena, sums, err) &&
         (!picture->flip || put_flip(v, picture, source_height, codes, &arena, sums, err));
    arena_finish(&arena);
    json_array_append_new(v->pictures,
                          json_pack("{s:o, s:o, s:b, s:o, s:[]}", "label",
                                    json_words(picture->label), "title", json_words(picture->title),
                                    "reference", picture->is_reference, "sums", sums, "figures"));
    return ok;
}

void html_viewer_figure(struct html_viewer *viewer, const char *name, struct interval value)
{
    json_t *picture = json_array_get(viewer->pictures, json_array_size(viewer->pictures) - 1);
    json_array_append_new(json_object_get(picture, "figures"),
                          json_pack("{s:s, s:o, s:o, s:o}", "name", name, "value",
                                    json_number(value.value), "low", json_number(value.low), "high",
                                    json_number(value.high)));
}

// Writes JSON inside a script element. "<" is escaped, so that a name can neither end the element
// nor begin another one (HTML standard, 13.2.5.15 and following).
static void put_json(FILE *out, const char *text)
{
    for (; *text; text++)
        if (*text == '<')
            fputs("\\u003c", out);
        else
            fputc(*text, out);
}

bool html_viewer_end(struct html_viewer *viewer, bool ok, struct err *err)
{
    json_decref(viewer->pictures);
    char *text = ok ? json_to_text(viewer->spec, JSON_REAL_PRECISION(9), err) : NULL;
    if (!ok)
        json_decref(viewer->spec);
    viewer->spec = viewer->pictures = NULL;
    if (text) {
        fputs("<script type=\"application/json\" class=\"spec\">", viewer->page->out);
        put_json(viewer->page->out, text);
        fputs("</script>\n</section>\n", viewer->page->out);
    }
    json_release(text);
    return text != NULL;
}
