// The placement of the selected object, and the exchange of lamps and directional lights.
#include "viewer/panel/panel_internal.h"

#include "scene/core/placement.h"
#include "viewer/core/lamps.h"
#include <string.h>

static const struct gui_range turn = {-1e6, 1e6, .unit = "°", .drag = 180};
static const struct gui_range scale = {1e-6, 1e6, .logarithmic = true};

// Returns the centre of an object. It depends on all vertices of a mesh, so it is computed only
// when the object changes.
static const double *middle_of(struct panel *panel, const struct scene *scene, uint32_t object)
{
    struct panel_middle *known = &panel->middle;
    bool is_shape = object >= scene->instance_count;
    const struct instance *instance = is_shape ? NULL : &scene->instances[object];
    bool is_known = !is_shape && known->hash == scene->hash && known->object == object &&
                    memcmp(known->transform, instance->transform, sizeof known->transform) == 0;
    if (is_known)
        return known->middle;
    scene_object_middle(scene, object, known->middle);
    known->hash = is_shape ? 0 : scene->hash;
    known->object = object;
    if (instance)
        memcpy(known->transform, instance->transform, sizeof known->transform);
    return known->middle;
}

// Applies the changed factor to all axes, for shapes with a single scale factor.
static void even_scale(double now[3], const double before[3])
{
    double changed = now[0];
    for (int c = 0; c < 3; c++)
        if (now[c] != before[c])
            changed = now[c];
    for (int c = 0; c < 3; c++)
        now[c] = changed;
}

static void place(struct panel *panel, const struct document *document, uint32_t object)
{
    const struct scene *scene = &document->scene;
    struct gui *gui = panel->gui;
    gui->used = NULL;
    struct placement to = scene_placement(scene, object);
    if (!scene_find_placed(scene, object))
        to = placement_none(middle_of(panel, scene, object));
    const struct placement before = to;
    double position[3];
    for (int c = 0; c < 3; c++)
        position[c] = to.about[c] + to.move[c];
    bool is_moved =
        panel_position(panel, document, "object.position",
                       "Position of the object's centre in world space, in metres.", position);
    for (int c = 0; c < 3 && is_moved; c++)
        to.move[c] = position[c] - to.about[c];
    gui_vector(gui, "object.turn", "Turned",
               "Rotation about the object's centre and the world's x axis, then y, then z, in "
               "degrees, relative to the file.",
               &turn, to.turn_degrees);
    if (gui_vector(gui, "object.scale", "Scaled",
                   "Scale along the object's own axes, relative to the file; round shapes have a "
                   "single scale.",
                   &scale, to.scale) &&
        !place_axes_are_free(scene, object))
        even_scale(to.scale, before.scale);
    gui_enabled(panel->gui, !placement_is_none(&before));
    if (gui_button(panel->gui, "object.put_back", "Put back",
                   "Returns the object to its placement in the file.")) {
        to = placement_none(before.about);
        gui->used = "object.put_back";
    }
    gui_enabled(panel->gui, true);
    if (gui->used)
        edit_place(panel->viewer, object, &to, gui->used);
}

void panel_place(struct panel *panel, const struct document *document)
{
    const struct scene *scene = &document->scene;
    uint32_t object = document->chosen_object;
    if (object >= scene->instance_count + scene->shape_count)
        return;
    place(panel, document, object);
    gui_same_line(panel->gui);
    gui_applies(panel->gui, lamp_is(scene, object));
    if (gui_button(panel->gui, "object.exchange", "Replace by directional light",
                   "Hides this lamp and adds a directional light from its direction that is as "
                   "bright at the scene's centre."))
        lamp_exchange(panel->viewer, object, "object.exchange");
    gui_enabled(panel->gui, true);
}
