// SPDX-License-Identifier: MIT
#pragma once

#include "core/Error.h"
#include "render/order/SlotOrder.h"
#include "render/scene/PointId.h"

namespace punctum::render
{

/// Deals out the ids of one view: each cloud gets as many in a row as it has slots, and no id is kNoPoint.
class PointIds
{
public:
    /// The first of `count` ids that nobody has. Throws Error when not so many are left; the others stay as they
    /// are.
    PointId take(Slot count)
    {
        if (count > kNoPoint - m_next)
            throw Error(
                "A view holds up to 4,294,967,295 points, and these clouds together have more; leave one out.");
        const PointId first = m_next;
        m_next += count;
        return first;
    }

private:
    PointId m_next = 0;
};

}  // namespace punctum::render
