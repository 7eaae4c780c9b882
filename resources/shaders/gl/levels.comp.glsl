// SPDX-License-Identifier: MIT
// Of each sample what eye-dome lighting compares: eyedome.glsl goes before.
layout(local_size_x = 16, local_size_y = 16) in;

layout(r32f, binding = 2) writeonly uniform image2DArray levelsOut;  // a layer for each of a pixel's samples
layout(location = AT_logarithmic) uniform bool logarithmic;
layout(location = AT_band) uniform ivec4 band;  // first row, last row (excluded), width

void main()
{
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, band.x);
    if (pixel.x >= band.z || pixel.y >= band.y) return;
    for (int s = 0; s < SAMPLES; ++s) {
        const float level = idAt(pixel, s) == kNoPoint ? kNoLevel : levelOf(depthAt(pixel, s), logarithmic);
        imageStore(levelsOut, ivec3(pixel, s), vec4(level));
    }
}
