// Executes arithmetic as the driver compiles it, for lampyris check: each thread reads four words
// of Input and writes four of Output. A specialization constant selects the routine.
#version 460
#extension GL_GOOGLE_include_directive : require

#include "lib/angle.glsl"
#include "lib/constants.glsl"
#include "lib/double_float.glsl"
#include "shared/check.h"

layout(constant_id = CONSTANT_CHECK_ROUTINE) const uint ROUTINE = 0u;

layout(std430, set = 0, binding = 0) readonly buffer Input { uvec4 inputs[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Output { uvec4 outputs[]; };
layout(push_constant) uniform Push { uint items; };

// The planted fault is an error of one unit in the last place; a test shows that the check detects
// it.
#ifdef PLANTED_ULP
const uint FAULT = 1u;
#else
const uint FAULT = 0u;
#endif

vec4 contraction(float a, float b, float c)
{
    precise float apart = a * b;
    precise float sum = apart + c;
    return vec4(sum, a * b + c, fma(a, b, c), 0.0);
}

uvec4 integers(uvec4 v)
{
    uint high, low;
    umulExtended(v.x, v.y, high, low);
    return uvec4(high, low, bitfieldReverse(v.z), uint(findMSB(v.w)));
}

vec4 arithmetic(uvec4 words)
{
    vec4 v = uintBitsToFloat(words);
    switch (ROUTINE) {
    case CHECK_SUM:
        return vec4(v.x + v.y);
    case CHECK_PRODUCT:
    case CHECK_DENORMALS:
        return vec4(v.x * v.y);
    case CHECK_QUOTIENT:
        return vec4(v.x / v.y);
    case CHECK_ROOT:
        return vec4(sqrt(v.x));
    case CHECK_SUM_ERROR:
        return vec4(exact_sum(v.x, v.y), 0.0, 0.0);
    case CHECK_PRODUCT_ERROR:
        return vec4(exact_product(v.x, v.y), 0.0, 0.0);
    case CHECK_CONTRACTION:
        return contraction(v.x, v.y, v.z);
    case CHECK_SINE:
        return vec4(sin(v.x), cos(v.x), 0.0, 0.0);
    case CHECK_TURNS:
        return vec4(cos_sin_turns(v.x), 0.0, 0.0);
    case CHECK_HALVES:
        return vec4(unpackHalf2x16(words.x), 0.0, 0.0);
    }
    return vec4(float(words.x), floor(v.y), uintBitsToFloat(uint(v.z)), 0.0);
}

void main()
{
    uint item = gl_GlobalInvocationID.x;
    if (item >= items)
        return;
    uvec4 words = inputs[item];
    outputs[item] = (ROUTINE == CHECK_INTEGERS ? integers(words)
                                               : floatBitsToUint(arithmetic(words))) + FAULT;
}
