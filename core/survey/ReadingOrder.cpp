// SPDX-License-Identifier: MIT
#include "core/survey/ReadingOrder.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace punctum
{

namespace
{

/// Of a file of so many pieces all count as in sight when it is: where they are likely to be is not certain.
constexpr std::size_t kWholePart = 64;
/// Classes of sizes on the screen, each twice the one before, within which the order stays spread.
constexpr int kSizes = 16;

/// 0: out of sight.
int sizeClass(double px)
{
    return px > 0.0 ? std::clamp(int(std::floor(std::log2(px))), 0, kSizes - 2) + 1 : 0;
}

}  // namespace

void ReadingOrder::look(Sight sight)
{
    auto told = sight ? std::make_shared<const Sight>(std::move(sight)) : nullptr;
    const std::lock_guard lock(m_sightMutex);
    m_sight.swap(told);
    m_looks.fetch_add(1, std::memory_order_release);
}

bool ReadingOrder::sightRead() const noexcept
{
    if (m_ended.load(std::memory_order_acquire)) return true;
    const std::uint64_t looks = m_looks.load(std::memory_order_acquire);
    // In this order: who sorts anew forgets the number of before, then says so, then counts.
    return looks != 0 && m_begun.load(std::memory_order_acquire) &&
           m_sorted.load(std::memory_order_acquire) == looks && m_unread.load(std::memory_order_acquire) == 0;
}

auto ReadingOrder::sight(std::uint64_t* looks) const -> std::shared_ptr<const Sight>
{
    const std::lock_guard lock(m_sightMutex);
    if (looks != nullptr) *looks = m_looks.load(std::memory_order_relaxed);
    return m_sight;
}

void ReadingOrder::begin(std::vector<Part> parts, const std::vector<std::uint32_t>& order)
{
    const std::lock_guard lock(m_mutex);
    m_parts = std::move(parts);
    m_first.assign(1, 0);
    for (const Part& part : m_parts) m_first.push_back(m_first.back() + part.turns.size());
    m_state.assign(m_first.back(), State::Waiting);
    m_inSight.assign(m_first.back(), false);
    m_turns.clear();
    m_turns.reserve(m_first.back());
    for (const std::uint32_t part : order)
        for (const std::uint32_t piece : m_parts[part].turns) m_turns.push_back({part, piece});
    m_turn = m_nextTurn = 0;
    m_begun = true;
}

std::optional<ReadingOrder::Unit> ReadingOrder::take()
{
    const std::lock_guard lock(m_mutex);
    if (m_looks.load(std::memory_order_acquire) != m_sorted.load(std::memory_order_relaxed)) {
        std::uint64_t looks = 0;
        const auto told = sight(&looks);
        m_unread = SIZE_MAX;
        m_sorted.store(looks, std::memory_order_release);
        sort(told ? *told : Sight());
    }
    const auto from = [&](const std::vector<Unit>& turns, std::size_t& turn) -> std::optional<Unit> {
        while (turn < turns.size()) {
            const Unit unit = turns[turn++];
            State& state = m_state[indexOf(unit)];
            if (state != State::Waiting) continue;
            state = State::Taken;
            return unit;
        }
        return std::nullopt;
    };
    const auto unit = from(m_next, m_nextTurn);
    return unit ? unit : from(m_turns, m_turn);
}

/// Finds what comes before the others, with m_mutex held: some 0.2 us for each file, and for each piece of those in
/// sight.
void ReadingOrder::sort(const Sight& seen)
{
    m_next.clear();
    m_nextTurn = 0;
    std::fill(m_inSight.begin(), m_inSight.end(), false);
    std::size_t unread = seen ? 0 : SIZE_MAX;  // where nobody looks, it is known in the end
    if (seen) {
        std::vector<int> sizes(m_parts.size());
        for (std::size_t k = 0; k < m_parts.size(); ++k)
            sizes[k] = m_parts[k].box.empty() ? 0 : sizeClass(seen(m_parts[k].box));
        std::vector<std::vector<Unit>> bySize(kSizes);  // 0: what else the files in sight have
        for (std::size_t turn = 0; turn < m_turns.size(); ++turn) {
            const Unit unit = m_turns[turn];
            if (sizes[unit.part] == 0) continue;
            const std::size_t index = indexOf(unit);
            const Part& part = m_parts[unit.part];
            const bool known = !part.boxes.empty() && !part.boxes[unit.piece].empty();
            const int size = known ? sizeClass(seen(part.boxes[unit.piece])) : sizes[unit.part];
            m_inSight[index] = size > 0 || (!part.sure && part.turns.size() <= kWholePart);
            unread += m_inSight[index] && m_state[index] != State::Done ? 1 : 0;
            if (m_state[index] == State::Waiting) bySize[std::size_t(size)].push_back(unit);
        }
        for (auto units = bySize.rbegin(); units != bySize.rend(); ++units)
            m_next.insert(m_next.end(), units->begin(), units->end());
    }
    m_unread.store(unread, std::memory_order_release);
}

void ReadingOrder::done(Unit unit)
{
    const std::lock_guard lock(m_mutex);
    const std::size_t index = indexOf(unit);
    if (std::exchange(m_state[index], State::Done) != State::Done && m_inSight[index])
        m_unread.fetch_sub(1, std::memory_order_release);
}

void ReadingOrder::drop(std::uint32_t part)
{
    const std::lock_guard lock(m_mutex);
    for (std::size_t index = m_first[part]; index < m_first[part + 1]; ++index)
        if (m_state[index] == State::Waiting) {
            m_state[index] = State::Done;
            if (m_inSight[index]) m_unread.fetch_sub(1, std::memory_order_release);
        }
}

void ReadingOrder::end() noexcept
{
    m_ended.store(true, std::memory_order_release);
}

}  // namespace punctum
