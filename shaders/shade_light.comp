// One thread processes one surface hit of a light path: connects it to the camera (the queue of
// shadow rays) and scatters the path (the queue of rays of the next bounce). Reads a queue of the
// surface hits of all classes or of one class.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/adjoint.glsl"
#include "lib/connect_camera.glsl"
#include "lib/emit.glsl"
#include "lib/interface.glsl"
#include "lib/queue.glsl"
#include "lib/roulette.glsl"
#include "lib/texture.glsl"

// Two ratios of densities, from which MIS weights are computed: the densities of this path by
// shadow rays to its emitter, and by camera paths that hit the emitter, each divided by the density
// of the light path. Both lack the factor of the connection to the camera. Multiplied by this
// factor, they are the inverses of the ratios in lib/bidir.glsl.
struct ratios {
    float by_shadow_ray;
    float by_hit;
};

// Connects the vertex to the camera. Returns false if the connection contributes nothing. The
// random numbers u choose the point of the lens (x and y) and the pixel (z).
bool connect_camera(vertex v, ratios r, float scale, vec3 u)
{
    camera_sight c = see_from_camera(v.s.position, u.xy);
    uint pixel;
    float share = c.valid ? choose_pixel(c.at, u.z, pixel) : 0.0;
    if (!(share > 0.0))
        return false;
    vec3 onwards = -c.direction;
    // For directions in the plane of the surface the cosine is 0, and the BSDF may be infinite.
    if (dot(onwards, v.s.normal_geometric) == 0.0)
        return false;
    float pdf;
    vec3 f = eval_reversed(v, onwards, pdf);
    float extent = first_ratio(c.direction, c.distance);
    if (all(equal(f, vec3(0.0))) || !(extent > 0.0))
        return false;
    float weight =
        weight_of_light_path(r.by_shadow_ray * (push.bounce > 0u ? pdf : 1.0) / extent,
                             r.by_hit * pdf / extent);
    vec3 brings = v.throughput * f * (scale * measure_ratio(v, onwards) * share * weight / extent);
    if (HAS(FEATURE_MEDIA))
        brings *= transmittance(load_medium(medium_towards(v, onwards)), c.distance);
    if (!is_finite(brings)) {
        report_nonfinite(v.slot, SITE_SHADOW);
        return false;
    }
    if (all(equal(brings, vec3(0.0))))
        return false;
    vec3 origin = offset_origin(v.s.position, v.s.error, v.s.normal_geometric, onwards);
    store_shadow_ray(v.slot, 0u, 0u, uvec4(floatBitsToUint(origin), v.primitive));
    store_shadow_ray(v.slot, 0u, 1u, uvec4(floatBitsToUint(c.target - origin), NO_PRIMITIVE));
    store_shadow_ray(v.slot, 0u, 2u, uvec4(floatBitsToUint(brings), pixel));
    store_shadow_instance(v.slot, 0u, v.instance);
    return true;
}

struct light_onwards {
    vec3 direction;
    uint media;
    bool valid;
};

// Scatters the path, and computes the throughput and the ratios of the next vertex.
light_onwards scatter_light(inout vertex v, inout ratios r, bool passes, uint stack, vec4 u)
{
    if (HAS(FEATURE_MEDIA) && passes) {
        r.by_shadow_ray = push.bounce > 0u ? r.by_shadow_ray : 0.0;
        return light_onwards(-v.view, v.media.stack_beyond, true);
    }
    bsdf_sample b = sample_bsdf(v.m, v.wo, v.eta, u);
    vec3 next = normalize(v.frame * b.wi);
    light_onwards o = light_onwards(next, stack, b.valid && sides_agree(v, next, b.wi));
    if (HAS(FEATURE_MEDIA) && b.transmitted)
        o.media = v.media.stack_beyond;
    if (b.pdf > 0.0) {
        float pdf;
        vec3 f = eval_reversed(v, next, pdf);
        v.throughput *= f * (measure_ratio(v, next) / b.pdf);
        r.by_shadow_ray *= push.bounce > 0u ? pdf / b.pdf : 1.0 / b.pdf;
        r.by_hit *= pdf / b.pdf;
    } else if (o.valid) {
        o.valid = is_reversible(v, next);
        v.throughput *= b.weight * delta_factor(v, next, b.transmitted);
        r.by_shadow_ray = push.bounce > 0u ? r.by_shadow_ray : 0.0;
    }
    return o;
}

