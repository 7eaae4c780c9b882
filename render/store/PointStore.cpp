// SPDX-License-Identifier: MIT
#include "render/store/PointStore.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>

namespace punctum::render
{

namespace
{

/// Points that one task takes at a time.
constexpr PointIndex kPutPoints = BlockBoxes::kPoints;

/// Up to this many changed points are brought up to date at once instead of being streamed.
constexpr PointIndex kFewPoints = 200'000;

constexpr PointIndex kSamples = 4096;

/// Of each range ahead, in the prime order.
constexpr PointIndex kFewAhead = 32;

/// The i-th of kSamples points spread over the range (low discrepancy: multiples of the golden ratio).
PointIndex samplePoint(PointRange range, PointIndex i)
{
    const double at = double(i) * 0.6180339887498949;
    return range.first + PointIndex((at - std::floor(at)) * double(range.size()));
}

}  // namespace

std::string firstAttribute(const PointCloud& cloud, PointRange range)
{
    const auto varies = [&](const Attribute& a, bool fromZero) {
        const double first = fromZero ? 0.0 : a.number(range.first);
        for (std::uint32_t c = 0; c < a.components; ++c)
            for (PointIndex i = 0; i < kSamples; ++i)
                if (a.number(samplePoint(range, i), c) != first) return true;
        return false;
    };
    if (range.empty()) return "Z";
    const Attribute* rgb = cloud.findAttribute("RGB");
    if (rgb != nullptr && varies(*rgb, true)) return "RGB";
    for (const char* name : {"Intensity", "Classification"}) {
        const Attribute* a = cloud.findAttribute(name);
        if (a != nullptr && varies(*a, false)) return name;
    }
    return "Z";
}

PointStore::PointStore(std::shared_ptr<const PointCloud> cloud, const RawBounds& firstBounds, OrderKind order)
    : m_cloud(std::move(cloud)),
      m_order(order, m_cloud->size()),
      m_bounds(firstBounds),
      m_frame(LocalFrame::around(firstBounds)),
      m_slots(m_order.slotCount()),
      m_hidden(m_order.slotCount()),
      m_positionVersions(blocks()),
      m_wordVersions(blocks())
{
    if (const Attribute* a = m_cloud->findAttribute("Classification")) m_classification = *a;
}

PointStore::~PointStore() = default;

std::span<const LocalPosition> PointStore::positions() const noexcept
{
    return {reinterpret_cast<const LocalPosition*>(m_slots.positions.data()), slotCount()};
}

std::span<const std::uint32_t> PointStore::words() const noexcept
{
    return {reinterpret_cast<const std::uint32_t*>(m_slots.words.data()), slotCount()};
}

std::span<const std::uint8_t> PointStore::classes() const noexcept
{
    return {reinterpret_cast<const std::uint8_t*>(m_slots.classes.data()), slotCount()};
}

std::span<const std::uint8_t> PointStore::hidden() const noexcept
{
    return {reinterpret_cast<const std::uint8_t*>(m_hidden.data()), slotCount()};
}

void PointStore::hide(const PointSet* points)
{
    if (points == nullptr && !m_hidesAny) return;
    auto* const hidden = reinterpret_cast<std::uint8_t*>(m_hidden.data());
    const PointIndex size =
        std::min<PointIndex>(m_cloud->size(), points != nullptr ? points->size() : m_cloud->size());
    tbb::parallel_for(tbb::blocked_range<PointIndex>(0, (size + kPutPoints - 1) / kPutPoints), [&](const auto& r) {
        std::vector<Slot> slots(kPutPoints);
        for (PointIndex piece = r.begin(); piece != r.end(); ++piece) {
            const PointRange range{piece * kPutPoints, std::min(size, (piece + 1) * kPutPoints)};
            m_order.slotsOf(range, slots.data());
            for (PointIndex i = range.first; i < range.last; ++i)
                hidden[slots[i - range.first]] = std::uint8_t(points != nullptr && points->contains(i));
        }
    });
    m_hidesAny = points != nullptr;
    ++m_hiddenVersion;
}

bool PointStore::isFilled(PointIndex index) const noexcept
{
    return positions()[m_order.slotOf(index)].x != 0;
}

std::shared_ptr<const AttributeEncoder> PointStore::encoder() const
{
    const std::lock_guard lock(m_encoderMutex);
    return m_previewEncoder ? m_previewEncoder : m_encoder;
}

Attribute PointStore::shown() const
{
    const std::lock_guard lock(m_encoderMutex);
    return m_encoder->attribute();
}

void PointStore::setEncoder(std::shared_ptr<const AttributeEncoder> encoder)
{
    std::shared_ptr<AttributeEncoder> instead;
    if (m_preview) {
        const auto& changed = m_preview->attributes;
        auto after = std::find_if(changed.begin(), changed.end(),
                                  [&](const Attribute& a) { return a.name == encoder->attribute().name; });
        if (after == changed.end() && !m_preview->shows.empty())
            after = std::find_if(changed.begin(), changed.end(),
                                 [&](const Attribute& a) { return a.name == m_preview->shows; });
        if (after == changed.end() && !changed.empty() && changed.front().kind == AttributeKind::Class)
            after = changed.begin();
        if (after != changed.end()) {
            instead = makeEncoder(*after, {});  // no marks: they would cover the colors that are to be seen
        } else {
            instead = std::make_shared<AttributeEncoder>(*encoder);
            instead->setSelection(m_preview->points);
        }
    }
    {
        const std::lock_guard lock(m_encoderMutex);
        m_encoder = std::move(encoder);
        m_previewEncoder = std::move(instead);
    }
    m_wordChanges.fetch_add(1, std::memory_order_release);
}

std::shared_ptr<AttributeEncoder> PointStore::makeEncoder(const Attribute& attribute, PointRange range) const
{
    // Judged by points that have arrived: all of `range` if it was given, else a sample of the filled slots.
    double bias = 0.0;
    bool first = true;
    const bool color = attribute.kind == AttributeKind::Color;
    const bool whole = range.empty();
    if (whole) range = {0, m_cloud->size()};
    const PointIndex samples = std::min(kSamples, range.size());
    std::vector<std::uint32_t> largest;
    PointIndex looked = 0;
    for (PointIndex k = 0; k < samples; ++k) {
        const PointIndex i = samples < kSamples ? range.first + k : samplePoint(range, k);
        if (whole && !isFilled(i)) continue;
        ++looked;
        const double v = attribute.number(i);
        if (first && std::isfinite(v)) {
            bias = std::floor(v);
            first = false;
        }
        if (!color && !first) break;
        if (color)
            largest.push_back(
                std::uint32_t(std::max({attribute.number(i, 0), attribute.number(i, 1), attribute.number(i, 2)})));
    }
    if (!color) return std::make_shared<AttributeEncoder>(attribute, bias, 0);
    const int shift = colorShiftOf(largest);  // leaves the points that have a color
    m_coloredShare.store(looked == 0 ? 0.0f : float(largest.size()) / float(looked), std::memory_order_relaxed);
    return std::make_shared<AttributeEncoder>(attribute, 0.0, shift);
}

std::shared_ptr<const AttributeEncoder> PointStore::encoderFor(PointRange range)
{
    const std::lock_guard lock(m_encoderMutex);
    if (!m_encoder) {
        const auto first = makeEncoder(*m_cloud->findAttribute(firstAttribute(*m_cloud, range)), range);
        first->setSelection(m_selection);
        m_encoder = first;
    }
    return m_encoder;
}

void PointStore::fill(PointRange range)
{
    assert(m_order.runs() == nullptr);
    const auto encoder = encoderFor(range);
    put(range, *encoder, true);
    noteArrival(range, UINT32_MAX, range.size() - takenAhead(range));
}

void PointStore::fillAhead(PointRange range, std::uint32_t windows)
{
    const bool prime = m_order.kind() == OrderKind::Prime;
    if (!prime && windows > m_order.memberMask()) windows = UINT32_MAX;
    // Each of them is a page of its own.
    if (prime && windows != UINT32_MAX) range.last = std::min(range.last, range.first + kFewAhead);
    const auto encoder = encoderFor(range);
    put(range, *encoder, true, windows);
    {
        const std::lock_guard lock(m_arrivalMutex);
        m_ahead[range.first] = {range, windows};
    }
    noteArrival(range, windows, pointsAhead(range, windows));
}

/// Points of a range that lie in the first windows.
PointIndex PointStore::pointsAhead(PointRange range, std::uint32_t windows) const noexcept
{
    if (windows == UINT32_MAX || m_order.kind() == OrderKind::Prime) return range.size();
    PointIndex points = 0;
    for (PointIndex i = range.first; i < range.last; ++i)
        points += m_order.slotOfPlace(i) / m_order.windowSize() < windows ? 1 : 0;
    return points;
}

/// Points of a range that fillAhead() has taken.
PointIndex PointStore::takenAhead(PointRange range) const
{
    const std::lock_guard lock(m_arrivalMutex);
    PointIndex points = 0;
    auto one = m_ahead.upper_bound(range.first);
    if (one != m_ahead.begin()) --one;
    for (; one != m_ahead.end() && one->first < range.last; ++one) {
        const PointRange& ahead = one->second.range;
        const PointRange common{std::max(range.first, ahead.first), std::min(range.last, ahead.last)};
        if (common.first < common.last) points += pointsAhead(common, one->second.windows);
    }
    return points;
}

void PointStore::noteArrival(PointRange range, std::uint32_t windows, PointIndex points)
{
    m_filled.fetch_add(points, std::memory_order_release);
    if (range.empty()) return;
    const std::lock_guard lock(m_arrivalMutex);
    m_arrived.push_back({range, windows, (m_arrived.empty() ? 0 : m_arrived.back().after) + points});
    m_arrivals.store(m_arrived.size(), std::memory_order_release);
}

std::uint32_t PointStore::windowsOfGrowing(std::uint64_t inWindow) const noexcept
{
    if (inWindow == 0) inWindow = m_order.windowSize();
    const std::uint64_t all = std::uint64_t(m_order.memberMask()) + 1;
    return std::bit_floor(std::uint32_t(std::clamp<std::uint64_t>(m_slotsOfGrowing / inWindow, 1, all)));
}

void PointStore::withdraw(PointRange range)
{
    // Of a file that could not be read at all, nothing is looked for: it may have more than memory holds.
    std::vector<PointRange> taken;
    {
        const std::lock_guard lock(m_arrivalMutex);
        for (const Arrival& arrival : m_arrived) {
            const PointRange common{std::max(range.first, arrival.range.first),
                                    std::min(range.last, arrival.range.last)};
            if (common.first < common.last) taken.push_back(common);
        }
    }
    auto* const positions = reinterpret_cast<LocalPosition*>(m_slots.positions.data());
    PointIndex gone = 0;
    for (const PointRange& part : taken)
        for (PointIndex i = part.first; i < part.last; ++i) {
            LocalPosition& position = positions[m_order.slotOf(i)];
            gone += PointIndex(position.x != 0);
            position = {};
        }
    if (gone == 0) return;
    m_filled.fetch_sub(gone, std::memory_order_release);
    bumpVersions(range, true);
}

void PointStore::arrivedPoints(std::size_t from, std::size_t to, std::vector<PointRange>& out) const
{
    const std::lock_guard lock(m_arrivalMutex);
    for (std::size_t k = from; k < std::min(to, m_arrived.size()); ++k) out.push_back(m_arrived[k].range);
}

bool PointStore::arrivedSlots(std::size_t from, std::size_t to, SlotRange within, std::vector<SlotRange>& out) const
{
    const std::lock_guard lock(m_arrivalMutex);
    to = std::min(to, m_arrived.size());
    if (from >= to || within.first >= within.last) return true;
    if (m_order.kind() != OrderKind::Stratified) {
        const PointIndex before = from == 0 ? 0 : m_arrived[from - 1].after;
        const PointIndex after = m_arrived[to - 1].after;
        if (after < 2 * before && after < m_cloud->size()) return false;
        out.push_back(within);
        return true;
    }
    // Each window has the points of a group in one slot, at the group's place.
    const Slot window = m_order.windowSize();
    for (std::size_t k = from; k < to; ++k) {
        const PointRange& range = m_arrived[k].range;
        const auto first = Slot(range.first >> m_order.groupBits()),
                   last = Slot((range.last - 1) >> m_order.groupBits()) + 1;
        for (Slot w = within.first / window; w <= (within.last - 1) / window && w < m_arrived[k].windows; ++w) {
            const std::uint64_t begin = std::uint64_t(w) * window;
            const auto a = Slot(std::max<std::uint64_t>(begin + first, within.first));
            const auto b = Slot(std::min<std::uint64_t>(begin + last, within.last));
            if (a < b) out.push_back({a, b});
        }
    }
    return true;
}

void PointStore::fillAll()
{
    (void)encoderFor({0, m_cloud->size()});
    tbb::parallel_for(tbb::blocked_range<PointIndex>(0, m_cloud->size(), kPutPoints), [&](const auto& r) {
        fill({r.begin(), r.end()});
    });
}

void PointStore::setBounds(const RawBounds& bounds)
{
    m_bounds = bounds;
    if (!outgrown() && m_frame.holds(bounds)) return;
    m_frame = LocalFrame::around(bounds);
    m_outgrown.store(false, std::memory_order_relaxed);
    const auto current = encoder();
    if (!current) return;
    tbb::parallel_for(tbb::blocked_range<PointIndex>(0, m_cloud->size(), kPutPoints), [&](const auto& r) {
        put({r.begin(), r.end()}, *current, true);
        bumpVersions({r.begin(), r.end()}, true);
    });
}

void PointStore::put(PointRange places, const AttributeEncoder& encoder, bool positions, std::uint32_t windows)
{
    const Dealt dealt = dealOut(*m_cloud, places, encoder, m_classification, m_slots, m_order,
                                positions ? &m_frame : nullptr, windows);
    if (dealt.colorsCut != 0) m_colorsCut.fetch_add(dealt.colorsCut, std::memory_order_relaxed);
    if (!dealt.inside) m_outgrown.store(true, std::memory_order_relaxed);
}

void PointStore::bumpVersions(PointRange places, bool withPositions) noexcept
{
    const auto bump = [&](Slot slot) {
        const Slot block = slot >> kBlockBits;
        if (withPositions) m_positionVersions[block].fetch_add(1, std::memory_order_release);
        m_wordVersions[block].fetch_add(1, std::memory_order_release);
    };
    if (m_order.kind() == OrderKind::Stratified && places.size() > m_order.memberMask()) {
        // Every window was touched around the same place: bump the blocks of those runs.
        const auto g0 = Slot(places.first >> m_order.groupBits()),
                   g1 = Slot((places.last - 1) >> m_order.groupBits());
        Slot last = ~Slot(0);
        for (std::uint32_t w = 0; w <= m_order.memberMask(); ++w)
            for (Slot b = (w * m_order.windowSize() + g0) >> kBlockBits,
                      e = (w * m_order.windowSize() + g1) >> kBlockBits;
                 b <= e; ++b)
                if (b != last) bump((last = b) << kBlockBits);
    } else if (places.size() >= slotCount() / 4 || m_order.kind() == OrderKind::Prime) {
        for (Slot b = 0; b < blocks(); ++b) bump(b << kBlockBits);
    } else {
        for (PointIndex i = places.first; i < places.last; ++i) bump(m_order.slotOfPlace(i));
    }
}

bool PointStore::colorsMisjudged() const
{
    if (encoder()->kind() != WordKind::Color || encoder()->colorShift() == 8) return false;
    // Well above the share of bright points that a judgement lets go, and each time more: a few points that no
    // sample meets must not have it made again and again.
    const double share = std::max(m_coloredShare.load(std::memory_order_relaxed), 1.0f / float(kSamples));
    const double limit = double(filled()) * share / 32 * std::pow(4.0, m_rejudged);
    return double(m_colorsCut.load(std::memory_order_relaxed)) > limit;
}

void PointStore::show(const Attribute& attribute)
{
    if (encoder() && colorsMisjudged()) ++m_rejudged;
    const auto next = makeEncoder(attribute, {});
    next->setSelection(m_selection);
    if (!m_preview) {
        const std::lock_guard lock(m_encoderMutex);
        if (!std::exchange(m_encoder, next)) return;  // no word was made by another one
    }
    setEncoder(next);
    m_colorsCut.store(0, std::memory_order_relaxed);
    markStale(nullptr);
}

void PointStore::setPreview(std::shared_ptr<const Preview> preview)
{
    if (!preview && !m_preview) return;
    m_preview = std::move(preview);
    if (!encoder()) return;
    setEncoder(m_encoder);
    markStale(nullptr);
}

void PointStore::setSelection(std::shared_ptr<const PointSet> selection)
{
    if (!selection && !m_selection) return;
    if (!selection) selection = std::make_shared<PointSet>(m_cloud->size());
    const auto before = std::exchange(m_selection, std::move(selection));
    if (!encoder()) return;
    const auto current = m_encoder;
    const auto next = std::make_shared<AttributeEncoder>(*current);
    next->setSelection(m_selection);
    setEncoder(next);
    if (m_preview) return;  // all words are made anew when it ends
    // Words of other kinds say "not selected" from the beginning; of scalars the bit was a digit like others.
    if (!before && current->kind() == WordKind::Scalar) return markStale(nullptr);
    PointSet changed = *m_selection;
    if (before)
        for (std::size_t w = 0; w < changed.words().size(); ++w) changed.words()[w] ^= before->words()[w];
    markStale(&changed);
}

void PointStore::markStale(const PointSet* points)
{
    const auto current = encoder();
    if (!current) return;
    const Attribute* a = m_cloud->findAttribute("Classification");
    if (a != nullptr && a->columns[0] != m_classification.columns[0]) m_classification = *a;
    m_wordChanges.fetch_add(1, std::memory_order_release);
    if (points != nullptr && points->count() <= kFewPoints) {
        const PointRange extent = points->extent();
        const std::size_t firstWord = std::size_t(extent.first / 64),
                          lastWord = std::size_t((extent.last + 63) / 64);
        std::vector<std::uint32_t> indices;
        points->forEachInWords(firstWord, lastWord, [&](PointIndex i) { indices.push_back(std::uint32_t(i)); });
        tbb::parallel_for(tbb::blocked_range<std::size_t>(0, indices.size(), 4096), [&](const auto& r) {
            std::vector<std::uint32_t> words(r.size()), classes(r.size());
            const std::span<const std::uint32_t> part(indices.data() + r.begin(), r.size());
            m_colorsCut.fetch_add(current->encode(part, words.data()), std::memory_order_relaxed);
            if (m_classification.columns[0]) m_classification.gatherBits(part, classes.data());
            for (std::size_t k = 0; k < part.size(); ++k) {
                const Slot slot = m_order.slotOf(part[k]);
                reinterpret_cast<std::uint32_t*>(m_slots.words.data())[slot] = words[k];
                if (m_classification.columns[0])
                    reinterpret_cast<std::uint8_t*>(m_slots.classes.data())[slot] = std::uint8_t(classes[k]);
                m_wordVersions[slot >> kBlockBits].fetch_add(1, std::memory_order_release);
            }
        });
        return;
    }
    m_fresh.assign((slotCount() + 63) / 64, 0);
    m_refreshed = 0;
    m_stale = m_cloud->size() != 0;
}

std::size_t PointStore::refresh(std::span<const Slot> slotList)
{
    const auto current = encoder();
    if (!m_stale || !current) return 0;
    constexpr std::size_t kGrain = 4096;
    return tbb::parallel_reduce(
        tbb::blocked_range<std::size_t>(0, slotList.size(), kGrain), std::size_t(0),
        [&](const auto& r, std::size_t total) {
            std::vector<Slot> stale;
            std::vector<std::uint32_t> indices;
            for (std::size_t k = r.begin(); k != r.end(); ++k) {
                const Slot slot = slotList[k];
                const std::uint64_t bit = std::uint64_t(1) << (slot % 64);
                std::atomic_ref<std::uint64_t> fresh(m_fresh[slot / 64]);
                if ((fresh.load(std::memory_order_relaxed) & bit) != 0) continue;
                fresh.fetch_or(bit, std::memory_order_relaxed);
                const PointIndex place = m_order.placeAt(slot);
                if (place < m_refreshed || place >= m_cloud->size()) continue;
                stale.push_back(slot);
                indices.push_back(std::uint32_t(m_order.indexAt(place)));
            }
            std::vector<std::uint32_t> words(stale.size()), classes(stale.size());
            m_colorsCut.fetch_add(current->encode(indices, words.data()), std::memory_order_relaxed);
            if (m_classification.columns[0]) m_classification.gatherBits(indices, classes.data());
            for (std::size_t k = 0; k < stale.size(); ++k) {
                reinterpret_cast<std::uint32_t*>(m_slots.words.data())[stale[k]] = words[k];
                if (m_classification.columns[0])
                    reinterpret_cast<std::uint8_t*>(m_slots.classes.data())[stale[k]] = std::uint8_t(classes[k]);
                m_wordVersions[stale[k] >> kBlockBits].fetch_add(1, std::memory_order_release);
            }
            return total + stale.size();
        },
        std::plus<>());
}

void PointStore::refreshNext(PointIndex points)
{
    const auto current = encoder();
    if (!m_stale || !current) return;
    const PointIndex end = std::min(m_cloud->size(), (m_refreshed + points) / kPutPoints * kPutPoints + kPutPoints);
    tbb::parallel_for(tbb::blocked_range<PointIndex>(m_refreshed / kPutPoints, (end + kPutPoints - 1) / kPutPoints),
                      [&](const auto& r) {
                          const PointRange range{std::max(m_refreshed, r.begin() * kPutPoints),
                                                 std::min(end, r.end() * kPutPoints)};
                          put(range, *current, false);
                          bumpVersions(range, false);
                      });
    m_refreshed = end;
    m_stale = m_refreshed < m_cloud->size();
}

}  // namespace punctum::render
