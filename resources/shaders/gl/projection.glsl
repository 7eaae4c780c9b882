// SPDX-License-Identifier: MIT
// LayerProjection in render/raster/Backend.h, as useProjection() sets it; the order of operations is that of the CPU
// backend's kernels.
layout(location = 0) uniform ivec3 reference;
layout(location = 1) uniform vec4 rowX;
layout(location = 2) uniform vec4 rowY;
layout(location = 3) uniform vec4 rowD;
layout(location = 4) uniform bool perspective;
layout(location = 5) uniform float nearDepth;

float along(vec4 row, vec3 q) { return fma(row.x, q.x, fma(row.y, q.y, fma(row.z, q.z, row.w))); }
