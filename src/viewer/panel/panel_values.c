// Ranges and values that several files of the panel use.
#include "viewer/panel/panel_internal.h"

#include "base/maths.h"
#include "viewer/core/messages.h"
#include <float.h>
#include <math.h>
#include <string.h>

const struct gui_range panel_unit = {0, 1};
const struct gui_range panel_radiance = {0, SCENE_RADIANCE_MAX, .logarithmic = true};
const struct gui_range panel_turn = {-360, 360, .unit = "°"};

bool panel_position(struct panel *panel, const struct document *document, const char *id,
                    const char *help, double position[3])
{
    double diagonal = 0;
    for (int c = 0; c < 3; c++) {
        double side = document->bounds_max[c] - document->bounds_min[c];
        diagonal += side * side;
    }
    bool is_some = document->bounds_min[0] <= document->bounds_max[0] && isfinite(diagonal);
    const struct gui_range range = {-SCENE_COORDINATE_MAX, SCENE_COORDINATE_MAX,
                                    .drag = is_some ? sqrt(diagonal) : 0};
    return gui_vector(panel->gui, id, "Position", help, &range, position);
}

bool panel_direction(struct panel *panel, const char *id, const char *help, const double *up,
                     double direction[3])
{
    static const struct gui_range range = {-1, 1};
    const char *used = panel->gui->used;
    double to[3], across[3], above[3];
    memcpy(to, direction, sizeof to);
    if (!gui_vector(panel->gui, id, "Direction", help, &range, to))
        return false;
    const double typed[3] = {to[0], to[1], to[2]};
    bool is_some = vec3_normalize(to);
    if (is_some && up) {
        memcpy(above, up, sizeof above);
        is_some = vec3_normalize(above);
        vec3_cross(to, above, across);
        is_some = is_some && vec3_length(across) > (double)FLT_EPSILON;
    }
    if (is_some) {
        memcpy(direction, to, sizeof to);
        return true;
    }
    panel->gui->used = used;
    viewer_message(panel->viewer, MESSAGE_WARNING, "%s: (%g, %g, %g) is zero%s: expected a %s", id,
                   typed[0], typed[1], typed[2], up ? " or parallel to the up vector" : "",
                   up ? "line of sight" : "direction");
    return false;
}
