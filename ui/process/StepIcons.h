// SPDX-License-Identifier: MIT
#pragma once

#include <QIcon>

namespace punctum
{
class Step;
}

namespace punctum::ui
{

/// The small picture of a step: its own, or that of its group. GUI thread only.
QIcon stepIcon(const Step& step);

}  // namespace punctum::ui
