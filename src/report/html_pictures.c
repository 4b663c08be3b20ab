// Pictures of HTML reports: error maps with their scale, and two pictures under a slider.
#include "report/html.h"

#include "metrics/metrics.h"
#include <math.h>

// False colours are display values; pictures hold linear ones.
static void linearize(struct image *image)
{
    const float steps = 16; // between one colour of the scale and the next
    uint64_t count = (uint64_t)image->width * image->height;
    for (uint64_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            image->pixels[i][k] = image_srgb_to_linear(roundf(image->pixels[i][k] * steps) / steps);
}

bool html_difference(struct html_page *page, const char *name, const struct image *image,
                     const struct image *reference, const char *attributes, struct err *err)
{
    uint64_t count = (uint64_t)image->width * image->height;
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
    bool ok = html_picture(page, name, &map, attributes, err);
    page->exposure_stops = plain.exposure_stops;
    page->tone = plain.tone;
    return ok;
}

// By the same function from differences that rise evenly over the scale's four decades, from black.
bool html_difference_scale(struct html_page *page, struct err *err)
{
    enum { WIDTH = 160, DECADES = 4 };
    float values[WIDTH][3], black[WIDTH][3] = {{0}};
    for (int x = 0; x < WIDTH; x++)
        for (int k = 0; k < 3; k++)
            values[x][k] =
                (float)(METRICS_RELMSE_EPSILON * pow(10, DECADES * ((x + 0.5) / WIDTH - 1)));
    const struct image rising = {WIDTH, 1, values}, none = {WIDTH, 1, black};
    fputs("<div class=\"scale\">Relative difference |x &minus; r| / (|r| + 0.01)", page->out);
    if (!html_difference(page, "scale", &rising, &none, "alt=\"\"", err))
        return false;
    fputs("<span><span>1e-4</span><span>1e-3</span><span>1e-2</span><span>0.1</span>"
          "<span>1</span></span></div>\n",
          page->out);
    return true;
}

static void put_choice(struct html_page *page, const struct html_choice *choices, uint32_t count,
                       const char *of, uint32_t chosen)
{
    fprintf(page->out,
            "<select onchange=\"this.closest('.compare').querySelector('%s').src="
            "document.getElementById(this.value).src\">",
            of);
    for (uint32_t i = 0; i < count; i++) {
        fprintf(page->out, "<option value=\"%s\"%s>", choices[i].id,
                i == chosen ? " selected" : "");
        html_text(page, choices[i].label);
        fputs("</option>", page->out);
    }
    fputs("</select>", page->out);
}

void html_slider(struct html_page *page, const struct html_choice *choices, uint32_t count,
                 uint32_t right, uint32_t width)
{
    fputs("<div class=\"compare\"><p>Left: ", page->out);
    put_choice(page, choices, count, ".over", 0);
    fputs(" &nbsp; right: ", page->out);
    put_choice(page, choices, count, ".under", right);
    fprintf(page->out,
            "</p>\n<div class=\"slider\" style=\"width:%upx\"><img class=\"under\" alt=\"\">"
            "<img class=\"over\" alt=\"\"><input type=\"range\" min=\"0\" max=\"100\" value=\"50\" "
            "step=\"0.5\" title=\"what is shown of the left picture\" "
            "oninput=\"this.previousElementSibling.style.clipPath='inset(0 '+(100-this.value)+'%% "
            "0 0)'\"></div></div>\n",
            width);
    // The pictures' bytes stand in the page once.
    fputs(
        "<script>document.querySelectorAll('.compare select').forEach(s=>s.onchange())</script>\n",
        page->out);
}
