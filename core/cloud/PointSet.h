// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"

#include <algorithm>
#include <bit>
#include <cstdint>
#include <span>
#include <vector>

namespace punctum
{

/// A set of points of one cloud: a bit for each index. 64 neighboring points share a word, so that parallel
/// writers must own whole words.
class PointSet
{
public:
    PointSet() = default;
    explicit PointSet(PointIndex size) : m_size(size), m_words((size + 63) / 64) {}

    PointIndex size() const noexcept { return m_size; }  ///< of the cloud, not of the set
    bool contains(PointIndex i) const noexcept { return (m_words[i / 64] >> (i % 64)) & 1u; }
    void insert(PointIndex i) noexcept { m_words[i / 64] |= std::uint64_t(1) << (i % 64); }
    void insert(PointRange range) noexcept
    {
        while (range.first < range.last) {
            const PointIndex end = std::min(range.last, (range.first / 64 + 1) * 64), n = end - range.first;
            const std::uint64_t run = n == 64 ? ~std::uint64_t(0) : (std::uint64_t(1) << n) - 1;
            m_words[range.first / 64] |= run << (range.first % 64);
            range.first = end;
        }
    }
    void remove(PointIndex i) noexcept { m_words[i / 64] &= ~(std::uint64_t(1) << (i % 64)); }
    void clear() { std::fill(m_words.begin(), m_words.end(), 0); }

    std::span<std::uint64_t> words() noexcept { return m_words; }
    std::span<const std::uint64_t> words() const noexcept { return m_words; }

    PointIndex count() const noexcept
    {
        PointIndex n = 0;
        for (const std::uint64_t w : m_words) n += PointIndex(std::popcount(w));
        return n;
    }
    void insert(const PointSet& others) noexcept  ///< of the same cloud
    {
        for (std::size_t w = 0; w < m_words.size(); ++w) m_words[w] |= others.m_words[w];
    }
    void remove(const PointSet& others) noexcept  ///< of the same cloud
    {
        for (std::size_t w = 0; w < m_words.size(); ++w) m_words[w] &= ~others.m_words[w];
    }
    void intersect(const PointSet& others) noexcept  ///< of the same cloud
    {
        for (std::size_t w = 0; w < m_words.size(); ++w) m_words[w] &= others.m_words[w];
    }
    /// What was no member is one, and the other way round.
    void invert() noexcept
    {
        for (std::uint64_t& w : m_words) w = ~w;
        if (m_size % 64 != 0) m_words.back() &= (std::uint64_t(1) << (m_size % 64)) - 1;
    }
    /// How many members come before each block of so many words; then how many there are in all.
    std::vector<PointIndex> ranks(std::size_t blockWords) const
    {
        std::vector<PointIndex> before{0};
        for (std::size_t first = 0; first < m_words.size(); first += blockWords) {
            PointIndex n = before.back();
            const std::size_t last = std::min(m_words.size(), first + blockWords);
            for (std::size_t w = first; w < last; ++w) n += PointIndex(std::popcount(m_words[w]));
            before.push_back(n);
        }
        return before;
    }
    /// Calls f(index) for each member of words [firstWord, lastWord), in rising order.
    template <typename F>
    void forEachInWords(std::size_t firstWord, std::size_t lastWord, F&& f) const
    {
        for (std::size_t w = firstWord; w < lastWord; ++w)
            for (std::uint64_t bits = m_words[w]; bits != 0; bits &= bits - 1)
                f(PointIndex(w * 64 + std::size_t(std::countr_zero(bits))));
    }
    template <typename F>
    void forEach(F&& f) const
    {
        forEachInWords(0, m_words.size(), std::forward<F>(f));
    }
    /// From the first to past the last member; empty for an empty set.
    PointRange extent() const noexcept
    {
        std::size_t a = 0, b = m_words.size();
        while (a < b && m_words[a] == 0) ++a;
        while (b > a && m_words[b - 1] == 0) --b;
        if (a == b) return {};
        return {PointIndex(a * 64 + std::size_t(std::countr_zero(m_words[a]))),
                PointIndex(b * 64 - std::size_t(std::countl_zero(m_words[b - 1])))};
    }
    friend bool operator==(const PointSet&, const PointSet&) = default;

private:
    PointIndex m_size = 0;
    std::vector<std::uint64_t> m_words;
};

}  // namespace punctum
