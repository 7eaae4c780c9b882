// SPDX-License-Identifier: MIT
#include "core/edit/PackedSet.h"

#include "core/Error.h"
#include "core/edit/PackedValues.h"

#include <algorithm>
#include <bit>

namespace punctum
{

namespace
{

void put(std::vector<std::uint8_t>& out, std::uint64_t v)
{
    for (; v >= 128; v >>= 7) out.push_back(std::uint8_t(v | 128));
    out.push_back(std::uint8_t(v));
}

bool take(const std::vector<std::uint8_t>& in, std::size_t& at, std::uint64_t& v)
{
    v = 0;
    for (int shift = 0; shift < 64 && at < in.size(); shift += 7) {
        const std::uint8_t byte = in[at++];
        if (shift == 63 && byte > 1) return false;
        v |= std::uint64_t(byte & 127) << shift;
        if (byte < 128) return true;
    }
    return false;
}

/// The first point from `from` on that is a member (or none, with `member` false); size() when there is no more.
PointIndex next(const PointSet& points, PointIndex from, bool member)
{
    const auto words = points.words();
    for (std::size_t w = std::size_t(from / 64); w < words.size(); ++w) {
        std::uint64_t bits = member ? words[w] : ~words[w];
        if (w == from / 64) bits &= ~std::uint64_t(0) << (from % 64);
        if (bits != 0) return std::min(points.size(), PointIndex(w * 64 + std::size_t(std::countr_zero(bits))));
    }
    return points.size();
}

}  // namespace

PackedSet::PackedSet(const PointSet& points) : m_size(points.size())
{
    PointIndex at = 0;
    for (;;) {
        const PointIndex first = next(points, at, true);
        if (first >= m_size) break;
        const PointIndex last = next(points, first, false);
        put(m_runs, first - at);
        put(m_runs, last - first);
        at = last;
    }
    m_runs.shrink_to_fit();
}

/// Calls f(first, last) for each run; false when they leave the cloud or end in their middle.
template <typename F>
bool PackedSet::forRuns(F f) const
{
    PointIndex point = 0;
    for (std::size_t at = 0; at < m_runs.size();) {
        std::uint64_t left = 0, count = 0;
        if (!take(m_runs, at, left) || !take(m_runs, at, count)) return false;
        if (left > m_size - point || count == 0 || count > m_size - point - left) return false;
        point += left;
        f(point, point + count);
        point += count;
    }
    return true;
}

PointSet PackedSet::unpacked() const
{
    PointSet points(m_size);
    forRuns([&](PointIndex first, PointIndex last) { points.insert(PointRange{first, last}); });
    return points;
}

std::string PackedSet::text() const
{
    return toBase64(std::as_bytes(std::span(m_runs)));
}

std::optional<PackedSet> PackedSet::fromText(std::string_view text, PointIndex size)
{
    const auto bytes = fromBase64(text);
    if (!bytes) return {};
    std::vector<std::uint8_t> runs(bytes->size());
    std::transform(bytes->begin(), bytes->end(), runs.begin(),
                   [](std::byte b) { return std::to_integer<std::uint8_t>(b); });
    return fromRuns(std::move(runs), size);
}

std::optional<PackedSet> PackedSet::fromRuns(std::vector<std::uint8_t> runs, PointIndex size)
{
    PackedSet set;
    set.m_size = size;
    set.m_runs = std::move(runs);
    if (!set.forRuns([](PointIndex, PointIndex) {})) return {};
    return set;
}

std::shared_ptr<const PointSet> StowableSet::points() const
{
    if (const Plain* const plain = std::get_if<Plain>(&m_kept)) return *plain;
    if (const PackedSet* const packed = std::get_if<PackedSet>(&m_kept))
        return std::make_shared<const PointSet>(packed->unpacked());
    const Spilled& spilled = std::get<Spilled>(m_kept);
    std::optional<PointSet> points;
    if (spilled.packed) {
        std::vector<std::uint8_t> runs(spilled.piece.size());
        spilled.piece.read(std::as_writable_bytes(std::span(runs)));
        if (const auto packed = PackedSet::fromRuns(std::move(runs), m_size)) points = packed->unpacked();
    } else {
        points.emplace(m_size);
        spilled.piece.read(std::as_writable_bytes(points->words()));
    }
    // The values that belong to it are as many.
    if (!points || points->count() != spilled.count)
        throw Error("What this edit needs was damaged on the disk; the points stay as they are.");
    return std::make_shared<const PointSet>(std::move(*points));
}

void StowableSet::stow()
{
    const Plain* const plain = std::get_if<Plain>(&m_kept);
    if (plain == nullptr || std::exchange(m_tried, true)) return;
    PackedSet packed(**plain);
    if (packed.bytes() < (*plain)->words().size_bytes()) m_kept = std::move(packed);
}

void StowableSet::spill(SpillFile& file)
{
    if (const Plain* const plain = std::get_if<Plain>(&m_kept))
        m_kept = Spilled{file.write(std::as_bytes((*plain)->words())), false, (*plain)->count()};
    else if (const PackedSet* const packed = std::get_if<PackedSet>(&m_kept))
        m_kept = Spilled{file.write(std::as_bytes(std::span(packed->runs()))), true, packed->unpacked().count()};
}

void StowableSet::fetch()
{
    m_kept = points();
    m_tried = false;
}

std::size_t StowableSet::memory() const noexcept
{
    if (const Plain* const plain = std::get_if<Plain>(&m_kept)) return (*plain)->words().size_bytes();
    const PackedSet* const packed = std::get_if<PackedSet>(&m_kept);
    return packed != nullptr ? packed->bytes() : 0;
}

std::size_t StowableSet::spilled() const noexcept
{
    const Spilled* const spilled = std::get_if<Spilled>(&m_kept);
    return spilled != nullptr ? spilled->piece.size() : 0;
}

}  // namespace punctum
