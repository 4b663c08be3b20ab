// Generates tangents for normal maps, for meshes without tangents.
#ifndef LAMPYRIS_SCENE_MESH_TANGENTS_H
#define LAMPYRIS_SCENE_MESH_TANGENTS_H

#include "scene/core/scene.h"

// Gives a mesh tangents along its texture coordinates uvs[uv_set], which must exist, after
// Mikkelsen 2008, "Simulation of Wrinkled Surfaces Revisited", section 3.3 and appendix, with the
// rules of his reference program, so that they fit normal maps that were baked with it. The sign of
// the bitangent is for maps whose green points up in the image, although t points down. Vertices
// whose corners need different tangents are split. Then all vertex arrays and the indices are new,
// in order of first use. Memory of the result comes from `arena`; the mesh's old arrays are
// unchanged.
bool mesh_generate_tangents(struct mesh *mesh, uint32_t uv_set, const struct progress *progress,
                            struct arena *arena, struct err *err);

// Generates tangents for every mesh of the scene that has none, has texture coordinates, and is
// used with a material that needs tangents (for a normal map or anisotropy).
bool scene_generate_tangents(struct scene *scene, struct err *err);

#endif
