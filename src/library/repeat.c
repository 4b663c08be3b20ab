// Makes the command line that renders the same picture again.
#include "library/library.h"

#include "render/aov_names.h"
#include "render/sampling_plan.h"
#include "shared/aov.h"
#include <inttypes.h>
#include <string.h>

// Appends a blank and a word, quoted for a POSIX shell if necessary. Returns NULL when out of
// memory.
static const char *append_word(const char *line, const char *word, struct arena *arena)
{
    static const char plain[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789"
                                "_@%+=:,./-";
    if (!line || (*word && word[strspn(word, plain)] == '\0'))
        return line ? arena_printf(arena, "%s %s", line, word) : NULL;
    line = arena_printf(arena, "%s '", line);
    for (const char *at = word; line && *at;) {
        size_t length = strcspn(at, "'");
        // Replaces a single quote by '\'': ends the quoted text, adds an escaped quote, and begins
        // again.
        line = arena_printf(arena, "%s%.*s%s", line, (int)length, at, at[length] ? "'\\''" : "");
        at += length + (at[length] == '\'');
    }
    return line ? arena_printf(arena, "%s'", line) : NULL;
}

static const char *append_override(const char *line, const char *key, const char *value,
                                   struct arena *arena)
{
    const char *word = arena_printf(arena, "%s=%s", key, value);
    return word ? append_word(append_word(line, "-D", arena), word, arena) : NULL;
}

const char *repeat_begin(const struct lampyris_scene *scene, struct arena *arena)
{
    const char *line = "lampyris render";
    if (!scene->is_repeatable)
        return NULL;
    line = append_word(line, scene->path, arena);
    for (uint32_t i = 0; i < scene->override_count; i++)
        line = append_override(line, scene->overrides[i].key, scene->overrides[i].value, arena);
    for (const struct scene_edit *edit = scene->edits; edit; edit = edit->next)
        line = append_override(line, edit->key, edit->value, arena);
    if (line && scene->allow_outside_paths)
        line = append_word(line, "--allow-outside-paths", arena);
    return line && scene->is_strict ? append_word(line, "--strict", arena) : line;
}

// Appends the settings that differ from the scene's.
static const char *append_settings(const char *line, const struct lampyris_render *render,
                                   struct arena *arena)
{
    const struct settings *made = &render->adapted.settings,
                          *given = &render->loaded->scene.settings;
    if (made->width != given->width || made->height != given->height)
        line =
            line ? arena_printf(arena, "%s --size %ux%u", line, made->width, made->height) : NULL;
    for (int i = 0; i < SETTING_TOTAL; i++) {
        const struct setting *setting = &settings_table[i];
        char value[FIELD_TEXT_MAX];
        bool is_same = field_same(&setting->field, made, given);
        if (i == SETTING_SPP || i == SETTING_WIDTH || i == SETTING_HEIGHT || is_same)
            continue;
        if (!setting->option)
            return NULL;
        field_text(&setting->field, made, value);
        line = line ? arena_printf(arena, "%s --%s %s", line, setting->option, value) : NULL;
    }
    return line;
}

static const char *append_layers(const char *line, uint32_t aovs, struct arena *arena)
{
    const char *names = "";
    for (const struct aov_name *word = aov_names; word->name && names; word++)
        if (word->bits != AOV_END - 1u && (aovs & word->bits))
            names = arena_printf(arena, "%s%s%s", names, *names ? "," : "", word->name);
    return names && line && *names ? arena_printf(arena, "%s --aov %s", line, names)
           : names                 ? line
                                   : NULL;
}

// Returns whether the render has its planned number of samples. A sampler that needs this number in
// advance renders the same picture only for the same number.
static bool is_as_planned(const struct job *job)
{
    const struct settings *settings = &job->scene->settings;
    return sample_planning(settings, NULL) == PLANNING_NONE ||
           (!job->is_open_ended && job_samples(job) == settings->spp);
}

static bool is_repeatable(const struct lampyris_render *render)
{
    const struct job *job = &render->job;
    const struct film_image *film = &job->film;
    bool is_even = render->wishes.goal.adaptive ? !job->stopped && !job_is_rescued(job)
                                                : film->least_samples == film->most_samples;
    return render->command && render->has_step && is_even && film->least_samples > 0 &&
           is_as_planned(job);
}

const char *repeat_command(const struct lampyris_render *render, struct arena *arena)
{
    const struct render_wishes *wishes = &render->wishes;
    if (!is_repeatable(render))
        return NULL;
    const char *line = append_settings(render->command, render, arena);
    if (line && wishes->camera > 0)
        line = arena_printf(arena, "%s --camera %u", line, wishes->camera);
    line = append_layers(line, wishes->aovs, arena);
    if (line && wishes->goal.adaptive)
        line = arena_printf(arena, "%s --adaptive on", line);
    return line ? arena_printf(arena, "%s --spp %" PRIu64, line, job_samples(&render->job)) : NULL;
}
