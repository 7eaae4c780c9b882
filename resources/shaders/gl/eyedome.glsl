// SPDX-License-Identifier: MIT
// Eye-dome lighting by the steps of render/resolve/EyeDome.h; change them together.
const float kNoLevel = 3.0e38;
const float kSteepness = 14.0, kDarkest = 0.15, kLog2E = 1.442695;
const ivec2 kNeighbors[8] = ivec2[8](ivec2(-1, -1), ivec2(0, -1), ivec2(1, -1), ivec2(-1, 0), ivec2(1, 0), ivec2(-1, 1),
                                     ivec2(0, 1), ivec2(1, 1));

float log2Of(float value)
{
    const uint bits = floatBitsToUint(value);
    const int exponent = int(bits - 0x3F3504F3u) >> 23;
    const float m = uintBitsToFloat(bits - (uint(exponent) << 23));
    precise const float t = (m - 1.0) / (m + 1.0), s = t * t;
    precise const float result = float(exponent) + t * (2.885390 + s * (0.9617967 + s * (0.5770780 + s * 0.4121986)));
    return result;
}

float exp2Of(float value)
{
    const float x = max(value, -120.0);
    const int whole = int(x);
    const float f = x - float(whole);
    precise float p = 0.0000152527;
    p = p * f + 0.0001540353;
    p = p * f + 0.0013333558;
    p = p * f + 0.0096181291;
    p = p * f + 0.0555041087;
    p = p * f + 0.2402265070;
    p = p * f + 0.6931471806;
    p = p * f + 1.0;
    return p * uintBitsToFloat(uint(whole + 127) << 23);
}

float levelOf(float depth, bool logarithm)
{
    return logarithm ? log2Of(max(depth, 1e-6)) : depth;
}

float scaleOf(float strength, float extent)
{
    return kSteepness * kLog2E * strength / (extent * 16.0);
}
