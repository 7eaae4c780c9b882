// SPDX-License-Identifier: MIT
// The color of a point's word. The arithmetic follows colorOf() in render/resolve/colorOf.inl and categoryColor() in
// render/color/ColorMap.h; change them together.
layout(std430, binding = 4) readonly buffer Tables {
    uint colorMap[256];
    uint palette[256];
    uint tone[256];
    uint noValue;
    uint background[];  // a color a row
};
layout(location = AT_lit) uniform bool lit;  // NormalLook
layout(location = AT_light) uniform vec3 light;
layout(location = AT_eye) uniform vec3 eye;

uvec4 unpack(uint color) { return uvec4(color, color >> 8, color >> 16, color >> 24) & 255u; }

uvec4 categoryColor(uint id)
{
    if (id == 0u) return uvec4(112u, 116u, 122u, 255u);  // none
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
        const float size = length(n), side = dot(n, eye) > 0.0 ? 1.0 : -1.0;
        const float facing = size > 0.0 ? max(side * dot(n, light), 0.0) / size : 0.0;
        return uvec4(uvec3(min(38.0 + 217.0 * facing, 255.0) + 0.5), 255u);
    }
    const uvec4 c = unpack(word);
    return uvec4(uvec3(tone[c.r], tone[c.g], tone[c.b]) & 255u, c.a);
}

uvec4 colorOf(uint word, uint kind, float low, float high)
{
    if (kind < 8u) return ownColorOf(word, kind, low, high);
    kind -= 8u;
    const bool color = kind == 3u;
    const uint bit = kind == 0u ? 1u : color ? 1u << 24 : 1u << 31;
    const bool selected = ((word & bit) != 0u) != color;
    const uvec4 own = ownColorOf(color ? word | bit : word & ~bit, kind, low, high);
    return selected ? uvec4((own.rgb + 3u * uvec3(255u, 0u, 255u)) / 4u, 255u) : own;
}
