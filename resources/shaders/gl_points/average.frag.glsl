// SPDX-License-Identifier: MIT
// When all is drawn: adds a point's color to the samples whose nearest point is at most 1 % nearer, by blending. Runs
// once a sample.
flat in uint colorWord;
flat in float depthSeen;
layout(location = 0) out vec4 sum;  // color, and 1
#ifdef CIRCLES
flat in ivec3 square;  // left and top edge, and size, in steps of 1/16 px
layout(location = AT_places) uniform ivec2 places[16];  // of the samples, steps from the pixel's corner
#endif
layout(location = AT_kind) uniform uint kind;  // of the layer, for colorOf()
layout(location = AT_range) uniform vec2 range;

void main()
{
    const ivec2 pixel = ivec2(gl_FragCoord.xy);
#if SAMPLES == 1
    const int which = 0;
#else
    const int which = gl_SampleID;
#endif
#ifdef CIRCLES
    if (!inCircle(16 * pixel - square.xy + places[which], square.z)) discard;
#endif
    if (!(depthSeen <= depthAt(pixel, SAMPLES == 1 ? 0 : which) * 1.01)) discard;
    sum = vec4(vec3(colorOf(colorWord, kind, range.x, range.y).rgb), 1.0);
}
