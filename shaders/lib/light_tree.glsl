// Selects an emitter by a bound on its contribution to a point, by descending a tree (Conty Estevez
// and Kulla 2018; see render/tables/light_tree.h). Reads the emitters' buffer.
#ifndef LIGHT_TREE_GLSL
#define LIGHT_TREE_GLSL

#include "lib/buffers.glsl"
#include "lib/surface.glsl"

// The point of a surface that receives light.
struct receiver {
    vec3 position;
    vec3 normal;    // unit, on the side that receives light; 0: all directions count
    bool two_sided; // light from behind the surface counts, too
};

// Returns cos and sin of max(a - b, 0) for angles in [0, pi].
float cos_difference(float sin_a, float cos_a, float sin_b, float cos_b)
{
    return cos_a > cos_b ? 1.0 : cos_a * cos_b + sin_a * sin_b;
}

float sin_difference(float sin_a, float cos_a, float sin_b, float cos_b)
{
    return cos_a > cos_b ? 0.0 : sin_a * cos_b - cos_a * sin_b;
}

float sin_from_cos(float cosine)
{
    return sqrt(max(0.0, 1.0 - cosine * cosine));
}

// Returns a bound on the contribution of a child's emitters to the receiver, according to their
// bounds (Pharr, Jakob, Humphreys 2023, section 12.6.3), whose two words begin at `at`. Distances
// below the radius of the bounds count as that radius.
float light_importance(uint at, receiver r)
{
    vec4 sphere = load_emitters_float(at);
    uvec4 word = load_emitters(at + 1u);
    vec3 axis = decode_normal(word.x);
    float cos_o = float(word.y & 0xffffu) * (2.0 / LIGHT_COS_O_SCALE) - 1.0;
    float cos_e = float(word.y >> 16u & 0x7fffu) * (2.0 / LIGHT_COS_E_SCALE) - 1.0;
    vec3 to_point = r.position - sphere.xyz;
    float distance2 = dot(to_point, to_point), radius2 = sphere.w * sphere.w;
    // The angle b is half the angle that the bounds subtend.
    bool outside = distance2 > radius2;
    float sin2_b = outside ? radius2 / distance2 : 0.0;
    float sin_b = sqrt(sin2_b);
    float cos_b = outside ? sqrt(1.0 - sin2_b) : -1.0;
    vec3 direction = outside ? to_point * inversesqrt(distance2) : axis;

    float cos_w = dot(direction, axis);
    if ((word.y & LIGHT_TWO_SIDED) != 0u)
        cos_w = abs(cos_w);
    float sin_w = sin_from_cos(cos_w), sin_o = sin_from_cos(cos_o);
    float cos_x = cos_difference(sin_w, cos_w, sin_o, cos_o);
    float sin_x = sin_difference(sin_w, cos_w, sin_o, cos_o);
    float cos_emitted = cos_difference(sin_x, cos_x, sin_b, cos_b);
    float importance = cos_emitted > cos_e ? cos_emitted : 0.0;

    float cos_n = -dot(direction, r.normal);
    if (r.two_sided)
        cos_n = abs(cos_n);
    float cos_received = cos_difference(sin_from_cos(cos_n), cos_n, sin_b, cos_b);
    if (r.normal != vec3(0.0))
        importance *= max(0.0, cos_received);
    // At the position of a delta light the bound is infinite; any finite value suffices.
    return importance * uintBitsToFloat(word.z) / max(max(distance2, radius2), 1.17549435e-38);
}

// The division of a parent's probability between the two children of a pair. The less probable
// child comes first; the other one receives the remainder, so that rounding loses nothing.
struct light_fork {
    float smaller; // probability of the less probable child; undefined if `dark`
    uint first;    // index of that child
    bool dark;     // neither child contributes
};

light_fork light_fork_at(uint at, receiver r)
{
    float a = light_importance(at, r), b = light_importance(at + 2u, r);
    float sum = a + b;
    return light_fork(min(a, b) / sum, a <= b ? 0u : 1u, !(sum > 0.0));
}

// Returns a number of 48 bits, in the upper bits of 64, from two uniforms in [0, 1).
uvec2 number_of(vec2 u)
{
    uvec2 bits = uvec2(u * 16777216.0);
    return uvec2(bits.x << 8u | bits.y >> 16u, bits.y << 16u);
}

