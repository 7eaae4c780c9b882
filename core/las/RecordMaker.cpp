// SPDX-License-Identifier: MIT
#include "core/las/RecordMaker.h"

#include "core/las/RecordBlocks.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace punctum::las
{

namespace
{

constexpr std::size_t kMadeAtOnce = 4096;  ///< points converted at once

/// Return number and number of returns of the formats 6-10 in the bits of the formats 0-5. Of more than 7 returns
/// the last one stays the last, and no other becomes one.
std::uint8_t classicReturns(std::uint8_t extended) noexcept
{
    const unsigned number = extended & 15u, of = extended >> 4;
    const unsigned most = kMostOldReturns;
    const unsigned cut = of > most && number < of ? std::min(number, most - 1) : std::min(number, most);
    return std::uint8_t(cut | std::min(of, most) << 3);
}

/// Packed fields of the target, for a piece of points.
struct Packed {
    std::array<std::uint8_t, kMadeAtOnce> returns, flags, classes;
    std::array<std::int16_t, kMadeAtOnce> angle16;
    std::array<std::int8_t, kMadeAtOnce> angle8;

    /// `w`: classes of their own, or null: those in `c`.
    void toExtended(const std::uint8_t* r, const std::uint8_t* c, const std::uint8_t* w, const std::int8_t* a,
                    std::size_t n)
    {
        for (std::size_t i = 0; i < n; ++i) {
            const std::uint8_t cls = w != nullptr ? w[i] : c[i] & 31;
            returns[i] = std::uint8_t((r[i] & 7) | ((r[i] >> 3) & 7) << 4);
            flags[i] = std::uint8_t((c[i] >> 5) | (cls == kOverlapClass ? 8 : 0) | (r[i] & 0xC0));
            classes[i] = cls;
            angle16[i] = std::int16_t(std::lround(double(a[i]) / kScanAngleStep));
        }
    }
    void toClassic(const std::uint8_t* r, const std::uint8_t* f, const std::uint8_t* c, const std::int16_t* a,
                   std::size_t n)
    {
        for (std::size_t i = 0; i < n; ++i) {
            returns[i] = std::uint8_t(classicReturns(r[i]) | (f[i] & 0xC0));
            classes[i] = std::uint8_t((c[i] > kHighestOldClass ? kUnclassified : c[i]) | (f[i] & 7) << 5);
            angle8[i] = std::int8_t(std::clamp(std::lround(double(a[i]) * kScanAngleStep), -128L, 127L));
        }
    }
    void foldClasses(const std::uint8_t* c, const std::uint8_t* w, std::size_t n)
    {
        for (std::size_t i = 0; i < n; ++i)
            classes[i] = std::uint8_t((c[i] & 0xE0) | (w[i] > kHighestOldClass ? kUnclassified : w[i]));
    }
};

template <typename T>
const T* valuesFrom(const std::shared_ptr<const Column>& column, PointIndex first)
{
    return reinterpret_cast<const T*>(column->data()) + first;
}

}  // namespace

RecordMaker::RecordMaker(RecordLayout layout, std::vector<std::shared_ptr<const Column>> columns,
                         Conversion conversion, PackedColumns packed, KeptPoints kept)
    : m_layout(std::move(layout)),
      m_columns(std::move(columns)),
      m_conversion(conversion),
      m_packed(std::move(packed)),
      m_returns(m_layout.find("Returns")),
      m_flags(m_layout.find(isExtendedFormat(m_layout.format) ? "Flags" : "Classes")),
      m_classes(isExtendedFormat(m_layout.format) ? m_layout.find("Classification") : -1),
      m_angle(m_layout.find("ScanAngle")),
      m_kept(std::move(kept))
{
}

void RecordMaker::make(PointRange range, std::byte* records) const
{
    m_kept.forEachRun(range, [&](PointRange run, PointIndex) {
        const PointIndex piece = m_conversion == Conversion::None ? run.size() : kMadeAtOnce;
        for (PointIndex i = run.first; i < run.last; i += piece) {
            const PointIndex n = std::min(piece, run.last - i);
            makePiece(i, std::size_t(n), records);
            records += n * m_layout.length;
        }
    });
}

void RecordMaker::makePiece(PointIndex first, std::size_t count, std::byte* records) const
{
    std::vector<const std::byte*> from(m_columns.size());
    for (std::size_t k = 0; k < from.size(); ++k)
        from[k] = m_columns[k] ? m_columns[k]->data() + first * m_columns[k]->elementBytes() : nullptr;
    if (m_conversion == Conversion::None) return interleave(m_layout, from, count, records);

    Packed packed;
    const auto use = [&](int field, const void* values) {
        from[std::size_t(field)] = static_cast<const std::byte*>(values);
    };
    const auto* const flags = valuesFrom<std::uint8_t>(m_packed.flags, first);
    const auto* const classes = m_packed.classes ? valuesFrom<std::uint8_t>(m_packed.classes, first) : nullptr;
    if (m_conversion == Conversion::FoldClasses) {
        packed.foldClasses(flags, classes, count);
        use(m_flags, packed.classes.data());
    } else if (m_conversion == Conversion::ToExtended) {
        packed.toExtended(valuesFrom<std::uint8_t>(m_packed.returns, first), flags, classes,
                          valuesFrom<std::int8_t>(m_packed.angle, first), count);
        use(m_returns, packed.returns.data());
        use(m_flags, packed.flags.data());
        use(m_classes, packed.classes.data());
        use(m_angle, packed.angle16.data());
    } else {
        packed.toClassic(valuesFrom<std::uint8_t>(m_packed.returns, first), flags, classes,
                         valuesFrom<std::int16_t>(m_packed.angle, first), count);
        use(m_returns, packed.returns.data());
        use(m_flags, packed.classes.data());
        use(m_angle, packed.angle8.data());
    }
    interleave(m_layout, from, count, records);
}

}  // namespace punctum::las
