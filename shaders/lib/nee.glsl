// Decides which vertices of a path send shadow rays. The MIS weights of scattered rays depend on
// this decision.
#ifndef NEE_GLSL
#define NEE_GLSL

#include "lib/buffers.glsl"

// True if the selection probability of an emitter depends on the vertex's position, because
// emitters, or those of each lamp, are selected by a bound on their contribution.
#define CHOOSES_BY_PLACE                                                                           \
    (LIGHT_CHOICE == LIGHT_CHOICE_TREE || LIGHT_CHOICE == LIGHT_CHOICE_ALL)
// True if all vertices send a shadow ray to each lamp.
#define CONNECTS_ALWAYS_TO_EACH                                                                    \
    (LIGHT_CHOICE == LIGHT_CHOICE_ALL && LIGHT_VERTICES == ALL_VERTICES)

// Returns whether a vertex sends a shadow ray to each lamp. With LIGHT_CHOICE_ALL the first
// vertices of a path do.
bool connects_to_each(uint vertex)
{
    return CONNECTS_ALWAYS_TO_EACH || vertex < LIGHT_VERTICES;
}

// Returns whether the vertex at which the ray of this bounce starts has sent a shadow ray to each
// lamp.
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

// Returns whether the vertex at which the ray of this bounce starts has sent shadow rays; bsdf_pdf
// is the density of the ray's direction. If so, emission that the ray finds has an MIS weight;
// otherwise it counts in full.
bool sent_shadow_rays(float bsdf_pdf)
{
    if (HAS(FEATURE_NEE_DEPTH) && push.bounce > frame.nee_depth)
        return false;
    return HAS(FEATURE_NEE) && bsdf_pdf > 0.0;
}

// Returns the probability with which the vertex at which the ray of this bounce starts would have
// selected an infinitely far emitter. `recorded` is the probability at vertices without a ray to
// each lamp; it is 0 if the emitter is not sampled.
float pick_of_far(float recorded)
{
    if (LIGHT_CHOICE == LIGHT_CHOICE_ALL)
        recorded = connected_to_each() && recorded > 0.0 ? 1.0 : recorded;
    return recorded;
}

#endif
