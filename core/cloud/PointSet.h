// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"
#include "core/cloud/SetWords.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

namespace punctum
{

/// A set of points of one cloud: a bit for each index. 64 neighboring points share a word, so that parallel
/// writers own whole words, or call insertShared().
///
/// Where none of 32,768 neighboring points was ever put in, these cost no memory; a set of none, and one of all
/// (all()) that nobody changed, cost none at all and are asked in no time. So writers in parallel better leave
/// words alone that are as they should be.
class PointSet
{
public:
    PointSet() = default;
    explicit PointSet(PointIndex size) : m_size(size), m_words(wordsFor(size), SetWords::Fill::Zeros) {}
    /// All points of a cloud.
    static PointSet all(PointIndex size)
    {
        PointSet set;
        set.m_size = size;
        set.m_words = SetWords(wordsFor(size), SetWords::Fill::Ones);
        set.trim();
        set.m_known = size == 0 ? Known::None : Known::All;
        return set;
    }
    PointSet(const PointSet& other) : m_size(other.m_size)
    {
        switch (other.known()) {
            case Known::None:
                m_words = SetWords(other.m_words.size(), SetWords::Fill::Zeros);
                break;
            case Known::All:
                *this = all(other.m_size);
                break;
            case Known::Nothing:
                m_words = other.m_words;
                m_known = Known::Nothing;
        }
    }
    PointSet(PointSet&& other) noexcept
        : m_size(std::exchange(other.m_size, 0)),
          m_words(std::move(other.m_words)),
          m_known(other.m_known.exchange(Known::None, std::memory_order_relaxed))
    {
    }
    PointSet& operator=(const PointSet& other)
    {
        if (this != &other) *this = PointSet(other);
        return *this;
    }
    PointSet& operator=(PointSet&& other) noexcept
    {
        std::swap(m_size, other.m_size);
        std::swap(m_words, other.m_words);
        const Known ours = known();
        m_known.store(other.known(), std::memory_order_relaxed);
        other.m_known.store(ours, std::memory_order_relaxed);
        return *this;
    }
    ~PointSet() = default;

    PointIndex size() const noexcept { return m_size; }  ///< of the cloud, not of the set
    /// Whether it is sure, without looking, that no point is in it; that all are.
    bool surelyNone() const noexcept { return known() == Known::None; }
    bool surelyAll() const noexcept { return known() == Known::All; }
    bool contains(PointIndex i) const noexcept { return (m_words.data()[i / 64] >> (i % 64)) & 1u; }
    void insert(PointIndex i) noexcept
    {
        touch();
        m_words.data()[i / 64] |= std::uint64_t(1) << (i % 64);
    }
    /// From any number of threads at once, also where they share a word.
    void insertShared(PointIndex i) noexcept
    {
        touch();
        std::atomic_ref(m_words.data()[i / 64]).fetch_or(std::uint64_t(1) << (i % 64), std::memory_order_relaxed);
    }
    void insert(PointRange range) noexcept
    {
        if (!range.empty()) touch();
        while (range.first < range.last) {
            const PointIndex end = std::min(range.last, (range.first / 64 + 1) * 64), n = end - range.first;
            const std::uint64_t run = n == 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << n) - 1;
            m_words.data()[range.first / 64] |= run << (range.first % 64);
            range.first = end;
        }
    }
    void remove(PointIndex i) noexcept
    {
        if (!contains(i)) return;
        touch();
        m_words.data()[i / 64] &= ~(std::uint64_t(1) << (i % 64));
    }
    void clear()
    {
        if (!surelyNone()) *this = PointSet(m_size);
    }

    std::span<std::uint64_t> words() noexcept
    {
        touch();
        return {m_words.data(), m_words.size()};
    }
    std::span<const std::uint64_t> words() const noexcept { return {m_words.data(), m_words.size()}; }

