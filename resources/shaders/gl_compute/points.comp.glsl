// SPDX-License-Identifier: MIT
// Draws points into the visibility buffer (Schuetz, Kerbl, Wimmer 2022, section 3). A work group draws a batch of
// GROUP_POINTS points, one invocation some of them, a stride apart, so that neighbors read neighboring memory; it asks
// for LOADS of them before it draws the first. What is hidden by what was drawn before is found by a plain read; only
// the rest does atomic operations.
//
// PASS 2: one 64-bit minimum of (depth, id). Where the driver has none: PASS 0 finds each sample's least depth and
// takes out the id of what is hidden now, PASS 1 puts in the least id of that depth. Both give the same picture.
//
// PASS 3, when all is drawn: adds colors to the samples whose nearest point is at most 1 % nearer (section 3.6).
//
// Where points go and what they cover is in render/scene/LayerProjection.h.
layout(local_size_x = GROUP_SIZE) in;

layout(std430, binding = 0) readonly buffer Positions { int positions[]; };  // local integers; x == 0: empty slot
#ifdef FILTER
layout(std430, binding = 1) readonly buffer Groups { uint groups[]; };  // two to a word
#endif
#if PASS == 3
layout(std430, binding = 2) readonly buffer Words { uint words[]; };
layout(std430, binding = 3) coherent buffer RedGreen { uint redGreen[]; };    // sums, two to a cell
layout(std430, binding = 7) coherent buffer BlueCount { uint blueCount[]; };  // sum and number of points
layout(location = AT_kind) uniform uint kind;  // of the layer, for colorOf()
layout(location = AT_range) uniform vec2 range;
const uint kMostPoints = 1u << 24;  // the sums are full then
#endif
#ifdef LIST
layout(std430, binding = 2) readonly buffer List { uint list[]; };  // slots in the chunk
#endif
#ifdef COMMANDS
layout(std430, binding = 3) readonly buffer Commands { Command commands[]; };
layout(location = AT_chunk) uniform uint chunk;
#else
layout(location = AT_slots) uniform uvec2 slots;  // first, last (excluded), in the chunk
#endif
#if PASS == 2
layout(std430, binding = 5) coherent buffer Cells { uint64_t cells[]; };
#elif PASS == 3 && defined(WIDE)
layout(std430, binding = 5) readonly buffer Cells { uvec2 cells[]; };
#elif PASS == 3
layout(std430, binding = 6) readonly buffer Depths { uint depths[]; };
#else
layout(std430, binding = 5) coherent buffer Ids { uint ids[]; };
layout(std430, binding = 6) coherent buffer Depths { uint depths[]; };
#endif

#ifdef STRETCHES
layout(std430, binding = 4) readonly buffer InSight { uint inSight[]; };  // VisibleStretches::list()
// slots of a window, log2 of a stretch's, the chunk's first slot, how many are in sight
layout(location = AT_stretches) uniform uvec4 stretches;
#endif

layout(location = AT_kept) uniform vec4 kept;       // points with lowX <= x < highX and lowY <= y < highY are drawn
layout(location = AT_firstId) uniform uint firstId;   // of the chunk's first slot
layout(location = AT_band) uniform ivec4 band;     // first row, last row (excluded), width

const uint kNoPoint = 0xFFFFFFFFu;
const ivec2 kPlaces[SAMPLES] = ivec2[SAMPLES](SAMPLE_PLACES);

#if PASS == 3
uvec3 color;

void cover(uint cell, uint id, uint depth)
{
#ifdef WIDE
    const uint nearest = cells[cell].y;
#else
    const uint nearest = depths[cell];
#endif
    precise const float reach = uintBitsToFloat(nearest) * 1.01;
    if (!(uintBitsToFloat(depth) <= reach) || blueCount[2u * cell + 1u] >= kMostPoints) return;
    atomicAdd(redGreen[2u * cell], color.r);
    atomicAdd(redGreen[2u * cell + 1u], color.g);
    atomicAdd(blueCount[2u * cell], color.b);
    atomicAdd(blueCount[2u * cell + 1u], 1u);
}
#else
void cover(uint cell, uint id, uint depth)
{
#if PASS == 0
    if (depth < depths[cell] && atomicMin(depths[cell], depth) > depth) ids[cell] = kNoPoint;
#elif PASS == 1
    if (depth == depths[cell] && id < ids[cell]) atomicMin(ids[cell], id);
#else
    const uint64_t key = packUint2x32(uvec2(id, depth));
    if (key < cells[cell]) atomicMin(cells[cell], key);
#endif
}
#endif

