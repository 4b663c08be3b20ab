// Draws a control for each setting from the table of settings.
#include "viewer/panel/panel_internal.h"

#include <math.h>

#define WIDE 1e3 // wider ranges get a logarithmic control

static const char *const setting_ids[SETTING_TOTAL] = {
#define SETTING(ID, type, member, key, ...) [SETTING_##ID] = "renderer." key,
#define SETTING_OF_FILE SETTING
#include "scene/core/settings_list.h"
};

// Returns whether a word stands for a number above the range. The control then has one step more
// than the range.
static bool has_word_at_end(const struct field *field)
{
    return field->word && field->word_value > field->max;
}

static struct gui_range range_of(const struct setting *setting)
{
    const struct field *field = &setting->field;
    const char *word = setting->special ? setting->special : field->word;
    bool is_count = field->type == FIELD_COUNT;
    return (struct gui_range){
        .min = field->min,
        .max = !has_word_at_end(field) ? field->max
               : is_count              ? field->max + 1
                                       : INFINITY,
        .logarithmic = field->max - field->min > WIDE,
        .integer = is_count,
        .unit = setting->unit,
        .infinite = has_word_at_end(field) ? word : NULL,
        .greatest = field->max,
        .least = has_word_at_end(field) ? NULL : word,
        .file_word = field->word,
        .drag = setting->drag,
    };
}

static void number(struct gui *gui, enum setting_id id, struct settings *to)
{
    const struct setting *setting = &settings_table[id];
    const struct field *field = &setting->field;
    const struct gui_range range = range_of(setting);
    bool is_word = has_word_at_end(field) && field_is_word(field, to);
    double value = is_word ? range.max : field_get(field, to);
    float narrow = (float)value;
    bool is_used;
    if (field->type == FIELD_REAL) {
        is_used = gui_float(gui, setting_ids[id], setting->label, setting->help, &range, &narrow);
        value = (double)narrow;
    } else {
        is_used = gui_number(gui, setting_ids[id], setting->label, setting->help, &range, &value);
    }
    if (is_used && has_word_at_end(field) && value > field->max)
        field_set_word(field, to);
    else if (is_used)
        field_set(field, to, value);
}

static void control(struct gui *gui, enum setting_id id, struct settings *to)
{
    const struct setting *setting = &settings_table[id];
    const struct field *field = &setting->field;
    uint32_t choice = (uint32_t)field_get(field, to);
    bool on = choice != 0;
    switch (field->type) {
    case FIELD_SWITCH:
        if (gui_switch(gui, setting_ids[id], setting->label, setting->help, &on))
            field_set(field, to, on);
        break;
    case FIELD_CHOICE:
        if (gui_choice(gui, setting_ids[id], setting->label, setting->help, field->words, &choice))
            field_set(field, to, choice);
        break;
    default:
        number(gui, id, to);
    }
}

void panel_settings(struct panel *panel, const struct document *document, struct settings *to)
{
    struct gui *gui = panel->gui;
    bool has_image = document->scene.environment.width > 0;
    for (int i = 0; i < SETTING_TOTAL; i++) {
        const struct setting *setting = &settings_table[i];
        if (!setting->label)
            continue;
        if (setting->gap)
            gui_space(gui);
        gui_applies(gui, setting_is_in_use(setting, to, has_image));
        control(gui, i, to);
    }
    gui_enabled(gui, true);
}
