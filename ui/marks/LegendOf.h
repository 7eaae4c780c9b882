// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"
#include "core/cloud/DistinctValues.h"
#include "render/progressive/DisplaySettings.h"
#include "ui/marks/Legend.h"

#include <QString>

#include <array>
#include <cstdint>
#include <utility>

namespace punctum::ui
{

class Document;

/// What is known of the values that an attribute of a picture has, beside the range that it is drawn over.
struct LegendFacts {
    const std::array<std::uint64_t, 256>* classCounts = nullptr;  ///< null: not counted yet
    const DistinctValues* values = nullptr;                       ///< null: not known yet
};

/// The legend of a picture that shows this attribute, drawn over `range` where it is a quantity. Classes and values
/// are those that occur, without hidden classes. Any thread.
Legend legendOf(const Attribute& attribute, const LegendFacts& facts, std::pair<double, double> range,
                const render::DisplaySettings& display);

/// The legend of a picture that shows `attribute` of a document, drawn over `range` where it is a quantity. GUI
/// thread. Classes and values are those that occur, without hidden classes, and none until they have been counted.
Legend legendOf(const Document& document, const QString& attribute, std::pair<double, double> range,
                const render::DisplaySettings& display);

}  // namespace punctum::ui