void main()
{
    uint item = item_index();
    bool valid = item < item_count();
    uint slot = valid ? queue_slot(push.queue, item) : 0u;
    bool connected = false;
    bool scattered = false;

    if (valid && push.bounce < frame.max_bounces) {
        vertex v;
        v.slot = slot;
        uvec4 words = load_path(slot, PATH_ORIGIN);
        vec3 origin = uintBitsToFloat(words.xyz);
        uint from = words.w;
        vec3 direction = uintBitsToFloat(load_path(slot, PATH_DIRECTION).xyz);
        words = load_path(slot, PATH_THROUGHPUT);
        v.throughput = uintBitsToFloat(words.xyz);
        uint stack = words.w;
        words = load_path(slot, PATH_HIT);
        vec3 hit = uintBitsToFloat(words.xyz);
        v.primitive = words.w;
        v.instance = path_hit_instance(slot);
        v.s = load_surface(origin, direction, hit.x, hit.yz, v.primitive, v.instance);
        v.m = load_material(v.s.material);
        if (HAS(FEATURE_TEXTURES) || HAS(FEATURE_COLORS))
            apply_textures(v.m, v.s);
        v.view = -direction;
        v.frame = shading_frame(v.s, v.m, v.view);
        v.wo = v.view * v.frame;
        v.eta = material_ior(v.m);

        uvec4 weights = load_path(slot, PATH_WEIGHTS);
        ratios r = ratios(uintBitsToFloat(weights.x), uintBitsToFloat(weights.y));
        float scale = uintBitsToFloat(weights.z);
        if (push.bounce == 0u) {
            vec2 first = light_ratios(v, from, hit.x, r.by_shadow_ray, r.by_hit);
            r = ratios(first.x, first.y);
        }
        bool passes = false;
        if (HAS(FEATURE_MEDIA)) {
            vec4 u_extra = vec4(0.0);
            if (HAS_LOBE(LOBE_DISPERSION))
                u_extra = uniforms(slot, light_path_dimension(push.bounce, DIMENSION_EXTRA));
            passes = !find_media(v, stack, hit.x, u_extra.y);
        }
        vec4 u = uniforms(slot, light_path_dimension(push.bounce, DIMENSION_LIGHT));
        if (!passes)
            connected = connect_camera(v, r, scale, u.xyz);
        if (push.bounce + 1u < frame.max_bounces) {
            vec4 u_bsdf = uniforms(slot, light_path_dimension(push.bounce, DIMENSION_BSDF));
            light_onwards o = scatter_light(v, r, passes, stack, u_bsdf);
            if (!is_finite(v.throughput)) {
                report_nonfinite(slot, SITE_THROUGHPUT);
                o.valid = false;
            }
            scattered = o.valid && any(greaterThan(v.throughput, vec3(0.0))) &&
                        survives_roulette(slot, v.throughput, 1.0, u.w);
            if (scattered) {
                vec3 begin = offset_origin(v.s.position, v.s.error, v.s.normal_geometric,
                                           o.direction);
                store_path(slot, PATH_ORIGIN, uvec4(floatBitsToUint(begin), v.primitive));
                store_path(slot, PATH_DIRECTION, uvec4(floatBitsToUint(o.direction), 0u));
                store_path(slot, PATH_THROUGHPUT,
                           uvec4(floatBitsToUint(v.throughput), o.media));
                store_path_start_instance(slot, v.instance);
            }
            uvec3 next = floatBitsToUint(vec3(r.by_shadow_ray, r.by_hit, scale));
            store_path(slot, PATH_WEIGHTS, uvec4(next, weights.w));
        }
    }
    queue_push(QUEUE_SHADOW, slot, connected);
    queue_push(QUEUE_RAYS + ((push.bounce + 1u) & 1u), slot, scattered);
}
