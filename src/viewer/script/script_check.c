// Commands that wait, and commands that test the viewer's state and image.
#include "viewer/core/messages.h"
#include "viewer/script/script_run.h"

#include "base/file.h"
#include "base/file_inputs.h"
#include "base/file_system.h"
#include "base/hash.h"
#include "json/json_parse.h"
#include "viewer/core/viewer.h"
#include <errno.h>
#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

// --- waiting -------------------------------------------------------------------------------------

static uint64_t least_samples(const struct viewer *viewer)
{
    uint64_t least = UINT64_MAX;
    for (uint32_t i = 0; i < viewer->stage.side_count; i++) {
        const struct view *view = &viewer->stage.sides[i];
        uint64_t samples = view->is_ready && !view->is_preview ? view_samples(view) : 0;
        least = samples < least ? samples : least;
    }
    return viewer->stage.side_count ? least : 0;
}

// Returns whether all pixels have all their samples and no work is in progress.
static bool is_complete(const struct viewer *viewer)
{
    return viewer->stage.is_resting && viewer->stage.shown.spp_limit > 0 &&
           least_samples(viewer) >= viewer->stage.shown.spp_limit &&
           worker_is_idle(viewer->shell.worker);
}

static enum step wait_samples(const struct viewer *viewer, uint64_t wanted, struct err *err)
{
    uint32_t limit = viewer->stage.shown.spp_limit;
    if (limit > 0 && wanted > limit) {
        err_set(err, ERR_INPUT,
                "there will be no %" PRIu64 " samples: rendering stops at the limit of %u", wanted,
                limit);
        return STEP_FAILED;
    }
    return !viewer->view.is_moving && !rebuild_is_pending(viewer) && !pose_is_pending(viewer) &&
                   least_samples(viewer) >= wanted
               ? STEP_DONE
               : STEP_AGAIN;
}

enum step step_wait(struct script *script, struct viewer *viewer,
                    const struct command_line *command, struct err *err)
{
    bool is_over = false;
    switch (command->unit) {
    case WAIT_FRAMES:
        return rest_frames(script, (uint64_t)command->numbers[0]);
    case WAIT_MS:
        is_over = viewer_seconds(viewer) - script->started >= 1e-3 * command->numbers[0];
        break;
    case WAIT_SAMPLES:
        return wait_samples(viewer, (uint64_t)command->numbers[0], err);
    case WAIT_IDLE:
        is_over = worker_is_idle(viewer->shell.worker) && !viewer->view.is_moving &&
                  (viewer->stage.shown.spp_limit == 0 || is_complete(viewer));
        break;
    }
    return is_over ? STEP_DONE : STEP_AGAIN;
}

// --- writing results -----------------------------------------------------------------------------

// Appends a JSON object to a file, as a line.
static bool append(const char *path, json_t *object, struct err *err)
{
    if (!file_inputs_check(path, err)) {
        json_decref(object);
        return false;
    }
    FILE *file = file_stream(path, "a");
    bool ok = file && object && json_dumpf(object, file, JSON_REAL_PRECISION(9)) == 0 &&
              fputc('\n', file) != EOF;
    int cause = errno;
    if (file && fclose(file) != 0)
        ok = false;
    json_decref(object);
    return ok || err_set(err, ERR_OUTPUT, "%s: cannot be written: %s", path, strerror(cause));
}

enum step step_hash(struct script *script, struct viewer *viewer,
                    const struct command_line *command, struct err *err)
{
    (void)script;
    if (command->side >= viewer->stage.side_count || !viewer->stage.sides[command->side].is_ready) {
        err_set(err, ERR_INPUT, "side %c has no picture", "ab"[command->side]);
        return STEP_FAILED;
    }
    struct arena arena = {0};
    struct film_image film;
    bool ok = job_copy_film(&viewer->stage.sides[command->side].job, &arena, &film, err);
    if (ok) {
        uint64_t pixels = (uint64_t)film.width * film.height;
        char hash[20];
        snprintf(hash, sizeof hash, "%016" PRIx64,
                 hash_bytes(HASH_INIT, film.mean, pixels * sizeof *film.mean));
        ok = append(command->texts[0],
                    json_pack("{s:s, s:I, s:I, s:i, s:i}", "image_hash", hash, "spp",
                              (json_int_t)film.least_samples, "spp_most",
                              (json_int_t)film.most_samples, "width", film.width, "height",
                              film.height),
                    err);
    }
    arena_finish(&arena);
    return ok ? STEP_DONE : STEP_FAILED;
}

enum step step_state(struct script *script, struct viewer *viewer,
                     const struct command_line *command, struct err *err)
{
    (void)script;
    return json_write(state_json(viewer), command->texts[0], err) ? STEP_DONE : STEP_FAILED;
}

// --- the command expect --------------------------------------------------------------------------

static const char *value_text(const json_t *value, char *out, size_t size)
{
    if (json_is_string(value))
        return json_string_value(value);
    char *text = json_dumps(value, JSON_ENCODE_ANY | JSON_COMPACT | JSON_REAL_PRECISION(9));
    snprintf(out, size, "%s", text ? text : "");
    json_release(text);
    return out;
}

