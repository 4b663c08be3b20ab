// Rows of controls over a copy of something, and the ranges that several of them have.
#include "viewer/panel/panel_internal.h"

#include "base/maths.h"
#include <math.h>

const struct gui_range panel_unit = {0, 1};
const struct gui_range panel_radiance = {0, SCENE_RADIANCE_MAX, .logarithmic = true};
const struct gui_range panel_turn = {-360, 360, .unit = "°"};

struct gui_range panel_coordinate(const struct document *document)
{
    double diagonal = 0;
    for (int c = 0; c < 3; c++) {
        double side = document->bounds_max[c] - document->bounds_min[c];
        diagonal += side * side;
    }
    bool is_some = document->bounds_min[0] <= document->bounds_max[0] && isfinite(diagonal);
    return (struct gui_range){-SCENE_COORDINATE_MAX, SCENE_COORDINATE_MAX,
                              .drag = is_some ? sqrt(diagonal) : 0};
}

static bool used(struct form *form, const char *id, bool is_used)
{
    if (is_used)
        form->used = id;
    return is_used;
}

bool form_switch(struct form *form, const char *id, const char *label, const char *help,
                 bool *value)
{
    return used(form, id, gui_switch(form->gui, id, label, help, value));
}

bool form_flag(struct form *form, const char *id, const char *label, const char *help,
               uint32_t *value)
{
    bool on = *value != 0;
    if (!form_switch(form, id, label, help, &on))
        return false;
    *value = on;
    return true;
}

bool form_number(struct form *form, const char *id, const char *label, const char *help,
                 const struct gui_range *range, double *value)
{
    return used(form, id, gui_number(form->gui, id, label, help, range, value));
}

bool form_float(struct form *form, const char *id, const char *label, const char *help,
                const struct gui_range *range, float *value)
{
    return used(form, id, gui_float(form->gui, id, label, help, range, value));
}

bool form_count(struct form *form, const char *id, const char *label, const char *help,
                const struct gui_range *range, uint32_t *value)
{
    return used(form, id, gui_count(form->gui, id, label, help, range, value));
}

bool form_angle(struct form *form, const char *id, const char *label, const char *help,
                const struct gui_range *range, double *radians)
{
    double degrees = *radians * (180.0 / M_PI);
    if (!form_number(form, id, label, help, range, &degrees))
        return false;
    *radians = degrees * DEGREE;
    return true;
}

bool form_choice(struct form *form, const char *id, const char *label, const char *help,
                 const char *const *names, uint32_t *value)
{
    return used(form, id, gui_choice(form->gui, id, label, help, names, value));
}

bool form_color(struct form *form, const char *id, const char *label, const char *help,
                const struct gui_range *range, float value[3])
{
    return used(form, id, gui_color(form->gui, id, label, help, range, value));
}

bool form_vector(struct form *form, const char *id, const char *label, const char *help,
                 const struct gui_range *range, double value[3])
{
    return used(form, id, gui_vector(form->gui, id, label, help, range, value));
}
