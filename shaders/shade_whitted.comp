// One thread processes one hit, or miss, of its slot's ray, in Whitted's recursion. A hit adds
// emission and ambient light, sends a shadow ray to every light and continues with the reflected
// ray; if there is also a refracted ray, it is postponed on the slot's stack. When a ray ends, the
// ray that was postponed last continues. So the contributions of a slot are added in the order of
// the tree. Reads the queue of surface hits or, in another dispatch, that of misses.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/aov.glsl"
#include "lib/camera.glsl"
#include "lib/environment.glsl"
#include "lib/interface.glsl"
#include "lib/queue.glsl"
#include "lib/radiance.glsl"
#include "lib/texture.glsl"
#include "lib/whitted.glsl"

// Adds the environment's radiance as shade_miss does.
void add_surroundings(vertex v, vec3 direction, uint stack)
{
    if (HAS(FEATURE_MEDIA)) {
        vec3 extinction = load_medium(media_current(stack)).extinction;
        v.throughput *= vec3(equal(extinction, vec3(0.0)));
    }
    vec3 radiance = v.throughput * environment_radiance(direction);
    if (any(greaterThan(radiance, vec3(0.0))))
        add_radiance(v.slot, radiance, SITE_MISS, BY_EMITTER_ENVIRONMENT);
}

void load_vertex(inout vertex v, vec3 origin, vec3 direction, vec3 hit, uint primitive)
{
    v.primitive = primitive;
    v.instance = path_hit_instance(v.slot);
    v.s = load_surface(origin, direction, hit.x, hit.yz, primitive, v.instance);
    v.m = load_material(v.s.material);
    if (HAS(FEATURE_TEXTURES) || HAS(FEATURE_COLORS))
        apply_textures(v.m, v.s);
    v.frame = shading_frame(v.s, v.m, -direction);
    v.wo = -direction * v.frame;
    v.eta = material_ior(v.m);
}

whitted_ray child(vertex v, vec3 direction, vec3 throughput, uint stack, uint depth, uint pending)
{
    whitted_ray r;
    r.origin = offset_origin(v.s.position, v.s.error, v.s.normal_geometric, direction);
    r.ignore = v.primitive;
    r.instance = v.instance;
    r.direction = direction;
    r.depth = depth;
    r.pending = pending;
    r.throughput = throughput;
    r.media = stack;
    return r;
}

// Returns the fraction of a camera ray's throughput that this ray has, not counting the factors of
// the media at both ends.
float part_of_camera(vec3 throughput, uint medium_number)
{
    float ratio = 1.0;
    if (HAS(FEATURE_MEDIA))
        ratio = load_medium(medium_number).ior / camera_ior();
    return max_channel(throughput) * ratio * ratio;
}

// Follows the reflected ray, the refracted ray or both; returns false if neither continues.
bool scatter_rays(vertex v, whitted_surface w, uint stack, uint state)
{
    uint depth = (state & 0xffffu) + 1u;
    uint pending = state >> 16u;
    vec3 local = vec3(-v.wo.xy, v.wo.z);
    vec3 direction = normalize(v.frame * local);
    vec3 reflected = v.throughput * w.reflected;
    bool reflects = sides_agree(v, direction, local) && any(greaterThan(reflected, vec3(0.0)));
    if (!is_finite(reflected)) {
        report_nonfinite(v.slot, SITE_THROUGHPUT);
        reflects = false;
    }
    whitted_ray mirrored_ray = child(v, direction, reflected, stack, depth, pending);
    if (!HAS_LOBE(LOBES_THROUGH)) {
        if (reflects)
            follow(v.slot, mirrored_ray);
        return reflects;
    }
    direction = normalize(v.frame * w.onwards);
    vec3 refracted = v.throughput * w.refracted;
    bool refracts = any(greaterThan(refracted, vec3(0.0))) && is_finite(refracted) &&
                    sides_agree(v, direction, w.onwards);
    uint beyond = HAS(FEATURE_MEDIA) ? v.media.stack_beyond : stack;
    whitted_ray refracted_ray = child(v, direction, refracted, beyond, depth, pending);
    if (reflects && refracts) {
        float part_reflected = part_of_camera(reflected, v.media.here);
        float part_refracted = part_of_camera(refracted, v.media.beyond);
        reflects = part_reflected >= min(LEAST_PART, part_refracted);
        refracts = part_refracted >= min(LEAST_PART, part_reflected);
    }
    if (reflects && refracts) {
        put_off(v.slot, refracted_ray);
        mirrored_ray.pending++;
    }
    if (reflects)
        follow(v.slot, mirrored_ray);
    else if (refracts)
        follow(v.slot, refracted_ray);
    return reflects || refracts;
}

