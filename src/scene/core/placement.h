// Objects that are placed anew after a scene was loaded: moved, turned and scaled against how their
// file has them. Scene files keep such placements in "edits", and editors change them.
//
// Objects are numbered as in renders: instances, then shapes.
#ifndef LAMPYRIS_SCENE_CORE_PLACEMENT_H
#define LAMPYRIS_SCENE_CORE_PLACEMENT_H

#include "scene/core/scene.h"

// An object is scaled along its own axes, then turned about the world's x, y and z axis in this
// order, then moved. A mesh is scaled about the same point that it is turned about, a shape about
// its own middle.
struct placement {
    double about[3]; // metres, in the world: the point that turning leaves where it is
    double move[3];  // metres
    double turn_degrees[3];
    double scale[3]; // > 0; along the axes of a mesh's space, or of a shape (place_axes_are_free)
};

// An object with a placement. Those of a scene are in ascending order.
struct placed_object {
    uint32_t object;
    struct placement placement;
    double transform[3][4]; // of an instance, as it would be without; or
    struct shape shape;     // a shape likewise: of its members only those that say where it is
};

struct placement placement_none(const double about[3]);
bool placement_is_none(const struct placement *placement); // whatever it is about

// Which of a shape's scales may differ from the others: a quad's are those of its edges u and v, a
// box's of its three edges; the first is along the axis of a cylinder. All others take one scale.
bool place_axes_are_free(const struct scene *scene, uint32_t object);

const struct placed_object *scene_find_placed(const struct scene *scene,
                                              uint32_t object); // or NULL
// The object's placement; none about the origin where it has none.
struct placement scene_placement(const struct scene *scene, uint32_t object);
// Places it. One that is none gives the object back the very bits that it was loaded with.
// ERR_INPUT where the shape would be none of its kind, or has no room in a scene's range; the
// object is as before then.
bool scene_place(struct scene *scene, uint32_t object, const struct placement *to, struct err *err);
// All of a shape but its material, and whether it is hidden.
void shape_take_place(struct shape *to, const struct shape *from);
// Writes the point that an object without a placement is turned about: the middle of a shape, or of
// the bounds that a mesh has in its own space. Looks at all vertices of a mesh.
void scene_object_middle(const struct scene *scene, uint32_t object, double out[3]);

#endif
