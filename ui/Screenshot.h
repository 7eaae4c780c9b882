// SPDX-License-Identifier: MIT
#pragma once

#include <QString>

namespace punctum::ui
{

class ViewRenderer;
class Workspace;

/// Writes the finished picture of a view as PNG, whole or not at all, by a job of the workspace, and says
/// `sentence` then, or what went wrong. GUI thread; returns at once.
void saveScreenshot(Workspace& workspace, ViewRenderer& view, const QString& path, bool transparent,
                    const QString& sentence);

}  // namespace punctum::ui
