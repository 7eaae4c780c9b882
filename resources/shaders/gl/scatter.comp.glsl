// SPDX-License-Identifier: MIT
// Puts words and classes of single slots into a chunk.
layout(local_size_x = 256) in;

struct Entry {
    uint slot;  // in the chunk
    uint word;
    uint pointClass;
};
layout(std430, binding = 0) readonly buffer Entries { Entry entries[]; };
layout(std430, binding = 1) writeonly buffer Words { uint words[]; };
#ifdef CLASSES
layout(std430, binding = 2) coherent buffer Classes { uint classes[]; };  // four to a word
#endif
layout(location = 0) uniform uint count;

void main()
{
    const uint i = gl_GlobalInvocationID.x;
    if (i >= count) return;
    const Entry entry = entries[i];
    words[entry.slot] = entry.word;
#ifdef CLASSES
    const uint shift = (entry.slot & 3u) * 8u;
    atomicAnd(classes[entry.slot >> 2], ~(255u << shift));
    atomicOr(classes[entry.slot >> 2], entry.pointClass << shift);
#endif
}
