#include "viewer/core/edit.h"

#include "render/sampling_plan.h"
#include "scene/core/environment.h"
#include "scene/core/light.h"
#include "viewer/core/changes.h"
#include "viewer/core/exposure.h"
#include "viewer/core/messages.h"
#include "viewer/core/viewer.h"
#include <assert.h>
#include <stdlib.h>
#include <string.h>

// The greatest number of steps in the history; the oldest ones are discarded.
#define STEPS_MAX 1000u

// The editable state of the environment. It includes the sun of a sky, which is a light that may
// have been edited.
struct around {
    struct surroundings surroundings;
    struct light sun;
    bool has_sun;
};

// The value of a target before or after a step.
union state {
    struct camera camera;
    struct method method;
    struct around around;
    struct material material;
    struct light light;
    struct shown shown;
    struct placement placement;
    struct list_counts counts;
    struct scene_pose pose;
    struct shape shape;
    bool visible;
};

static const size_t state_bytes[TARGET_COUNT] = {
    [TARGET_CAMERA] = sizeof(struct camera),       [TARGET_METHOD] = sizeof(struct method),
    [TARGET_SURROUNDINGS] = sizeof(struct around), [TARGET_MATERIAL] = sizeof(struct material),
    [TARGET_LIGHT] = sizeof(struct light),         [TARGET_OBJECT] = sizeof(bool),
    [TARGET_DISPLAY] = sizeof(struct shown),       [TARGET_PLACE] = sizeof(struct placement),
    [TARGET_LISTS] = sizeof(struct list_counts),   [TARGET_SHAPE] = sizeof(struct shape),
    [TARGET_POSE] = sizeof(struct scene_pose),
};

struct step {
    enum target target;
    uint32_t index;
    char control[GUI_ID_MAX];
    bool is_joined; // undone and redone together with the previous step
    void *states;   // the states of the target before and after the step
};

struct history {
    struct step steps[STEPS_MAX];
    uint32_t count, done; // steps[0, done) can be undone, steps[done, count) redone
    bool is_open;         // further changes by the same control belong to the last step
    bool is_fresh;        // the last step has not been applied successfully yet
    bool is_group;        // new steps are joined to those of the group
    uint32_t group_begin; // index of the group's first step
};

bool history_create(struct history **out, struct err *err)
{
    *out = calloc(1, sizeof **out);
    return *out || err_memory(err, "a history", sizeof **out);
}

static void forget(struct history *history, uint32_t from, uint32_t to)
{
    for (uint32_t i = from; i < to; i++)
        free(history->steps[i].states);
    memmove(&history->steps[from], &history->steps[to],
            (history->count - to) * sizeof *history->steps);
    history->count -= to - from;
    if (history->done > history->count)
        history->done = history->count;
}

void history_clear(struct history *history)
{
    forget(history, 0, history->count);
    history->is_open = history->is_fresh = false;
}

void history_destroy(struct history *history)
{
    if (history)
        history_clear(history);
    free(history);
}

// --- the current state of targets ----------------------------------------------------------------

static bool *hidden_flag(struct scene *scene, uint32_t object)
{
    if (object < scene->instance_count)
        return &scene->instances[object].hidden;
    assert(object - scene->instance_count < scene->shape_count);
    return &scene->shapes[object - scene->instance_count].hidden;
}

static struct light *find_sun(struct scene *scene)
{
    uint32_t sun = scene->environment.sun.light;
    return scene->environment.present && sun > 0 ? &scene->lights[sun - 1] : NULL;
}

static void get(struct viewer *viewer, enum target target, uint32_t index, union state *out)
{
    memset(out, 0, sizeof *out);
    switch (target) {
    case TARGET_CAMERA:
        out->camera = viewer->view.camera;
        break;
    case TARGET_METHOD:
        out->method = viewer->stage.sides[index].method;
        break;
    case TARGET_SURROUNDINGS: {
        const struct light *sun = find_sun(&viewer->document.scene);
        out->around.surroundings = viewer->document.surroundings;
        out->around.has_sun = sun != NULL;
        if (sun)
            out->around.sun = *sun;
        break;
    }
    case TARGET_MATERIAL:
        out->material = viewer->document.scene.materials[index];
        break;
    case TARGET_LIGHT:
        out->light = viewer->document.scene.lights[index];
        break;
    case TARGET_OBJECT:
        out->visible = !*hidden_flag(&viewer->document.scene, index);
        break;
    case TARGET_DISPLAY:
        out->shown = viewer->stage.shown;
        break;
    case TARGET_PLACE:
        out->placement = scene_placement(&viewer->document.scene, index);
        break;
    case TARGET_LISTS:
        out->counts = edit_counts(viewer);
        break;
    case TARGET_POSE:
        out->pose = viewer->document.pose.wanted;
        break;
    case TARGET_SHAPE:
        out->shape = viewer->document.scene.shapes[index];
        break;
    case TARGET_COUNT:
        break;
    }
}

