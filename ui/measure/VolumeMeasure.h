// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"
#include "core/measure/Measurement.h"
#include "core/surface/Volume.h"

#include <bitset>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace punctum
{
class PointCloud;
class Progress;
}  // namespace punctum

namespace punctum::ui
{

/// How a volume is to be measured, as a person chooses it.
struct VolumeWish {
    enum class Points {
        Automatic,  ///< ground where the area has some, else what is shown
        Ground,     ///< the classes that are ground
        Shown,      ///< all points that the view shows
    };
    VolumeBase base = VolumeBase::Outline;  ///< not another surface
    double height = 0;                      ///< of VolumeBase::Height
    Points points = Points::Automatic;
    friend bool operator==(const VolumeWish&, const VolumeWish&) = default;
};

/// Which points are ground, and which are shown, at the moment of measuring.
struct VolumeScope {
    std::bitset<256> ground{4};
    Visibility visibility{};
};

/// A volume, and of which points' surface it is.
struct MeasuredVolume {
    Volume volume;
    bool ground = false;  ///< of those classes; else of what is shown
    std::bitset<256> classes{};
};

/// Within the polygon of these points seen from above. In a job; throws Error and Cancelled.
MeasuredVolume measureVolume(const PointCloud& cloud, const std::vector<MeasuredPoint>& corners,
                             const VolumeWish& wish, const VolumeScope& scope, Progress& progress);

/// What a measurement tells of it: figures, the net volume first, and the rest in words.
std::vector<Quantity> quantitiesOf(const MeasuredVolume& found);
std::vector<std::pair<std::string, std::string>> factsOf(const MeasuredVolume& found, const VolumeWish& wish);

}  // namespace punctum::ui
