// One thread works on one surface hit: adds what the surface emits, connects it to an emitter (the
// queue of shadow rays) and scatters the path (the queue of rays of the next bounce). Reads the
// queue of surface hits.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/light.glsl"
#include "lib/queue.glsl"
#include "lib/random.glsl"
#include "lib/ray_offset.glsl"

struct scattering {
    vec3 direction; // unit
    vec3 weight;    // BSDF * cos / pdf
    float pdf;      // per solid angle; 0 for a perfect mirror
    bool valid;
};

// Emission as seen by the path, weighted against next-event estimation.
void add_emission(uint slot, surface s, material m, vec3 origin, vec3 direction, float distance,
                  float bsdf_pdf, vec3 throughput)
{
    float weight = 1.0;
    if (HAS(FEATURE_NEE) && bsdf_pdf > 0.0 && m.group[GROUP_EMISSION].a > 0.0) {
        weight = 0.0;
        if (HAS(FEATURE_BSDF_HITS_EMITTERS))
            weight = mis_power_weight(bsdf_pdf,
                                      pdf_light(origin, direction, distance, s, m.group[GROUP_EMISSION].a));
    }
    if (weight > 0.0 && any(greaterThan(m.group[GROUP_EMISSION].rgb, vec3(0.0))))
        add_radiance(slot, throughput * m.group[GROUP_EMISSION].rgb * weight, SITE_EMISSION);
}

// Writes the shadow ray to a point on an emitter; false when there is nothing to connect.
bool connect_light(uint slot, surface s, material m, vec3 throughput, vec3 u, uint primitive)
{
    vec3 origin = offset_origin(s.position, s.error, s.normal_geometric, s.normal_geometric);
    light_sample l = sample_light(origin, u);
    vec3 wi = normalize(l.to_light);
    float cos_surface = dot(wi, s.normal_shading);
    bool facing = cos_surface > 0.0 && dot(wi, s.normal_geometric) > 0.0;
    if (!facing || !(l.pdf > 0.0) || material_model(m) != MATERIAL_LAMBERT)
        return false;

    float weight = 1.0;
    if (HAS(FEATURE_BSDF_HITS_EMITTERS))
        weight = mis_power_weight(l.pdf, pdf_cosine_hemisphere(cos_surface));
    vec3 radiance = throughput * m.group[GROUP_BASE].rgb * l.radiance *
                    (INV_PI * cos_surface * weight / l.pdf);
    store_shadow_ray(slot, 0u, uvec4(floatBitsToUint(origin), primitive));
    store_shadow_ray(slot, 1u, uvec4(floatBitsToUint(l.to_light), l.primitive));
    store_shadow_ray(slot, 2u, floatBitsToUint(vec4(radiance, l.pdf)));
    return true;
}

scattering scatter(surface s, material m, vec3 direction, vec2 u)
{
    scattering result = scattering(vec3(0.0), m.group[GROUP_BASE].rgb, 0.0, false);
    if (HAS_LOBE(LOBE_LAMBERT) && material_model(m) == MATERIAL_LAMBERT) {
        vec3 local = sample_cosine_hemisphere(u);
        result.direction = basis_around(s.normal_shading) * local;
        result.pdf = pdf_cosine_hemisphere(local.z);
        result.valid = local.z > 0.0;
    }
    if (HAS_LOBE(LOBE_MIRROR) && material_model(m) == MATERIAL_MIRROR) {
        result.direction = reflect(direction, s.normal_shading);
        result.valid = true;
    }
    result.direction = normalize(result.direction);
    // A shading normal may send light to the wrong side of the real surface.
    result.valid = result.valid && dot(result.direction, s.normal_geometric) > 0.0;
    return result;
}

// Russian roulette by throughput: survivors carry those who are ended (Arvo and Kirk 1990).
bool survives_roulette(inout vec3 throughput, float u)
{
    if (!HAS(FEATURE_ROULETTE) || push.bounce < push.roulette_min_bounces)
        return true;
    float survival = min(1.0, max(throughput.r, max(throughput.g, throughput.b)));
    throughput /= survival;
    return u < survival;
}

void main()
{
    uint item = item_index();
    bool valid = item < item_count();
    uint slot = valid ? queue_slot(push.queue, item) : 0u;
    bool shadow = false;
    bool scattered = false;

    if (valid) {
        uvec4 words = load_path(slot, PATH_ORIGIN);
        vec3 origin = uintBitsToFloat(words.xyz);
        vec4 ray = uintBitsToFloat(load_path(slot, PATH_DIRECTION));
        vec3 throughput = uintBitsToFloat(load_path(slot, PATH_THROUGHPUT).xyz);
        vec4 hit = uintBitsToFloat(load_path(slot, PATH_HIT));
        surface s = load_surface(origin, ray.xyz, hit);
        material m = load_material(s.material);
        uint primitive = floatBitsToUint(hit.w);

        if (HAS(FEATURE_EMISSION))
            add_emission(slot, s, m, origin, ray.xyz, hit.x, ray.w, throughput);

        if (push.bounce < push.max_bounces) {
            uint pixel = slot_pixel(slot);
            uint number = slot_sample(slot);
            vec4 u_light = vec4(0.0);
            if (HAS(FEATURE_NEE) || HAS(FEATURE_ROULETTE))
                u_light = random_4d(push.seed, pixel, number,
                                    bounce_dimension(push.bounce, DIMENSION_LIGHT));
            vec4 u_bsdf = random_4d(push.seed, pixel, number,
                                    bounce_dimension(push.bounce, DIMENSION_BSDF));

            if (HAS(FEATURE_NEE))
                shadow = connect_light(slot, s, m, throughput, u_light.xyz, primitive);

            scattering next = scatter(s, m, ray.xyz, u_bsdf.xy);
            throughput *= next.weight;
            if (!is_finite(throughput)) {
                report_nonfinite(slot, SITE_THROUGHPUT);
                next.valid = false;
            }
            scattered = next.valid && any(greaterThan(throughput, vec3(0.0))) &&
                        survives_roulette(throughput, u_light.w);
            if (scattered) {
                vec3 from = offset_origin(s.position, s.error, s.normal_geometric, next.direction);
                store_path(slot, PATH_ORIGIN, uvec4(floatBitsToUint(from), primitive));
                store_path(slot, PATH_DIRECTION, floatBitsToUint(vec4(next.direction, next.pdf)));
                store_path(slot, PATH_THROUGHPUT, uvec4(floatBitsToUint(throughput), 0u));
            }
        }
    }

    if (HAS(FEATURE_NEE))
        queue_push(QUEUE_SHADOW, slot, shadow);
    queue_push(QUEUE_RAYS + ((push.bounce + 1u) & 1u), slot, scattered);
}
