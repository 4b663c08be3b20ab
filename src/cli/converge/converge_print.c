// Prints the text output of `lampyris converge`.
#include "cli/converge/converge.h"

#include "cli/error_sources_out.h"

#include "report/text_out.h"
#include <inttypes.h>
#include <math.h>
#include <string.h>

static void print_head(const struct converge *c, const struct converge_curve *curve)
{
    const struct settings *settings = &curve->scene_data.settings;
    const struct converge_reference *reference = &c->references[curve->variant.scene];
    print_words(curve->scene_data.path);
    printf("  %u x %u, %u replicates", settings->width, settings->height, c->replicates_done);
    if (!reference->name)
        printf(
            ", no reference: errors are estimated from the half-buffers, which do not show bias\n");
    else if (reference->spp)
        printf(", reference of %" PRIu64 " spp\n", reference->spp);
    else {
        fputs(", reference ", stdout);
        print_line(reference->name,
                   reference->picture.noise_known ? "" : ", whose own noise is not known");
    }
    printf("  %-28s %30s %24s %9s %22s\n", "curve", "local relMSE at the end",
           c->spp ? "slope on samples" : "slope on time", "s", "efficiency, ratio");
}

// All formats are string literals of the callers with a single double.
#pragma GCC diagnostic ignored "-Wformat-nonliteral"

static void print_interval(struct interval i, const char *format, int width)
{
    char text[80], part[3][24];
    snprintf(part[0], sizeof part[0], format, i.value);
    snprintf(part[1], sizeof part[1], format, i.low);
    snprintf(part[2], sizeof part[2], format, i.high);
    if (isnan(i.value))
        snprintf(text, sizeof text, "not known");
    else if (isnan(i.low) || isnan(i.high))
        snprintf(text, sizeof text, "%s", part[0]);
    else
        snprintf(text, sizeof text, "%s [%s, %s]", part[0], part[1], part[2]);
    printf(" %*s", width, text);
}

// Prints the error at a point. If only bounds are known for some replicates, the mean of the bounds
// is printed.
static void print_error(const struct converge_point *point)
{
    struct interval error = point->metric[CONVERGE_LOCAL_RELMSE];
    char text[40];
    snprintf(text, sizeof text, "at most %.3g", point->at_most);
    if (isnan(error.value) && isfinite(point->at_most))
        printf(" %30s", text);
    else
        print_interval(error, "%.3g", 30);
}

static void print_metrics(const struct converge *c, const struct converge_curve *curve)
{
    const struct converge_point *last = &curve->points[c->point_count - 1];
    if (c->seconds)
        printf("      %.4g samples per pixel;", last->spp.value);
    else
        printf("     ");
    for (int m = CONVERGE_RELMSE; m < CONVERGE_METRICS; m++)
        if (!isnan(last->metric[m].value))
            printf("  %s %.4g", converge_metric_names[m], last->metric[m].value);
    if (!isnan(curve->efficiency.value))
        printf("  efficiency %.3g, of MSE %.3g", curve->efficiency.value,
               curve->efficiency_mse.value);
    putchar('\n');
}

static void print_targets(const struct converge_curve *curve)
{
    printf("      to local relMSE");
    for (int i = 0; i < CONVERGE_TARGETS; i++) {
        const struct converge_target *target = &curve->targets[i];
        if (isnan(target->seconds.value))
            printf("  %g: not known", converge_targets[i]);
        else
            printf("  %g: %.3g s%s", converge_targets[i], target->seconds.value,
                   target->extrapolated ? " (extrapolated)" : "");
    }
    if (!isnan(curve->bias.value))
        printf("; bias %.2g [%.2g, %.2g]%s", curve->bias.value, curve->bias.low, curve->bias.high,
               converge_is_biased(curve) ? ": BIASED" : "");
    putchar('\n');
}

// Prints from which other curves this one differs significantly.
static void print_verdict(const struct converge *c, const struct converge_curve *curve,
                          enum curve_verdict verdict, const char *words)
{
    uint32_t first, count = converge_siblings(c, curve, &first), found = 0;
    for (uint32_t i = 0; i < count; i++) {
        if (curve_judge(curve->ratios[i]) != verdict)
            continue;
        printf("%s ", found++ == 0 ? words : ",");
        print_words(converge_label(&c->curves[first + i]));
    }
    if (found > 0)
        putchar('\n');
}

void converge_print(const struct converge *c)
{
    char notes[CONVERGE_NOTES][CONVERGE_NOTE_SIZE];
    for (uint32_t i = 0; i < c->curve_count; i++) {
        const struct converge_curve *curve = &c->curves[i];
        const struct converge_point *last = &curve->points[c->point_count - 1];
        uint32_t first;
        converge_siblings(c, curve, &first);
        bool is_first = curve == &c->curves[first];
        if (is_first)
            print_head(c, curve);
        fputs("  ", stdout);
        print_words(converge_label(curve));
        printf("%*s", (int)fmax(28.0 - (double)strlen(converge_label(curve)), 0), "");
        print_error(last);
        print_interval(curve->slope, "%.3f", 24);
        printf(" %9.3g", last->seconds.value);
        print_interval(curve->ratios[0], "%.3g", 22);
        printf("  %s\n", is_first ? "" : curve_verdict_words(curve_judge(curve->ratios[0])));
        print_metrics(c, curve);
        print_targets(curve);
        error_sources_print(&curve->pooled, NULL);
        print_verdict(c, curve, CURVE_BETTER, "      faster than");
        print_verdict(c, curve, CURVE_WORSE, "      slower than");
    }
    uint32_t count = converge_notes(c, notes);
    for (uint32_t i = 0; i < count; i++)
        printf("note    %s\n", notes[i]);
    printf("device  %s, %s\n", c->gpu.info.name, c->gpu.info.driver);
    print_report(c->options->study.report);
}
