// SPDX-License-Identifier: MIT
// Colors of the samples, lit where EYE_DOME is defined, and summed by pixel: up to four chunks a run.
layout(local_size_x = 16, local_size_y = 16) in;

layout(std430, binding = 0) readonly buffer Words0 { uint words0[]; };
layout(std430, binding = 1) readonly buffer Words1 { uint words1[]; };
layout(std430, binding = 2) readonly buffer Words2 { uint words2[]; };
layout(std430, binding = 3) readonly buffer Words3 { uint words3[]; };
layout(rgba32ui, binding = 0) uniform uimage2D sums;  // red, green, blue times alpha, and alpha
layout(r32ui, binding = 1) writeonly uniform uimage2D picture;  // a color packed as Rgba8

layout(location = AT_firstIds) uniform uvec4 firstIds;
layout(location = AT_counts) uniform uvec4 counts;  // 0: no such chunk
layout(location = AT_kinds) uniform uvec4 kinds;   // WordKind, and 8 where selected points are marked
layout(location = AT_lows) uniform vec4 lows;
layout(location = AT_highs) uniform vec4 highs;
layout(location = AT_first) uniform bool first;  // no sums yet
layout(location = AT_last) uniform bool last;   // make the picture
layout(location = AT_band) uniform ivec4 band;  // first row, last row (excluded), width

#if SAMPLES == 1
uvec4 weighted(uvec4 color) { return color; }
uvec4 average(uvec4 sum) { return sum; }
#else
// As render/raster/cpu/CpuResolve.cpp does it.
uvec4 weighted(uvec4 color) { return uvec4(color.rgb * color.a, color.a); }
uvec4 average(uvec4 sum)
{
    if (sum.a == 0u) return uvec4(0u);
    return uvec4((sum.rgb + sum.a / 2u) / sum.a, (sum.a + uint(SAMPLES / 2)) / uint(SAMPLES));
}
#endif

#ifndef EYE_DOME
uvec4 shaded(uvec4 color, ivec2 pixel, int which) { return color; }
#endif

void main()
{
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy) + ivec2(0, band.x);
    if (pixel.x >= band.z || pixel.y >= band.y) return;
    uvec4 sum = first ? uvec4(0u) : imageLoad(sums, pixel);
    for (int s = 0; s < SAMPLES; ++s) {
        const uint id = idAt(pixel, s);
        if (id == kNoPoint) {
            if (first) sum += weighted(unpack(background[pixel.y]));
            continue;
        }
#ifdef MEANS
        const uint mean = meanAt(pixel, s);
        if (mean != 0u) {
            if (first) sum += weighted(shaded(unpack(mean), pixel, s));
            continue;
        }
#endif
        const uvec4 slot = id - firstIds;  // wraps round, and is then too large
        uint word;
        uint chunk;
        if (slot.x < counts.x) {
            word = words0[slot.x];
            chunk = 0u;
        } else if (slot.y < counts.y) {
            word = words1[slot.y];
            chunk = 1u;
        } else if (slot.z < counts.z) {
            word = words2[slot.z];
            chunk = 2u;
        } else if (slot.w < counts.w) {
            word = words3[slot.w];
            chunk = 3u;
        } else {
            continue;
        }
        sum += weighted(shaded(colorOf(word, kinds[chunk], lows[chunk], highs[chunk]), pixel, s));
    }
    if (last) {
        const uvec4 color = average(sum);
        imageStore(picture, pixel, uvec4(color.r | color.g << 8 | color.b << 16 | color.a << 24, 0u, 0u, 0u));
    } else {
        imageStore(sums, pixel, sum);
    }
}