// Compares all bytes, including padding, because the structs are copied as a whole.
static bool same_bytes(const void *a, const void *b, size_t size)
{
    return memcmp(a, b, size) == 0;
}

// --- what a change requires ----------------------------------------------------------------------

static enum change method_change(const struct method *from, const struct method *to)
{
    struct method same = *from;
    // When samples of all frames start to add up, the image must begin with its first sample.
    enum change least = from->fresh_frames && !to->fresh_frames ? CHANGE_CAMERA : CHANGE_SHOWN;
    same.fresh_frames = to->fresh_frames;
    same.samples_a_frame = to->samples_a_frame;
    for (int i = 0; i < SETTING_TOTAL; i++)
        if (!settings_table[i].changes_samples)
            field_copy(&settings_table[i].field, &same.settings, &to->settings);
    return same_bytes(&same, to, sizeof same) ? least : CHANGE_METHOD;
}

static void shown_changed(struct viewer *viewer, const struct shown *from)
{
    const struct shown *to = &viewer->stage.shown;
    uint32_t aovs = viewer_aovs(to);
    if (from->what != to->what)
        viewer->stage.has_kept = false; // the kept image was made with other display settings
    for (uint32_t side = 0; side < VIEWER_SIDES; side++) {
        const struct view *view = &viewer->stage.sides[side];
        enum change change = CHANGE_SHOWN;
        if (from->spp_limit != to->spp_limit)
            change = sample_planning(&view->method.settings, NULL) != PLANNING_NONE ? CHANGE_METHOD
                                                                                    : CHANGE_LIMIT;
        if (view->is_ready && (aovs & ~view->job.renderer.aovs))
            change = CHANGE_METHOD;
        viewer_side_changed(viewer, side, change);
    }
}

// Shows the planned number of samples if the method distributes samples according to it.
static void tell_plan(struct viewer *viewer, const struct method *from, const struct method *to)
{
    uint32_t limit = viewer->stage.shown.spp_limit;
    enum sample_planning planning = sample_planning(&to->settings, NULL);
    if (planning == PLANNING_NONE || sample_planning(&from->settings, NULL) != PLANNING_NONE)
        return;
    if (limit > 0)
        viewer_message(
            viewer, MESSAGE_NOTE,
            "sample points are planned for %u samples per pixel, at which rendering stops", limit);
    else if (planning == PLANNING_NEEDED)
        viewer_message(
            viewer, MESSAGE_NOTE,
            "this sampler stratifies over a fixed number of samples: set a sample limit");
}

// Replaces the environment. The new texels are loaded into a new arena, so that the old ones
// survive a failure.
static bool put_around(struct viewer *viewer, const struct around *to, struct err *err)
{
    struct arena arena = {0};
    if (!scene_set_surroundings(&viewer->document.scene, &viewer->document.original,
                                &to->surroundings, &arena, err)) {
        arena_finish(&arena);
        return false;
    }
    if (rebuild_is_pending(viewer)) { // the background build reads the texels that are freed below
        rebuild_cancel(viewer);
        viewer_changed(viewer, CHANGE_GEOMETRY);
    }
    arena_finish(&viewer->document.surroundings_arena);
    viewer->document.surroundings_arena = arena;
    viewer->document.surroundings = to->surroundings;
    viewer_begin_exposure(viewer);
    struct light *sun = find_sun(&viewer->document.scene);
    if (sun && to->has_sun)
        *sun = to->sun;
    viewer_changed(viewer, CHANGE_METHOD);
    return true;
}

struct list_counts edit_counts(const struct viewer *viewer)
{
    const struct scene *scene = &viewer->document.scene;
    return (struct list_counts){
        .materials = scene->material_count,
        .lights = scene->light_count - (scene_sun_light(scene) != SCENE_NONE),
        .shapes = scene->shape_count,
    };
}

static bool add_light(struct document *document)
{
    uint32_t index;
    struct light *added = scene_insert_light(&document->scene, &index);
    if (added)
        light_init(added);
    document->original.light_count += added != NULL;
    return added != NULL;
}

