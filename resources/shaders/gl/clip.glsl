// SPDX-License-Identifier: MIT
// render/scene/LayerClip.h, as useClip() sets it.
layout(location = AT_clipLow) uniform ivec3 clipLow;
layout(location = AT_clipHigh) uniform ivec3 clipHigh;
layout(location = AT_planeCount) uniform int planeCount;  // -1: all is drawn
layout(location = AT_planes) uniform vec4 planes[10];

bool clipped(ivec3 position, vec3 q)
{
    if (planeCount < 0) return false;
    if (any(lessThan(position, clipLow)) || any(greaterThan(position, clipHigh))) return true;
    for (int k = 0; k < planeCount; ++k)
        if (along(planes[k], q) < 0.0) return true;
    return false;
}
