// Flattens vertex attributes. Part of flatten.c.
#ifndef LAMPYRIS_FLATTEN_FLATTEN_ATTRIBUTES_H
#define LAMPYRIS_FLATTEN_FLATTEN_ATTRIBUTES_H

#include "flatten/flatten_placement.h"

// The optional arrays of struct flat_scene that some triangle needs and some mesh provides.
struct attribute_needs {
    bool normals, tangents, uvs[2], colors;
};

// Adds the needs of an instance, by the materials of its triangles.
void attributes_census(const struct scene *scene, const struct instance *instance,
                       struct attribute_needs *needs);
// Returns the bytes per triangle of the arrays that are needed.
uint64_t attributes_bytes(const struct attribute_needs *needs);
bool attributes_reserve(const struct attribute_needs *needs, size_t triangle_count,
                        struct arena *arena, struct flat_scene *flat, struct err *err);
// Stores the attributes of the next flat triangle. The last arguments are its vertices in the mesh
// and its geometric unit normal.
void attributes_place(struct flat_scene *flat, const struct scene *scene,
                      const struct placement *placement, const uint32_t vertices[3],
                      const double geometric[3]);

// Returns the set of texture coordinates from which a material's tangents are computed if a mesh
// has none.
uint32_t attributes_tangent_set(const struct scene *scene, uint32_t material);

// Returns a number that identifies the set of vertex attributes that a material needs.
uint32_t attributes_of_material(const struct scene *scene, uint32_t material);

// Returns the material of a triangle of the instance's mesh.
uint32_t instance_material(const struct mesh *mesh, const struct instance *instance,
                           uint32_t triangle);

#endif
