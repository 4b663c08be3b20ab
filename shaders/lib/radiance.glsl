// Adds contributions to the radiance of slots and to the related AOVs: its parts, the contributions
// of each class of --error-by, and the brightest contribution. Writes the slot's record.
#ifndef RADIANCE_GLSL
#define RADIANCE_GLSL

#include "lib/buffers.glsl"
#include "lib/primitive.glsl"

// Adds a contribution to the part that belongs to its number of scattering events. The number is
// push.bounce, because shadow rays are traced in the bounce after the one that spawned them. With
// INTEGRATOR_WHITTED, push.bounce counts the rays of the tree that were traced before.
void add_part(uint slot, vec3 contribution)
{
    if (HAS_AOV(AOV_EMISSION) && push.bounce == 0u)
        add_aov_vector(slot, AOV_EMISSION, contribution);
    if (HAS_AOV(AOV_DIRECT) && push.bounce == 1u)
        add_aov_vector(slot, AOV_DIRECT, contribution);
    if (HAS_AOV(AOV_INDIRECT) && push.bounce > 1u)
        add_aov_vector(slot, AOV_INDIRECT, contribution);
}

// Scales a contribution down so that its largest component does not exceed the limit. Counts the
// scaled contributions, and sums the luminance (BT.709) that they lose. The sum is in integer units
// of limit / CLAMP_UNITS, so that it does not depend on the order of additions.
vec3 clamp_contribution(vec3 contribution)
{
    float largest = max(contribution.r, max(contribution.g, contribution.b));
    if (!(largest > frame.clamp_limit) || !is_finite(contribution))
        return contribution;
    vec3 kept = contribution * (frame.clamp_limit / largest);
    vec3 lost = (contribution - kept) / frame.clamp_limit;
    float units = min(CLAMP_UNITS * dot(lost, vec3(0.2126, 0.7152, 0.0722)) + 0.5,
                      CLAMP_UNITS_MOST);
    uint high = uint(units * 2.3283064365386963e-10); // 2^-32
    uint low = uint(units - float(high) * 4294967296.0);
    uint before = atomicAdd(counters.clamped_light[0], low);
    high += before + low < before ? 1u : 0u;
    if (high > 0u)
        atomicAdd(counters.clamped_light[1], high);
    atomicAdd(counters.clamped, 1u);
    return kept;
}

// --- by class ------------------------------------------------------------------------------------

// Adds a contribution to one class. number: index of the class among all requested ones
// (shared/aov.h).
void add_to_class(uint slot, uint number, vec3 contribution)
{
    uint word = slot * SLOT_WORDS + AOV_SLOT_CLASSES_AT(AOVS) + number;
    vec3 sum = uintBitsToFloat(radiance_words[word].rgb) + contribution;
    radiance_words[word] = uvec4(floatBitsToUint(sum), 0u);
}

// Adds a contribution to one class of each requested kind. emitter: BY_EMITTER_*. Scattering events
// are counted as in add_part().
void add_to_classes(uint slot, vec3 contribution, uint emitter)
{
    if (HAS_AOV(AOV_BY_PART))
        add_to_class(slot, min(push.bounce, BY_PART_COUNT - 1u), contribution);
    if (HAS_AOV(AOV_BY_BOUNCE))
        add_to_class(slot, AOV_BOUNCES_AT(AOVS) + min(push.bounce, BY_BOUNCE_COUNT - 1u),
                     contribution);
    if (HAS_AOV(AOV_BY_EMITTER))
        add_to_class(slot, AOV_EMITTERS_AT(AOVS) + emitter, contribution);
}

// Returns the class (BY_EMITTER_*) to which a surface's emission belongs.
uint emitter_of_primitive(uint primitive)
{
    return IS_SHAPE(primitive) ? BY_EMITTER_SHAPES : BY_EMITTER_TRIANGLES;
}

// Moves a contribution from class `from` to class `to`, because another emitter than assumed was
// its source.
void move_to_emitter(uint slot, uint from, uint to, vec3 contribution)
{
    add_to_class(slot, AOV_EMITTERS_AT(AOVS) + from, -contribution);
    add_to_class(slot, AOV_EMITTERS_AT(AOVS) + to, contribution);
}

// Returns the luminance (BT.709), with the same bits in all kernels.
float brightness(vec3 radiance)
{
    precise float sum = 0.2126 * radiance.r + 0.7152 * radiance.g + 0.0722 * radiance.b;
    return sum;
}

// Keeps the brightest contribution of the slot: the first one, if several are equally bright.
void keep_brightest(uint slot, vec3 contribution, uint site, uint emitter)
{
    uint word = slot * SLOT_WORDS + AOV_SLOT_BRIGHTEST_AT(AOVS);
    if (brightness(contribution) > brightness(uintBitsToFloat(radiance_words[word].rgb)))
        radiance_words[word] =
            uvec4(floatBitsToUint(contribution), BRIGHTEST_ORIGIN(push.bounce, site, emitter));
}

// -------------------------------------------------------------------------------------------------

// Adds a contribution to the slot's radiance, after those of earlier dispatches. If the sum would
// not be finite, drops the contribution, and report_nonfinite() sets w of the radiance to 1.
// emitter: BY_EMITTER_* of the source. Returns the value that was added.
vec3 add_radiance(uint slot, vec3 contribution, uint site, uint emitter)
{
    if (HAS(FEATURE_CLAMP))
        contribution = clamp_contribution(contribution);
    vec4 radiance = uintBitsToFloat(radiance_words[slot * SLOT_WORDS]); // not read as a texel,
                                                                        // because this invocation
                                                                        // may just have written it
    vec3 sum = radiance.rgb + contribution;
    if (!is_finite(sum)) {
        report_nonfinite(slot, site);
        return vec3(0.0);
    }
    radiance_words[slot * SLOT_WORDS] = floatBitsToUint(vec4(sum, radiance.w));
    if (HAS_AOV(AOVS_OF_PARTS))
        add_part(slot, contribution);
    if (HAS_AOV(AOVS_BY)) {
        add_to_classes(slot, contribution, emitter);
        keep_brightest(slot, contribution, site, emitter);
    }
    return contribution;
}

#endif
