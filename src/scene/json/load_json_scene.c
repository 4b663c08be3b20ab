// The sections "film" and "settings" of a scene file.
#include "json/field_json.h"
#include "scene/json/load_json.h"
#include "shared/methods.h"
#include <math.h>
#include <string.h>

// Reads the settings `first` to `last`, which are in one section.
static bool read_section(struct settings *settings, const struct json_node *node,
                         enum setting_id first, enum setting_id last, struct err *err)
{
    static const char *const none[] = {NULL};
    const char *known[SETTING_TOTAL + 1] = {NULL};
    for (uint32_t i = 0; i <= last - first; i++)
        known[i] = settings_table[first + i].field.key;
    if (!node_check_object(node, none, known, err))
        return false;
    for (uint32_t i = first; i <= last; i++)
        if (!field_read(&settings_table[i].field, node, settings, err))
            return false;
    return true;
}

bool load_json_film(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    struct scene *scene = loader->scene;
    struct settings *settings = &scene->settings;
    if (!read_section(settings, node, SETTINGS_FILM_FIRST, SETTINGS_FILM_LAST, err))
        return false;
    scene->has_own_exposure |= node_member(node, "exposure").value != NULL;
    scene->has_own_tone |= node_member(node, "tone").value != NULL;
    if ((uint64_t)settings->width * settings->height > SETTINGS_PIXELS_MAX)
        return node_fail(node, err, "%u x %u pixels; expected at most %llu in all", settings->width,
                         settings->height, (unsigned long long)SETTINGS_PIXELS_MAX);
    return true;
}

// Removes the key of a former setting, attenuation by distance, which files of earlier versions
// have with the value 0.
static bool take_out_falloff(const struct json_node *node, struct err *err)
{
    struct json_node falloff = node_member(node, "falloff");
    double value = 0;
    if (!falloff.value)
        return true;
    if (!node_number(&falloff, (struct range){0, INFINITY}, &value, err))
        return false;
    if (value > 0)
        return node_fail(&falloff, err,
                         "attenuation by distance is no longer supported; expected no such key");
    json_object_del(node->value, "falloff");
    return true;
}

// Renames the default accumulation, which was called "compensated" in files of earlier versions.
static bool rename_accumulation(const struct json_node *node, struct err *err)
{
    struct json_node name = node_member(node, "film_accumulation");
    const char *text = json_string_value(name.value);
    if (!text || strcmp(text, "compensated") != 0)
        return true;
    const char *now = accumulation_names[ACCUMULATION_BINNED];
    return json_object_set_new(node->value, "film_accumulation", json_string(now)) == 0 ||
           err_memory(err, "film_accumulation", strlen(now));
}

bool load_json_settings(struct json_loader *loader, const struct json_node *node, struct err *err)
{
    if (!take_out_falloff(node, err) || !rename_accumulation(node, err))
        return false;
    return read_section(&loader->scene->settings, node, SETTINGS_FILM_LAST + 1, SETTING_TOTAL - 1,
                        err);
}
