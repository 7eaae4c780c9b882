// SPDX-License-Identifier: MIT
#include "core/las/TailPoints.h"

#include "core/las/ChunkProbe.h"
#include "core/las/File.h"
#include "core/las/PointFormat.h"
#include "core/las/SourceFile.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace punctum::las
{

namespace
{

constexpr std::uint64_t kSamples = 256;    ///< records that are looked at, of the counted ones and of the others
constexpr std::uint64_t kFewSamples = 16;  ///< fewer say little on where the others are
constexpr double kMostlyAll = 0.95;        ///< of them must look like points: there are strays everywhere
constexpr std::uint64_t kMostPadding = 64 << 20;  ///< zeros behind the points that are looked through
constexpr std::uint64_t kMostSearched = 1 << 20;  ///< bytes in which lost extended records are looked for
constexpr std::uint32_t kMostLost =
    100;  ///< records that are looked for there: each place costs a look at all of them
constexpr double kLargestRaw = 2147483648.0;

struct Sampled {
    std::array<std::int32_t, 3> axes{};
    std::uint8_t returns = 0;
};

std::vector<Sampled> sample(const File& file, std::uint64_t begin, std::uint64_t length, std::uint64_t first,
                            std::uint64_t last)
{
    const std::uint64_t count = std::min(kSamples, last - first);
    std::vector<Sampled> samples;
    std::array<std::byte, 15> record{};
    for (std::uint64_t k = 0; k < count; ++k) {
        const std::uint64_t step = (last - first) / count, rest = (last - first) % count;
        file.readAt(begin + (first + step * k + rest * k / count) * length, record);
        Sampled s;
        std::memcpy(s.axes.data(), record.data(), 12);
        s.returns = std::to_integer<std::uint8_t>(record[14]);
        samples.push_back(s);
    }
    return samples;
}

/// A range of raw coordinates, as doubles, and as much again to either side.
struct Range {
    double low = kLargestRaw, high = -kLargestRaw;

    void include(double v)
    {
        low = std::min(low, v);
        high = std::max(high, v);
    }
    /// Whether it leaves out most of what 32 bits can be.
    bool telling() const { return high - low < kLargestRaw / 8; }
    bool nearly(double v) const
    {
        const double size = high - low + 1;
        return v >= low - size && v <= high + size;
    }
};

/// The header's box in raw coordinates; nothing when it cannot be one.
std::optional<std::array<Range, 3>> headerBox(const SourceFile& source)
{
    std::array<Range, 3> box;
    bool extent = false;
    for (std::size_t k = 0; k < 3; ++k) {
        const double scale = source.coordinates.scale[int(k)], offset = source.coordinates.offset[int(k)];
        const double low = source.header.get(at::kMin[k]), high = source.header.get(at::kMax[k]);
        const double a = (low - offset) / scale, b = (high - offset) / scale;
        if (!(low <= high) || !(std::fabs(a) <= kLargestRaw) || !(std::fabs(b) <= kLargestRaw)) return {};
        extent = extent || high > low;
        box[k].include(a);
        box[k].include(b);
    }
    return extent ? std::optional(box) : std::nullopt;
}

bool possibleReturns(std::uint8_t byte, bool extended)
{
    const unsigned number = extended ? byte & 15u : byte & 7u, returns = extended ? byte >> 4u : (byte >> 3u) & 7u;
    return number >= 1 && number <= returns;
}

/// The beginning of an extended record.
struct EvlrHead {
    bool named = false;   ///< its user is text
    bool filled = false;  ///< NULs follow it
    std::uint64_t length = 0;

    EvlrHead(const File& file, std::uint64_t at)
    {
        if (at > file.size() || file.size() - at < Vlr::kExtendedHeaderSize) return;
        std::array<std::byte, 28> head{};
        file.readAt(at, head);
        const auto* user = reinterpret_cast<const char*>(head.data() + 2);
        const char* const end = std::find(user, user + 16, '\0');
        named = end != user && std::all_of(user, end, [](char c) { return c >= ' ' && c <= '~'; });
        filled = std::all_of(end, user + 16, [](char c) { return c == '\0'; });
        std::memcpy(&length, head.data() + 20, sizeof length);
    }
};

}  // namespace

std::optional<std::uint64_t> endOfEvlrs(const File& file, std::uint64_t at, std::uint32_t count)
{
    for (std::uint32_t k = 0; k < count; ++k) {
        const EvlrHead head(file, at);
        if (!head.named || head.length > file.size() - at - Vlr::kExtendedHeaderSize) return {};
        at += Vlr::kExtendedHeaderSize + head.length;
    }
    return at;
}

std::optional<std::uint64_t> findEvlrs(const File& file, std::uint64_t from, std::uint32_t count)
{
    if (endOfEvlrs(file, from, count)) return from;
    if (count > kMostLost) return {};
    const std::uint64_t last = std::min(file.size(), from + kMostSearched);
    for (std::uint64_t at = from + 1; at < last; ++at)
        if (endOfEvlrs(file, at, count) == file.size()) return at;
    return {};
}

std::uint64_t recordsAfterAll(const File& file, const SourceFile& source, std::uint64_t begin, std::uint64_t stated,
                              std::uint64_t held)
{
    const std::uint64_t length = source.header.recordLength();
    const std::uint64_t statedEnd = begin + stated * length, heldEnd = begin + held * length;
    const std::uint64_t zeros = zerosBefore(file, statedEnd, heldEnd, kMostPadding);
    if (heldEnd - zeros >= kMostPadding) return stated;
    held = (zeros - begin + length - 1) / length;  // the last record may end with zeros of its own
    if (held <= stated) return stated;
    if (const EvlrHead head(file, statedEnd); head.named && head.filled) return stated;

    const bool extended = isExtendedFormat(source.header.pointFormat());
    std::optional<std::array<Range, 3>> box = headerBox(source);
    if (stated >= kFewSamples) {
        if (!box) box.emplace();
        for (const Sampled& s : sample(file, begin, length, 0, stated))
            for (std::size_t k = 0; k < 3; ++k) (*box)[k].include(s.axes[k]);
    }
    const bool telling = box && std::any_of(box->begin(), box->end(), [](const Range& r) { return r.telling(); });
    const auto others = sample(file, begin, length, stated, held);
    const auto like = std::count_if(others.begin(), others.end(), [&](const Sampled& s) {
        if (!telling && !possibleReturns(s.returns, extended)) return false;
        return !box || ((*box)[0].nearly(s.axes[0]) && (*box)[1].nearly(s.axes[1]) && (*box)[2].nearly(s.axes[2]));
    });
    return double(like) >= kMostlyAll * double(others.size()) ? held : stated;
}

}  // namespace punctum::las
