// One thread adds what arrives from the environment along one ray that left the scene. Reads the
// queue of misses.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/environment.glsl"
#include "lib/media.glsl"
#include "lib/queue.glsl"

void main()
{
    uint item = item_index();
    if (item >= item_count())
        return;
    uint slot = queue_slot(push.queue, item);
    vec3 direction = uintBitsToFloat(load_path(slot, PATH_DIRECTION).xyz);
    vec3 radiance = environment_radiance(direction);
    uvec4 words = load_path(slot, PATH_THROUGHPUT);
    vec3 throughput = uintBitsToFloat(words.rgb);
    // Out of an open mesh, or with the camera inside of something endless.
    if (HAS(FEATURE_MEDIA)) {
        vec3 extinction = load_medium(media_current(words.a)).extinction;
        throughput *= vec3(equal(extinction, vec3(0.0)));
    }
    add_radiance(slot, throughput * radiance, SITE_MISS);
}
