// target[i] = source[i] * FACTOR + addend for i below count; the source is a storage buffer or, with
// TEXEL, the uniform texel buffer. One thread an element.
#version 460
layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint FACTOR = 1;
layout(constant_id = 2) const bool TEXEL = false;

layout(std430, set = 0, binding = 0) readonly buffer Source { uint source[]; };
layout(std430, set = 0, binding = 1) writeonly buffer Target { uint target[]; };
layout(set = 0, binding = 16) uniform usamplerBuffer source_texels;
layout(push_constant) uniform Push { uint count, addend; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    if (i >= count)
        return;
    uint value = TEXEL ? texelFetch(source_texels, int(i / 4))[i % 4] : source[i];
    target[i] = value * FACTOR + addend;
}
