// Ambient occlusion: one thread sends one shadow ray, cosine-weighted about the normal of the
// surface that a camera ray has met, as far as frame.ao_distance. A sample is worth 1 where nothing
// is in the way (Zhukov, Iones, Kronin 1998, "An Ambient Light Illumination Model", section 3, with
// an obscurance of 1 at all distances that count). Reads the queue of surface hits. No material is
// looked at.
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

// For those who asked for it: the only ones to look at materials.
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
        // Below the real surface, where an interpolated normal leans over, nothing is open.
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
