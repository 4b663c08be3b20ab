// One thread works on one surface hit: adds what the surface emits, connects it to an emitter (the
// queue of shadow rays) and scatters the path (the queue of rays of the next bounce). Reads the
// queue of surface hits, of all of them or of one class.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/bsdf.glsl"
#include "lib/light.glsl"
#include "lib/media.glsl"
#include "lib/queue.glsl"
#include "lib/random.glsl"
#include "lib/ray_offset.glsl"
#include "lib/texture.glsl"

// Where a path is: all that its vertex is shaded from.
struct vertex {
    uint slot;
    uint primitive;
    surface s;
    material m;
    mat3 frame; // tangent, bitangent, shading normal
    vec3 wo;    // local
    vec3 throughput;
    media_interface media; // with FEATURE_MEDIA
    float eta;             // see lib/bsdf_types.glsl
};

// The medium on the side that `direction` points to.
uint medium_towards(vertex v, vec3 direction)
{
    return dot(direction, v.s.normal_geometric) > 0.0 ? v.media.here : v.media.beyond;
}

// Emission as seen by the path, weighted against next-event estimation.
void add_emission(vertex v, vec3 origin, vec3 direction, float distance, float bsdf_pdf)
{
    float weight = 1.0;
    float pick_density = v.m.group[GROUP_EMISSION].a;
    if (HAS(FEATURE_NEE) && bsdf_pdf > 0.0 && pick_density > 0.0) {
        weight = 0.0;
        if (HAS(FEATURE_BSDF_HITS_EMITTERS))
            weight = mis_power_weight(bsdf_pdf,
                                      pdf_light(origin, direction, distance, v.s, pick_density));
    }
    vec3 emission = v.m.group[GROUP_EMISSION].rgb;
    if (weight > 0.0 && any(greaterThan(emission, vec3(0.0))))
        add_radiance(v.slot, v.throughput * emission * weight, SITE_EMISSION);
}

// A direction in the local frame, of which the shading normal and the real surface say the same: on
// which side it is. Otherwise light would leak through.
bool sides_agree(vertex v, vec3 direction, vec3 local)
{
    float side = dot(direction, v.s.normal_geometric);
    bool reflects = local.z > 0.0 && side > 0.0;
    bool transmits = local.z < 0.0 && side < 0.0;
    return reflects || (HAS_LOBE(LOBES_THROUGH) && transmits);
}

// Writes the shadow ray to a point on an emitter; false when there is nothing to connect.
bool connect_light(vertex v, vec4 u)
{
    surface s = v.s;
    vec3 origin = offset_origin(s.position, s.error, s.normal_geometric, s.normal_geometric);
    light_sample l = sample_light(origin, u);
    vec3 wi = normalize(l.to_light);
    vec3 local = wi * v.frame;
    if (!(l.pdf > 0.0) || !sides_agree(v, wi, local))
        return false;

    float pdf;
    vec3 f = eval_bsdf(v.m, v.wo, local, v.eta, pdf);
    float weight = 1.0;
    if (HAS(FEATURE_BSDF_HITS_EMITTERS) && !l.delta)
        weight = mis_power_weight(l.pdf, pdf);
    vec3 radiance = v.throughput * f * l.radiance * (weight / l.pdf);
    if (HAS(FEATURE_MEDIA))
        radiance *= transmittance(load_medium(medium_towards(v, wi)), length(l.to_light));
    if (all(equal(radiance, vec3(0.0))))
        return false;
    if (HAS_LOBE(LOBES_THROUGH) && local.z < 0.0) {
        vec3 other = offset_origin(s.position, s.error, s.normal_geometric, wi);
        l.to_light += origin - other;
        origin = other;
    }
    store_shadow_ray(v.slot, 0u, uvec4(floatBitsToUint(origin), v.primitive));
    store_shadow_ray(v.slot, 1u, uvec4(floatBitsToUint(l.to_light), l.primitive));
    store_shadow_ray(v.slot, 2u, floatBitsToUint(vec4(radiance, l.pdf)));
    return true;
}

// Russian roulette by throughput: survivors carry those who are ended (Arvo and Kirk 1990).
// Refraction into a medium of index n divides the throughput by n^2, and leaving it brings that back:
// `scale` undoes it here, so that paths inside of glass do not end for it.
bool survives_roulette(inout vec3 throughput, float scale, float u)
{
    if (!HAS(FEATURE_ROULETTE) || push.bounce < push.roulette_min_bounces)
        return true;
    float survival =
        min(1.0, max(throughput.r, max(throughput.g, throughput.b)) * scale);
    throughput /= survival;
    return u < survival;
}

// (n / n of the camera's medium)^2
float roulette_scale(float ior)
{
    float ratio = ior / uintBitsToFloat(load_materials(1u).y);
    return ratio * ratio;
}

// An interface that disperses leaves one channel of those that the path carries, with the index of
// refraction of that one (KHR_materials_dispersion: green has the nominal index).
float disperse(inout vec3 throughput, medium m, float u)
{
    if (!(m.dispersion > 0.0))
        return m.ior;
    bvec3 carried = greaterThan(throughput, vec3(0.0));
    uint count = uint(carried.r) + uint(carried.g) + uint(carried.b);
    uint chosen = min(uint(u * float(count)), count - 1u);
    uint channel = 0u;
    for (uint c = 0u, seen = 0u; c < 3u; c++) {
        channel = carried[c] && seen == chosen ? c : channel;
        seen += carried[c] ? 1u : 0u;
    }
    for (uint c = 0u; c < 3u; c++)
        throughput[c] = c == channel ? throughput[c] * float(count) : 0.0;
    float half_spread = (m.ior - 1.0) * 0.025 * m.dispersion;
    return m.ior + half_spread * (float(channel) - 1.0);
}

