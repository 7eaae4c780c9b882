// SPDX-License-Identifier: MIT
// Depth of each pixel's nearest sample.
layout(local_size_x = 16, local_size_y = 16) in;

layout(r32f, binding = 2) writeonly uniform image2D depthsOut;
layout(location = AT_band) uniform ivec4 band;  // first row, last row (excluded), width
const float kNowhere = 3.0e38;  // farther than any point

void main()
{
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, band.x);
    if (pixel.x >= band.z || pixel.y >= band.y) return;
    float nearest = kNowhere;
    for (int s = 0; s < SAMPLES; ++s)
        if (idAt(pixel, s) != kNoPoint) nearest = min(nearest, depthAt(pixel, s));
    imageStore(depthsOut, pixel, vec4(nearest));
}
