// Placements: objects that were translated, rotated and scaled after loading, relative to their
// placement in the file. Scene files store placements in "edits", and editors change them.
//
// Objects are numbered as in renders: all instances, then all shapes.
#ifndef LAMPYRIS_SCENE_CORE_PLACEMENT_H
#define LAMPYRIS_SCENE_CORE_PLACEMENT_H

#include "scene/core/scene.h"

// An object is scaled along its own axes, then rotated about the world's x, y and z axis in this
// order, then translated. The centre of scaling and rotation is the point `about` for a mesh; a
// shape is scaled about its own centre.
struct placement {
    double about[3]; // centre of rotation in the world, metres
    double move[3];  // translation, metres
    double turn_degrees[3];
    double scale[3]; // > 0; along the object's own axes (see place_axes_are_free)
};

// An object with a placement. The array in a scene is in ascending order of `object`.
struct placed_object {
    uint32_t object;
    struct placement placement;
    double transform[3][4]; // for an instance: its transform without the placement
    struct shape shape;     // for a shape: its geometry without the placement; no other members
};

struct placement placement_none(const double about[3]);
bool placement_is_none(const struct placement *placement); // ignores `about`

// Returns whether the object's scales may differ. A quad may be scaled along its edges u and v, a
// box along its three edges, and a cylinder along its axis, which is the first. All other objects
// need one scale.
bool place_axes_are_free(const struct scene *scene, uint32_t object);

// Returns the entry of the object; NULL if it has no placement.
const struct placed_object *scene_find_placed(const struct scene *scene, uint32_t object);
// Returns the object's placement; the identity about the origin if it has none.
struct placement scene_placement(const struct scene *scene, uint32_t object);
// Places the object. The identity restores exactly the bits that were loaded. Fails with ERR_INPUT
// if the shape would become another kind of shape, or would leave the permitted range of
// coordinates; the object is then unchanged.
bool scene_place(struct scene *scene, uint32_t object, const struct placement *to, struct err *err);
// Copies all members of a shape except `material` and `hidden`.
void shape_take_place(struct shape *to, const struct shape *from);
// Computes the point about which an object without a placement is rotated: the centre of a shape,
// or of a mesh's bounds in its own space. Visits all vertices of a mesh.
void scene_object_middle(const struct scene *scene, uint32_t object, double out[3]);

#endif
