// SPDX-License-Identifier: MIT
// The mean color of each cell that colors were added to, packed as Rgba8; 0: none was.
layout(local_size_x = 256) in;

layout(std430, binding = 0) readonly buffer RedGreen { uvec2 redGreen[]; };
layout(std430, binding = 1) readonly buffer BlueCount { uvec2 blueCount[]; };
layout(std430, binding = 2) writeonly buffer Means { uint means[]; };
layout(location = AT_cells) uniform uint cells;

void main()
{
    // as many groups as fit one direction, in rows
    const uint cell = gl_GlobalInvocationID.y * gl_NumWorkGroups.x * 256u + gl_GlobalInvocationID.x;
    if (cell >= cells) return;
    const uvec3 sum = uvec3(redGreen[cell], blueCount[cell].x);
    const uint count = blueCount[cell].y;
    const uvec3 mean = count > 0u ? (sum + count / 2u) / count : uvec3(0u);
    means[cell] = count > 0u ? mean.r | mean.g << 8 | mean.b << 16 | 0xFF000000u : 0u;
}
