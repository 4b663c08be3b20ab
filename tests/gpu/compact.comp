// Appends the odd elements of source to target; target[0] counts them. One atomic a subgroup: the
// lanes of one subgroup keep their order, the order of subgroups is left to chance.
#version 460
#extension GL_KHR_shader_subgroup_ballot : require
layout(local_size_x_id = 0) in;

layout(std430, set = 0, binding = 0) readonly buffer Source { uint source[]; };
layout(std430, set = 0, binding = 1) buffer Target { uint target[]; };
layout(push_constant) uniform Push { uint count; };

void main()
{
    uint i = gl_GlobalInvocationID.x;
    uint value = i < count ? source[i] : 0;
    bool keep = value % 2 == 1;
    uvec4 ballot = subgroupBallot(keep);
    uint first = 0;
    if (subgroupElect())
        first = atomicAdd(target[0], subgroupBallotBitCount(ballot));
    first = subgroupBroadcastFirst(first);
    if (keep)
        target[1 + first + subgroupBallotExclusiveBitCount(ballot)] = value;
}
