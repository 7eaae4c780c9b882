// SPDX-License-Identifier: MIT
// Projects one point (render/scene/LayerProjection.h), and places it so that the rasterizer covers
// exactly the samples that the contract asks for.
layout(location = 0) in ivec3 position;  // local integers; x == 0: empty slot
#ifdef FILTER
layout(location = 1) in uint group;
#endif

#ifdef AVERAGE
layout(location = 2) in uint word;
#endif

layout(location = AT_pictureSize) uniform vec2 pictureSize; // px
layout(location = AT_margin) uniform float margin;     // px between viewport and picture, at the left and at the top
layout(location = AT_perPixel) uniform float perPixel;  // clip units
layout(location = AT_firstId) uniform uint firstId;    // of vertex 0

flat out uint id;
#ifdef CIRCLES
flat out ivec3 square;  // left and top edge, and size, in steps of 1/16 px
#endif
#ifdef FRAGMENT_DEPTH
flat out float depthValue;
#endif
#ifdef AVERAGE
flat out uint colorWord;
flat out float depthSeen;
#endif

void main()
{
    const vec3 q = vec3(position - reference);
    const float depth = along(rowD, q);
    const float inverse = perspective ? 1.0 / depth : 1.0;
    vec2 px = vec2(along(rowX, q), along(rowY, q)) * inverse;
    const int size = sizeAt(depth);
    const float pointSize = float(size) * 0.0625, halfSize = 0.5 * pointSize;

    bool keep = position.x != 0 && depth >= nearDepth && all(greaterThanEqual(px, vec2(-halfSize))) &&
                all(lessThan(px, pictureSize + halfSize));
    keep = keep && !clipped(position, q);
#ifdef FILTER
    keep = keep && isShown(group);
#endif

    // Samples lie at multiples of 1/16 px. Moving the square so that its edges lie in the middle between two of
    // these keeps what it covers, and survives the rasterizer's rounding to (usually) 1/256 px.
    const vec2 low = floor(16.0 * (px - halfSize));
    px = (low + 0.5) * 0.0625 + halfSize;
#ifdef CIRCLES
    square = ivec3(ivec2(clamp(low, vec2(-1e6), vec2(1e6))), size);
#endif

    // Reversed depth without loss: the bits of positive floats order like the floats themselves, so taking them
    // from a constant turns [2^-40, 2^86] round into (0, 1], one to one, for perspective and orthographic views.
    const uint kNearest = 0x2B800000u, kSum = 0x3F800000u + kNearest;
    const uint bits = clamp(floatBitsToUint(max(depth, uintBitsToFloat(kNearest))), kNearest, kSum - 0x00800000u);
    const float reversed = uintBitsToFloat(kSum - bits);

    id = firstId + uint(gl_VertexID);
#ifdef AVERAGE
    colorWord = word;
    depthSeen = depth;
#endif
#ifdef FRAGMENT_DEPTH
    depthValue = reversed;
    const float z = 0.0;
#else
    const float z = reversed;
#endif
    // The division is done, so w is 1. Row 0 of the picture is row 0 of the texture: the picture stands on its
    // head as OpenGL sees it, and is read back the right way up.
    gl_Position = keep ? vec4((px + margin) * perPixel - 1.0, z, 1.0) : vec4(2.0, 2.0, 2.0, 1.0);
    gl_PointSize = pointSize;
}
