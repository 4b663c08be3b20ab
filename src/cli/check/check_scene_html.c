// Writes the HTML report: a single file with the findings of a scene, and images that show where
// they are.
#include "cli/check/scene_check.h"

#include "base/file.h"
#include "base/maths.h"
#include "cli/options.h"
#include "report/html.h"
#include <math.h>

// Draws the image in grey at half its brightness, and the pixels that a finding affects in red.
// `white` is the radiance that becomes 1.
static void mark_pixels(const struct image *picture, const uint8_t *flags, float white,
                        float (*out)[3])
{
    for (uint32_t i = 0; i < picture->width * picture->height; i++) {
        float grey = 0.5f * (float)fmin(luminance(picture->pixels[i]), (double)white);
        for (int c = 0; c < 3; c++)
            out[i][c] = grey;
        if (flags[i])
            out[i][0] += 0.5f * white;
    }
}

static bool put_marked(struct html_page *page, const struct image *picture, const uint8_t *flags,
                       struct err *err)
{
    struct image marked = *picture;
    size_t count = (size_t)picture->width * picture->height;
    marked.pixels = arena_alloc(page->arena, count, sizeof *marked.pixels);
    if (!marked.pixels)
        return err_memory(err, "a picture", count * sizeof *marked.pixels);
    mark_pixels(picture, flags, exp2f(-page->exposure_stops), marked.pixels);
    fputs("<figure>", page->out);
    bool ok = html_picture(page, "finding", &marked, "style=\"width:256px\" alt=\"\"", err);
    fputs("</figure>\n", page->out);
    return ok;
}

static void put_line(struct html_page *page, const char *label, const char *text)
{
    if (!text)
        return;
    fprintf(page->out, "<tr><th>%s</th><td style=\"text-align:left\">", label);
    html_text(page, text);
    fputs("</td></tr>\n", page->out);
}

static bool put_finding(struct html_page *page, const struct scene_check *check,
                        const struct scene_finding *finding, struct err *err)
{
    static const char *const classes[] = {
        [FINDING_REMARK] = "", [FINDING_SLOW] = "note", [FINDING_WRONG] = "alarm"};
    bool is_changed = check->options->check.fix && finding->change;
    fprintf(page->out, "<h2>%s</h2>\n<p><span class=\"%s\">%s</span>", finding->name,
            classes[finding->level], finding_level_names[finding->level]);
    scene_check_print_share(finding->share, page->out);
    fputs("</p>\n<div class=\"pictures\">\n", page->out);
    bool ok = !finding->pixels || put_marked(page, &check->findings.picture, finding->pixels, err);
    fputs("<div><table>\n", page->out);
    put_line(page, "where", finding->place);
    put_line(page, "seen", finding->figure);
    put_line(page, "so", finding->consequence);
    put_line(page, "remedy", finding->remedy);
    put_line(page, "changed", is_changed ? finding->change : NULL);
    fputs("</table></div></div>\n", page->out);
    return ok;
}

static bool put_picture(struct html_page *page, const struct image *picture, struct err *err)
{
    page->exposure_stops = image_measure_exposure(picture);
    fputs("<figure>", page->out);
    bool ok = html_picture(page, "picture", picture, "style=\"width:384px\" alt=\"\"", err);
    fprintf(page->out,
            "<figcaption>The picture of %u x %u pixels that was checked. Below, pixels that a "
            "finding affects are red.</figcaption></figure>\n",
            picture->width, picture->height);
    return ok;
}

bool scene_check_report(struct scene_check *check, struct err *err)
{
    struct html_page page;
    const struct scene_findings *findings = &check->findings;
    const char *path = check->options->study.report;
    if (!html_begin(&page, &check->arena, path_folder(&check->arena, path),
                    "Causes of wrong, noisy or slow pictures of the scene", err))
        return false;
    page.path = path;
    fputs("<p>", page.out);
    html_text(&page, check->scene.path);
    fprintf(page.out, findings->count == 0 ? ": no findings.</p>\n<p>" : ": %u finding%s.</p>\n<p>",
            findings->count, findings->count == 1 ? "" : "s");
    scene_check_print_outlook(&findings->outlook, page.out);
    fputs("</p>\n", page.out);
    bool ok = put_picture(&page, &findings->picture, err);
    for (uint32_t i = 0; ok && i < findings->count; i++)
        ok = put_finding(&page, check, &findings->items[i], err);
    html_machine(&page, &check->gpu, check->options->command_line);
    return html_end(&page, ok, err);
}
