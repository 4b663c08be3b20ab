// Recompiles kernels while the viewer runs. The kernels for display and denoising are not
// recompiled: they do not belong to the renderer, and do not affect the film.
#include "viewer/core/reload.h"

#include "base/clock.h"
#include "base/file_system.h"
#include "cli/options.h"
#include "kernel_source.h"
#include "viewer/core/messages.h"
#include "viewer/core/shader_compile.h"
#include "viewer/core/viewer.h"
#include <limits.h>
#include <stdatomic.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ERRORS_MAX 8192

// A .comp file. `code` is the result of its last compilation, or NULL while the embedded code is
// used.
struct source {
    struct shader_unit unit;
    struct shader_code *code;
};

// Kernels that renderers may be using. The set holds references to their code.
struct set {
    struct kernel_set kernels;
    struct shader_code *codes[KERNEL_COUNT];
    struct set *next;
};

struct reload {
    char folder[PATH_MAX];
    const char *why_not;
    struct source sources[SHADER_UNITS_MAX];
    uint32_t source_count;
    uint32_t source_of[KERNEL_COUNT];
    struct set *sets;
    // is_running: done() has not been called for the current job. is_asked_again: another job was
    // requested in the meantime.
    bool is_running, is_asked_again;
    char errors[ERRORS_MAX];
    atomic_bool is_cancelled;
};

// Lists the sources. Kernels of the same source have the same embedded code; the first of them has
// the file's name.
static void list_sources(struct reload *reload)
{
    for (int id = 0; id < KERNEL_COUNT; id++) {
        struct kernel_code code = kernel_code((enum kernel_id)id, true);
        int first = 0;
        while (kernel_code((enum kernel_id)first, true).spirv != code.spirv)
            first++;
        if (first == id) {
            reload->source_of[id] = reload->source_count;
            reload->sources[reload->source_count++].unit.name = code.name;
        } else {
            reload->source_of[id] = reload->source_of[first];
        }
    }
}
_Static_assert(KERNEL_COUNT <= SHADER_UNITS_MAX, "room for all sources");

bool reload_create(const struct options *options, struct reload **out, struct err *err)
{
    struct reload *reload = calloc(1, sizeof *reload);
    *out = reload;
    if (!reload)
        return err_memory(err, "reloading shaders", sizeof *reload);
    const char *folder = options->view.shaders ? options->view.shaders : KERNEL_FOLDER;
    char *real = file_real_path(folder);
    snprintf(reload->folder, sizeof reload->folder, "%s", real ? real : folder);
    free(real);
    reload->why_not = shader_why_not(reload->folder);
    list_sources(reload);
    return true;
}

// --- references to code --------------------------------------------------------------------------

static void release(struct shader_code *code, struct gpu *gpu)
{
    if (!code || --code->users > 0)
        return;
    if (gpu->device)
        gpu_kernels_forget(gpu, code->words);
    free(code);
}

static bool is_used(const struct set *set, const struct viewer *viewer)
{
    bool used = viewer->stage.kernels == &set->kernels;
    for (uint32_t i = 0; i < VIEWER_SIDES; i++)
        used |= viewer->stage.sides[i].job.renderer.kernel_set == &set->kernels;
    return used;
}

static void free_unused_sets(struct reload *reload, struct viewer *viewer)
{
    for (struct set **link = &reload->sets; *link;) {
        struct set *set = *link;
        if (is_used(set, viewer)) {
            link = &set->next;
            continue;
        }
        *link = set->next;
        for (int id = 0; id < KERNEL_COUNT; id++)
            release(set->codes[id], &viewer->stage.gpu);
        free(set);
    }
}

void reload_destroy(struct reload *reload, struct viewer *viewer)
{
    if (!reload)
        return;
    viewer->stage.kernels = NULL;
    free_unused_sets(reload, viewer);
    for (uint32_t i = 0; i < reload->source_count; i++) {
        free(reload->sources[i].unit.files);
        release(reload->sources[i].code, &viewer->stage.gpu);
    }
    free(reload);
}

void reload_stop(struct reload *reload)
{
    if (reload)
        atomic_store(&reload->is_cancelled, true);
}

// --- compiling, on the worker's thread -----------------------------------------------------------

struct compile {
    struct shader_job job;
    struct shader_unit units[SHADER_UNITS_MAX]; // the files' paths are owned by the struct reload
    struct shader_result results[SHADER_UNITS_MAX];
    char errors[ERRORS_MAX];
    uint64_t start_ns;
};

static bool compile(void *context, struct err *err)
{
    struct compile *c = context;
    return shader_compile(&c->job, c->results, c->errors, sizeof c->errors, err);
}

// --- results -------------------------------------------------------------------------------------

static bool is_same(const struct shader_code *code, const void *words, size_t bytes)
{
    return code->bytes == bytes && memcmp(code->words, words, bytes) == 0;
}

static const struct kernel_code *embedded(const struct reload *reload, uint32_t source, bool ballot,
                                          struct kernel_code *out)
{
    int id = 0;
    while (reload->source_of[id] != source)
        id++;
    *out = kernel_code((enum kernel_id)id, ballot);
    return out;
}

