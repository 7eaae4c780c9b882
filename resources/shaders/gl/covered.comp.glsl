// SPDX-License-Identifier: MIT
// Counts the pixels that show a point.
layout(local_size_x = 16, local_size_y = 16) in;

layout(std430, binding = 0) coherent buffer Total { uint total; };
layout(location = AT_band) uniform ivec4 band;  // first row, last row (excluded), width
shared uint inGroup;

void main()
{
    if (gl_LocalInvocationIndex == 0u) inGroup = 0u;
    barrier();
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, band.x);
    if (pixel.x < band.z && pixel.y < band.y) {
        bool covered = false;
        for (int s = 0; s < SAMPLES; ++s) covered = covered || idAt(pixel, s) != kNoPoint;
        if (covered) atomicAdd(inGroup, 1u);
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u) atomicAdd(total, inGroup);
}