    PointIndex count() const noexcept
    {
        if (known() != Known::Nothing) return surelyAll() ? m_size : 0;
        PointIndex n = 0;
        for (const std::uint64_t w : words()) n += PointIndex(std::popcount(w));
        return n;
    }
    void insert(const PointSet& others)  ///< of the same cloud
    {
        if (others.surelyNone() || surelyAll()) return;
        if (surelyNone() || others.surelyAll()) {
            *this = others;
            return;
        }
        const std::uint64_t* const theirs = others.m_words.data();
        change([theirs](std::size_t w, std::uint64_t ours) { return ours | theirs[w]; });
    }
    void remove(const PointSet& others)  ///< of the same cloud
    {
        if (others.surelyNone() || surelyNone()) return;
        if (others.surelyAll()) return clear();
        const std::uint64_t* const theirs = others.m_words.data();
        change([theirs](std::size_t w, std::uint64_t ours) { return ours & ~theirs[w]; });
    }
    void intersect(const PointSet& others)  ///< of the same cloud
    {
        if (others.surelyAll() || surelyNone()) return;
        if (others.surelyNone()) return clear();
        const std::uint64_t* const theirs = others.m_words.data();
        change([theirs](std::size_t w, std::uint64_t ours) { return ours & theirs[w]; });
    }
    /// What was no member is one, and the other way round.
    void invert()
    {
        if (known() != Known::Nothing) {
            *this = surelyAll() ? PointSet(m_size) : all(m_size);
            return;
        }
        for (std::uint64_t& w : words()) w = ~w;
        trim();
    }
    /// How many members come before each block of so many words; then how many there are in all.
    std::vector<PointIndex> ranks(std::size_t blockWords) const
    {
        std::vector<PointIndex> before{0};
        for (std::size_t first = 0; first < m_words.size(); first += blockWords) {
            PointIndex n = before.back();
            const std::size_t last = std::min(m_words.size(), first + blockWords);
            for (std::size_t w = first; w < last && !surelyNone(); ++w)
                n += PointIndex(std::popcount(m_words.data()[w]));
            before.push_back(n);
        }
        return before;
    }
    /// Calls f(index) for each member of words [firstWord, lastWord), in rising order.
    template <typename F>
    void forEachInWords(std::size_t firstWord, std::size_t lastWord, F&& f) const
    {
        for (std::size_t w = firstWord; w < lastWord; ++w)
            for (std::uint64_t bits = m_words.data()[w]; bits != 0; bits &= bits - 1)
                f(PointIndex(w * 64 + std::size_t(std::countr_zero(bits))));
    }
    template <typename F>
    void forEach(F&& f) const
    {
        if (!surelyNone()) forEachInWords(0, m_words.size(), std::forward<F>(f));
    }
    /// From the first to past the last member; empty for an empty set.
    PointRange extent() const noexcept
    {
        if (known() != Known::Nothing) return {0, surelyAll() ? m_size : 0};
        const std::uint64_t* const bits = m_words.data();
        std::size_t a = 0, b = m_words.size();
        while (a < b && bits[a] == 0) ++a;
        while (b > a && bits[b - 1] == 0) --b;
        if (a == b) return {};
        return {PointIndex(a * 64 + std::size_t(std::countr_zero(bits[a]))),
                PointIndex(b * 64 - std::size_t(std::countl_zero(bits[b - 1])))};
    }
    friend bool operator==(const PointSet& a, const PointSet& b) noexcept
    {
        if (a.m_size != b.m_size) return false;
        if (a.known() != Known::Nothing && a.known() == b.known()) return true;
        return std::equal(a.words().begin(), a.words().end(), b.words().begin());
    }

private:
    /// What is known of the members without looking.
    enum class Known : std::uint8_t { None, All, Nothing };

    static std::size_t wordsFor(PointIndex size) noexcept { return std::size_t((size + 63) / 64); }
    Known known() const noexcept { return m_known.load(std::memory_order_relaxed); }
    /// Somebody may change the words. Several threads may say so.
    void touch() noexcept
    {
        if (known() != Known::Nothing) m_known.store(Known::Nothing, std::memory_order_relaxed);
    }
    /// No bit stands for a point that the cloud does not have.
    void trim() noexcept
    {
        if (m_size % 64 != 0) m_words.data()[m_words.size() - 1] &= (std::uint64_t(1) << (m_size % 64)) - 1;
    }
    /// Makes each word what `next(index, word)` says, and writes by blocks where that is another one.
    template <typename F>
    void change(F&& next)
    {
        constexpr std::size_t kBlock = 512;
        const std::span<std::uint64_t> ours = words();
        for (std::size_t first = 0; first < ours.size(); first += kBlock) {
            const std::size_t last = std::min(ours.size(), first + kBlock);
            std::uint64_t other = 0;
            for (std::size_t w = first; w < last; ++w) other |= ours[w] ^ next(w, ours[w]);
            if (other == 0) continue;
            for (std::size_t w = first; w < last; ++w) ours[w] = next(w, ours[w]);
        }
    }

    PointIndex m_size = 0;
    SetWords m_words;
    std::atomic<Known> m_known{Known::None};  ///< relaxed: it says nothing of other memory
};

}  // namespace punctum
