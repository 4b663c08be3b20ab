// Reports each picture of a sequence when it is finished, as a line of text or JSON.
// docs/render.schema.json describes the JSON.
#include "cli/render/sequence.h"

#include "base/clock.h"
#include "cli/render/render_report.h"
#include "job/film_error.h"
#include "report/json_out.h"
#include "report/text_out.h"
#include <math.h>
#include <stdio.h>
#include <string.h>

static void print_place(const struct render_frame *frame)
{
    printf("picture %u/%u", frame->number, frame->count);
    if (isfinite(frame->at_seconds))
        printf(" at %.6g s", frame->at_seconds);
    if (isfinite(frame->degrees))
        printf(" from %.6g degrees", frame->degrees);
    fputs(": ", stdout);
}

static void print_outputs(const struct render_run *run)
{
    for (uint32_t i = 0; i < run->output_count; i++) {
        fputs(i ? ", " : "", stdout);
        print_words(run->outputs[i]);
    }
}

static void add_seconds(struct job_seconds *sum, const struct job_seconds *s)
{
    sum->load += s->load;
    sum->bvh += s->bvh;
    sum->upload += s->upload;
    sum->compile += s->compile;
    sum->render += s->render;
    sum->judge += s->judge;
    sum->write += s->write;
    sum->total += s->total;
}

bool sequence_report_frame(struct sequence *s, uint64_t start_ns, struct err *err)
{
    struct render_run *run = &s->run;
    char words[FILM_ERROR_WORDS];
    add_seconds(&s->seconds, &run->job.seconds);
    if (run->job.error.known && run->job.error.local_relmse > s->worst_error) {
        s->worst_error = run->job.error.local_relmse;
        s->worst = run->frame.number;
    }
    if (run->options->quiet && !run->options->json)
        return true;
    progress_pause(run->options->progress);
    bool ok = true;
    if (run->options->json) {
        ok = render_print_json(run, err);
    } else {
        film_error_words(&run->job.error, words);
        print_place(&run->frame);
        printf("%s, in %.3f s, ", words, clock_seconds_since(start_ns));
        print_outputs(run);
        putchar('\n');
    }
    fflush(stdout);
    return ok;
}

bool sequence_report_skipped(const struct sequence *s, struct err *err)
{
    const struct render_run *run = &s->run;
    if (run->options->json)
        return json_put_line(json_pack("{s:o, s:o, s:b, s:o}", "scene", json_words(run->scene.path),
                                       "frame", render_frame_json(&run->frame), "skipped", 1,
                                       "outputs", json_word_list(run->outputs, run->output_count)),
                             err);
    return true;
}

static json_t *seconds_json(const struct job_seconds *sum)
{
    return json_pack("{s:f, s:f, s:f, s:f, s:f, s:f, s:f, s:f}", "load", sum->load, "bvh", sum->bvh,
                     "upload", sum->upload, "compile", sum->compile, "render", sum->render, "judge",
                     sum->judge, "write", sum->write, "total", sum->total);
}

static void print_end(const struct sequence *s)
{
    const struct job_seconds *sum = &s->seconds;
    print_words(s->run.scene.path);
    printf("  %u pictures, %u of them rendered now", s->count, s->rendered);
    if (s->skipped > 0)
        printf(", %u finished before", s->skipped);
    putchar('\n');
    if (s->rendered > 0)
        printf("time      %.3f s per picture: load %.3f + BVH %.3f + upload %.3f + compile %.3f + "
               "render %.3f + judge %.3f + write %.3f + other\n",
               sum->total / s->rendered, sum->load / s->rendered, sum->bvh / s->rendered,
               sum->upload / s->rendered, sum->compile / s->rendered, sum->render / s->rendered,
               sum->judge / s->rendered, sum->write / s->rendered);
    if (s->worst > 0)
        printf("error     local relMSE %.3g at most, of picture %u\n", s->worst_error, s->worst);
    for (uint32_t i = 0; i < s->video.count && s->rendered + s->skipped == s->count; i++)
        print_line("wrote     ", s->video.paths[i]);
}

bool sequence_report_end(const struct sequence *s, struct err *err)
{
    bool is_whole = s->rendered + s->skipped == s->count;
    if (s->run.options->json)
        return json_put_line(
            json_pack("{s:o, s:i, s:i, s:i, s:o, s:o}", "scene", json_words(s->run.scene.path),
                      "pictures", (int)s->count, "rendered", (int)s->rendered, "skipped",
                      (int)s->skipped, "seconds", seconds_json(&s->seconds), "videos",
                      json_word_list(s->video.paths, is_whole ? s->video.count : 0)),
            err);
    if (!s->run.options->quiet)
        print_end(s);
    return true;
}