// Takes ownership of compiled code. Code that has not changed is freed, so that its pipelines stay
// in use.
static void take(struct reload *reload, struct gpu *gpu, uint32_t index, bool ballot,
                 const struct shader_result *result)
{
    struct source *source = &reload->sources[index];
    struct kernel_code built;
    free(source->unit.files);
    source->unit = result->unit;
    struct shader_code *code = result->code;
    embedded(reload, index, ballot, &built);
    if (is_same(code, built.spirv, built.bytes)) {
        free(code);
        code = NULL;
    } else if (source->code && is_same(code, source->code->words, source->code->bytes)) {
        free(code);
        return;
    } else {
        code->users = 1;
    }
    release(source->code, gpu);
    source->code = code;
}

static struct shader_code *current_code(const struct viewer *viewer, int id)
{
    // `set` is the struct's first member.
    const struct set *set = (const struct set *)viewer->stage.kernels;
    return set ? set->codes[id] : NULL;
}

// Makes the renderers use the current code of the sources. Returns how many kernels have changed,
// or -1 when out of memory.
static int use_sources(struct reload *reload, struct viewer *viewer)
{
    int changed = 0;
    bool is_embedded = true;
    for (int id = 0; id < KERNEL_COUNT; id++) {
        const struct shader_code *code = reload->sources[reload->source_of[id]].code;
        changed += code != current_code(viewer, id);
        is_embedded &= !code;
    }
    if (changed == 0)
        return 0;
    struct set *set = is_embedded ? NULL : calloc(1, sizeof *set);
    if (!set && !is_embedded)
        return -1;
    for (int id = 0; set && id < KERNEL_COUNT; id++) {
        struct shader_code *code = reload->sources[reload->source_of[id]].code;
        if (!code)
            continue;
        code->users++;
        set->codes[id] = code;
        set->kernels.codes[id] = (struct kernel_code){kernel_code((enum kernel_id)id, true).name,
                                                      code->words, code->bytes};
    }
    if (set) {
        set->next = reload->sets;
        reload->sets = set;
    }
    viewer->stage.kernels = set ? &set->kernels : NULL;
    viewer->stage.shaders_changed = true;
    return changed;
}
_Static_assert(offsetof(struct set, kernels) == 0, "current_code counts on it");

static void tell(struct viewer *viewer, const struct compile *c, int changed)
{
    double seconds = clock_seconds_since(c->start_ns);
    if (changed < 0)
        viewer_message(viewer, MESSAGE_ERROR, "shaders: out of memory");
    else if (changed == 0)
        viewer_message(viewer, MESSAGE_NOTE, "shaders: no source has changed");
    else
        viewer_message(viewer, MESSAGE_NOTE, "shaders: %d of %d kernels were recompiled in %.1f s",
                       changed, KERNEL_COUNT, seconds);
}

static void done(void *context, void *viewer_pointer, bool ok, const struct err *err)
{
    struct viewer *viewer = viewer_pointer;
    struct compile *c = context;
    struct reload *reload = viewer->shell.reload;
    reload->is_running = false;
    for (uint32_t i = 0; i < c->job.count; i++)
        if (c->results[i].outcome == SHADER_COMPILED)
            take(reload, &viewer->stage.gpu, i, c->job.ballot, &c->results[i]);
    memcpy(reload->errors, c->errors, sizeof reload->errors);
    if (ok)
        tell(viewer, c, use_sources(reload, viewer));
    else if (err->code != ERR_STOPPED)
        viewer_message(viewer, MESSAGE_ERROR, "shaders: %s", err->msg);
    free(c);
    free_unused_sets(reload, viewer);
    if (reload->is_asked_again && !atomic_load(&reload->is_cancelled)) {
        reload->is_asked_again = false;
        reload_shaders(viewer);
    }
}

void reload_shaders(struct viewer *viewer)
{
    struct reload *reload = viewer->shell.reload;
    if (reload->why_not) {
        viewer_message(viewer, MESSAGE_ERROR, "shaders: %s: %s", reload->folder, reload->why_not);
        return;
    }
    if (reload->is_running) {
        reload->is_asked_again = true;
        return;
    }
    struct compile *c = calloc(1, sizeof *c);
    if (!c) {
        viewer_message(viewer, MESSAGE_ERROR, "shaders: out of memory");
        return;
    }
    for (uint32_t i = 0; i < reload->source_count; i++)
        c->units[i] = reload->sources[i].unit;
    c->job = (struct shader_job){
        .folder = reload->folder,
        .ballot = viewer->stage.gpu.has_ballot,
        .units = c->units,
        .count = reload->source_count,
        .is_cancelled = &reload->is_cancelled,
    };
    c->start_ns = clock_ns();
    if (!worker_add(viewer->shell.worker, &(struct worker_task){"shaders", compile, done, c})) {
        free(c);
        viewer_message(viewer, MESSAGE_ERROR,
                       "shaders: not reloaded, because too many tasks are waiting");
        return;
    }
    reload->is_running = true;
}

bool reload_can_compile(const struct reload *reload, const char **why_not)
{
    *why_not = reload->why_not;
    return !reload->why_not;
}

const char *reload_errors(const struct reload *reload)
{
    return reload->errors;
}

const char *reload_folder(const struct reload *reload)
{
    return reload->folder;
}
