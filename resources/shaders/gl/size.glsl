// SPDX-License-Identifier: MIT
// The size of a point in steps of 1/16 px, and which samples a circle covers (LayerProjection in
// render/scene/LayerProjection.h), as usePointSize() sets it.
layout(location = AT_sizes) uniform ivec2 sizes;  // least and most
layout(location = AT_sizeOverDepth) uniform float sizeOverDepth;
layout(location = AT_circles) uniform bool circles;

int sizeAt(float depth)
{
    if (sizeOverDepth <= 0.0) return sizes.x;
    return clamp(int(min(sizeOverDepth / depth + 0.5, float(sizes.y))), sizes.x, sizes.y);
}

// Whether a point of this size covers the sample this far from the left and top edge of its square.
bool inCircle(ivec2 from, int size)
{
    const ivec2 d = 2 * from - (size + 1);
    return !circles || size < 24 || d.x * d.x + d.y * d.y <= size * size;
}
