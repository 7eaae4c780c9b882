// SPDX-License-Identifier: MIT
flat in uint id;
layout(location = 0) out uint visibleId;
#ifdef FRAGMENT_DEPTH
flat in float depthValue;
#endif

void main()
{
    visibleId = id;
#ifdef FRAGMENT_DEPTH
    gl_FragDepth = depthValue;
#endif
}
