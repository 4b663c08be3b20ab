// The report of `lampyris compare`: a page with a viewer of all images and a table of errors.
#include "cli/compare/compare.h"

#include "base/file.h"
#include <math.h>
#include <string.h>

// Returns the name of a file without its folder, or the whole path if another image has the same
// name.
static const char *label_of(const struct comparison *c, const char *path)
{
    const char *name = path_name(path);
    uint32_t same = 0;
    for (uint32_t i = 0; i <= c->count; i++)
        same += strcmp(path_name(c->options->arguments[i]), name) == 0;
    return same > 1 ? path : name;
}

bool compare_html_begin(struct comparison *c, struct err *err)
{
    const struct image *reference = &c->reference.image;
    const struct html_viewer_params params = {
        .width = reference->width,
        .height = reference->height,
        .count = c->count + 1,
        .exposure_stops = c->options->scene.settings.exposure,
    };
    if (!html_begin(&c->page, &c->arena, ".", "Comparison", err))
        return false;
    c->page.path = c->options->study.report;
    fputs("<p class=\"lead\">Reference: ", c->page.out);
    html_text(&c->page, c->reference_path);
    fprintf(c->page.out, ", %u &times; %u pixels</p>\n", reference->width, reference->height);
    return html_viewer_begin(&c->page, &params, &c->viewer, err);
}

bool compare_html_add(struct comparison *c, const struct compared *picture,
                      const struct image *image, float *const flip[2], struct err *err)
{
    const struct html_viewer_picture shown = {
        .label = label_of(c, picture->path),
        .title = picture->path,
        .pixels = (const float(*)[3])image->pixels,
        .flip = flip[0],
        .hdr_flip = flip[1],
    };
    if (!html_viewer_add(&c->viewer, &shown, err))
        return false;
    html_viewer_figure(&c->viewer, "local relMSE", picture->error.local_relmse);
    html_viewer_figure(&c->viewer, "relMSE", picture->error.relmse);
    html_viewer_figure(&c->viewer, "MSE", picture->error.mse);
    return true;
}

// --- the table -----------------------------------------------------------------------------------

// Returns whether to mark an image as the best. If all images are equal, none is marked.
static bool has_star(const struct comparison *c, uint32_t picture, enum compare_metric metric)
{
    bool differ = false;
    for (uint32_t i = 1; i < c->count; i++)
        differ = differ || c->pictures[i].value[metric] != c->pictures[0].value[metric];
    return differ && compare_is_best(c, picture, metric);
}

static void put_cell(struct comparison *c, uint32_t picture, enum compare_metric metric)
{
    const struct compared *p = &c->pictures[picture];
    const struct interval *interval = compare_interval(p, metric);
    bool is_count = metric == METRIC_NONFINITE || metric == METRIC_DIFFERING;
    FILE *out = c->page.out;
    fputs("<td>", out);
    fputs(has_star(c, picture, metric) ? "<span class=\"best\">" : "<span>", out);
    if (isinf(p->value[metric]))
        fputs("&infin;", out);
    else
        fprintf(out, is_count ? "%.0f" : "%.4g", p->value[metric]);
    fputs("</span>", out);
    if (interval && isfinite(interval->low) && isfinite(interval->high))
        fprintf(out, "<small>[%.3g, %.3g]</small>", interval->low, interval->high);
    if (c->is_corrected && p->value[metric] < 0 && metric <= METRIC_LOCAL_RELMSE)
        fputs("<small>below the reference's noise</small>", out);
    if (metric == METRIC_MAX)
        fprintf(out, "<small>at %u, %u</small>", p->max_pixel[0], p->max_pixel[1]);
    fputs("</td>", out);
}

static void put_table(struct comparison *c)
{
    static const char *const heads[METRIC_TOTAL] = {
        "MSE",  "RMSE", "relMSE",   "local relMSE", "SMAPE",      "PSNR, dB",
        "SSIM", "FLIP", "HDR-FLIP", "greatest",     "not finite", "differing"};
    static const enum compare_metric order[METRIC_TOTAL] = {
        METRIC_LOCAL_RELMSE, METRIC_RELMSE, METRIC_MSE,       METRIC_RMSE,
        METRIC_SMAPE,        METRIC_FLIP,   METRIC_HDR_FLIP,  METRIC_SSIM,
        METRIC_PSNR,         METRIC_MAX,    METRIC_NONFINITE, METRIC_DIFFERING};
    FILE *out = c->page.out;
    fputs("<h2>Errors</h2>\n<div class=\"wide\"><table><tr><th></th>", out);
    for (int m = 0; m < METRIC_TOTAL; m++)
        fprintf(out, "<th>%s</th>", heads[order[m]]);
    fputs("</tr>\n", out);
    for (uint32_t i = 0; i < c->count; i++) {
        fputs("<tr><th>", out);
        html_text(&c->page, label_of(c, c->pictures[i].path));
        fputs("</th>", out);
        for (int m = 0; m < METRIC_TOTAL; m++)
            put_cell(c, i, order[m]);
        fputs("</tr>\n", out);
    }
    fputs("</table></div>\n", out);
}

static void put_words(struct comparison *c)
{
    FILE *out = c->page.out;
    fprintf(out,
            "<p>%sThe 95 %% intervals are Student's t over tiles of the picture: they show how "
            "much the noise of another seed may change the error of the whole picture, and do not "
            "include bias. FLIP, SSIM and PSNR are computed from display values at an exposure of "
            "%g stops; HDR-FLIP is the greatest FLIP over %u exposures from %.2f to %.2f stops. "
            "Pixels that are not finite are omitted, and are green in error maps.</p>\n",
            c->count > 1 ? "The best of each column has a star. " : "",
            (double)c->options->scene.settings.exposure, c->exposures.count, c->exposures.start,
            c->exposures.stop);
    if (c->is_corrected)
        fprintf(out,
                "<p>The reference's own noise is subtracted: %.3g of MSE, %.3g of relMSE, %.3g of "
                "local relMSE.</p>\n",
                c->reference.mse, c->reference.relmse, c->reference.local_relmse);
    else
        fputs("<p>The reference's own noise is part of the errors: --reference-variance "
              "subtracts it.</p>\n",
              out);
    fprintf(out, "<h2>How this was made</h2>\n<p>Lampyris %s.</p>\n<pre>", LAMPYRIS_VERSION);
    html_text(&c->page, c->options->command_line);
    fputs("</pre>\n", out);
}

bool compare_html_end(struct comparison *c, bool ok, struct err *err)
{
    const struct html_viewer_picture reference = {
        .label = label_of(c, c->reference_path),
        .title = c->reference_path,
        .pixels = (const float(*)[3])c->reference.image.pixels,
        .is_reference = true,
    };
    ok = ok && html_viewer_add(&c->viewer, &reference, err);
    ok = html_viewer_end(&c->viewer, ok, err);
    if (ok) {
        put_table(c);
        put_words(c);
    }
    return html_end(&c->page, ok, err);
}
