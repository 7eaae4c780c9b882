// SPDX-License-Identifier: MIT
#include "ui/select/SelectionSteps.h"

#include <utility>

namespace punctum::ui
{

std::size_t KeptSelection::bytes() const noexcept
{
    return packed ? packed->bytes() : plain ? plain->words().size_bytes() : 0;
}

std::shared_ptr<const PointSet> KeptSelection::points() const
{
    return packed ? std::make_shared<const PointSet>(packed->unpacked()) : plain;
}

void SelectionSteps::push(Step step)
{
    m_undone.clear();
    m_done.push_back(std::move(step));
    limit();
}

void SelectionSteps::move(Stack& from, Stack& to, std::shared_ptr<KeptSelection> kept)
{
    if (from.empty()) return;
    to.push_back(std::move(from.back()));
    from.pop_back();
    to.back().kept = std::move(kept);
}

void SelectionSteps::limit()
{
    std::size_t bytes = 0;
    for (const Stack* stack : {&m_done, &m_undone})
        for (const Step& step : *stack) bytes += step.kept->bytes();
    for (Stack* stack : {&m_done, &m_undone}) {
        while (stack->size() > 1 && (bytes > kMostBytes || stack->size() > kMostSteps)) {
            bytes -= stack->front().kept->bytes();
            stack->pop_front();
        }
    }
}

}  // namespace punctum::ui
