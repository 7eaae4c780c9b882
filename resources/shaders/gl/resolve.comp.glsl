// SPDX-License-Identifier: MIT
// Colours of the samples, summed by pixel: up to four chunks a run. The arithmetic follows colorOf() in
// render/resolve/colorOf.inl and categoryColor() in render/color/ColorMap.h; change them together.
layout(local_size_x = 16, local_size_y = 16) in;

layout(std430, binding = 0) readonly buffer Words0 { uint words0[]; };
layout(std430, binding = 1) readonly buffer Words1 { uint words1[]; };
layout(std430, binding = 2) readonly buffer Words2 { uint words2[]; };
layout(std430, binding = 3) readonly buffer Words3 { uint words3[]; };
layout(std430, binding = 4) readonly buffer Tables {
    uint colorMap[256];
    uint palette[256];
    uint noValue;
    uint background[];  // a colour a row
};
layout(rgba32ui, binding = 0) uniform uimage2D sums;  // red, green, blue times alpha, and alpha
layout(r32ui, binding = 1) writeonly uniform uimage2D picture;  // a colour packed as Rgba8

layout(location = 0) uniform uvec4 firstIds;
layout(location = 1) uniform uvec4 counts;  // 0: no such chunk
layout(location = 2) uniform uvec4 kinds;   // WordKind, and 8 where selected points are marked
layout(location = 3) uniform vec4 lows;
layout(location = 4) uniform vec4 highs;
layout(location = 5) uniform bool first;  // no sums yet
layout(location = 6) uniform bool last;   // make the picture
layout(location = 8) uniform bool lit;      // NormalLook
layout(location = 9) uniform vec3 light;
layout(location = 7) uniform ivec4 band;  // first row, last row (excluded), width

#if SAMPLES == 1
uvec4 weighted(uvec4 color) { return color; }
uvec4 average(uvec4 sum) { return sum; }
#else
// As render/resolve/CpuResolve.cpp does it.
uvec4 weighted(uvec4 color) { return uvec4(color.rgb * color.a, color.a); }
uvec4 average(uvec4 sum)
{
    if (sum.a == 0u) return uvec4(0u);
    return uvec4((sum.rgb + sum.a / 2u) / sum.a, (sum.a + uint(SAMPLES / 2)) / uint(SAMPLES));
}
#endif

uvec4 unpack(uint color) { return uvec4(color, color >> 8, color >> 16, color >> 24) & 255u; }

uvec4 categoryColor(uint id)
{
    const uint hue = (((id * 2654435769u) >> 16) * 1536u) >> 16;
    const uint ramp = hue & 255u, ring = id % 3u;
    const uint hi = ring == 0u ? 235u : ring == 1u ? 205u : 250u;
    const uint lo = ring == 0u ? 70u : ring == 1u ? 40u : 130u;
    const uint up = lo + (hi - lo) * ramp / 255u;
    const uint down = hi - (hi - lo) * ramp / 255u;
    switch (hue >> 8) {
    case 0u: return uvec4(hi, up, lo, 255u);
    case 1u: return uvec4(down, hi, lo, 255u);
    case 2u: return uvec4(lo, hi, up, 255u);
    case 3u: return uvec4(lo, down, hi, 255u);
    case 4u: return uvec4(up, lo, hi, 255u);
    }
    return uvec4(hi, lo, down, 255u);
}

uvec4 ownColorOf(uint word, uint kind, float low, float high)
{
    if (kind == 0u) {
        if ((word & 0x7FFFFFFFu) > 0x7F800000u) return unpack(noValue);
        const float range = high - low;
        const float t = range > 0.0 ? (uintBitsToFloat(word) - low) / range : 0.5;
        return unpack(colorMap[uint(clamp(t, 0.0, 1.0) * 255.0 + 0.5)]);
    }
    if (kind == 1u) return unpack(palette[word & 255u]);
    if (kind == 2u) return categoryColor(word);
    if (kind == 4u) {
        if (word == 0u) return unpack(noValue);
        const vec3 n = (vec3(uvec3(word, word >> 10, word >> 20) & 1023u) - 512.0) / 511.0;
        if (!lit) return uvec4(uvec3(clamp(n * 127.5 + 127.5, 0.0, 255.0) + 0.5), 255u);
        const float size = length(n);
        const float facing = size > 0.0 ? abs(dot(n, light)) / size : 0.0;
        return uvec4(uvec3(min(38.0 + 217.0 * facing, 255.0) + 0.5), 255u);
    }
    return unpack(word);
}

uvec4 colorOf(uint word, uint kind, float low, float high)
{
    if (kind < 8u) return ownColorOf(word, kind, low, high);
    kind -= 8u;
    const bool color = kind == 3u;
    const uint bit = kind == 0u ? 1u : color ? 1u << 24 : 1u << 31;
    const bool selected = ((word & bit) != 0u) != color;
    const uvec4 own = ownColorOf(color ? word | bit : word & ~bit, kind, low, high);
    return selected ? uvec4((own.rgb + 3u * uvec3(255u, 214u, 64u)) / 4u, 255u) : own;
}

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
        sum += weighted(colorOf(word, kinds[chunk], lows[chunk], highs[chunk]));
    }
    if (last) {
        const uvec4 color = average(sum);
        imageStore(picture, pixel, uvec4(color.r | color.g << 8 | color.b << 16 | color.a << 24, 0u, 0u, 0u));
    } else {
        imageStore(sums, pixel, sum);
    }
}
