// SPDX-License-Identifier: MIT
// The visible points of a band of rows, sorted by chunk: run once to count (FILL undefined), then scan.comp, then
// once to write the lists (Schuetz et al. 2019, section 3.4, pass 3).
layout(local_size_x = 16, local_size_y = 16) in;

layout(std430, binding = 0) readonly buffer Chunks { uint firstIds[]; };  // rising
layout(std430, binding = 1) coherent buffer Commands { Command commands[]; };
#ifdef FILL
layout(std430, binding = 2) writeonly buffer List { uint list[]; };
#endif

layout(location = AT_band) uniform ivec4 band;  // first row, last row (excluded), width
layout(location = AT_chunkCount) uniform uint chunkCount;

bool pixelHas(ivec2 pixel, uint id)
{
    for (int s = 0; s < SAMPLES; ++s)
        if (idAt(pixel, s) == id) return true;
    return false;
}

// The last chunk that begins at or before an id.
uint chunkOf(uint id)
{
    uint low = 0u, high = chunkCount;
    while (high - low > 1u) {
        const uint middle = (low + high) >> 1;
        if (firstIds[middle] <= id) low = middle;
        else high = middle;
    }
    return low;
}

void main()
{
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, band.x);
    if (pixel.x >= band.z || pixel.y >= band.y) return;
    uint seen[SAMPLES];
    for (int s = 0; s < SAMPLES; ++s) {
        const uint id = idAt(pixel, s);
        seen[s] = id;
        bool again = id == kNoPoint;
        for (int t = 0; t < s; ++t) again = again || seen[t] == id;
        // Of the pixels that show a point, the leftmost of the topmost row of its band always lists it.
        if (!again && pixel.x > 0) again = pixelHas(pixel - ivec2(1, 0), id);
        if (!again && pixel.y > band.x) again = pixelHas(pixel - ivec2(0, 1), id);
        if (again) continue;
        const uint chunk = chunkOf(id);
        if (id < firstIds[chunk]) continue;
#ifdef FILL
        list[commands[chunk].firstIndex + atomicAdd(commands[chunk].written, 1u)] = id - firstIds[chunk];
#else
        atomicAdd(commands[chunk].count, 1u);
#endif
    }
}
