// Writes the HTML report: a single file with the cases and their images.
#include "cli/check/device_check.h"

#include "base/file.h"
#include "cli/options.h"
#include "report/html.h"
#include <math.h>
#include <stdio.h>

static bool put_picture(struct html_page *page, const struct check_result *result, struct err *err)
{
    const struct check_picture *picture = &result->picture;
    const struct image image = {picture->width, picture->height, picture->pixels};
    double sum = 0.0;
    size_t values = 3 * (size_t)picture->width * picture->height;
    fputs("<td>", page->out);
    if (picture->pixels) {
        for (size_t i = 0; i < values; i++)
            sum += (double)picture->pixels[i / 3][i % 3];
        // The exposure maps the image's mean to middle grey.
        page->exposure_stops = sum > 0.0 ? (float)log2(0.18 * (double)values / sum) : 0.0f;
        if (!html_picture(page, "case", &image, "width=\"64\" alt=\"\"", err))
            return false;
    }
    fputs("</td>", page->out);
    return true;
}

static void put_text(struct html_page *page, const char *text)
{
    fputs("<td style=\"text-align:left\">", page->out);
    html_text(page, text);
    fputs("</td>", page->out);
}

static bool put_row(struct html_page *page, const struct check_row *row, struct err *err)
{
    static const char *const classes[] = {
        [CHECK_NOT_RUN] = "note", [CHECK_PASSED] = "better", [CHECK_FAILED] = "alarm"};
    const struct check_result *r = &row->result;
    fputs("<tr><th>", page->out);
    html_text(page, row->this_case->name);
    fprintf(page->out, "</th><td class=\"%s\">%s</td>", classes[r->outcome],
            check_outcome_names[r->outcome]);
    put_text(page, row->this_case->expected);
    put_text(page, r->expected);
    put_text(page, r->seen);
    put_text(page, r->why);
    html_number(page, r->seconds, "%.2f");
    bool ok = put_picture(page, r, err);
    fputs("</tr>\n", page->out);
    return ok;
}

static bool put_group(struct html_page *page, const struct device_check *d, size_t *row,
                      struct err *err)
{
    const struct check_group *group = d->rows[*row].group;
    bool ok = true;
    fprintf(page->out, "<h2>%s</h2>\n<p>", group->name);
    html_text(page, group->about);
    fputs("</p>\n<div class=\"wide\"><table><tr><th>case</th><th>outcome</th><th>expected</th>"
          "<th>value</th><th>seen</th><th>why</th><th>s</th><th>picture</th></tr>\n",
          page->out);
    for (; ok && *row < d->done && d->rows[*row].group == group; ++*row)
        ok = put_row(page, &d->rows[*row], err);
    fputs("</table></div>\n", page->out);
    return ok;
}

bool device_check_report(struct device_check *d, struct err *err)
{
    struct html_page page;
    const char *path = d->options->study.report;
    if (!html_begin(&page, &d->arena, path_folder(&d->arena, path), "Check of the device", err))
        return false;
    page.path = path;
    fprintf(page.out, "<p>%zu cases pass, %zu fail, of %zu.</p>\n",
            device_check_outcomes(d, CHECK_PASSED), device_check_outcomes(d, CHECK_FAILED),
            d->count);
    bool ok = true;
    for (size_t row = 0; ok && row < d->done;)
        ok = put_group(&page, d, &row, err);
    html_machine(&page, &d->gpu, d->options->command_line);
    return html_end(&page, ok, err);
}
