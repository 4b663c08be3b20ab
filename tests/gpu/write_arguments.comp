// One thread turns an element count into the arguments of an indirect dispatch.
#version 460
layout(local_size_x_id = 0) in;
layout(constant_id = 1) const uint GROUP = 64;

layout(std430, set = 0, binding = 0) readonly buffer Count { uint count; };
layout(std430, set = 0, binding = 1) writeonly buffer Arguments { uint arguments[]; };

void main()
{
    if (gl_GlobalInvocationID.x > 0)
        return;
    arguments[0] = (count + GROUP - 1) / GROUP;
    arguments[1] = 1;
    arguments[2] = 1;
}
