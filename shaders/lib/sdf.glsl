// Evaluates signed distance fields, which are programs (shared/sdf.h). Shapes are those of Quilez
// ("Distance functions", 2013 ff.) and of Hart 1996 unless sdf.h names another source.
#ifndef SDF_GLSL
#define SDF_GLSL

#include "lib/angle.glsl"
#include "lib/buffers.glsl"
#include "lib/primitive.glsl"
#include "shared/sdf.h"

// The number of loop iterations so far. They are counted because drivers may limit the iterations
// of an invocation. On drivers that mask lanes (lavapipe) the loops of all operations count once
// for each instruction, whatever the instruction is.
uint sdf_rounds = 0u;
const uint SDF_INNER_LOOPS = (HAS_SDF(SDF_BIT(SDF_METABALLS)) ? 1u : 0u) +
                             (HAS_SDF(SDF_BIT(SDF_MANDELBULB)) ? 1u : 0u) +
                             (HAS_SDF(SDF_BIT(SDF_MENGER)) ? 1u : 0u) +
                             (HAS_SDF(SDF_BIT(SDF_APOLLONIAN)) ? 1u : 0u) +
                             (HAS_SDF(SDF_BIT(SDF_PYRAMID)) ? 1u : 0u);

struct sdf_field {
    vec4 to_object[3]; // linear part, and in w the vector that is subtracted first
    vec3 low, high;    // box of the field, in its own space
    uint first, count; // instructions
    float scale;       // world lengths per metre of the field
    float magnitude;
};

uint sdf_number(uint shape)
{
    return load_shapes(shape * SHAPE_WORDS + 2u).y;
}

sdf_field load_sdf(uint number)
{
    uint at = frame.sdfs + number * SDF_WORDS;
    sdf_field f;
    for (uint i = 0u; i < 3u; i++)
        f.to_object[i] = load_shapes_float(at + i);
    uvec4 low = load_shapes(at + 3u);
    uvec4 high = load_shapes(at + 4u);
    vec4 last = load_shapes_float(at + 5u);
    f.low = uintBitsToFloat(low.xyz);
    f.first = low.w;
    f.high = uintBitsToFloat(high.xyz);
    f.count = high.w;
    f.scale = last.x;
    f.magnitude = last.z;
    return f;
}

vec3 sdf_to_object(sdf_field f, vec3 direction)
{
    return vec3(dot(f.to_object[0].xyz, direction), dot(f.to_object[1].xyz, direction),
                dot(f.to_object[2].xyz, direction));
}

vec3 sdf_origin(sdf_field f)
{
    return vec3(f.to_object[0].w, f.to_object[1].w, f.to_object[2].w);
}

// Returns a bound on the rounding error of a program's value: 16 roundings of the largest
// coordinate. This was found by comparison with double precision (tests/kernels/test_sdf.c).
float sdf_error(sdf_field f)
{
    return GAMMA(16) * max(f.magnitude, 1e-30);
}

// --- shapes --------------------------------------------------------------------------------------

float max3(vec3 v)
{
    return max(v.x, max(v.y, v.z));
}

// Returns the distance to a corner from the distances along the axes.
float corner(vec3 q)
{
    return length(max(q, 0.0)) + min(max3(q), 0.0);
}

float sdf_sphere(const vec3 p, const vec3 a, const vec4 b)
{
    return length(p) - a.x;
}

float sdf_box(const vec3 p, const vec3 a, const vec4 b)
{
    return corner(abs(p) - a + b.x) - b.x;
}

float sdf_frame(const vec3 p, const vec3 a, const vec4 b)
{
    vec3 q = abs(p) - a;
    vec3 r = abs(q + b.x) - b.x;
    return min(corner(vec3(q.x, r.yz)), min(corner(vec3(r.x, q.y, r.z)), corner(vec3(r.xy, q.z))));
}

float sdf_torus(const vec3 p, const vec3 a, const vec4 b)
{
    return length(vec2(length(p.xz) - a.x, p.y)) - a.y;
}

float sdf_capsule(const vec3 p, const vec3 a, const vec4 b)
{
    vec3 along = b.xyz - a;
    float h = clamp(dot(p - a, along) / max(dot(along, along), 1e-37), 0.0, 1.0);
    return length(p - a - h * along) - b.w;
}

float sdf_cone(const vec3 p, const vec3 a, const vec4 b)
{
    vec2 q = vec2(length(p.xz), p.y);
    vec2 side = vec2(a.y - a.x, 2.0 * a.z);
    vec2 to_end = vec2(q.x - min(q.x, q.y < 0.0 ? a.x : a.y), abs(q.y) - a.z);
    float h = clamp(dot(a.yz - q, side) / max(dot(side, side), 1e-37), 0.0, 1.0);
    vec2 to_side = q - a.yz + side * h;
    float d = min(length(to_end), length(to_side));
    return to_side.x < 0.0 && to_end.y < 0.0 ? -d : d;
}

