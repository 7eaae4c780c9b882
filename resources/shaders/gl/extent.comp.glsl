// SPDX-License-Identifier: MIT
// The range of the levels of a picture without outliers, as eyeDomeExtent() in render/resolve/EyeDome.cpp finds it.
// One work group: values are few. Both percentiles are found byte by byte, from counts of the values that begin alike.
layout(local_size_x = 256) in;

layout(binding = 3) uniform sampler2DArray levels;
layout(r32f, binding = 3) writeonly uniform image2D extentOut;  // the range, and the factor that follows
layout(location = AT_strength) uniform float strength;
layout(location = AT_fixedExtent) uniform float fixedExtent;  // 0: it is to be found

const uint kValues = 4096u;
const uint kNone = 0xFFFFFFFFu;
shared uint valid;
shared uint counts[512];  // of the next byte, for both
shared uint ranks[2], begins[2];

void main()
{
    const uint self = gl_LocalInvocationIndex;
    const ivec3 size = textureSize(levels, 0);
    const uint all = uint(size.x) * uint(size.y) * uint(size.z);
    const uint every = max(1u, all / kValues);
    if (self == 0u) valid = 0u;
    barrier();
    // Keys order like the floats: there are less than 2 * kValues.
    uint keys[32];
    for (uint k = 0u; k < 32u; ++k) {
        const uint at = k * 256u + self;
        keys[k] = kNone;
        if (at > (all - 1u) / every) continue;
        const uint cell = at * every, pixel = cell / uint(size.z);
        const float level = texelFetch(
            levels, ivec3(pixel % uint(size.x), pixel / uint(size.x), cell % uint(size.z)), 0).r;
        if (!(level < kNoLevel)) continue;
        const uint bits = floatBitsToUint(level);
        keys[k] = bits ^ ((bits & 0x80000000u) != 0u ? 0xFFFFFFFFu : 0x80000000u);
        atomicAdd(valid, 1u);
    }
    barrier();
    if (self < 2u) {
        precise const float rank = (self == 0u ? 0.02 : 0.98) * float(max(valid, 1u) - 1u);
        ranks[self] = uint(rank);
        begins[self] = 0u;
    }
    for (int shift = 24; shift >= 0; shift -= 8) {
        counts[self] = counts[self + 256u] = 0u;
        barrier();
        const uint known = shift == 24 ? 0u : 0xFFFFFFFFu << (shift + 8);
        for (uint k = 0u; k < 32u; ++k) {
            if (keys[k] == kNone) continue;
            for (uint r = 0u; r < 2u; ++r)
                if ((keys[k] & known) == begins[r]) atomicAdd(counts[r * 256u + ((keys[k] >> shift) & 255u)], 1u);
        }
        barrier();
        if (self < 2u) {
            uint rank = ranks[self], digit = 0u;
            while (digit < 255u && rank >= counts[self * 256u + digit]) rank -= counts[self * 256u + digit++];
            ranks[self] = rank;
            begins[self] |= digit << shift;
        }
        barrier();
    }
    if (self != 0u) return;
    float ends[2];
    for (int r = 0; r < 2; ++r) {
        const uint key = begins[r];
        ends[r] = uintBitsToFloat(key ^ ((key & 0x80000000u) != 0u ? 0x80000000u : 0xFFFFFFFFu));
    }
    const float extent = fixedExtent > 0.0 ? fixedExtent : valid < 2u ? 0.0 : ends[1] - ends[0];
    imageStore(extentOut, ivec2(0, 0), vec4(extent));
    imageStore(extentOut, ivec2(1, 0), vec4(extent > 0.0 ? scaleOf(strength, extent) : 0.0));
}
