// SPDX-License-Identifier: MIT
// What filters go by: a point's class in the low byte, 256 for a hidden point (GlPointCopy::Part::Groups).
layout(location = AT_shownClasses) uniform uvec4 shownClasses[2];  // a bit a class

bool isShown(uint group)
{
    const uint pointClass = group & 255u;
    return (group & 256u) == 0u &&
           ((shownClasses[pointClass >> 7][(pointClass >> 5) & 3u] >> (pointClass & 31u)) & 1u) != 0u;
}
