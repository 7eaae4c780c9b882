// SPDX-License-Identifier: MIT
#pragma once

namespace punctum::ui
{

class ShownCount;
class ViewFilter;
class ViewRenderer;
class ViewScope;
class ViewSettings;
class Viewport;
class Workspace;

/// The window's main view with what it shows and what decides how, for a part that brings another view of the same.
/// All of it is borrowed, and outlives the part.
struct MainView {
    Workspace& workspace;
    ViewRenderer& renderer;
    ViewSettings& settings;
    ViewFilter& filter;
    ViewScope& scope;
    ShownCount& shown;
    Viewport& viewport;
};

}  // namespace punctum::ui
