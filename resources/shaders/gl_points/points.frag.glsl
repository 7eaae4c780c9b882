// SPDX-License-Identifier: MIT
flat in uint id;
layout(location = 0) out uint visibleId;
#ifdef FRAGMENT_DEPTH
flat in float depthValue;
#endif
#ifdef CIRCLES
flat in ivec3 square;  // left and top edge, and size, in steps of 1/16 px
layout(location = AT_samples) uniform int samples;
layout(location = AT_places) uniform ivec2 places[16];  // of the samples, steps from the pixel's corner
#endif

void main()
{
    visibleId = id;
#ifdef FRAGMENT_DEPTH
    gl_FragDepth = depthValue;
#endif
#ifdef CIRCLES
    const ivec2 corner = 16 * ivec2(gl_FragCoord.xy) - square.xy;
    int mask = 0;
    for (int s = 0; s < samples; ++s) mask |= int(inCircle(corner + places[s], square.z)) << s;
    if (mask == 0) discard;
    gl_SampleMask[0] = mask;
#endif
}
