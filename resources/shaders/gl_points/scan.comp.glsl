// SPDX-License-Identifier: MIT
// Between the two runs of collect.comp: where each chunk's list begins. Chunks are few: one invocation.
layout(local_size_x = 1) in;

struct Command {
    uint count, instances, firstIndex;
    int baseVertex;
    uint baseInstance;
    uint written, unused0, unused1;
};
layout(std430, binding = 1) buffer Commands { Command commands[]; };
layout(location = 1) uniform uint chunkCount;

void main()
{
    uint first = 0u;
    for (uint i = 0u; i < chunkCount; ++i) {
        commands[i].instances = 1u;
        commands[i].firstIndex = first;
        first += commands[i].count;
    }
}
