// One thread tests whether a surface is between a vertex and the sampled point on an emitter. If
// not, the contribution is added to the path's radiance. Reads the queue of shadow rays.
#version 460
#extension GL_GOOGLE_include_directive : require

#define ANY_HIT
#include "lib/material_header.glsl"
#include "lib/queue.glsl"
#include "lib/radiance.glsl"
#include "lib/suspend.glsl"

// Returns the class (BY_EMITTER_*) to which the light of a shadow ray belongs. `word` is the
// primitive word of its target.
uint emitter_of_connection(uint word)
{
    if (word == PRIMITIVE_ENVIRONMENT || word == NO_PRIMITIVE)
        return BY_EMITTER_ENVIRONMENT;
    if ((word & PRIMITIVE_LIGHT) == 0u || (word & PRIMITIVE_SHAPE) != 0u)
        return emitter_of_primitive(word);
    if (!HAS_EMITTER(EMITTER_SUNS))
        return BY_EMITTER_LIGHTS;
    uint light = lights_begin() + (word & ~PRIMITIVE_LIGHT) * LIGHT_WORDS;
    return load_materials_float(light + 3u).w > 0.0 ? BY_EMITTER_SUNS : BY_EMITTER_LIGHTS;
}

void main()
{
    uint item = item_index();
    bool valid = item < item_count();
    uint slot = valid ? queue_slot(push.queue, item) : 0u;

    trace_ray ray = no_ray();
    vec3 radiance = vec3(0.0);
    if (valid)
        radiance = uintBitsToFloat(load_shadow_ray(slot, push.light_ray, 2u).rgb);
    if (LIGHT_RAYS > 1u && all(equal(radiance, vec3(0.0))))
        valid = false;
    if (valid) {
        uvec4 origin = load_shadow_ray(slot, push.light_ray, 0u);
        uvec4 direction = load_shadow_ray(slot, push.light_ray, 1u);
        ray = trace_ray(uintBitsToFloat(origin.xyz), uintBitsToFloat(direction.xyz), origin.w,
                        direction.w, shadow_start_instance(slot, push.light_ray),
                        ray_alpha(slot, true));
    }
    trace_hit hit = trace_hit(1.0, vec2(0.0), NO_PRIMITIVE, 0u, NO_INSTANCE);
    bool done = trace_or_suspend(slot, valid, ray, hit);

    if (done && hit.primitive == NO_PRIMITIVE) {
        uint emitter = 0u;
        if (HAS_AOV(AOVS_BY))
            emitter = emitter_of_connection(load_shadow_ray(slot, push.light_ray, 1u).w);
        add_radiance(slot, radiance, SITE_SHADOW, emitter);
    }
}
