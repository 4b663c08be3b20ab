// Reports what a render leaves out: in a line of the summary, and in the table of --explain.
#include "cli/render/render_report.h"
#include "render/parts.h"
#include "render/tables/light_choice.h"
#include "report/text_out.h"
#include <inttypes.h>
#include <stdio.h>

// --- one line ------------------------------------------------------------------------------------

struct census {
    uint32_t features, left_out_features, kernels, left_out_kernels;
    uint64_t left_out_bytes;
};

static void count_part(void *context, const struct part *part)
{
    struct census *census = context;
    bool is_left_out = !part->is_kept;
    if (part->kind == PART_BUFFER) {
        census->left_out_bytes += is_left_out ? part->bytes : 0;
    } else if (part->kind == PART_KERNEL) {
        census->kernels++;
        census->left_out_kernels += is_left_out;
    } else {
        census->features++;
        census->left_out_features += is_left_out;
    }
}

void explain_print_line(const struct renderer *r)
{
    struct census census = {0};
    parts_visit(r, count_part, &census);
    printf("left out  %u of %u features, %u of %u kernels, %.1f MiB; --explain lists them\n",
           census.left_out_features, census.features, census.left_out_kernels, census.kernels,
           (double)census.left_out_bytes / 1048576.0);
}

// --- the table -----------------------------------------------------------------------------------

static void print_part(void *context, const struct part *part)
{
    const struct render_run *run = context;
    const struct renderer *r = &run->job.renderer;
    if (part->is_kept)
        return;
    struct part_cost cost = part_find_cost(r, part);
    char name[64];
    snprintf(name, sizeof name, "%s: %s", part_kind_name(part->kind), part->name);
    printf("%-47s  %12" PRId64 "  %12" PRId64 "  %s\n", name, cost.bytes, cost.instructions,
           part_reason(r, part));
}

static void print_waves(const struct renderer *r)
{
    if (r->plan.waves > 1)
        printf("waves     %" PRIu64 ", of which %" PRIu64
               " began while the last bounces of the wave before were traced\n",
               r->stats.waves, r->stats.waves_ahead);
}

static void print_classes(const struct renderer *r)
{
    if (!(r->specialization.features & FEATURE_CLASSES))
        return;
    printf("classes  ");
    for (int c = 0; c < (int)CLASS_COUNT; c++)
        if (r->specialization.class_lobes[c])
            printf(" %s %.1f M hits", report_class_names[c],
                   (double)r->stats.surface_hits[c] * 1e-6);
    putchar('\n');
}

// Prints the emitters to which shadow rays are sent.
static void print_aim(const struct renderer *r)
{
    const struct settings *settings = &r->scene->settings;
    const struct emitter_counts counts = emitters_count(r->scene, &r->flat);
    if (!(r->specialization.features & FEATURE_NEE) ||
        r->specialization.integrator == INTEGRATOR_WHITTED)
        return;
    printf("nee       shadow rays go to %s\n",
           light_choice_print(settings->light_choice, emitters_total(&counts), &r->lamps).text);
}

void explain_print(struct render_run *run)
{
    const struct renderer *r = &run->job.renderer;
    struct part_totals totals = parts_count_instructions(r);
    putchar('\n');
    for (uint32_t i = 0; i < run->scene.note_count; i++)
        print_line("note      ", run->scene.notes[i]);
    if (run->job.error.bounded)
        printf("relMSE    at most %.3g (95 %%); it divides by the pixels' own values, which have "
               "more noise than the local means by which local relMSE divides\n",
               run->job.error.relmse_at_most);
    print_aim(r);
    print_waves(r);
    print_classes(r);
    if (r->stats.suspended)
        printf("continued %" PRIu64 " traversals of more than %u steps\n", r->stats.suspended,
               r->specialization.iteration_budget);
    report_print_steps(run);
    report_print_kernels(&r->stats);
    printf("code      %" PRIu64 " SPIR-V instructions remain of %" PRIu64 "\n", totals.instructions,
           totals.all_instructions);
    if (r->specialization.stack_shared)
        printf("stack     %u of at most %u entries of a traversal are in shared memory\n",
               r->specialization.stack_shared, r->specialization.stack_entries + 2);
    if (r->specialization.sort_rays)
        printf("sort      rays are sorted by octant and cell from bounce %u on\n",
               SORT_FIRST_BOUNCE);
    puts("saved     device memory in bytes and SPIR-V instructions that each part would add, if it "
         "alone were not left out:\n");
    printf("%-47s  %12s  %12s  %s\n", "left out", "bytes", "instructions", "why");
    parts_visit(r, print_part, run);
}

// --- for machines --------------------------------------------------------------------------------

json_t *explain_json(const struct renderer *r, const struct part *part)
{
    struct part_cost cost = part_find_cost(r, part);
    return json_pack("{s:s, s:I, s:I}", "why", part_reason(r, part), "bytes",
                     (json_int_t)cost.bytes, "instructions", (json_int_t)cost.instructions);
}
