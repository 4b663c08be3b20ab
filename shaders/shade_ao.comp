// For ambient occlusion, one thread sends one shadow ray of length frame.ao_distance, in a
// cosine-weighted direction about the normal of the surface that a camera ray has hit. A sample has
// the value 1 if nothing is hit (Zhukov, Iones, Kronin 1998, "An Ambient Light Illumination Model",
// section 3, with an obscurance of 1 at all distances). Reads the queue of surface hits. Uses no
// materials, except for AOVs.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/aov.glsl"
#include "lib/camera.glsl"
#include "lib/queue.glsl"
#include "lib/ray_offset.glsl"
#include "lib/sampler.glsl"
#include "lib/sampling.glsl"
#include "lib/surface.glsl"
#include "lib/texture.glsl"

// Stores the AOVs of the surface, if any are wanted; only they depend on materials.
void store_surface(uint slot, surface s, uint primitive, uint instance, float t)
{
    material m;
    if (HAS_AOV(AOV_ALBEDO)) {
        m = load_material(s.material);
        if (HAS(FEATURE_TEXTURES) || HAS(FEATURE_COLORS))
            apply_textures(m, s);
    }
    store_first_hit(slot, s, m, primitive, instance, t);
}

void main()
{
    uint item = item_index();
    bool valid = item < item_count();
    uint slot = valid ? queue_slot(push.queue, item) : 0u;
    bool shadow = false;

    if (valid) {
        uvec4 words = load_path(slot, PATH_ORIGIN);
        vec3 direction = uintBitsToFloat(load_path(slot, PATH_DIRECTION).xyz);
        uvec4 hit_words = load_path(slot, PATH_HIT);
        vec3 hit = uintBitsToFloat(hit_words.xyz);
        uint primitive = hit_words.w;
        uint instance = path_hit_instance(slot);
        surface s = load_surface(uintBitsToFloat(words.xyz), direction, hit.x, hit.yz, primitive,
                                 instance);
        float t = hit.x;
        if (HAS(FEATURE_FAR_CAMERA))
            t = distance_from_camera(direction, t);
        if (HAS_AOV(AOVS_OF_SURFACES))
            store_surface(slot, s, primitive, instance, t);

        vec4 u = uniforms(slot, bounce_dimension(0u, DIMENSION_BSDF));
        vec3 local = sample_cosine_hemisphere(u.xy);
        vec3 wi = normalize(basis_around(s.normal_shading) * local);
        // An interpolated normal may be tilted: directions below the geometric surface are
        // occluded.
        shadow = dot(wi, s.normal_geometric) > 0.0;
        if (shadow) {
            vec3 from = offset_origin(s.position, s.error, s.normal_geometric, wi);
            store_shadow_ray(slot, 0u, 0u,
                             uvec4(floatBitsToUint(from), primitive));
            store_shadow_ray(slot, 0u, 1u,
                             uvec4(floatBitsToUint(frame.ao_distance * wi), NO_PRIMITIVE));
            store_shadow_ray(slot, 0u, 2u,
                             floatBitsToUint(vec4(vec3(1.0), pdf_cosine_hemisphere(local.z))));
            store_shadow_instance(slot, 0u, instance);
        }
    }
    queue_push(QUEUE_SHADOW, slot, shadow);
}
