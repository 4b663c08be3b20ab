// Names the files of a sequence's pictures.
#include "cli/render/sequence.h"

#include "base/file_inputs.h"
#include "base/maths.h"
#include <math.h>

bool sequence_list_names(struct sequence *s, struct err *err)
{
    struct render_run *run = &s->run;
    const struct render_options *asked = &s->options.render;
    run->outputs = asked->outputs;
    run->output_count = asked->output_count;
    if (run->output_count == 0 && !render_default_outputs(run, err))
        return false;
    // The PNG files from which videos are made may need one more name.
    s->names = ARENA_NEW(&run->arena, struct frame_name, run->output_count + 1);
    s->video.paths = ARENA_NEW(&run->arena, const char *, run->output_count);
    if (!s->names || !s->video.paths)
        return err_memory(err, "output names", run->output_count * sizeof *s->names);
    for (uint32_t i = 0; i < run->output_count; i++) {
        if (output_is_video(run->outputs[i]))
            s->video.paths[s->video.count++] = run->outputs[i];
        else if (!frame_name_parse(run->outputs[i], &s->names[s->name_count++], err))
            return false;
    }
    return sequence_video_init(s, err);
}

bool sequence_turn_to(struct sequence *s, uint32_t index, struct err *err)
{
    const struct sequence_options *asked = &s->options.render.sequence;
    struct render_frame *frame = &s->run.frame;
    arena_finish(&s->frame_arena);
    s->index = index;
    *frame = (struct render_frame){index + 1, s->count, NAN, NAN, NULL};
    if (asked->views > 0)
        frame->degrees = sequence_angle(asked, index) / DEGREE;
    else
        s->options.scene.at_seconds = frame->at_seconds = sequence_seconds(asked, index);
    const char **names = ARENA_NEW(&s->frame_arena, const char *, s->name_count);
    for (uint32_t i = 0; names && i < s->name_count; i++)
        if (!(names[i] = frame_name_make(&s->names[i], index + 1, &s->frame_arena)))
            names = NULL;
    const char *base = s->identity ? s->identity : "";
    frame->identity =
        asked->views > 0
            ? arena_printf(&s->frame_arena, "%spicture=view %u of %u\n", base, index + 1, s->count)
            : arena_printf(&s->frame_arena, "%spicture=at %.17g s\n", base, frame->at_seconds);
    if (!names || !frame->identity)
        return err_memory(err, "output names", s->name_count * sizeof *names);
    s->run.outputs = names;
    s->run.output_count = s->name_count;
    s->options.render.outputs = names;
    s->options.render.output_count = s->name_count;
    return true;
}

bool sequence_check_names(struct sequence *s, struct err *err)
{
    for (uint32_t index = 0; index < s->count; index++) {
        if (!sequence_turn_to(s, index, err))
            return false;
        for (uint32_t i = 0; i < s->name_count; i++) {
            if (!file_inputs_check(s->run.outputs[i], err))
                return false;
            for (uint32_t k = 0; k < i; k++)
                if (!file_check_distinct(s->run.outputs[k], s->run.outputs[i], err))
                    return false;
        }
    }
    return true;
}
