// SPDX-License-Identifier: MIT
// Id of each pixel's nearest sample; of those that are as near, the least.
layout(local_size_x = 16, local_size_y = 16) in;

layout(r32ui, binding = 2) writeonly uniform uimage2D idsOut;
layout(location = AT_band) uniform ivec4 band;  // first row, last row (excluded), width
const float kNowhere = 3.0e38;  // farther than any point

void main()
{
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, band.x);
    if (pixel.x >= band.z || pixel.y >= band.y) return;
    uint id = kNoPoint;
    float nearest = kNowhere;
    for (int s = 0; s < SAMPLES; ++s) {
        const uint other = idAt(pixel, s);
        if (other == kNoPoint) continue;
        const float depth = depthAt(pixel, s);
        if (depth > nearest || (depth == nearest && other > id)) continue;
        id = other;
        nearest = depth;
    }
    imageStore(idsOut, pixel, uvec4(id));
}
