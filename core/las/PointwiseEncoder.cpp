// SPDX-License-Identifier: MIT
#include "core/las/PointwiseEncoder.h"

#include "core/las/PointwiseItems.h"
#include "core/task/Progress.h"

namespace punctum::las
{

namespace
{

constexpr std::size_t kEncodeStep = 4096;  ///< points between two looks at the cancel flag
/// A record takes at most some three times its bytes: each of its values a few symbols of at most 15 bits, and
/// bits.
constexpr std::size_t kMostGrowth = 8;
constexpr std::size_t kUsualShrinking = 4;

}  // namespace

std::vector<std::byte> encodePointwise(const LazInfo& info, std::span<const std::byte> records,
                                       const Progress& progress)
{
    const std::size_t length = info.recordLength, count = records.size() / length;
    const auto items = std::make_unique<PointwiseItems>(info);
    RangeEncoder out;
    out.reserve(records.size() / kUsualShrinking);
    items->start(records.data());
    for (std::size_t k = 1; k < count; ++k) {
        if (k % kEncodeStep == 0) progress.check();
        out.reserve(kMostGrowth * length);
        items->encode(out, records.data() + k * length);
    }
    std::vector<std::byte> chunk(records.begin(), records.begin() + std::ptrdiff_t(length));
    const std::vector<std::byte> coded = out.finish();
    chunk.insert(chunk.end(), coded.begin(), coded.end());
    return chunk;
}

}  // namespace punctum::las
