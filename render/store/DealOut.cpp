// SPDX-License-Identifier: MIT
#include "render/store/DealOut.h"

#include "core/cloud/BlockBoxes.h"
#include "render/store/SlotElements.h"

#include <algorithm>
#include <cstring>
#include <memory>

#if defined(__SSE2__)
#include <emmintrin.h>
#endif

namespace punctum::render
{

namespace
{

/// Points encoded and dealt out together: their positions, words and classes stay in the processor's second level
/// cache, and with 1024 windows each window gets runs of 16 slots, whole cache lines.
constexpr PointIndex kDealtPoints = BlockBoxes::kPoints;
/// Groups dealt out together; more only with small clouds, whose groups are small.
constexpr std::uint32_t kMostGroups = 64;
/// Windows ahead of the one that is written, whose cache lines are asked for.
constexpr std::uint32_t kFetchAhead = 8;

/// Points of one piece before they are dealt out, in the order of their places.
struct DealtPiece {
    std::uint32_t words[kDealtPoints];
    std::uint8_t classes[kDealtPoints];
    Element elements[kDealtPoints];
    std::int32_t raw[3][kDealtPoints];  ///< of points that are not consecutive in the file
};

/// Words and classes of the points at some places.
std::size_t takeValues(PointRange places, const AttributeEncoder& encoder, const Attribute& classification,
                       const RunOrder* runs, DealtPiece& s)
{
    const bool haveClasses = classification.columns[0] != nullptr;
    if (runs == nullptr) {
        if (haveClasses) classification.gatherBits(places, s.classes);
        return encoder.encode(places, s.words);
    }
    if (runs->runPoints() == 1) {
        const auto points = runs->pointsAt(places);
        if (haveClasses) {
            classification.gatherBits(points, s.words);
            for (std::size_t k = 0; k < points.size(); ++k) s.classes[k] = std::uint8_t(s.words[k]);
        }
        return encoder.encode(points, s.words);
    }
    std::size_t cut = 0;
    runs->forRuns(places, [&](PointRange points, PointIndex place) {
        const auto at = std::size_t(place - places.first);
        if (haveClasses) classification.gatherBits(points, s.classes + at);
        cut += encoder.encode(points, s.words + at);
    });
    return cut;
}

/// Fills the piece with the points at some places.
Dealt takePoints(const PointCloud& cloud, PointRange places, const AttributeEncoder& encoder,
                 const Attribute& classification, const RunOrder* runs, const LocalFrame* frame, DealtPiece& s)
{
    Dealt dealt;
    dealt.colorsCut = takeValues(places, encoder, classification, runs, s);
    if (frame == nullptr) return dealt;
    const std::int32_t* axes[3] = {cloud.rawX().data() + places.first, cloud.rawY().data() + places.first,
                                   cloud.rawZ().data() + places.first};
    if (runs != nullptr) {
        runs->coordinatesAt(cloud, places, s.raw[0], s.raw[1], s.raw[2]);
        for (std::size_t axis = 0; axis < 3; ++axis) axes[axis] = s.raw[axis];
    }
    dealt.inside = makeElements(*frame, axes, s.words, std::size_t(places.size()), s.elements);
    return dealt;
}

}  // namespace

Dealt dealOut(const PointCloud& cloud, PointRange places, const AttributeEncoder& encoder,
              const Attribute& classification, SlotArrays& arrays, const SlotOrder& order, const LocalFrame* frame,
              std::uint32_t windows)
{
    thread_local std::unique_ptr<DealtPiece> scratch;
    if (!scratch) scratch = std::make_unique<DealtPiece>();
    auto* const positions = reinterpret_cast<LocalPosition*>(arrays.positions.data());
    auto* const words = reinterpret_cast<std::uint32_t*>(arrays.words.data());
    auto* const classes = reinterpret_cast<std::uint8_t*>(arrays.classes.data());
    const bool haveClasses = classification.columns[0] != nullptr;
    Dealt dealt;

    for (PointIndex first = places.first, last = first; first < places.last; first = last) {
        // Pieces end where groups of the order do, so that all but the outermost groups are dealt out whole.
        last = std::min(places.last, (first / kDealtPoints + 1) * kDealtPoints);
        const PointRange piece{first, last};
        const auto count = std::size_t(piece.size());
        DealtPiece& s = *scratch;
        const Dealt part = takePoints(cloud, piece, encoder, classification, order.runs(), frame, s);
        dealt.colorsCut += part.colorsCut;
        dealt.inside &= part.inside;

        const auto store = [&](Slot slot, std::size_t k) {
            words[slot] = s.words[k];
            if (haveClasses) classes[slot] = s.classes[k];
            if (frame != nullptr) positions[slot] = {s.elements[k].x, s.elements[k].y, s.elements[k].z};
        };
        if (order.kind() != OrderKind::Stratified) {
            for (std::size_t k = 0; k < count; ++k) store(order.slotOfPlace(first + k), k);
            continue;
        }
        const std::uint32_t mask = order.memberMask();
        const Slot window = order.windowSize();
        const PointIndex groupPoints = PointIndex(mask) + 1;
        const auto dealOut = [&](PointIndex from, PointIndex to) {  // points of one group
            const auto group = std::uint32_t(from >> order.groupBits());
            const GroupShuffle shuffle = groupShuffle(group);
            for (PointIndex i = from; i < to; ++i) {
                const std::uint32_t w = shuffle.window(std::uint32_t(i) & mask, mask);
                if (w < windows) store(w * window + group, std::size_t(i - first));
            }
        };
        const PointIndex wholeFirst = std::min(piece.last, (piece.first + mask) / groupPoints * groupPoints);
        const PointIndex wholeLast = std::max(wholeFirst, piece.last / groupPoints * groupPoints);
        if (piece.first < wholeFirst) dealOut(piece.first, wholeFirst);
        if (wholeLast < piece.last) dealOut(wholeLast, piece.last);
        // Whole groups window by window: each gets a run of consecutive slots, one from each group.
        for (PointIndex from = wholeFirst; from < wholeLast;) {
            const auto group = std::uint32_t(from >> order.groupBits());
            const auto groups =
                std::uint32_t(std::min<PointIndex>(kMostGroups, (wholeLast - from) >> order.groupBits()));
            // members[g]: the member of group g that the window gets, from window to window by a fixed step
            std::uint32_t members[kMostGroups], steps[kMostGroups], bases[kMostGroups];
            for (std::uint32_t g = 0; g < groups; ++g) {
                const GroupShuffle shuffle = groupShuffle(group + g);
                members[g] = shuffle.member(0, mask);
                steps[g] = shuffle.inverse;
                bases[g] = std::uint32_t(from - first) + (g << order.groupBits());
            }
            const bool lines =
                frame != nullptr && groups == kLineSlots && group % kLineSlots == 0 && window % kLineSlots == 0;
            for (std::uint32_t w = 0; w <= mask && w < windows; ++w) {
                const Slot slot = w * window + group;
                // part of a line, which must come before it can be written
                if (haveClasses && w + kFetchAhead <= mask)
                    __builtin_prefetch(classes + slot + kFetchAhead * window, 1);
                std::uint32_t at[kMostGroups];
                for (std::uint32_t g = 0; g < groups; ++g) {
                    at[g] = bases[g] + members[g];
                    members[g] = (members[g] + steps[g]) & mask;
                }
                if (lines) {
                    const Element* elements[kLineSlots];
                    for (std::uint32_t g = 0; g < kLineSlots; ++g) elements[g] = &s.elements[at[g]];
                    storeLines(elements, &positions[slot].x, &words[slot]);
                } else {
                    for (std::uint32_t g = 0; g < groups; ++g) words[slot + g] = s.words[at[g]];
                    if (frame != nullptr)
                        for (std::uint32_t g = 0; g < groups; ++g) {
                            const Element& e = s.elements[at[g]];
                            positions[slot + g] = {e.x, e.y, e.z};
                        }
                }
                if (haveClasses) {
                    // eight at once, because each store of its own would wait for the cache line
                    std::uint32_t g = 0;
                    for (; g + 8 <= groups; g += 8) {
                        std::uint64_t eight = 0;
                        for (std::uint32_t k = 0; k < 8; ++k)
                            eight |= std::uint64_t(s.classes[at[g + k]]) << (8 * k);
                        std::memcpy(classes + slot + g, &eight, sizeof eight);
                    }
                    for (; g < groups; ++g) classes[slot + g] = s.classes[at[g]];
                }
            }
            from += PointIndex(groups) << order.groupBits();
        }
    }
#if defined(__SSE2__)
    _mm_sfence();  // what was written past the caches is there before anybody is told of it
#endif
    return dealt;
}

}  // namespace punctum::render
