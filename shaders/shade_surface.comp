// One thread processes one surface hit: adds the surface's emission, connects it to an emitter (the
// queue of shadow rays) and scatters the path, or both branches of a path that splits (the queue of
// rays of the next bounce). Reads a queue of surface hits: of all surfaces, or of one class.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/aov.glsl"
#include "lib/camera.glsl"
#include "lib/connect.glsl"
#include "lib/emission.glsl"
#include "lib/interface.glsl"
#include "lib/queue.glsl"
#include "lib/sampler.glsl"
#include "lib/scatter.glsl"
#include "lib/split.glsl"
#include "lib/texture.glsl"

void main()
{
    uint item = item_index();
    bool valid = item < item_count();
    uint slot = valid ? queue_slot(push.queue, item) : 0u;
    bool shadow = false;
    bool scattered = false;
    uint branch = 0u;
    bool branched = false;

    if (valid) {
        vertex v;
        v.slot = slot;
        uvec4 words = load_path(slot, PATH_ORIGIN);
        vec3 origin = uintBitsToFloat(words.xyz);
        vec4 ray = uintBitsToFloat(load_path(slot, PATH_DIRECTION));
        words = load_path(slot, PATH_THROUGHPUT);
        v.throughput = uintBitsToFloat(words.xyz);
        uint stack = words.w;
        words = load_path(slot, PATH_HIT);
        vec3 hit = uintBitsToFloat(words.xyz);
        v.primitive = words.w;
        v.instance = path_hit_instance(slot);
        v.s = load_surface(origin, ray.xyz, hit.x, hit.yz, v.primitive, v.instance);
        v.m = load_material(v.s.material);
        if (HAS(FEATURE_TEXTURES) || HAS(FEATURE_COLORS))
            apply_textures(v.m, v.s);
        float t = hit.x;
        if (HAS(FEATURE_FAR_CAMERA) && push.bounce == 0u)
            t = distance_from_camera(ray.xyz, t);
        if (HAS_AOV(AOVS_OF_SURFACES) && push.bounce == 0u)
            store_first_hit(slot, v.s, v.m, v.primitive, v.instance, t);
        v.frame = shading_frame(v.s, v.m, -ray.xyz);
        v.wo = -ray.xyz * v.frame;
        v.eta = material_ior(v.m);

        vec4 u_extra = vec4(0.0);
        // This is not one expression, because glslang miscompiles chains of three constants.
        bool needs_extra = HAS(FEATURE_NEE) || HAS_LOBE(LOBE_DISPERSION);
        if (needs_extra || DIRECTIONS != DIRECTIONS_BSDF)
            u_extra = uniforms(slot, bounce_dimension(push.bounce, DIMENSION_EXTRA));
        bool passes = false;
        if (HAS(FEATURE_MEDIA))
            passes = !find_media(v, stack, t, u_extra.y);

        if (IS_BIDIR) {
            v.view = -ray.xyz;
            v.ratio = push.bounce == 0u ? first_ratio(ray.xyz, t) : load_ratio(slot);
        }
        if (HAS(FEATURE_EMISSION))
            add_emission(v, origin, ray.xyz, hit.x, ray.w);

        if (push.bounce < frame.max_bounces) {
            vec4 u_light = vec4(0.0);
            if (HAS(FEATURE_NEE) || HAS(FEATURE_ROULETTE))
                u_light = uniforms(slot, bounce_dimension(push.bounce, DIMENSION_LIGHT));
            vec4 u_bsdf = uniforms(slot, bounce_dimension(push.bounce, DIMENSION_BSDF));

            if (HAS(FEATURE_NEE)) {
                if (sends_shadow_rays() && !passes)
                    shadow = connect_light(v, vec4(u_light.xyz, u_extra.x));
            }

            if (CAN_SPLIT) {
                if (splits_lobes(v.m) && !passes) {
                    branch = branch_slot(slot);
                    if (HAS(FEATURE_MIN_DENSITY))
                        atomicAdd(counters.branches, 1u);
                    branched = go_on_specular(v, branch, ray.xyz, stack);
                    v.m = part_of(v.m, MATERIAL_DIFFUSE_PART);
                }
            }
            scattered = go_on(v, ray.xyz, passes, stack, u_bsdf, u_extra.z, u_light.w);
        }
    }

    if (HAS(FEATURE_NEE))
        queue_push(QUEUE_SHADOW, slot, shadow);
    uint next_rays = QUEUE_RAYS + ((push.bounce + 1u) & 1u);
    queue_push(next_rays, slot, scattered);
    if (CAN_SPLIT)
        queue_push(next_rays, branch, branched);
}
