// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/SourceFile.h"

#include <optional>
#include <string>
#include <vector>

namespace punctum::las
{

/// What numbers of the header and of records mean, in words, for reports and for the window. Any thread.

/// A text of the header up to the first NUL, as UTF-8, without blanks at its end.
template <std::size_t N>
std::string headerText(const Header& header, at::Field<at::Text<N>> field);

/// The project's id as people write it, "8D1F0C2E-...": empty when it is all zeros.
std::string guidText(const Header& header);
/// The day of creation as "2024-05-17"; empty when the header says none that can be.
std::string creationText(const Header& header);
/// What each bit of the global encoding says, and what its absence does where that matters; a phrase each.
std::vector<std::string> encodingWords(const Header& header);
/// The day of an adjusted standard GPS time (seconds since 2011-09-14 01:46:40): "2012-07-11"; empty where it
/// cannot be one.
std::string gpsDay(double adjusted);

/// The same of a time of a file, by its own clock; empty for seconds of a week.
std::string gpsDay(const Header& header, double time);

/// Units of the coordinates: "m", "m, heights in ftUS", "deg, heights in m (nothing is stated, it looks like it)",
/// "not known".
std::string unitsText(const CoordinateUnits& units);

/// What a record is for, where that is known ("GeoTIFF keys"), else its own description.
std::string recordWords(const Vlr& record);

}  // namespace punctum::las
