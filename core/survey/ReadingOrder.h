// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Column.h"
#include "core/cloud/PointCloud.h"

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace punctum
{

/// In which order a survey is read while somebody looks at it: what is in sight first, and of that what is largest
/// on the screen; then the rest of the files in sight; then all else. Within each, and where nobody looks, in the
/// order that is spread over the survey.
///
/// Between whoever looks (look(), sightRead(): any thread, at once) and Survey::read(), which owns the rest.
///
/// Example:
///     order->look([camera, size](const WorldBounds& box) { return camera.seenSize(box, size); });
class ReadingOrder
{
public:
    /// How many px wide or high, about, what lies in a box (world) is to be seen; 0: it is out of sight. Called by
    /// threads that read, 100,000 times in a row or more.
    using Sight = std::function<double(const WorldBounds&)>;

    /// This is looked at from now on; null: nothing is.
    void look(Sight sight);
    /// Whether all that is in sight, as it was told last, has been read, or all there is. Where that is not known
    /// of each piece of a file, all of the file counts. Not before reading has begun; where nothing is looked at,
    /// when all has been read.
    bool sightRead() const noexcept;

    // -- for Survey::read()

    /// Of what is looked at, how large it is; null where nothing is. `looks`: how often look() was called.
    std::shared_ptr<const Sight> sight(std::uint64_t* looks = nullptr) const;
    std::uint64_t looks() const noexcept { return m_looks.load(std::memory_order_acquire); }
    /// A piece of a file: las::Reader::pieces().
    struct Unit {
        std::uint32_t part = 0, piece = 0;
    };
    /// One of the files.
    struct Part {
        WorldBounds box;                   ///< that holds it, for all that is known
        std::vector<std::uint32_t> turns;  ///< its pieces, in the order in which they are read
        /// Where the points of each piece are likely to be, by piece; empty: not known, as is an empty box.
        std::vector<WorldBounds> boxes{};
        bool sure = false;  ///< they hold all points of their pieces
    };
    /// From now on there is something to take. `order`: of the parts.
    void begin(std::vector<Part> parts, const std::vector<std::uint32_t>& order);
    /// What to read next; nothing when all has been taken. Any thread.
    std::optional<Unit> take();
    /// It has been read, and handed on. Any thread.
    void done(Unit unit);
    /// The file cannot be read: nothing of it is given any more. Any thread.
    void drop(std::uint32_t part);
    void end() noexcept;

private:
    enum class State : std::uint8_t { Waiting, Taken, Done };
    void sort(const Sight& seen);
    std::size_t indexOf(Unit unit) const noexcept { return m_first[unit.part] + unit.piece; }

    mutable std::mutex m_sightMutex;  ///< guards m_sight, for next to no time
    std::shared_ptr<const Sight> m_sight;
    std::atomic<std::uint64_t> m_looks{0};   ///< how often look() was called
    std::atomic<std::uint64_t> m_sorted{0};  ///< m_looks as the units were sorted last
    std::atomic<std::size_t> m_unread{0};    ///< of those in sight then
    std::atomic<bool> m_begun{false}, m_ended{false};

    std::mutex m_mutex;  ///< guards what follows; readers alone wait for it
    std::vector<Part> m_parts;
    std::vector<std::size_t> m_first;  ///< number of the first piece of each part; by it what follows
    std::vector<State> m_state;
    std::vector<bool> m_inSight;
    std::vector<Unit> m_turns;  ///< all, where nobody looks
    std::size_t m_turn = 0;
    std::vector<Unit> m_next;  ///< before those
    std::size_t m_nextTurn = 0;
};

}  // namespace punctum
