// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/DisplaySettings.h"
#include "render/progressive/ViewCloud.h"

#include <string>
#include <utility>

namespace punctum::render
{

/// Which attribute, and which range, one legend tells for all clouds of a view.
///
/// Owned by ProgressiveRenderer; its thread. Takes each cloud's mutex() shared while it reads columns.
class SharedLegend
{
public:
    /// Shows an attribute of a cloud; returns whether the cloud has it, and did not show it already.
    static bool show(ViewCloud& cloud, const std::string& name);
    /// Name of the attribute on screen: the display's where a cloud has it, else what the first cloud shows.
    static std::string shownAttribute(const ViewClouds& clouds, const DisplaySettings& display);

    /// What clouds show may differ from now on: agree() has to look.
    void attributesChanged() noexcept { m_agreementNeeded = m_rangeNeeded = true; }
    /// What the first of those clouds shows that are colored by a range, all of these show that have it. Returns
    /// whether one shows something else now.
    bool agree(ViewClouds& clouds, const DisplaySettings& display);

    /// Values or what is shown of them have changed.
    void valuesChanged() noexcept { m_rangeNeeded = true; }
    bool rangeNeeded() const noexcept { return m_rangeNeeded; }
    /// Finds the range anew, of the values that are shown.
    void updateRange(ViewClouds& clouds, const DisplaySettings& display);
    /// Range that scalar colors are drawn over at present (world values of the attribute).
    std::pair<double, double> range() const noexcept { return m_range; }

private:
    /// Name of the attribute that the range is of; empty when no cloud is colored by one.
    static std::string scalarOf(const ViewClouds& clouds, const DisplaySettings& display);

    std::pair<double, double> m_range{0.0, 1.0};
    bool m_rangeNeeded = true;
    bool m_agreementNeeded = true;
};

}  // namespace punctum::render
