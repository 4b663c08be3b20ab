// Which vertices of a path send shadow rays: what their scattered rays meet is weighted against
// that.
#ifndef NEE_GLSL
#define NEE_GLSL

#include "lib/buffers.glsl"

// Whether emitters are chosen by what they may send to a vertex, all or those of a lamp: only where
// the vertex is does their probability say.
#define CHOOSES_BY_PLACE                                                                           \
    (LIGHT_CHOICE == LIGHT_CHOICE_TREE || LIGHT_CHOICE == LIGHT_CHOICE_ALL)
// Whether all vertices send a shadow ray to each lamp.
#define CONNECTS_ALWAYS_TO_EACH                                                                    \
    (LIGHT_CHOICE == LIGHT_CHOICE_ALL && LIGHT_VERTICES == ALL_VERTICES)

// Returns whether a vertex sends a shadow ray to each lamp, as the first ones of a path may with
// LIGHT_CHOICE_ALL.
bool connects_to_each(uint vertex)
{
    return CONNECTS_ALWAYS_TO_EACH || vertex < LIGHT_VERTICES;
}

// Returns whether the vertex that the ray of this bounce comes from did.
bool connected_to_each()
{
    return connects_to_each(push.bounce - 1u);
}

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

// The probability with which that vertex would have connected to what is infinitely far, of which
// `recorded` is the one where not each lamp is connected to; 0 where it is no lamp.
float pick_of_far(float recorded)
{
    if (LIGHT_CHOICE == LIGHT_CHOICE_ALL)
        recorded = connected_to_each() && recorded > 0.0 ? 1.0 : recorded;
    return recorded;
}

#endif
