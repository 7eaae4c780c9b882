// SPDX-License-Identifier: MIT
// Lets surfaces grow one px into holes, as a pass of fillHoles() in render/resolve/HoleFill.cpp does.
layout(local_size_x = 16, local_size_y = 16) in;

layout(binding = 3) uniform sampler2D depths;  // nearest.comp
layout(binding = 4) uniform usampler2D picture;
layout(r32ui, binding = 1) writeonly uniform uimage2D pictureOut;
layout(r32f, binding = 2) writeonly uniform image2D depthsOut;

// In the order of fillHoles(): the first in front gives its color.
const ivec2 kAround[8] = ivec2[8](ivec2(0, -1), ivec2(-1, 0), ivec2(1, 0), ivec2(0, 1), ivec2(-1, -1), ivec2(1, -1),
                                  ivec2(-1, 1), ivec2(1, 1));
const int kMostOf = 5;

void main()
{
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy), size = textureSize(depths, 0);
    if (any(greaterThanEqual(pixel, size))) return;
    ivec2 from = pixel;
    const float own = texelFetch(depths, pixel, 0).r;
    if (all(greaterThan(pixel, ivec2(0))) && all(lessThan(pixel, size - 1))) {
        float around[8];
        float nearest = 3.4e38;
        for (int k = 0; k < 8; ++k) {
            around[k] = texelFetch(depths, pixel + kAround[k], 0).r;
            nearest = min(nearest, around[k]);
        }
        precise const float front = nearest * 1.02;
        if (front < own) {
            int near = 0;
            ivec2 first = pixel;
            for (int k = 0; k < 8; ++k) {
                if (!(around[k] <= front)) continue;
                if (near++ == 0) first = pixel + kAround[k];
            }
            if (near >= kMostOf) from = first;
        }
    }
    imageStore(pictureOut, pixel, uvec4(texelFetch(picture, from, 0).r));
    imageStore(depthsOut, pixel, vec4(texelFetch(depths, from, 0).r));
}
