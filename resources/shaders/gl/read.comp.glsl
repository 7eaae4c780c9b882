// SPDX-License-Identifier: MIT
// Ids and depths of the samples of a small rectangle, for picking.
layout(local_size_x = 8, local_size_y = 8) in;

struct Sample {
    uint id;
    float depth;  // along the view direction
};
layout(std430, binding = 0) writeonly buffer Samples { Sample samples[]; };
layout(location = AT_rectangle) uniform ivec4 rectangle;  // x, y, width, height
layout(location = AT_rows) uniform ivec2 rows;       // of the picture: first, last (excluded)

void main()
{
    const ivec2 at = ivec2(gl_GlobalInvocationID.xy);
    if (at.x >= rectangle.z || at.y >= rectangle.w) return;
    const ivec2 pixel = rectangle.xy + at;
    if (pixel.y < rows.x || pixel.y >= rows.y) return;
    for (int s = 0; s < SAMPLES; ++s)
        samples[(at.y * rectangle.z + at.x) * SAMPLES + s] = Sample(idAt(pixel, s), depthAt(pixel, s));
}