void draw(uint slot, ivec3 position)
{
    const vec3 q = vec3(position - reference);
    precise const float depth = along(rowD, q);
    precise const float inverse = perspective ? 1.0 / depth : 1.0;
    precise const vec2 px = vec2(along(rowX, q), along(rowY, q)) * inverse;
    bool shown = depth >= nearDepth && px.x >= kept.x && px.x < kept.y && px.y >= kept.z &&
                 px.y < kept.w;
    shown = shown && !clipped(position, q);
#ifdef FILTER
    shown = shown && isShown((groups[slot >> 1] >> ((slot & 1u) * 16u)) & 0xFFFFu);
#endif
    if (!shown) return;

    const uint id = firstId + slot, bits = floatBitsToUint(depth);
#if PASS == 3
    color = colorOf(words[slot], kind, range.x, range.y).rgb;
#endif
#ifdef PIXELS
    const ivec2 pixel = ivec2(px);
    if (pixel.y >= band.x && pixel.y < band.y) cover(uint((pixel.y - band.x) * band.z + pixel.x), id, bits);
#else
    const int size = sizeAt(depth);
    precise const vec2 edge = (px - float(size) * 0.03125) * 16.0;
    const ivec2 low = ivec2(floor(edge));
    for (int s = 0; s < SAMPLES; ++s) {
        const ivec2 first = max(((low - kPlaces[s]) >> 4) + 1, ivec2(0, band.x));
        const ivec2 last = min((low + size - kPlaces[s]) >> 4, ivec2(band.z, band.y) - 1);
        for (int y = first.y; y <= last.y; ++y)
            for (int x = first.x; x <= last.x; ++x)
                if (inCircle(16 * ivec2(x, y) + kPlaces[s] - low, size))
                    cover(uint(((y - band.x) * band.z + x) * SAMPLES + s), id, bits);
    }
#endif
}

#ifdef STRETCHES
// What is drawn are the slots in sight of all windows that [first, last) lies in, one after the other; of these, the
// `item`-th. Not below `last` where it is none of the run.
uint slotOf(uint item, uint window, uint perWindow, uint first, uint last)
{
    // by float, whose error is less than one, as whole numbers are divided slowly
    uint k = uint(float(item) / float(perWindow));
    int rest = int(item) - int(k * perWindow);
    if (rest < 0) {
        --k;
        rest += int(perWindow);
    } else if (rest >= int(perWindow)) {
        ++k;
        rest -= int(perWindow);
    }
    const uint within = uint(rest), stretch = inSight[within >> stretches.y];
    const uint place = (stretch << stretches.y) + (within & ((1u << stretches.y) - 1u));
    const uint slot = (window + k) * stretches.x + place - stretches.z;  // wraps round before the chunk: too large
    return place < stretches.x && slot >= first ? slot : last;
}
#endif

void main()
{
#ifdef COMMANDS
    const uint first = commands[chunk].firstIndex, last = first + commands[chunk].count;
#else
    const uint first = slots.x, last = slots.y;
#endif
#ifdef STRETCHES
    const uint perWindow = stretches.w << stretches.y, window = (stretches.z + first) / stretches.x;
    const uint items =
        last > first ? ((stretches.z + last - 1u) / stretches.x + 1u - window) * perWindow : 0u;
#else
    const uint items = last - first;
#endif
    // Once, but where the commands of the device count slots and more of them are looked at than it knew.
    for (uint batch = gl_WorkGroupID.x * uint(GROUP_POINTS); batch < items;
         batch += gl_NumWorkGroups.x * uint(GROUP_POINTS)) {
        const uint end = min(items, batch + uint(GROUP_POINTS));
        for (uint i = batch + gl_LocalInvocationID.x; i < end; i += uint(LOADS * GROUP_SIZE)) {
            uint slot[LOADS];
            ivec3 position[LOADS];
            for (int k = 0; k < LOADS; ++k) {
                const uint item = i + uint(k * GROUP_SIZE);
                slot[k] = last;
                position[k] = ivec3(0);
                if (item < end) {
#ifdef LIST
                    slot[k] = list[first + item];
                    const bool has = true;
#elif defined(STRETCHES)
                    slot[k] = slotOf(item, window, perWindow, first, last);
                    const bool has = slot[k] < last;
#else
                    slot[k] = first + item;
                    const bool has = true;
#endif
                    if (has)
                        position[k] = ivec3(positions[3u * slot[k]], positions[3u * slot[k] + 1u],
                                            positions[3u * slot[k] + 2u]);
                }
            }
            for (int k = 0; k < LOADS; ++k)
                if (position[k].x != 0) draw(slot[k], position[k]);
        }
    }
}