float sdf_solid_angle(const vec3 p, const vec3 a, const vec4 b)
{
    vec2 q = vec2(length(p.xz), p.y);
    float to_side = length(q - b.xy * clamp(dot(q, b.xy), 0.0, a.x));
    return max(length(q) - a.x, b.y * q.x > b.x * q.y ? to_side : -to_side);
}

float sdf_cylinder(const vec3 p, const vec3 a, const vec4 b)
{
    vec2 q = vec2(length(p.xz), abs(p.y)) - a.xy + a.z;
    return min(max(q.x, q.y), 0.0) + length(max(q, 0.0)) - a.z;
}

float sdf_plane(const vec3 p, const vec3 a, const vec4 b)
{
    return dot(p, a) - b.x;
}

// Returns cosine and sine of an angle in radians.
vec2 cos_sin(float angle)
{
    float turns = angle * (0.5 * INV_PI);
    return cos_sin_turns(turns - floor(turns + 0.5));
}

float sdf_gyroid(const vec3 p, const vec3 a, const vec4 b)
{
    vec2 x = cos_sin(a.x * p.x), y = cos_sin(a.x * p.y), z = cos_sin(a.x * p.z);
    return abs(x.y * y.x + y.y * z.x + z.y * x.x) / (a.x * b.x) - a.y;
}

// Adds one ball: returns the sum, and the distance to the nearest ball.
vec2 sdf_ball(const vec3 p, const vec4 ball, const vec2 sums)
{
    vec3 v = p - ball.xyz;
    float squared = dot(v, v);
    float inside = max(0.0, 1.0 - squared / (ball.w * ball.w));
    return vec2(sums.x + inside * inside * inside, min(sums.y, sqrt(squared) - ball.w));
}

const vec2 SDF_NO_BALLS = vec2(0.0, 3e38);

float sdf_metaballs(const vec2 sums, const vec3 a)
{
    return (a.x - sums.x) * a.y + max(sums.y, 0.0);
}

float sdf_mandelbulb(const vec3 p, const vec3 a, const vec4 b)
{
    vec3 z = p;
    float slope = 1.0;
    float r = length(z);
    uint i = 0u;
    for (; i < uint(a.y) && r <= a.z; i++) {
        float polar = a.x * atan_turns(length(z.xz), z.y);
        float around = a.x * atan_turns(z.x, z.z);
        float scale = pow(max(r, 1e-37), a.x - 1.0);
        vec2 up = cos_sin_turns(polar - floor(polar + 0.5));
        // The map stretches by 1 along the radius, and by sin(n theta) / sin(theta) around the
        // pole, which is at most n. That bound is used near the pole, where the quotient would be
        // dominated by rounding.
        float across = length(z.xz);
        float turning = r * abs(up.y) / max(across, 1e-37);
        float stretch = 64.0 * across > r ? clamp(turning, 1.0, a.x) : a.x;
        slope = a.x * scale * stretch * slope + 1.0;
        vec2 side = cos_sin_turns(around - floor(around + 0.5));
        z = p + scale * r * vec3(up.y * side.y, up.x, up.y * side.x);
        r = length(z);
    }
    sdf_rounds += i;
    return b.x * 0.5 * log(max(r, 1e-37)) * r / slope;
}

float sdf_menger(const vec3 p, const vec3 a, const vec4 b)
{
    vec3 q = p / a.x;
    float scale = 1.0;
    float d = corner(abs(q) - 1.0);
    for (uint i = 0u; i < uint(a.y); i++) {
        vec3 folded = q * scale - 2.0 * floor(0.5 * q * scale + 0.5);
        vec3 r = abs(1.0 - 3.0 * abs(folded));
        scale *= 3.0;
        float holes = min(max(r.x, r.y), min(max(r.y, r.z), max(r.z, r.x)));
        d = max(d, (holes - 1.0) / scale);
    }
    sdf_rounds += uint(a.y);
    return d * a.x;
}

float sdf_apollonian(const vec3 p, const vec3 a, const vec4 b)
{
    vec3 q = p;
    float scale = 1.0;
    for (uint i = 0u; i < uint(a.y); i++) {
        q -= 2.0 * floor(0.5 * q + 0.5);
        float k = a.x / max(dot(q, q), 1e-12);
        q *= k;
        scale *= k;
    }
    sdf_rounds += uint(a.y);
    return b.x * abs(q.y) / scale;
}

