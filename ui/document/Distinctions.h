// SPDX-License-Identifier: MIT
#pragma once

#include <QStringList>

namespace punctum::ui
{

/// For paths of files that have one name: of each the shortest end of its folder's path that no other has, such as
/// "north/day 1" for north/day 1/tile.laz beside south/day 1/tile.laz. Paths are absolute, with "/", and differ.
QStringList distinctionsOf(const QStringList& paths);

}  // namespace punctum::ui