static bool read_number(const char *text, double *out)
{
    char *end;
    *out = strtod(text, &end);
    return end != text && *end == '\0';
}

static bool compare(enum comparison comparison, const char *a, const char *b)
{
    double x, y;
    bool are_numbers = read_number(a, &x) && read_number(b, &y);
    bool is_equal = are_numbers ? x == y : strcmp(a, b) == 0;
    switch (comparison) {
    case COMPARE_EQUAL:
        return is_equal;
    case COMPARE_UNEQUAL:
        return !is_equal;
    case COMPARE_CONTAINS:
        return strstr(a, b) != NULL;
    case COMPARE_LACKS:
        return strstr(a, b) == NULL;
    case COMPARE_LESS:
        return are_numbers && x < y;
    case COMPARE_AT_MOST:
        return are_numbers && x <= y;
    case COMPARE_GREATER:
        return are_numbers && x > y;
    case COMPARE_AT_LEAST:
        return are_numbers && x >= y;
    }
    return false;
}

enum step step_expect(struct script *script, struct viewer *viewer,
                      const struct command_line *command, struct err *err)
{
    (void)script;
    json_t *state = state_json(viewer);
    const json_t *value = state ? state_find(state, command->texts[0]) : NULL;
    char text[1024];
    bool ok = false;
    if (!state)
        err_memory(err, "the state", 0);
    else if (!value)
        err_set(err, ERR_INPUT, "the viewer's state has no key %s", command->texts[0]);
    else if (compare(command->comparison, value_text(value, text, sizeof text), command->texts[1]))
        ok = true;
    else
        err_set(err, ERR_INPUT, "%s is \"%.300s\"; expected %s \"%s\"", command->texts[0],
                value_text(value, text, sizeof text), comparison_name(command->comparison),
                command->texts[1]);
    json_decref(state);
    return ok ? STEP_DONE : STEP_FAILED;
}

// --- the command check ---------------------------------------------------------------------------

// Removes the members of a state that always differ: the control's own value, messages, the number
// of undone steps, and times.
static void forget_own(json_t *state, const char *id)
{
    static const char history[] = "history.";
    json_object_del(state, "times");
    json_object_del(state, "message");
    json_t *counts = json_object_get(state, "counts");
    json_object_del(counts, "undo");
    json_object_del(counts, "redo");
    json_t *items = json_object_get(state, "items");
    for (size_t i = json_array_size(items); i-- > 0;) {
        const char *name = json_string_value(json_object_get(json_array_get(items, i), "id"));
        if (!name || strcmp(name, id) == 0 || strncmp(name, history, sizeof history - 1) == 0)
            json_array_remove(items, i);
    }
}

static bool has_changed(const struct script *script, const struct command_line *command,
                        const json_t *after, uint64_t picture)
{
    const json_t *before = script->now.before;
    if (picture != script->now.picture)
        return true;
    if (command->effect == EFFECT_PICTURE)
        return false;
    if (command->effect == EFFECT_STATE)
        return !json_equal(before, after);
    return !json_equal(json_object_get(before, "sides"), json_object_get(after, "sides"));
}

// Sets a control and tests the effect. It first waits until the image is complete, so that equal
// numbers of samples are compared. step_set() tests whether the control takes the value.
enum step step_check(struct script *script, struct viewer *viewer,
                     const struct command_line *command, struct err *err)
{
    const char *id = command->texts[0];
    uint64_t picture;
    if (viewer->stage.shown.spp_limit == 0) {
        err_set(err, ERR_INPUT,
                "check compares finished pictures: set a limit of samples before it");
        return STEP_FAILED;
    }
    if (script->now.phase == 0) {
        if (script->now.frame++ < FRAMES_TO_SEE || !is_complete(viewer))
            return STEP_AGAIN;
        script->now.before = state_json(viewer);
        forget_own(script->now.before, id);
        if (!state_hash_picture(viewer, &script->now.picture, err))
            return STEP_FAILED;
        gui_set(&viewer->shell.gui, id, command->texts[1]);
        return next_phase(script);
    }
    const char *why_not = script->now.phase == 1 ? gui_set_result(&viewer->shell.gui) : NULL;
    if (why_not) {
        err_set(err, ERR_INPUT, "%s", why_not);
        return STEP_FAILED;
    }
    if (script->now.phase == 1)
        return next_phase(script);
    if (script->now.frame++ < FRAMES_TO_SEE ||
        (viewer->stage.shown.spp_limit && !is_complete(viewer)))
        return STEP_AGAIN;
    json_t *after = state_json(viewer);
    forget_own(after, id);
    bool ok = state_hash_picture(viewer, &picture, err);
    if (ok && !has_changed(script, command, after, picture))
        ok = err_set(err, ERR_INPUT,
                     "%s: setting it to \"%s\" has changed nothing but its own value", id,
                     command->texts[1]);
    json_decref(after);
    return ok ? STEP_DONE : STEP_FAILED;
}