float sdf_pyramid(const vec3 p, const vec3 a, const vec4 b)
{
    vec3 q = p / a.x;
    float scale = a.x;
    for (uint i = 0u; i < uint(a.y); i++) {
        q.xy = q.x + q.y < 0.0 ? -q.yx : q.xy;
        q.xz = q.x + q.z < 0.0 ? -q.zx : q.xz;
        q.yz = q.y + q.z < 0.0 ? -q.zy : q.yz;
        q = 2.0 * q - 1.0;
        scale *= 0.5;
    }
    sdf_rounds += uint(a.y);
    float faces = max(max(-q.x - q.y - q.z, q.x + q.y - q.z), max(q.y + q.z - q.x, q.x + q.z - q.y));
    return (faces - 1.0) * 0.57735027 * scale;
}

// --- operations ----------------------------------------------------------------------------------

float sdf_union(const float x, const float y, const float width)
{
    float h = max(width - abs(x - y), 0.0);
    return min(x, y) - 0.25 * h * h / max(width, 1e-37);
}

float sdf_intersection(const float x, const float y, const float width)
{
    float h = max(width - abs(x - y), 0.0);
    return max(x, y) + 0.25 * h * h / max(width, 1e-37);
}

float sdf_difference(const float x, const float y, const float width)
{
    return sdf_intersection(x, -y, width);
}

float sdf_round(const float x, const float width)
{
    return x - width;
}

float sdf_shell(const float x, const float width)
{
    return abs(x) - width;
}

float sdf_factor(const float x, const float factor)
{
    return x * factor;
}

vec3 sdf_transform(const vec3 p, const vec4 b, const vec4 c, const vec4 d)
{
    return vec3(dot(b.xyz, p) + b.w, dot(c.xyz, p) + c.w, dot(d.xyz, p) + d.w);
}

vec3 sdf_repeat(const vec3 p, const vec3 a, const vec4 b)
{
    bvec3 none = equal(a, vec3(0.0));
    vec3 cell = floor(p / mix(a, vec3(1.0), none) + 0.5);
    return p - a * clamp(cell, -b.xyz, b.xyz);
}

vec3 sdf_twist(const vec3 p, const vec3 a, const vec4 b)
{
    vec2 turn = cos_sin(a.x * p.y);
    return vec3(turn.x * p.x - turn.y * p.z, p.y, turn.y * p.x + turn.x * p.z);
}

vec3 sdf_mirror(const vec3 p, const vec3 a, const vec4 b)
{
    return mix(abs(p), p, equal(a, vec3(0.0)));
}

// --- the stack machine ---------------------------------------------------------------------------

vec4 sdf_places[SDF_POINTS_MAX];       // saved points and factors
float sdf_pending[SDF_DISTANCES_MAX + 1]; // distances below the top of the stack

// Evaluates operations up to SDF_PYRAMID, except metaballs. The driver removes those that the scene
// does not use.
float sdf_shape(uint op, vec3 p, vec3 a, vec4 b)
{
    float d = 0.0;
    if (HAS_SDF(SDF_BIT(SDF_SPHERE)) && op == SDF_SPHERE)
        d = sdf_sphere(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_BOX)) && op == SDF_BOX)
        d = sdf_box(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_FRAME)) && op == SDF_FRAME)
        d = sdf_frame(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_TORUS)) && op == SDF_TORUS)
        d = sdf_torus(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_CAPSULE)) && op == SDF_CAPSULE)
        d = sdf_capsule(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_CONE)) && op == SDF_CONE)
        d = sdf_cone(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_SOLID_ANGLE)) && op == SDF_SOLID_ANGLE)
        d = sdf_solid_angle(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_CYLINDER)) && op == SDF_CYLINDER)
        d = sdf_cylinder(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_PLANE)) && op == SDF_PLANE)
        d = sdf_plane(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_GYROID)) && op == SDF_GYROID)
        d = sdf_gyroid(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_MANDELBULB)) && op == SDF_MANDELBULB)
        d = sdf_mandelbulb(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_MENGER)) && op == SDF_MENGER)
        d = sdf_menger(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_APOLLONIAN)) && op == SDF_APOLLONIAN)
        d = sdf_apollonian(p, a, b);
    if (HAS_SDF(SDF_BIT(SDF_PYRAMID)) && op == SDF_PYRAMID)
        d = sdf_pyramid(p, a, b);
    return d;
}

// The balls are in words after the instruction; `at` is the first one.
float sdf_balls(uint at, uint count, vec3 p, vec3 a)
{
    vec2 sums = SDF_NO_BALLS;
    for (uint i = 0u; i < count; i++)
        sums = sdf_ball(p, load_shapes_float(at + i), sums);
    sdf_rounds += count;
    return sdf_metaballs(sums, a);
}