static bool add_shape(struct scene *scene)
{
    struct shape *added = scene_add_shape(scene, NULL);
    if (!added)
        return false;
    // Clears padding, too, because shapes are compared byte by byte.
    memset(added, 0, sizeof *added);
    added->kind = SHAPE_QUAD;
    added->axes[0][0] = added->axes[1][2] = 0.5;
    return true;
}

// Keeps the selection within a list: if the selected entry was removed, the last one is selected.
static void choose_within(uint32_t *chosen, uint32_t count)
{
    if (*chosen >= count)
        *chosen = count > 0 ? count - 1 : 0;
}

// Adds or removes elements. If memory runs out in between, the elements added so far remain, but
// invisible.
static bool put_lists(struct document *document, const struct list_counts *to, struct err *err)
{
    struct scene *scene = &document->scene;
    uint32_t sun = scene_sun_light(scene) != SCENE_NONE;
    bool ok = true;
    while (ok && scene->material_count < to->materials)
        ok = scene_add_material(scene, NULL) != NULL;
    while (ok && scene->light_count - sun < to->lights)
        ok = add_light(document);
    while (ok && scene->shape_count < to->shapes)
        ok = add_shape(scene);
    if (!ok)
        return err_memory(err, "what is added", sizeof(struct shape));
    for (; scene->light_count - sun > to->lights; document->original.light_count--)
        scene_take_light(scene);
    scene->material_count = to->materials;
    scene->shape_count = to->shapes;
    choose_within(&document->chosen_material, scene->material_count);
    choose_within(&document->chosen_light, scene->light_count);
    choose_within(&document->chosen_object, scene->instance_count + scene->shape_count);
    return true;
}

static bool put(struct viewer *viewer, enum target target, uint32_t index, const union state *from,
                const union state *to, struct err *err)
{
    switch (target) {
    case TARGET_CAMERA:
        viewer->view.camera = to->camera;
        viewer_changed(viewer, CHANGE_CAMERA);
        break;
    case TARGET_METHOD:
        viewer->stage.sides[index].method = to->method;
        viewer_side_changed(viewer, index, method_change(&from->method, &to->method));
        tell_plan(viewer, &from->method, &to->method);
        break;
    case TARGET_SURROUNDINGS:
        return put_around(viewer, &to->around, err);
    case TARGET_MATERIAL:
        viewer->document.scene.materials[index] = to->material;
        viewer_changed(viewer, CHANGE_TABLES);
        break;
    case TARGET_LIGHT:
        viewer->document.scene.lights[index] = to->light;
        viewer_changed(viewer, CHANGE_METHOD);
        break;
    case TARGET_OBJECT:
        *hidden_flag(&viewer->document.scene, index) = !to->visible;
        viewer_changed(viewer, CHANGE_GEOMETRY);
        break;
    case TARGET_DISPLAY:
        viewer->stage.shown = to->shown;
        shown_changed(viewer, &from->shown);
        break;
    case TARGET_PLACE:
        if (!scene_place(&viewer->document.scene, index, &to->placement, err))
            return false;
        viewer_changed(viewer, CHANGE_GEOMETRY);
        break;
    case TARGET_LISTS:
        if (!put_lists(&viewer->document, &to->counts, err))
            return false;
        viewer_changed(viewer, CHANGE_GEOMETRY);
        break;
    case TARGET_POSE:
        viewer->document.pose.wanted = to->pose;
        viewer->stage.is_resting = false;
        break;
    case TARGET_SHAPE:
        viewer->document.scene.shapes[index] = to->shape;
        viewer_changed(viewer, CHANGE_GEOMETRY);
        break;
    case TARGET_COUNT:
        break;
    }
    return true;
}

static bool is_there(const struct scene *scene, enum target target, uint32_t index)
{
    switch (target) {
    case TARGET_METHOD:
        return index < VIEWER_SIDES;
    case TARGET_MATERIAL:
        return index < scene->material_count;
    case TARGET_LIGHT:
        return index < scene->light_count;
    case TARGET_OBJECT:
    case TARGET_PLACE:
        return index < scene->instance_count + scene->shape_count;
    case TARGET_SHAPE:
        return index < scene->shape_count;
    case TARGET_LISTS:
    case TARGET_POSE:
    case TARGET_CAMERA:
    case TARGET_SURROUNDINGS:
    case TARGET_DISPLAY:
    case TARGET_COUNT:
        break;
    }
    return true;
}

