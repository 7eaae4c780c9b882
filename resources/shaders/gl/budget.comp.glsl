// SPDX-License-Identifier: MIT
// How many slots there is time for (Schuetz et al. 2019, section 3.4.1), by what the first run took, and the commands
// that draw them. Commands are few: one invocation.
layout(local_size_x = 1) in;

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

void main()
{
    const uint spent = nanoseconds(times[0], times[2]), cost = max(nanoseconds(times[1], times[2]), 1u);
    const float open = spent < budget ? float(budget - spent) : 0.0;
    uint left = uint(min(open / float(cost) * float(firstSlots), 4e9));
    uint allotted = 0u;
    total = 0u;
    for (uint i = 0u; i < commandCount; ++i) {
        if (commands[i].offset == 0u) {  // a run begins
            allotted = min(left, commands[i].run);
            if (allotted < commands[i].run) allotted -= allotted % commands[i].step;
            // What does not fit a step ends it all: runs are drawn one after the other.
            left = allotted < commands[i].run ? 0u : left - allotted;
            total += allotted;
        }
        const uint count = allotted > commands[i].offset ? min(commands[i].count, allotted - commands[i].offset) : 0u;
        commands[i].count = count;
        commands[i].groupsX = (count + groupPoints - 1u) / groupPoints;
    }
}