// Returns the result of an operation on the last distance or on the last two; `below` is the
// distance before the last.
float sdf_change(uint op, float below, float last, float k, float width)
{
    float d = last;
    if (HAS_SDF(SDF_BIT(SDF_UNION)) && op == SDF_UNION)
        d = sdf_union(below, last, width);
    if (HAS_SDF(SDF_BIT(SDF_INTERSECTION)) && op == SDF_INTERSECTION)
        d = sdf_intersection(below, last, width);
    if (HAS_SDF(SDF_BIT(SDF_DIFFERENCE)) && op == SDF_DIFFERENCE)
        d = sdf_difference(below, last, width);
    if (HAS_SDF(SDF_BIT(SDF_ROUND)) && op == SDF_ROUND)
        d = sdf_round(last, width);
    if (HAS_SDF(SDF_BIT(SDF_SHELL)) && op == SDF_SHELL)
        d = sdf_shell(last, width);
    if (HAS_SDF(SDF_BIT(SDF_FACTOR)) && op == SDF_FACTOR)
        d = sdf_factor(last, k);
    return d;
}

// Returns the point and the factor after an operation from SDF_TRANSFORM to SDF_MIRROR.
vec4 sdf_move(uint op, vec4 place, vec3 a, vec4 b, vec4 c, vec4 d)
{
    vec4 moved = place;
    if (HAS_SDF(SDF_BIT(SDF_TRANSFORM)) && op == SDF_TRANSFORM)
        moved = vec4(sdf_transform(place.xyz, b, c, d), a.x * place.w);
    if (HAS_SDF(SDF_BIT(SDF_REPEAT)) && op == SDF_REPEAT)
        moved.xyz = sdf_repeat(place.xyz, a, b);
    if (HAS_SDF(SDF_BIT(SDF_TWIST)) && op == SDF_TWIST)
        moved = vec4(sdf_twist(place.xyz, a, b), a.y * place.w);
    if (HAS_SDF(SDF_BIT(SDF_MIRROR)) && op == SDF_MIRROR)
        moved.xyz = sdf_mirror(place.xyz, a, b);
    return moved;
}

#define SDF_MOVING                                                                                 \
    (SDF_BIT(SDF_TRANSFORM) | SDF_BIT(SDF_REPEAT) | SDF_BIT(SDF_TWIST) | SDF_BIT(SDF_MIRROR))

// Returns the value of a program at a point in the field's own space. This body interprets the
// program. If the scene's programs are short enough, render/sdf_inline.c replaces it by calls of
// the functions above with constants.
float sdf_value(const uint first, const uint count, const vec3 point)
{
    vec4 place = vec4(point, 1.0);
    float last = 0.0;
    uint depth = 0u, pending = 0u;
    for (uint i = 0u; i < count; i++) {
        uint at = frame.sdf_code + (first + i) * SDF_INSTRUCTION_WORDS;
        uvec4 head = load_shapes(at);
        vec4 b = load_shapes_float(at + 1u);
        uint op = head.x & 0xffu;
        vec3 a = uintBitsToFloat(head.yzw);
        if (op <= SDF_PYRAMID) {
            sdf_pending[pending++] = last;
            last = place.w * sdf_shape(op, place.xyz, a, b);
        }
        if (HAS_SDF(SDF_BIT(SDF_METABALLS)) && op == SDF_METABALLS) {
            uint balls = head.x >> 8u;
            last = place.w * sdf_balls(at + SDF_INSTRUCTION_WORDS, balls, place.xyz, a);
            i += SDF_BALL_INSTRUCTIONS(balls);
        }
        if (op > SDF_PYRAMID && op <= SDF_FACTOR) {
            bool takes_two = op <= SDF_DIFFERENCE;
            float below = sdf_pending[pending - 1u];
            pending -= takes_two ? 1u : 0u;
            last = sdf_change(op, below, last, a.x, a.x * place.w);
        }
        if (HAS_SDF(SDF_MOVING) && op >= SDF_TRANSFORM && op <= SDF_MIRROR) {
            sdf_places[depth++] = place;
            vec4 c = load_shapes_float(at + 2u);
            vec4 d = load_shapes_float(at + 3u);
            place = sdf_move(op, place, a, b, c, d);
        }
        if (HAS_SDF(SDF_BIT(SDF_RESTORE)) && op == SDF_RESTORE)
            place = sdf_places[--depth];
    }
    sdf_rounds += count * (1u + SDF_INNER_LOOPS);
    return last;
}

#endif
