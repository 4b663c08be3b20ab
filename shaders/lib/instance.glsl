// Reads instances: the transforms between the world and the space of a shared mesh.
#ifndef INSTANCE_GLSL
#define INSTANCE_GLSL

#include "lib/buffers.glsl"
#include "lib/primitive.glsl"

// The transform from the world to the mesh's space: first a subtraction, then a matrix. In this
// order no digits are lost if an instance is small and far from the world's origin.
struct instance_inverse {
    vec3 place;
    mat3 rows; // the rows of the matrix, stored as columns
};

uint instance_at(uint instance)
{
    return frame.instances + instance * INSTANCE_WORDS;
}

instance_inverse load_instance_inverse(uint instance)
{
    uint at = instance_at(instance);
    vec4 x = load_shapes_float(at);
    vec4 y = load_shapes_float(at + 1u);
    vec4 z = load_shapes_float(at + 2u);
    return instance_inverse(vec3(x.w, y.w, z.w), mat3(x.xyz, y.xyz, z.xyz));
}

// Returns the node of the tree's root, the material word or NO_MATERIAL, the id, and INSTANCE_*.
uvec4 load_instance_words(uint instance)
{
    return load_shapes(instance_at(instance) + 6u);
}

// Returns the material word of a triangle of an instance: the instance's own if it replaces all
// materials, else `word`, the triangle's.
uint instance_material(uint instance, uint word)
{
    uint own = load_instance_words(instance).y;
    return own != NO_MATERIAL ? own : word;
}

// Returns the instance that a slot's ray starts on or has hit. The path's record has it only if the
// scene has instances.
uint path_hit_instance(uint slot)
{
    return HAS_GEOMETRY(GEOMETRY_INSTANCES) ? load_path(slot, PATH_INSTANCE).x : NO_INSTANCE;
}

uint path_start_instance(uint slot)
{
    return HAS_GEOMETRY(GEOMETRY_INSTANCES) ? load_path(slot, PATH_INSTANCE).y : NO_INSTANCE;
}

void store_path_start_instance(uint slot, uint instance)
{
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES))
        store_path(slot, PATH_INSTANCE, uvec4(NO_INSTANCE, instance, 0u, 0u));
}

uint shadow_start_instance(uint slot, uint ray)
{
    return HAS_GEOMETRY(GEOMETRY_INSTANCES) ? load_shadow_ray(slot, ray, SHADOW_INSTANCE).x
                                            : NO_INSTANCE;
}

void store_shadow_instance(uint slot, uint ray, uint instance)
{
    if (HAS_GEOMETRY(GEOMETRY_INSTANCES))
        store_shadow_ray(slot, ray, SHADOW_INSTANCE, uvec4(instance, 0u, 0u, 0u));
}

#endif
