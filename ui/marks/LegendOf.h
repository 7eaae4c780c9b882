// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/DisplaySettings.h"
#include "ui/marks/Legend.h"

#include <QString>

#include <utility>

namespace punctum::ui
{

class Document;

/// The legend of a picture that shows `attribute` of a document, drawn over `range` where it is a quantity. GUI
/// thread. Classes and values are those that occur, without hidden classes, and none until they have been counted.
Legend legendOf(const Document& document, const QString& attribute, std::pair<double, double> range,
                const render::DisplaySettings& display);

}  // namespace punctum::ui
