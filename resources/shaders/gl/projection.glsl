// SPDX-License-Identifier: MIT
// render/scene/LayerProjection.h, as useProjection() sets it; the order of operations is that of the CPU
// backend's kernels.
layout(location = AT_reference) uniform ivec3 reference;
layout(location = AT_rowX) uniform vec4 rowX;
layout(location = AT_rowY) uniform vec4 rowY;
layout(location = AT_rowD) uniform vec4 rowD;
layout(location = AT_perspective) uniform bool perspective;
layout(location = AT_nearDepth) uniform float nearDepth;

float along(vec4 row, vec3 q) { return fma(row.x, q.x, fma(row.y, q.y, fma(row.z, q.z, row.w))); }
