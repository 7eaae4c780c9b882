// SPDX-License-Identifier: MIT
// How many slots there is time for (Schuetz et al. 2019, section 3.4.1), by what the first run took, and the commands
// that draw them. One work group.
const uint kGroup = 256u;
layout(local_size_x = 256) in;

layout(std430, binding = 0) buffer Clock {
    uvec2 times[4];  // GlBudget::Moment; ns, low word first
    uint total;      // slots that the commands draw
};
layout(std430, binding = 1) buffer Commands { Command commands[]; };  // count: as many as there are

layout(location = AT_commandCount) uniform uint commandCount;
layout(location = AT_groupPoints) uniform uint groupPoints;
layout(location = AT_firstSlots) uniform uint firstSlots;  // of the first run
layout(location = AT_budget) uniform uint budget;      // ns from times[0] on

// A clock that goes backward, or takes seconds, says that there is no time.
uint nanoseconds(uvec2 from, uvec2 to)
{
    uint borrow;
    const uint low = usubBorrow(to.x, from.x, borrow);
    return to.y - from.y - borrow == 0u ? low : 0xFFFFFFFFu;
}

shared uint sum;

void main()
{
    if (gl_LocalInvocationIndex == 0u) sum = 0u;
    barrier();
    const uint spent = nanoseconds(times[0], times[2]), cost = max(nanoseconds(times[1], times[2]), 1u);
    const float open = spent < budget ? float(budget - spent) : 0.0;
    const uint affordable = uint(min(open / float(cost) * float(firstSlots), 4e9));
    for (uint i = gl_LocalInvocationIndex; i < commandCount; i += kGroup) {
        const uint run = commands[i].run, before = commands[i].before, offset = commands[i].offset;
        // Runs are drawn one after the other: what does not fit a step ends it all, as nothing is left for further ones.
        uint allotted = affordable > before ? min(affordable - before, run) : 0u;
        if (allotted < run) allotted -= allotted % commands[i].step;
        if (offset == 0u) atomicAdd(sum, allotted);
        const uint count = allotted > offset ? min(commands[i].count, allotted - offset) : 0u;
        commands[i].count = count;
        commands[i].groupsX = (count + groupPoints - 1u) / groupPoints;
    }
    barrier();
    if (gl_LocalInvocationIndex == 0u) total = sum;
}
