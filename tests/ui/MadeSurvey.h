// SPDX-License-Identifier: MIT
#pragma once

#include <QString>

namespace punctum::ui::test
{

/// What tests of the window open: as an old airborne survey is, LAS 1.2, point format 3, compressed, 110,000 points
/// over 1,177 by 563 units, heights 406 to 521, ground (class 2, about a quarter) under what nobody has classified
/// (class 1), 8 bits of color. Made once by each program that asks for it; the same everywhere.
QString surveyFile();
inline const QString kSurvey = QStringLiteral("survey.laz");  ///< its name

/// The same, of so many points, to another place; `east`: so many units from there.
void writeSurvey(const QString& path, std::uint32_t points, double east = 0.0);

}  // namespace punctum::ui::test
