// SPDX-License-Identifier: MIT
// Between the two runs of collect.comp: where each chunk's list begins, and how many work groups draw it. Chunks are
// few: one invocation.
layout(local_size_x = 1) in;

layout(std430, binding = 1) buffer Commands { Command commands[]; };
layout(location = AT_chunkCount) uniform uint chunkCount;
layout(location = AT_groupPoints) uniform uint groupPoints;  // of a work group

void main()
{
    uint first = 0u;
    for (uint i = 0u; i < chunkCount; ++i) {
        commands[i].instances = 1u;
        commands[i].firstIndex = first;
        commands[i].groupsX = (commands[i].count + groupPoints - 1u) / groupPoints;
        commands[i].groupsY = commands[i].groupsZ = 1u;
        first += commands[i].count;
    }
}
