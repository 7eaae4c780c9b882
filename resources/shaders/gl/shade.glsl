// SPDX-License-Identifier: MIT
// Eye-dome lighting of a sample's color, from what levels.comp and extent.comp left: eyedome.glsl goes before.
layout(binding = 3) uniform sampler2DArray levels;
layout(binding = 4) uniform sampler2D extents;
layout(location = AT_reach) uniform int reach;

uvec4 shaded(uvec4 color, ivec2 pixel, int which)
{
    const float extent = texelFetch(extents, ivec2(0, 0), 0).r, scale = texelFetch(extents, ivec2(1, 0), 0).r;
    if (!(extent > 0.0)) return color;
    const ivec2 size = textureSize(levels, 0).xy;
    const float own = texelFetch(levels, ivec3(pixel, which), 0).r;
    precise float behind = 0.0;
    for (int far = 1; far <= 2; ++far)
        for (int k = 0; k < 8; ++k) {
            const ivec2 at = pixel + kNeighbors[k] * (far * reach);
            if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, size))) continue;
            behind += min(max(own - texelFetch(levels, ivec3(at, which), 0).r, 0.0), extent);
        }
    precise const float shade = kDarkest + (1.0 - kDarkest) * exp2Of(-behind * scale);
    precise const vec3 dim = vec3(color.rgb) * shade + 0.5;
    return uvec4(uvec3(dim), color.a);
}
