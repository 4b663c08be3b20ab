// Which vertices of a path send shadow rays: what their scattered rays meet is weighted against
// that.
#ifndef NEE_GLSL
#define NEE_GLSL

#include "lib/buffers.glsl"

// Returns whether the vertex that is being shaded sends shadow rays.
bool sends_shadow_rays()
{
    if (HAS(FEATURE_NEE_DEPTH) && push.bounce >= frame.nee_depth)
        return false;
    return HAS(FEATURE_NEE);
}

// Returns whether the vertex that the ray of this bounce comes from sent shadow rays, by the
// density that chose its direction. An emitter that such a ray meets may have been connected to;
// else it counts in full.
bool sent_shadow_rays(float bsdf_pdf)
{
    if (HAS(FEATURE_NEE_DEPTH) && push.bounce > frame.nee_depth)
        return false;
    return HAS(FEATURE_NEE) && bsdf_pdf > 0.0;
}

#endif
