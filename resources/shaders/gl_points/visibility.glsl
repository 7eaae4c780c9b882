// SPDX-License-Identifier: MIT
// The visibility buffer as shaders read it: SAMPLES is 1, 4, 8 or 16.
#if SAMPLES == 1
layout(binding = 0) uniform usampler2D ids;
layout(binding = 1) uniform sampler2D depths;
layout(binding = 2) uniform sampler2D colorSums;
#else
layout(binding = 0) uniform usampler2DMS ids;
layout(binding = 1) uniform sampler2DMS depths;
layout(binding = 2) uniform sampler2DMS colorSums;
#endif

const uint kNoPoint = 0xFFFFFFFFu;

// The mean of the colors that were added to a sample, packed as Rgba8; 0: none was.
uint meanAt(ivec2 pixel, int which)
{
    const vec4 sum = texelFetch(colorSums, pixel, which);
    const uint count = uint(sum.a);
    if (count == 0u) return 0u;
    const uvec3 mean = (uvec3(sum.rgb) + count / 2u) / count;
    return mean.r | mean.g << 8 | mean.b << 16 | 0xFF000000u;
}

// `which` is the level where there is one sample, and it is level 0.
uint idAt(ivec2 pixel, int which) { return texelFetch(ids, pixel, which).r; }

float depthAt(ivec2 pixel, int which)
{
    return uintBitsToFloat(0x3F800000u + 0x2B800000u - floatBitsToUint(texelFetch(depths, pixel, which).r));  // see points.vert
}