// --- steps ---------------------------------------------------------------------------------------

static void *before_of(const struct step *step)
{
    return step->states;
}

static void *after_of(const struct step *step)
{
    return (char *)step->states + state_bytes[step->target];
}

static bool goes_on(const struct history *history, enum target target, uint32_t index,
                    const char *control)
{
    const struct step *last = history->steps + history->done - 1;
    return history->is_open && !history->is_group && history->done > 0 &&
           history->done == history->count && last->target == target && last->index == index &&
           strcmp(last->control, control) == 0;
}

// Records a step. Returns false when out of memory: the change has been made but cannot be undone.
static bool record(struct history *history, enum target target, uint32_t index, const char *control,
                   const union state *before, const union state *after)
{
    size_t bytes = state_bytes[target];
    history->is_fresh = true;
    if (goes_on(history, target, index, control)) {
        memcpy(after_of(&history->steps[history->done - 1]), after, bytes);
        return true;
    }
    forget(history, history->done, history->count);
    bool is_joined = history->is_group && history->count > history->group_begin;
    if (history->count == STEPS_MAX) {
        forget(history, 0, 1);
        history->group_begin -= history->group_begin > 0;
    }
    struct step *step = &history->steps[history->count];
    *step = (struct step){
        .target = target, .index = index, .is_joined = is_joined, .states = malloc(2 * bytes)};
    if (!step->states)
        return false;
    strncpy(step->control, control, sizeof step->control - 1);
    memcpy(before_of(step), before, bytes);
    memcpy(after_of(step), after, bytes);
    history->done = ++history->count;
    history->is_open = true;
    return true;
}

static bool edit(struct viewer *viewer, enum target target, uint32_t index, const union state *to,
                 const char *control)
{
    union state before, after;
    struct err err = {0};
    assert(is_there(&viewer->document.scene, target, index));
    get(viewer, target, index, &before);
    if (same_bytes(&before, to, state_bytes[target]))
        return true;
    if (!put(viewer, target, index, &before, to, &err)) {
        viewer_message(viewer, MESSAGE_ERROR, "%s", err.msg);
        return false;
    }
    get(viewer, target, index, &after);
    if (!record(viewer->document.history, target, index, control, &before, &after))
        viewer_message(viewer, MESSAGE_WARNING, "out of memory: the change of %s cannot be undone",
                       control);
    return true;
}

static union state zeroed(void)
{
    union state state;
    memset(&state, 0, sizeof state);
    return state;
}

bool edit_camera(struct viewer *viewer, const struct camera *to, const char *control)
{
    union state state = zeroed();
    state.camera = *to;
    return edit(viewer, TARGET_CAMERA, 0, &state, control);
}

bool edit_method(struct viewer *viewer, uint32_t side, const struct method *to, const char *control)
{
    union state state = zeroed();
    state.method = *to;
    return edit(viewer, TARGET_METHOD, side, &state, control);
}

bool edit_surroundings(struct viewer *viewer, const struct surroundings *to, const char *control)
{
    union state state = zeroed();
    if (same_bytes(to, &viewer->document.surroundings, sizeof *to))
        return true;
    state.around.surroundings = *to;
    return edit(viewer, TARGET_SURROUNDINGS, 0, &state, control);
}

bool edit_material(struct viewer *viewer, uint32_t index, const struct material *to,
                   const char *control)
{
    union state state = zeroed();
    state.material = *to;
    return edit(viewer, TARGET_MATERIAL, index, &state, control);
}

bool edit_light(struct viewer *viewer, uint32_t index, const struct light *to, const char *control)
{
    union state state = zeroed();
    state.light = *to;
    return edit(viewer, TARGET_LIGHT, index, &state, control);
}

bool edit_visible(struct viewer *viewer, uint32_t object, bool visible, const char *control)
{
    union state state = zeroed();
    state.visible = visible;
    return edit(viewer, TARGET_OBJECT, object, &state, control);
}

bool edit_shown(struct viewer *viewer, const struct shown *to, const char *control)
{
    union state state = zeroed();
    state.shown = *to;
    const bool was_auto = viewer->stage.shown.exposure_is_auto;
    // Setting the exposure by hand turns off its automatic computation.
    if (!same_bytes(&to->exposure, &viewer->stage.shown.exposure, sizeof to->exposure))
        state.shown.exposure_is_auto = 0;
    bool ok = edit(viewer, TARGET_DISPLAY, 0, &state, control);
    if (viewer->stage.shown.exposure_is_auto != was_auto)
        viewer_begin_exposure(viewer);
    return ok;
}

