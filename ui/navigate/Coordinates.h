// SPDX-License-Identifier: MIT
#pragma once

#include "ui/basic/Numbers.h"

#include <QString>

#include <vector>

namespace punctum::ui
{

/// Two or three numbers in one text, as they are copied from elsewhere: "x, y", "x y z", "x;y", lines, cells of a
/// table, in brackets or not. Each is read as the locale writes numbers, or else all are read as programs do, with
/// a point. Empty where the text is one number, or none of this. Any thread.
std::vector<NumberRead> readCoordinates(const QString& text, const QLocale& locale = windowLocale());

}  // namespace punctum::ui
