// SPDX-License-Identifier: MIT
// GlVisibility::Command: the visible points of one chunk.
struct Command {
    uint count, instances, firstIndex;  // as glDrawElementsIndirect reads it
    int baseVertex;
    uint baseInstance;
    uint groupsX, groupsY, groupsZ;  // as glDispatchComputeIndirect reads it
    uint written, unused0, unused1, unused2;
};