bool edit_place(struct viewer *viewer, uint32_t object, const struct placement *to,
                const char *control)
{
    union state state = zeroed();
    state.placement = *to;
    return edit(viewer, TARGET_PLACE, object, &state, control);
}

bool edit_lists(struct viewer *viewer, const struct list_counts *to, const char *control)
{
    union state state = zeroed();
    state.counts = *to;
    return edit(viewer, TARGET_LISTS, 0, &state, control);
}

bool edit_shape(struct viewer *viewer, uint32_t index, const struct shape *to, const char *control)
{
    union state state = zeroed();
    state.shape = *to;
    return edit(viewer, TARGET_SHAPE, index, &state, control);
}

bool edit_pose(struct viewer *viewer, const struct scene_pose *to, const char *control)
{
    union state state = zeroed();
    state.pose = *to;
    return edit(viewer, TARGET_POSE, 0, &state, control);
}

void edit_begin_group(struct viewer *viewer)
{
    edit_close(viewer);
    viewer->document.history->is_group = true;
    viewer->document.history->group_begin = viewer->document.history->done;
}

void edit_end_group(struct viewer *viewer)
{
    viewer->document.history->is_group = viewer->document.history->is_open = false;
}

// Closes the open step. A step that ends with the value with which it began is removed from the
// history.
void edit_close(struct viewer *viewer)
{
    struct history *history = viewer->document.history;
    if (!history->is_open)
        return;
    const struct step *last = &history->steps[history->done - 1];
    if (same_bytes(before_of(last), after_of(last), state_bytes[last->target]))
        forget(history, history->done - 1, history->done);
    history->is_open = false;
}

// --- undoing and redoing -------------------------------------------------------------------------

static bool go(struct viewer *viewer, const struct step *step, const void *to)
{
    union state from, state = zeroed();
    struct err err = {0};
    memcpy(&state, to, state_bytes[step->target]);
    get(viewer, step->target, step->index, &from);
    if (put(viewer, step->target, step->index, &from, &state, &err))
        return true;
    viewer_message(viewer, MESSAGE_ERROR, "%s", err.msg);
    return false;
}

// Undoes one step. Returns false if there is none.
static bool undo_one(struct viewer *viewer)
{
    struct history *history = viewer->document.history;
    const struct step *step = &history->steps[history->done - 1];
    if (!go(viewer, step, before_of(step)))
        return false;
    history->done--;
    return true;
}

bool edit_undo(struct viewer *viewer)
{
    struct history *history = viewer->document.history;
    edit_close(viewer);
    if (history->done == 0)
        return false;
    while (undo_one(viewer) && history->done > 0 && history->steps[history->done].is_joined)
        ;
    return true;
}

bool edit_redo(struct viewer *viewer)
{
    struct history *history = viewer->document.history;
    edit_close(viewer);
    if (history->done == history->count)
        return false;
    do {
        const struct step *step = &history->steps[history->done];
        if (!go(viewer, step, after_of(step)))
            break;
        history->done++;
    } while (history->done < history->count && history->steps[history->done].is_joined);
    return true;
}

bool edit_revert(struct viewer *viewer)
{
    struct history *history = viewer->document.history;
    bool is_fresh = history->is_fresh && history->done > 0;
    history->is_fresh = history->is_open = false;
    if (!is_fresh || !undo_one(viewer))
        return false;
    while (history->done > 0 && history->steps[history->done].is_joined && undo_one(viewer))
        ;
    forget(history, history->done, history->count);
    return true;
}

void edit_settle(struct viewer *viewer)
{
    viewer->document.history->is_fresh = false;
}

// Returns the number of steps in a range; steps that are joined count as one.
static uint32_t count_steps(const struct history *history, uint32_t from, uint32_t to)
{
    uint32_t count = 0;
    for (uint32_t i = from; i < to; i++)
        count += !history->steps[i].is_joined;
    return count;
}

uint32_t edit_undo_count(const struct viewer *viewer)
{
    return count_steps(viewer->document.history, 0, viewer->document.history->done);
}

uint32_t edit_redo_count(const struct viewer *viewer)
{
    const struct history *history = viewer->document.history;
    return count_steps(history, history->done, history->count);
}

const char *edit_undo_name(const struct viewer *viewer)
{
    const struct history *history = viewer->document.history;
    return history->done > 0 ? history->steps[history->done - 1].control : NULL;
}
