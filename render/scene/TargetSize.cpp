// SPDX-License-Identifier: MIT
#include "render/scene/TargetSize.h"

#include "core/Error.h"

#include <algorithm>
#include <string>

namespace punctum::render
{

std::size_t sampleCountIndex(int samples) noexcept
{
    const auto at = std::find(kSampleCounts.begin(), kSampleCounts.end(), samples);
    return at == kSampleCounts.end() ? 0 : std::size_t(at - kSampleCounts.begin());
}

void checkSampleCount(int samples)
{
    if (kSampleCounts[sampleCountIndex(samples)] != samples)
        throw Error("Pictures have 1, 4, 8 or 16 samples a pixel, not " + std::to_string(samples) + ".");
}

const SamplePlace* samplePlaces(int samples) noexcept
{
    static constexpr SamplePlace k1[] = {{8, 8}};
    static constexpr SamplePlace k4[] = {{6, 2}, {14, 6}, {2, 10}, {10, 14}};
    static constexpr SamplePlace k8[] = {{9, 5}, {7, 11}, {13, 9}, {5, 3}, {3, 13}, {1, 7}, {11, 15}, {15, 1}};
    static constexpr SamplePlace k16[] = {{9, 9},  {7, 5}, {5, 10}, {12, 7}, {3, 6}, {10, 13}, {13, 11}, {11, 3},
                                          {6, 14}, {8, 1}, {4, 2},  {2, 12}, {0, 8}, {15, 4},  {14, 15}, {1, 0}};
    return samples == 16 ? k16 : samples == 8 ? k8 : samples == 4 ? k4 : k1;
}

}  // namespace punctum::render
