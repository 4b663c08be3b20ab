// One thread starts one path: computes the camera ray of its pixel and sample. Fills the queue of
// rays with the first slot of each sample.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/camera.glsl"
#include "lib/filter.glsl"
#include "lib/instance.glsl"
#include "lib/material_header.glsl"
#include "lib/pixel_sampling.glsl"
#include "lib/queue.glsl"

void main()
{
    uint item = item_index();
    uint count = push.pixel_count << push.sample_shift;
    if (item >= min(count, push.first_item + push.part_items))
        return;
    if (item == 0u)
        counters.queue[QUEUE_RAYS].count = count;

    uint slot = first_slot(item);
    uint pixel = slot_pixel(slot);
    vec4 u = vec4(0.0);
    bool is_apart = PIXEL_SAMPLING != PIXEL_SAMPLING_SAMPLER;
    if (HAS(FEATURE_JITTER) && !is_apart || HAS(FEATURE_LENS))
        u = uniforms(slot, DIMENSION_CAMERA);
    if (is_apart)
        u.xy = pixel_uniforms_2d(pixel, slot_sample(slot));
#ifdef PLANTED_SLOT // planted fault, which tests must detect: the image depends on slots
    u.x = fract(u.x + 0.5 * float(slot >> 8u & 1u));
#endif
    vec2 inside = HAS(FEATURE_JITTER) ? filter_position(u.xy) : vec2(0.5);
    vec2 size = vec2(frame.picture_width, frame.picture_height);
    vec2 place = vec2(pixel % frame.picture_width, pixel / frame.picture_width) + inside;
    vec2 at = place / size * 2.0 - 1.0;
    camera_ray ray = make_camera_ray(at, u.zw);

    store_path(slot, PATH_ORIGIN, uvec4(floatBitsToUint(ray.origin), NO_PRIMITIVE));
    store_path(slot, PATH_DIRECTION, uvec4(floatBitsToUint(ray.direction), 0u));
    uint media = HAS(FEATURE_MEDIA) ? camera_media() : 0u;
    store_path(slot, PATH_THROUGHPUT, uvec4(floatBitsToUint(vec3(1.0)), media));
    store_path_start_instance(slot, NO_INSTANCE);
    for (uint i = 0u; i < SLOT_WORDS * slots_a_sample(); i++)
        radiance_words[slot * SLOT_WORDS + i] = uvec4(0u);
    queue_slots[queue_index(QUEUE_RAYS, item)] = slot;
}