// What is on the two sides, as far as the surface bounds anything; attenuates the path on its way
// here. False where nothing changes: the path passes.
bool find_media(inout vertex v, uint stack, float distance, float u_dispersion)
{
    bool bounds = v.m.medium != 0u;
    v.media = media_interface(media_current(stack), media_current(stack), stack, false);
    if (bounds)
        v.media = media_cross(stack, v.m.medium, v.s.front);
    medium here = load_medium(v.media.here);
    v.throughput *= transmittance(here, distance);
    if (v.media.lost)
        atomicAdd(counters.media_lost, 1u);
    if (!bounds) {
        v.eta = v.m.group[GROUP_INTERFACE].g / here.ior;
        return true;
    }
    medium beyond = load_medium(v.media.beyond);
    if (HAS_LOBE(LOBE_DISPERSION) && v.media.here != v.media.beyond) {
        // One of both: two that disperse would need two indices of one channel.
        if (here.dispersion > beyond.dispersion)
            here.ior = disperse(v.throughput, here, u_dispersion);
        else
            beyond.ior = disperse(v.throughput, beyond, u_dispersion);
    }
    v.eta = beyond.ior / here.ior;
    return v.media.here != v.media.beyond;
}

struct ray_onwards {
    vec3 direction;
    float pdf;
    uint media;
    bool valid;
};

ray_onwards scatter(inout vertex v, vec3 direction, bool passes, uint stack, vec4 u)
{
    if (HAS(FEATURE_MEDIA) && passes)
        return ray_onwards(direction, 0.0, v.media.stack_beyond, true);
    bsdf_sample b = sample_bsdf(v.m, v.wo, v.eta, u);
    vec3 next = normalize(v.frame * b.wi);
    ray_onwards r = ray_onwards(next, b.pdf, stack, b.valid && sides_agree(v, next, b.wi));
    if (HAS(FEATURE_MEDIA) && b.transmitted)
        r.media = v.media.stack_beyond;
    v.throughput *= b.weight;
    return r;
}

void main()
{
    uint item = item_index();
    bool valid = item < item_count();
    uint slot = valid ? queue_slot(push.queue, item) : 0u;
    bool shadow = false;
    bool scattered = false;

    if (valid) {
        vertex v;
        v.slot = slot;
        uvec4 words = load_path(slot, PATH_ORIGIN);
        vec3 origin = uintBitsToFloat(words.xyz);
        vec4 ray = uintBitsToFloat(load_path(slot, PATH_DIRECTION));
        words = load_path(slot, PATH_THROUGHPUT);
        v.throughput = uintBitsToFloat(words.xyz);
        uint stack = words.w;
        vec4 hit = uintBitsToFloat(load_path(slot, PATH_HIT));
        v.primitive = floatBitsToUint(hit.w);
        v.s = load_surface(origin, ray.xyz, hit);
        v.m = load_material(v.s.material);
        if (HAS(FEATURE_TEXTURES) || HAS(FEATURE_COLORS))
            apply_textures(v.m, v.s);
        v.frame = shading_frame(v.s, v.m, -ray.xyz);
        v.wo = -ray.xyz * v.frame;
        v.eta = v.m.group[GROUP_INTERFACE].g;

        uint pixel = slot_pixel(slot);
        uint number = slot_sample(slot);
        vec4 u_extra = vec4(0.0);
        if (HAS(FEATURE_NEE) || HAS_LOBE(LOBE_DISPERSION))
            u_extra = random_4d(push.seed, pixel, number,
                                bounce_dimension(push.bounce, DIMENSION_EXTRA));
        bool passes = false;
        if (HAS(FEATURE_MEDIA))
            passes = !find_media(v, stack, hit.x, u_extra.y);

        if (HAS(FEATURE_EMISSION))
            add_emission(v, origin, ray.xyz, hit.x, ray.w);

        if (push.bounce < push.max_bounces) {
            vec4 u_light = vec4(0.0);
            if (HAS(FEATURE_NEE) || HAS(FEATURE_ROULETTE))
                u_light = random_4d(push.seed, pixel, number,
                                    bounce_dimension(push.bounce, DIMENSION_LIGHT));
            vec4 u_bsdf = random_4d(push.seed, pixel, number,
                                    bounce_dimension(push.bounce, DIMENSION_BSDF));

            if (HAS(FEATURE_NEE) && !passes)
                shadow = connect_light(v, vec4(u_light.xyz, u_extra.x));

            ray_onwards next = scatter(v, ray.xyz, passes, stack, u_bsdf);
            if (!is_finite(v.throughput)) {
                report_nonfinite(slot, SITE_THROUGHPUT);
                next.valid = false;
            }
            float scale = 1.0;
            if (HAS(FEATURE_MEDIA) && HAS(FEATURE_ROULETTE))
                scale = roulette_scale(load_medium(media_current(next.media)).ior);
            scattered = next.valid && any(greaterThan(v.throughput, vec3(0.0))) &&
                        survives_roulette(v.throughput, scale, u_light.w);
            if (scattered) {
                vec3 from = offset_origin(v.s.position, v.s.error, v.s.normal_geometric,
                                          next.direction);
                store_path(slot, PATH_ORIGIN, uvec4(floatBitsToUint(from), v.primitive));
                store_path(slot, PATH_DIRECTION, floatBitsToUint(vec4(next.direction, next.pdf)));
                store_path(slot, PATH_THROUGHPUT, uvec4(floatBitsToUint(v.throughput), next.media));
            }
        }
    }

    if (HAS(FEATURE_NEE))
        queue_push(QUEUE_SHADOW, slot, shadow);
    queue_push(QUEUE_RAYS + ((push.bounce + 1u) & 1u), slot, scattered);
}