bool shade(inout vertex v, vec3 origin, vec3 direction, uint stack, uint state, out bool shadow)
{
    uvec4 words = load_path(v.slot, PATH_HIT);
    vec3 hit = uintBitsToFloat(words.xyz);
    load_vertex(v, origin, direction, hit, words.w);
    float t = hit.x;
    if (HAS(FEATURE_FAR_CAMERA) && push.bounce == 0u)
        t = distance_from_camera(direction, t);
    if (HAS_AOV(AOVS_OF_SURFACES) && push.bounce == 0u)
        store_first_hit(v.slot, v.s, v.m, v.primitive, v.instance, t);
    shadow = false;
    bool passes = false;
    if (HAS(FEATURE_MEDIA))
        passes = !find_media(v, stack, t, 0.0);

    vec3 emission = v.throughput * material_emission(v.m);
    if (HAS(FEATURE_EMISSION) && any(greaterThan(emission, vec3(0.0))))
        add_radiance(v.slot, emission, SITE_EMISSION, emitter_of_primitive(v.primitive));
    if ((state & 0xffffu) >= frame.max_bounces)
        return false;
    whitted_surface w =
        whitted_surface(vec3(0.0), vec3(0.0), 0.0, vec3(0.0), vec3(1.0), -v.wo);
    if (!passes)
        w = whitted_surface_of(v.m, v.wo, v.eta);
    vec3 local = w.diffuse + w.highlight;
    if (any(greaterThan(local, vec3(0.0)))) {
        vec3 ambient = v.throughput * local * frame.ambient;
        if (HAS(FEATURE_ENVIRONMENT) && any(greaterThan(ambient, vec3(0.0))))
            add_radiance(v.slot, ambient, SITE_MISS, BY_EMITTER_ENVIRONMENT);
        if (HAS(FEATURE_NEE))
            shadow = whitted_lights(v, w);
    }
    return scatter_rays(v, w, stack, state);
}

void main()
{
    uint item = item_index();
    bool valid = item < item_count();
    uint slot = valid ? queue_slot(push.queue, item) : 0u;
    bool shadow = false;
    bool goes_on = false;

    if (valid) {
        vertex v;
        v.slot = slot;
        vec3 origin = uintBitsToFloat(load_path(slot, PATH_ORIGIN).xyz);
        uvec4 ray = load_path(slot, PATH_DIRECTION);
        vec3 direction = uintBitsToFloat(ray.xyz);
        uvec4 words = load_path(slot, PATH_THROUGHPUT);
        v.throughput = uintBitsToFloat(words.xyz);
        if (push.queue == QUEUE_MISS) {
            if (HAS(FEATURE_ENVIRONMENT))
                add_surroundings(v, direction, words.w);
        } else {
            goes_on = shade(v, origin, direction, words.w, ray.w, shadow);
        }
        uint pending = ray.w >> 16u;
        if (HAS_LOBE(LOBES_THROUGH) && !goes_on && pending > 0u) {
            take_up(slot, pending);
            goes_on = true;
        }
    }

    if (HAS(FEATURE_NEE))
        queue_push(QUEUE_SHADOW, slot, shadow);
    queue_push(QUEUE_RAYS + ((push.bounce + 1u) & 1u), slot, goes_on);
}
