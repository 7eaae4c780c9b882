// SPDX-License-Identifier: MIT
#include "render/order/SlotOrder.h"

#include "core/Error.h"

#include <algorithm>
#include <bit>

namespace punctum::render
{

namespace
{

/// Finalizer of splitmix64 (Steele, Lea, Flood 2014): spreads a group's number over all bits.
constexpr std::uint64_t mix(std::uint64_t x) noexcept
{
    x += 0x9E3779B97F4A7C15u;
    x = (x ^ (x >> 30)) * 0xBF58476D1CE4E5B9u;
    x = (x ^ (x >> 27)) * 0x94D049BB133111EBu;
    return x ^ (x >> 31);
}

constexpr std::uint32_t mulMod(std::uint32_t a, std::uint32_t b, std::uint32_t p) noexcept
{
    return std::uint32_t(std::uint64_t(a) * b % p);
}

constexpr std::uint32_t powMod(std::uint32_t base, std::uint32_t exponent, std::uint32_t p) noexcept
{
    std::uint32_t result = 1 % p;
    for (; exponent != 0; exponent >>= 1) {
        if (exponent & 1u) result = mulMod(result, base, p);
        base = mulMod(base, base, p);
    }
    return result;
}

/// Deterministic Miller-Rabin: the bases 2, 7, 61 decide all 32-bit numbers (Jaeschke 1993).
constexpr bool isPrime(std::uint32_t n) noexcept
{
    if (n < 2) return false;
    for (const std::uint32_t p : {2u, 3u, 5u, 7u, 61u})
        if (n % p == 0) return n == p;
    const int twos = std::countr_zero(n - 1);
    const std::uint32_t odd = (n - 1) >> twos;
    for (const std::uint32_t base : {2u, 7u, 61u}) {
        std::uint32_t x = powMod(base, odd, n);
        bool witness = x != 1 && x != n - 1;
        for (int k = 1; k < twos && witness; ++k) {
            x = mulMod(x, x, n);
            witness = x != n - 1;
        }
        if (witness) return false;
    }
    return true;
}

/// Equation 1 of Schuetz et al. 2019: quadratic residues, mirrored for the upper half.
constexpr std::uint32_t permute(std::uint32_t i, std::uint32_t p) noexcept
{
    const std::uint32_t square = mulMod(i, i, p);
    return i <= p / 2 ? square : p - square;
}

/// Inverse of permute(): of y and p - y one is a residue, whose root in the right half is what we look for.
/// Since p = 3 mod 4, a root of a residue r is r^((p+1)/4).
constexpr std::uint32_t unpermute(std::uint32_t y, std::uint32_t p) noexcept
{
    if (y == 0) return 0;
    const auto root = [p](std::uint32_t r) { return powMod(r, p / 4 + 1, p); };
    std::uint32_t x = root(y);
    if (mulMod(x, x, p) == y) return std::min(x, p - x);
    x = root(p - y);
    return std::max(x, p - x);
}

/// Inverse of an odd number modulo 2^32 (Newton; the low bits serve any smaller power of two).
constexpr std::uint32_t oddInverse(std::uint32_t a) noexcept
{
    std::uint32_t x = a;  // right to 3 bits
    for (int k = 0; k < 4; ++k) x *= 2u - a * x;
    return x;
}

}  // namespace

std::string_view nameOf(OrderKind kind) noexcept
{
    return kind == OrderKind::Prime ? "prime" : "stratified";
}

std::optional<OrderKind> orderFromName(std::string_view name) noexcept
{
    for (const OrderKind kind : {OrderKind::Prime, OrderKind::Stratified})
        if (name == nameOf(kind)) return kind;
    return std::nullopt;
}

GroupShuffle groupShuffle(std::uint32_t group) noexcept
{
    const std::uint64_t h = mix(group);
    const std::uint32_t factor = std::uint32_t(h) | 1u;
    return {factor, oddInverse(factor), std::uint32_t(h >> 32)};
}

SlotOrder::SlotOrder(OrderKind kind, PointIndex points) : m_kind(kind), m_points(points)
{
    constexpr PointIndex kMost = 0xFFFF0000u;  // leaves room for padding and kNoPoint
    if (points > kMost) throw Error("A view holds up to 4,294,901,760 points.");
    if (kind == OrderKind::Prime) {
        m_slots = Slot(points);
        m_window = std::min<Slot>(m_slots, 4096);
        std::uint32_t p = std::uint32_t(points);
        while (p >= 3 && !(p % 4 == 3 && isPrime(p))) --p;
        m_prime = p >= 3 ? p : 0;
    } else {
        // K = 1024 windows for large clouds; for small ones windows stay at least as long as they are many.
        const int log2 = points > 1 ? std::bit_width(points - 1) : 0;
        m_groupBits = std::uint32_t(std::clamp(log2 / 2 - 2, 0, 10));
        const PointIndex members = PointIndex(1) << m_groupBits;
        m_window = Slot((points + members - 1) >> m_groupBits);
        // Runs of 16 slots are then whole cache lines in every window, and can be written as such.
        if (m_window >= 1024) m_window = (m_window + 15) / 16 * 16;
        m_slots = m_window << m_groupBits;
    }
    m_window = std::max<Slot>(m_window, 1);
}

Slot SlotOrder::slotOfPlace(PointIndex place) const noexcept
{
    if (m_kind == OrderKind::Prime) {
        const auto i = std::uint32_t(place);
        return i < m_prime ? permute(permute(i, m_prime), m_prime) : i;
    }
    const std::uint32_t group = std::uint32_t(place >> m_groupBits);
    const GroupShuffle s = groupShuffle(group);
    return s.window(std::uint32_t(place) & memberMask(), memberMask()) * m_window + group;
}

PointIndex SlotOrder::placeAt(Slot slot) const noexcept
{
    if (m_kind == OrderKind::Prime) return slot < m_prime ? unpermute(unpermute(slot, m_prime), m_prime) : slot;
    const std::uint32_t group = slot % m_window;
    const std::uint32_t window = slot / m_window;
    const GroupShuffle s = groupShuffle(group);
    return (PointIndex(group) << m_groupBits) + s.member(window, memberMask());
}

void SlotOrder::slotsOf(PointRange range, Slot* out) const noexcept
{
    if (!m_runs) return slotsOfPlaces(range, out);
    const PointIndex runPoints = m_runs->runPoints();
    for (PointIndex first = range.first, last = first; first < range.last; first = last) {
        last = std::min(range.last, (first / runPoints + 1) * runPoints);
        const PointIndex place = m_runs->placeOf(first);
        slotsOfPlaces({place, place + (last - first)}, out + (first - range.first));
    }
}

void SlotOrder::slotsOfPlaces(PointRange places, Slot* out) const noexcept
{
    if (m_kind == OrderKind::Prime) {
        for (PointIndex i = places.first; i < places.last; ++i) *out++ = slotOfPlace(i);
        return;
    }
    PointIndex i = places.first;
    while (i < places.last) {
        const std::uint32_t group = std::uint32_t(i >> m_groupBits);
        const GroupShuffle s = groupShuffle(group);
        const PointIndex end = std::min(places.last, (PointIndex(group) + 1) << m_groupBits);
        for (; i < end; ++i) *out++ = s.window(std::uint32_t(i) & memberMask(), memberMask()) * m_window + group;
    }
}

}  // namespace punctum::render
