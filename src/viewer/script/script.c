// Runs a script instead of a user: one command after the other, and one step of a command per
// frame.
#include "viewer/script/script.h"

#include "base/clock.h"
#include "base/file.h"
#include "base/file_system.h"
#include "cli/exit_code.h"
#include "viewer/core/messages.h"
#include "viewer/core/save.h"
#include "viewer/core/viewer.h"
#include "viewer/script/script_run.h"
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define TIMEOUT_SECONDS 120.0

bool script_open(const char *path, struct script **out, struct err *err)
{
    struct script *script = calloc(1, sizeof *script);
    *out = script;
    if (!script)
        return err_memory(err, path, sizeof *script);
    script->timeout_seconds = TIMEOUT_SECONDS;
    script->path = arena_strdup(&script->arena, path);
    if (script->path && script_read(path, &script->arena, &script->commands, &script->count, err))
        return true;
    if (!script->path)
        err_memory(err, path, strlen(path));
    script_close(script);
    *out = NULL;
    return false;
}

void script_close(struct script *script)
{
    if (!script)
        return;
    json_decref(script->now.before);
    arena_finish(&script->arena);
    free(script);
}

enum step next_phase(struct script *script)
{
    script->now.phase++;
    script->now.frame = 0;
    return STEP_AGAIN;
}

enum step rest_frames(struct script *script, uint64_t frames)
{
    return script->now.frame++ < frames ? STEP_AGAIN : STEP_DONE;
}

// --- files ---------------------------------------------------------------------------------------

// Waits until an image is written. This happens on another thread; if it fails, there is a message
// that is newer than the start of the command.
static enum step wait_for_file(struct script *script, struct viewer *viewer, struct err *err)
{
    if (!worker_is_idle(viewer->shell.worker) || viewer->document.waits_to_save)
        return STEP_AGAIN;
    bool failed = viewer->shell.message_kind == MESSAGE_ERROR &&
                  viewer->shell.message_seconds >= script->started;
    if (!failed)
        return STEP_DONE;
    err_set(err, ERR_OUTPUT, "%s", viewer->shell.message);
    return STEP_FAILED;
}

static enum step step_save(struct script *script, struct viewer *viewer,
                           const struct command_line *command, struct err *err)
{
    const char *path = command->texts[0];
    if (script->now.phase > 0)
        return wait_for_file(script, viewer, err);
    if (viewer->document.waits_to_save)
        return STEP_AGAIN;
    if (command->verb == VERB_SCREENSHOT)
        save_png(viewer, path, command->with_panel);
    else if (command->verb == VERB_EXR)
        save_exr(viewer, command->side, path, command->denoised);
    else
        save_scene(viewer, path);
    return next_phase(script);
}

static enum step step_touch(struct script *script, struct viewer *viewer,
                            const struct command_line *command, struct err *err)
{
    (void)script, (void)viewer;
    if (file_touch(command->texts[0]))
        return STEP_DONE;
    err_set(err, ERR_OUTPUT, "%s: %s", command->texts[0], strerror(errno));
    return STEP_FAILED;
}

static enum step step_copy(struct script *script, struct viewer *viewer,
                           const struct command_line *command, struct err *err)
{
    (void)script, (void)viewer;
    struct arena arena = {0};
    struct file_bytes bytes;
    // Simulates an editor that replaces a file which the viewer reads.
    bool ok = file_read_own(&arena, command->texts[0], 0, &bytes, err) &&
              file_replace_atomic(command->texts[1], bytes.data, bytes.size, err);
    arena_finish(&arena);
    return ok ? STEP_DONE : STEP_FAILED;
}

// --- other commands ------------------------------------------------------------------------------

static enum step step_lose_device(struct script *script, struct viewer *viewer,
                                  const struct command_line *command, struct err *err)
{
    (void)command, (void)err;
    if (script->now.phase > 0)
        return STEP_DONE;
    viewer->stage.gpu.params.lose_device_at_submit = viewer->stage.gpu.submit_count + 1;
    return next_phase(script);
}

static enum step step_timeout(struct script *script, struct viewer *viewer,
                              const struct command_line *command, struct err *err)
{
    (void)viewer, (void)err;
    script->timeout_seconds = command->numbers[0];
    return STEP_DONE;
}

static enum step step_quit(struct script *script, struct viewer *viewer,
                           const struct command_line *command, struct err *err)
{
    (void)viewer, (void)command, (void)err;
    script->at = script->count - 1;
    return STEP_DONE;
}

static const step_fn steps[VERB_COUNT] = {
    [VERB_KEY] = step_key,
    [VERB_MOUSE] = step_mouse,
    [VERB_BUTTON] = step_button,
    [VERB_CLICK] = step_click,
    [VERB_DRAG] = step_drag,
    [VERB_SCROLL] = step_scroll,
    [VERB_TEXT] = step_text,
    [VERB_SET] = step_set,
    [VERB_PRESS] = step_set,
    [VERB_DROP] = step_drop,
    [VERB_RESIZE] = step_resize,
    [VERB_MINIMISE] = step_minimise,
    [VERB_RESTORE] = step_minimise,
    [VERB_CLOSE] = step_close,
    [VERB_WAIT] = step_wait,
    [VERB_SCREENSHOT] = step_save,
    [VERB_EXR] = step_save,
    [VERB_SCENE] = step_save,
    [VERB_HASH] = step_hash,
    [VERB_STATE] = step_state,
    [VERB_CHECK] = step_check,
    [VERB_EXPECT] = step_expect,
    [VERB_TOUCH] = step_touch,
    [VERB_COPY] = step_copy,
    [VERB_LOSE_DEVICE] = step_lose_device,
    [VERB_TIMEOUT] = step_timeout,
    [VERB_QUIT] = step_quit,
};

static void begin_next(struct script *script)
{
    json_decref(script->now.before);
    script->now = (struct progress_of){0};
    script->at++;
}

static bool fail(const struct script *script, struct viewer *viewer, struct err *err)
{
    viewer->shell.exit_code = EXIT_CODE_CHECK_FAILED;
    return err_prepend(err, "%s:%u", script->path, script->commands[script->at].line);
}

bool script_step(struct script *script, struct viewer *viewer, struct err *err)
{
    while (script->at < script->count) {
        const struct command_line *command = &script->commands[script->at];
        if (!script->now.has_begun)
            script->started = viewer_seconds(viewer);
        script->now.has_begun = true;
        enum step step = steps[command->verb](script, viewer, command, err);
        if (step == STEP_FAILED)
            return fail(script, viewer, err);
        if (step == STEP_DONE) {
            begin_next(script);
            continue;
        }
        if (viewer_seconds(viewer) - script->started > script->timeout_seconds) {
            err_set(err, ERR_INPUT, "the command has not finished after %g s",
                    script->timeout_seconds);
            return fail(script, viewer, err);
        }
        return true;
    }
    viewer->shell.wants_quit = true;
    *err = (struct err){0};
    return false;
}