// Returns whether `number`, which is below `width`, is in the first part, which has this
// probability (at most 1/2). Subtracts the beginning of the selected part from the number, and sets
// `width` to the width of the part.
bool take_first(inout uvec2 number, inout float width, float probability)
{
    float part = width * probability;
    float high = floor(part * 4294967296.0);
    uvec2 bound = uvec2(uint(high), uint((part * 4294967296.0 - high) * 4294967296.0));
    if (number.x < bound.x || (number.x == bound.x && number.y < bound.y)) {
        width = part;
        return true;
    }
    uint borrow, low;
    low = usubBorrow(number.y, bound.y, borrow);
    number = uvec2(number.x - bound.x - borrow, low);
    width -= part;
    return false;
}

uint light_pair_at(uint pair)
{
    return LIGHT_TREE_WORDS + pair * LIGHT_PAIR_WORDS;
}

// Descends from a child of the tree to one emitter, by a number below `width`; returns the
// emitter's primitive word. `width` becomes the emitter's share of the width. If no emitter
// contributes, the width becomes 0, and the word is the index of a pair, not that of a primitive.
uint choose_below(uint child, receiver r, uvec2 number, inout float width)
{
    while ((child & LIGHT_LEAF) == 0u) {
        uint at = light_pair_at(child);
        light_fork fork = light_fork_at(at, r);
        if (fork.dark) {
            width = 0.0;
            break;
        }
        bool first = take_first(number, width, fork.smaller);
        uint index = first ? fork.first : 1u - fork.first;
        child = load_emitters(at + 2u * index + 1u).w;
    }
    return child & ~LIGHT_LEAF;
}

// Follows the trail of an emitter from `child`, at level `level`, to its end, and returns the width
// with which choose_below() would end there.
float width_below(uint child, uint level, uvec4 trail, receiver r, float width)
{
    for (; level < trail.z; level++) {
        uint at = light_pair_at(child);
        light_fork fork = light_fork_at(at, r);
        uint index = (level < 32u ? trail.x >> level : trail.y >> (level - 32u)) & 1u;
        float part = width * fork.smaller;
        width = index == fork.first ? part : width - part;
        if (fork.dark)
            return 0.0;
        child = load_emitters(at + 2u * index + 1u).w;
    }
    return width;
}

// Selects an emitter by two uniforms. Returns its primitive word and its probability, which is 0 if
// no emitter contributes.
uint choose_from_tree(receiver r, vec2 u, out float probability)
{
    uvec4 head = load_emitters(0u);
    float share = load_emitters_float(1u).x;
    uvec2 number = number_of(u);
    float width = 1.0;
    if (share >= 1.0 || (share > 0.0 && take_first(number, width, share))) {
        // Selects an alias bin by the rest of the number.
        float place = min(float(number.x) * 2.3283064365386963e-10 / share, 0.99999994) *
                      float(head.w);
        uvec4 bin = load_emitters(head.z + uint(place));
        probability = share;
        return fract(place) < uintBitsToFloat(bin.x) ? bin.y : bin.z;
    }
    uint primitive = choose_below(head.x, r, number, width);
    probability = width;
    return primitive;
}

// Returns the probability with which choose_from_tree() selects the emitter with this index, which
// is a surface.
float probability_in_tree(receiver r, uint emitter)
{
    uvec4 head = load_emitters(0u);
    uvec4 trail = load_emitters(head.y + emitter);
    if (trail.z == LIGHT_NOWHERE)
        return 0.0;
    return width_below(head.x, 0u, trail, r, 1.0 - load_emitters_float(1u).x);
}

// Selects an emitter of a lamp by two uniforms. Returns its primitive word and its probability,
// which is 0 if no emitter of the lamp contributes.
uint choose_in_lamp(uint lamp, receiver r, vec2 u, out float probability)
{
    uvec4 own = load_emitters(load_emitters(1u).y + lamp);
    probability = own.y == LIGHT_NOWHERE ? 0.0 : 1.0;
    return choose_below(own.x, r, number_of(u), probability);
}

// Returns the probability with which choose_in_lamp() selects the emitter with this index, which is
// a surface, when called for the emitter's lamp.
float probability_in_lamp(receiver r, uint emitter)
{
    uvec4 trail = load_emitters(load_emitters(0u).y + emitter);
    if (trail.z == LIGHT_NOWHERE)
        return 0.0;
    uvec4 lamp = load_emitters(load_emitters(1u).y + trail.w);
    return width_below(lamp.x, lamp.y, trail, r, 1.0);
}

#endif
