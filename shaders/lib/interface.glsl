// Finds the media on both sides of a surface, and their indices of refraction.
#ifndef INTERFACE_GLSL
#define INTERFACE_GLSL

#include "lib/vertex.glsl"

// At a dispersive interface, keeps one of the channels that the path carries, and returns the index
// of refraction for that channel (KHR_materials_dispersion: green has the nominal index).
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

// Finds the media on both sides of a surface that bounds a medium, and attenuates the path's
// throughput along the ray that has hit it. Returns false if the surface changes nothing, so that
// the path passes through it.
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
        v.eta = material_ior(v.m) / here.ior;
        return true;
    }
    medium beyond = load_medium(v.media.beyond);
    if (HAS_LOBE(LOBE_DISPERSION) && v.media.here != v.media.beyond) {
        // Only one of the two media disperses: two would need two indices for one channel.
        if (here.dispersion > beyond.dispersion)
            here.ior = disperse(v.throughput, here, u_dispersion);
        else
            beyond.ior = disperse(v.throughput, beyond, u_dispersion);
    }
    v.eta = beyond.ior / here.ior;
    return v.media.here != v.media.beyond;
}

#endif
