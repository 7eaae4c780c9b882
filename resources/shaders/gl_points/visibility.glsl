// SPDX-License-Identifier: MIT
// The visibility buffer as shaders read it: SAMPLES is 1, 4, 8 or 16.
#if SAMPLES == 1
layout(binding = 0) uniform usampler2D ids;
layout(binding = 1) uniform sampler2D depths;
#else
layout(binding = 0) uniform usampler2DMS ids;
layout(binding = 1) uniform sampler2DMS depths;
#endif

const uint kNoPoint = 0xFFFFFFFFu;

// `which` is the level where there is one sample, and it is level 0.
uint idAt(ivec2 pixel, int which) { return texelFetch(ids, pixel, which).r; }

float depthAt(ivec2 pixel, int which)
{
    return uintBitsToFloat(0x3F800000u + 0x2B800000u - floatBitsToUint(texelFetch(depths, pixel, which).r));  // see points.vert
}
