// SPDX-License-Identifier: MIT
// The visibility buffer as shaders read it: SAMPLES is 1, 4, 8 or 16. A buffer holds a band of rows.
#ifdef CELLS64
layout(std430, binding = 5) readonly buffer Cells { uvec2 cells[]; };  // id, depth bits
#else
layout(std430, binding = 5) readonly buffer Ids { uint ids[]; };
layout(std430, binding = 6) readonly buffer Depths { uint depths[]; };
#endif
#ifdef MEANS
layout(std430, binding = 7) readonly buffer Means { uint means[]; };
#endif
layout(location = AT_stored) uniform ivec2 stored;  // first row, px of a row

const uint kNoPoint = 0xFFFFFFFFu;

int cellOf(ivec2 pixel, int which) { return ((pixel.y - stored.x) * stored.y + pixel.x) * SAMPLES + which; }

#ifdef MEANS
uint meanAt(ivec2 pixel, int which) { return means[cellOf(pixel, which)]; }
#endif
#ifdef CELLS64
uint idAt(ivec2 pixel, int which) { return cells[cellOf(pixel, which)].x; }
float depthAt(ivec2 pixel, int which) { return uintBitsToFloat(cells[cellOf(pixel, which)].y); }
#else
uint idAt(ivec2 pixel, int which) { return ids[cellOf(pixel, which)]; }
float depthAt(ivec2 pixel, int which) { return uintBitsToFloat(depths[cellOf(pixel, which)]); }
#endif
