// SPDX-License-Identifier: MIT
// GlVisibility::Command: points of one chunk.
struct Command {
    uint count, instances, firstIndex;  // as glDrawElementsIndirect reads it
    int baseVertex;
    uint baseInstance;
    uint groupsX, groupsY, groupsZ;  // as glDispatchComputeIndirect reads it
    uint written;
    uint offset, run, step, before;
};
