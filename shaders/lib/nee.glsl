// Decides which vertices of a path send shadow rays; the MIS weights of their scattered rays depend
// on it.
#ifndef NEE_GLSL
#define NEE_GLSL

#include "lib/buffers.glsl"

// Emitters are chosen by a bound on their contribution to a vertex, all of them or those of a lamp:
// their probability depends on the vertex's position.
#define CHOOSES_BY_PLACE                                                                           \
    (LIGHT_CHOICE == LIGHT_CHOICE_TREE || LIGHT_CHOICE == LIGHT_CHOICE_ALL)
// All vertices send a shadow ray to each lamp.
#define CONNECTS_ALWAYS_TO_EACH                                                                    \
    (LIGHT_CHOICE == LIGHT_CHOICE_ALL && LIGHT_VERTICES == ALL_VERTICES)

// Returns whether a vertex sends a shadow ray to each lamp, as the first vertices of a path may
// with LIGHT_CHOICE_ALL.
bool connects_to_each(uint vertex)
{
    return CONNECTS_ALWAYS_TO_EACH || vertex < LIGHT_VERTICES;
}

// Returns whether the vertex that the ray of this bounce comes from sent one to each lamp.
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
