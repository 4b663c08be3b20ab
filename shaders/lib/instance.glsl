// Reads instances: what leads from the world to a shared mesh's own space and back.
#ifndef INSTANCE_GLSL
#define INSTANCE_GLSL

#include "lib/buffers.glsl"
#include "lib/primitive.glsl"

// The transform from the world to the mesh's space: first what is subtracted, then a matrix by its
// rows. In this order nothing is lost where an instance is small and far from the world's origin.
struct instance_inverse {
    vec3 place;
    mat3 rows; // its columns are the matrix's rows
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

// Its root's node, its material's word or NO_MATERIAL, its id, INSTANCE_*.
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

// Returns the instance that the slot's ray starts on or has hit: a part of the path's record if
// there are instances.
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
