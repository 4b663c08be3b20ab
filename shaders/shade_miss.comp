// One thread adds the radiance of the environment and of suns along one ray that left the scene.
// Reads the queue of misses.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/bidir.glsl"
#include "lib/environment.glsl"
#include "lib/media.glsl"
#include "lib/nee.glsl"
#include "lib/queue.glsl"
#include "lib/radiance.glsl"
#include "lib/sun.glsl"

// Returns the MIS weight of radiance that a scattered ray has found, if light paths may find it,
// too. light_pdf: the density with which a shadow ray would have sampled this direction.
float weight_of_light_paths(uint slot, vec3 direction, float bsdf_pdf, float light_pdf)
{
    bool connects = sent_shadow_rays(bsdf_pdf) && light_pdf > 0.0;
    float ratio = push.bounce > 0u && light_pdf > 0.0 ? load_ratio(slot) : 0.0;
    if (ratio > 0.0) {
        vec3 origin = uintBitsToFloat(load_path(slot, PATH_ORIGIN).xyz);
        ratio *= light_pdf * reach_of_far(origin, direction);
    }
    return weight_of_camera_path(connects ? light_pdf / bsdf_pdf : 0.0, ratio);
}

// Returns the MIS weight of radiance that a scattered ray has found. light_pdf: the density with
// which a shadow ray would have sampled this direction.
float weight_found(uint slot, vec3 direction, float bsdf_pdf, float light_pdf)
{
    if (IS_BIDIR)
        return weight_of_light_paths(slot, direction, bsdf_pdf, light_pdf);
    if (!sent_shadow_rays(bsdf_pdf) || !(light_pdf > 0.0))
        return 1.0;
    return HAS(FEATURE_BSDF_HITS_EMITTERS) ? mis_weight(bsdf_pdf, light_pdf) : 0.0;
}

vec3 found_environment(uint slot, vec3 direction, float bsdf_pdf)
{
    if (!HAS(FEATURE_ENVIRONMENT_IMAGE))
        return frame.environment;
    vec4 found = load_environment_at(direction);
    vec3 radiance = frame.environment * found.rgb;
    if (HAS_EMITTER(EMITTER_ENVIRONMENT))
        radiance *= weight_found(slot, direction, bsdf_pdf,
                                 pick_of_far(frame.environment_pick) * found.a);
    return radiance;
}

vec3 found_suns(uint slot, vec3 direction, float bsdf_pdf)
{
    uvec2 suns = suns_range();
    vec3 radiance = vec3(0.0);
    for (uint i = 0u; i < suns.y; i++) {
        vec4 towards = load_materials_float(suns.x + i * SUN_WORDS);
        vec4 sun = load_materials_float(suns.x + i * SUN_WORDS + 1u);
        if (sees_sun(towards.xyz, towards.w, direction))
            radiance += sun.rgb * weight_found(slot, direction, bsdf_pdf,
                                               pick_of_far(sun.a) * pdf_sun(towards.w));
    }
    return radiance;
}

// Returns the part of `added` that comes from `light`, which is a part of `radiance`.
vec3 part_of_light(vec3 added, vec3 light, vec3 radiance)
{
    return mix(vec3(0.0), added * (light / radiance), greaterThan(radiance, vec3(0.0)));
}

void main()
{
    uint item = item_index();
    if (item >= item_count())
        return;
    uint slot = queue_slot(push.queue, item);
    vec4 ray = uintBitsToFloat(load_path(slot, PATH_DIRECTION));
    vec3 environment = found_environment(slot, ray.xyz, ray.w);
    vec3 radiance = environment;
    if (HAS_EMITTER(EMITTER_SUNS))
        radiance += found_suns(slot, ray.xyz, ray.w);
    uvec4 words = load_path(slot, PATH_THROUGHPUT);
    vec3 throughput = uintBitsToFloat(words.rgb);
    // The path is still in a medium if it left an open mesh, or if the camera is inside an
    // unbounded shape. If that medium absorbs, no light from infinitely far arrives.
    if (HAS(FEATURE_MEDIA)) {
        vec3 extinction = load_medium(media_current(words.a)).extinction;
        throughput *= vec3(equal(extinction, vec3(0.0)));
    }
    bool sees_suns = HAS_EMITTER(EMITTER_SUNS) && any(notEqual(radiance, environment));
    vec3 added = add_radiance(slot, throughput * radiance, SITE_MISS,
                              sees_suns ? BY_EMITTER_SUNS : BY_EMITTER_ENVIRONMENT);
    if (HAS_EMITTER(EMITTER_SUNS) && HAS_AOV(AOV_BY_EMITTER)) {
        if (sees_suns)
            move_to_emitter(slot, BY_EMITTER_SUNS, BY_EMITTER_ENVIRONMENT,
                            part_of_light(added, environment, radiance));
    }
}
