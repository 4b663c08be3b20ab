// load_scene FILE [KEY=VALUE …]: loads a scene with overrides. Exit status 0, or 1 with the error's
// code and message on stdout: what check_format.py drives. load_scene --parameters: prints the
// table of the materials' parameters, a line each: name, components, least, greatest, models, help.
// load_scene --settings: prints the table of settings as JSON.
// load_scene --edit OUT FILE [KEY=VALUE …]: edits everything at random and writes it to OUT.
#include "json/json_text.h"
#include "scene/json/scene_write.h"
#include "scene_edit_fixture.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_OVERRIDES 16

static void print_parameters(void)
{
    for (uint32_t i = 0; i < material_parameter_count; i++) {
        const struct material_parameter *p = &material_parameters[i];
        printf("%s %u %g %g ", p->name, p->count, (double)p->min, (double)p->max);
        for (uint32_t model = 0; model < MATERIAL_MODEL_COUNT; model++)
            if (p->models >> model & 1u)
                printf("%s,", material_model_names[model]);
        printf(" %s\n", p->help);
    }
}

static void print_text(struct json_text *t, const char *key, const char *text)
{
    json_text_key(t, key);
    json_text_string(t, text);
}

static void print_setting(struct json_text *t, enum setting_id id)
{
    static const char *const types[] = {[FIELD_SWITCH] = "switch",
                                        [FIELD_COUNT] = "count",
                                        [FIELD_CHOICE] = "choice",
                                        [FIELD_REAL] = "real"};
    const struct setting *setting = &settings_table[id];
    const struct field *field = &setting->field;
    char fallback[SETTING_RANGE_MAX];
    setting_default_text(setting, fallback);
    json_text_next(t);
    json_text_open(t, '{', true);
    print_text(t, "section", id <= SETTINGS_FILM_LAST ? "film" : "settings");
    print_text(t, "key", field->key);
    print_text(t, "type", types[field->type]);
    json_text_key(t, "range");
    json_text_open(t, '[', true);
    for (int i = 0; i < 2; i++) {
        json_text_next(t);
        json_text_double(t, i ? field->max : field->min);
    }
    json_text_close(t);
    print_text(t, "word", field->word ? field->word : "");
    json_text_key(t, "words");
    json_text_open(t, '[', true);
    for (int i = 0; field->words && field->words[i]; i++) {
        json_text_next(t);
        json_text_string(t, field->words[i]);
    }
    json_text_close(t);
    print_text(t, "default", fallback);
    print_text(t, "help", setting->help);
    json_text_close(t);
}

static void print_settings(void)
{
    struct json_text t;
    if (!json_text_begin(&t, 0, NULL))
        return;
    json_text_open(&t, '[', false);
    for (uint32_t i = 0; i < SETTING_TOTAL; i++)
        print_setting(&t, i);
    json_text_close(&t);
    char *text = json_text_end(&t);
    puts(text ? text : "");
    free(text);
}

static bool write_edited(const struct scene_load_params *load, struct scene *scene,
                         const char *path, struct err *err)
{
    struct random random = {1};
    struct arena arena = {0};
    struct scene before;
    bool ok = scene_snapshot(&arena, scene, &before, err);
    if (ok)
        edit_at_random(scene, &random);
    const struct scene_write_params params = {
        .path = path, .load = load, .before = &before, .scene = scene};
    ok = ok && scene_write(&params, err);
    arena_finish(&arena);
    return ok;
}

int main(int argc, char **argv)
{
    const char *out = NULL;
    struct scene_override overrides[MAX_OVERRIDES];
    struct scene_load_params params = {.overrides = overrides, .is_strict = true};
    if (argc < 2 || argc - 2 > MAX_OVERRIDES)
        return 2;
    if (strcmp(argv[1], "--parameters") == 0) {
        print_parameters();
        return 0;
    }
    if (strcmp(argv[1], "--settings") == 0) {
        print_settings();
        return 0;
    }
    if (argc > 3 && strcmp(argv[1], "--edit") == 0) {
        out = argv[2];
        argv += 2;
        argc -= 2;
    }
    params.path = argv[1];
    for (int i = 2; i < argc; i++) {
        char *equals = strchr(argv[i], '=');
        if (!equals)
            return 2;
        *equals = '\0';
        overrides[params.override_count++] = (struct scene_override){argv[i], equals + 1};
    }
    struct scene scene;
    struct err err = {0};
    bool ok =
        scene_load(&params, &scene, &err) && (!out || write_edited(&params, &scene, out, &err));
    if (!ok)
        printf("%d %s\n", err.code, err.msg);
    scene_finish(&scene);
    return !ok;
}
