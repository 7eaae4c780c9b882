// SPDX-License-Identifier: MIT
// The picture as a texture that others can draw.
layout(local_size_x = 16, local_size_y = 16) in;

layout(binding = 4) uniform usampler2D picture;  // Rgba8, packed
layout(rgba8, binding = 1) writeonly uniform image2D shown;

void main()
{
    const ivec2 pixel = ivec2(gl_GlobalInvocationID.xy);
    if (any(greaterThanEqual(pixel, textureSize(picture, 0)))) return;
    imageStore(shown, pixel, unpackUnorm4x8(texelFetch(picture, pixel, 0).r));
}
