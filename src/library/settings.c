// Reads the settings of a render from JSON.
#include "library/library.h"

#include "json/field_json.h"
#include "json/json_parse.h"
#include "render/aov_names.h"
#include <string.h>

// --- keys that are no settings of scene files ----------------------------------------------------

static const struct field goal_fields[] = {
    {.key = "error",
     .type = FIELD_REAL,
     .min = 0,
     .max = 1e9,
     .open = true,
     FIELD_OF(job_goal, error)},
    {.key = "seconds",
     .type = FIELD_REAL,
     .min = 0,
     .max = 1e9,
     .open = true,
     FIELD_OF(job_goal, seconds)},
    {.key = "adaptive", .type = FIELD_SWITCH, FIELD_OF(job_goal, adaptive)},
};
enum { GOAL_FIELDS = sizeof goal_fields / sizeof *goal_fields };

static const char *const other_keys[] = {"camera", "aov", "resume"};
enum { OTHER_KEYS = sizeof other_keys / sizeof *other_keys };

static bool read_layer(const struct json_node *node, uint32_t *aovs, struct err *err)
{
    const char *names[32] = {NULL};
    uint32_t index, count = 0;
    for (; aov_names[count].name; count++)
        names[count] = aov_names[count].name;
    if (!node_choice(node, names, &index, err))
        return false;
    *aovs |= aov_names[index].bits;
    return true;
}

static bool read_layers(const struct json_node *settings, uint32_t *aovs, struct err *err)
{
    const struct json_node list = node_member(settings, "aov");
    if (!list.value)
        return true;
    if (!node_check_array(&list, 0, 64, err))
        return false;
    for (size_t i = 0; i < json_array_size(list.value); i++) {
        const struct json_node node = node_element(&list, i);
        if (!read_layer(&node, aovs, err))
            return false;
    }
    return true;
}

static bool find_camera(const struct json_node *node, const struct scene *scene, uint32_t *out,
                        struct err *err)
{
    const char *name = json_string_value(node->value);
    for (uint32_t i = 0; name && i < scene->camera_count; i++)
        if (scene->cameras[i].name && strcmp(scene->cameras[i].name, name) == 0) {
            *out = i;
            return true;
        }
    if (json_is_integer(node->value) && json_integer_value(node->value) >= 0 &&
        json_integer_value(node->value) < scene->camera_count) {
        *out = (uint32_t)json_integer_value(node->value);
        return true;
    }
    return node_fail(node, err,
                     "there is no camera %s; expected the name of one or an index below %u",
                     node_describe(node->value).text, scene->camera_count);
}

static bool read_resume(const struct json_node *settings, struct arena *arena, const char **out,
                        struct err *err)
{
    const char *path = NULL;
    if (!node_read_string(settings, "resume", &path, err))
        return false;
    *out = path ? arena_strdup(arena, path) : NULL;
    return !path || *out || err_memory(err, "a path", strlen(path) + 1);
}

// --- all settings --------------------------------------------------------------------------------

static bool check_keys(const struct json_node *node, struct err *err)
{
    static const char *const none[] = {NULL};
    const char *known[SETTING_TOTAL + GOAL_FIELDS + OTHER_KEYS + 1] = {NULL};
    uint32_t count = 0;
    for (uint32_t i = 0; i < SETTING_TOTAL; i++)
        known[count++] = settings_table[i].field.key;
    for (uint32_t i = 0; i < GOAL_FIELDS; i++)
        known[count++] = goal_fields[i].key;
    for (uint32_t i = 0; i < OTHER_KEYS; i++)
        known[count++] = other_keys[i];
    return node_check_object(node, none, known, err);
}

static bool read_settings(const struct json_node *node, struct settings *settings, struct err *err)
{
    for (uint32_t i = 0; i < SETTING_TOTAL; i++)
        if (!field_read(&settings_table[i].field, node, settings, err))
            return false;
    if ((uint64_t)settings->width * settings->height > SETTINGS_PIXELS_MAX)
        return node_fail(node, err, "%u x %u pixels; expected at most %llu in all", settings->width,
                         settings->height, (unsigned long long)SETTINGS_PIXELS_MAX);
    return true;
}

static bool read_all(const struct json_node *node, struct scene *scene, struct arena *arena,
                     struct render_wishes *out, struct err *err)
{
    const struct json_node camera = node_member(node, "camera");
    if (!check_keys(node, err) || !read_settings(node, &scene->settings, err) ||
        !fields_read(goal_fields, GOAL_FIELDS, node, &out->goal, err) ||
        !read_layers(node, &out->aovs, err) || !read_resume(node, arena, &out->resume, err))
        return false;
    if (node_member(node, "spp").value)
        out->goal.samples = scene->settings.spp;
    // The framed camera depends on the size of the picture, which the settings may change.
    scene_frame_camera(scene);
    return !camera.value || find_camera(&camera, scene, &out->camera, err);
}

bool render_read_settings(const char *json, struct scene *scene, struct arena *arena,
                          struct render_wishes *out, struct err *err)
{
    const char *text = json ? json : "{}";
    const struct file_bytes bytes = {(const uint8_t *)text, strlen(text)};
    json_t *root = json_parse("settings", &bytes, JSON_REJECT_DUPLICATES, err);
    *out = (struct render_wishes){0};
    if (!root)
        return false;
    const struct json_node node = node_root("settings", root);
    bool ok = read_all(&node, scene, arena, out, err);
    json_decref(root);
    return ok;
}
