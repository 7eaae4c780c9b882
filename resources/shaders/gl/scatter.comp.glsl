// SPDX-License-Identifier: MIT
// Puts words and groups of single slots into a chunk.
layout(local_size_x = 256) in;

struct Entry {
    uint slot;  // in the chunk
    uint word;
    uint group;
};
layout(std430, binding = 0) readonly buffer Entries { Entry entries[]; };
layout(std430, binding = 1) writeonly buffer Words { uint words[]; };
#ifdef GROUPS
layout(std430, binding = 2) coherent buffer Groups { uint groups[]; };  // two to a word
#endif
layout(location = AT_count) uniform uint count;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    const Entry entry = entries[i];
    words[entry.slot] = entry.word;
#ifdef GROUPS
    const uint shift = (entry.slot & 1u) * 16u;
    atomicAnd(groups[entry.slot >> 1], ~(0xFFFFu << shift));
    atomicOr(groups[entry.slot >> 1], entry.group << shift);
#endif
}
