// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/PackedSet.h"

#include <QString>

#include <cstddef>
#include <deque>
#include <memory>

namespace punctum::ui
{

/// A selection that can be had back: packed as soon as a job has done that. Copies share what they hold.
struct KeptSelection {
    std::shared_ptr<const PointSet> plain;
    std::shared_ptr<const PackedSet> packed;  ///< instead of it; neither: nothing is selected

    std::size_t bytes() const noexcept;
    /// Unpacks it where need be, so in a job. Null: nothing is selected.
    std::shared_ptr<const PointSet> points() const;
};

/// The selections of one document that can be had back, in order. GUI thread only; a value type.
///
/// Steps stand in one order with the edits of the points: each knows how many edits were in force when it was done.
class SelectionSteps
{
public:
    struct Step {
        QString name;
        std::size_t edits = 0;                ///< in force when it was done
        std::shared_ptr<KeptSelection> kept;  ///< what its undoing, or doing again, leads to
    };

    // Bounds of one document: packed, a stroke over millions of points is some kilobytes.
    static constexpr std::size_t kMostBytes = std::size_t(64) << 20;
    static constexpr std::size_t kMostSteps = 500;

    /// A step has been done; those that were undone are gone. The oldest go when there are too many.
    void push(Step step);
    /// The step that `depth` undone ones ago is the next to undo, or to do again; null: there is none.
    const Step* undo(std::size_t depth = 0) const noexcept { return at(m_done, depth); }
    const Step* redo(std::size_t depth = 0) const noexcept { return at(m_undone, depth); }
    /// The newest has been undone, or done again, and `kept` is the selection of before that.
    void moveBack(std::shared_ptr<KeptSelection> kept) { move(m_done, m_undone, std::move(kept)); }
    void moveOn(std::shared_ptr<KeptSelection> kept) { move(m_undone, m_done, std::move(kept)); }
    /// Drops the oldest beyond the bounds, but never the newest; packing has made others smaller.
    void limit();

private:
    using Stack = std::deque<Step>;
    static const Step* at(const Stack& stack, std::size_t depth) noexcept
    {
        return depth < stack.size() ? &stack[stack.size() - 1 - depth] : nullptr;
    }
    static void move(Stack& from, Stack& to, std::shared_ptr<KeptSelection> kept);

    Stack m_done, m_undone;
};

}  // namespace punctum::ui
