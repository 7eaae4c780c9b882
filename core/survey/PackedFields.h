// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <cstdint>
#include <string>
#include <string_view>

namespace punctum
{

/// Fields of formats 0 to 5 that are packed in another way in formats 6 to 10, and those.
inline bool isClassicField(std::string_view name) noexcept
{
    return name == "Returns" || name == "Classes" || name == "ScanAngle";
}
inline bool isExtendedField(std::string_view name) noexcept
{
    return name == "Returns" || name == "Flags" || name == "Classification" || name == "ScanAngle";
}

/// Bytes 14 to 19 of point records: return numbers, flags, class and scan angle, packed in another way by point
/// formats 0 to 5 (LAS 1.4 R15, table 7) than by 6 to 10 (table 13).
struct ClassicFields {
    std::uint8_t* returns = nullptr;  ///< byte 14 of formats 0-5
    std::uint8_t* classes = nullptr;  ///< byte 15
    std::int8_t* angle = nullptr;     ///< byte 16, degrees
};
struct ExtendedFields {
    std::uint8_t* returns = nullptr;  ///< byte 14 of formats 6-10
    std::uint8_t* flags = nullptr;    ///< byte 15
    std::uint8_t* classification = nullptr;
    std::int16_t* angle = nullptr;  ///< steps of 0.006 degrees
};

/// Of `count` points, so that toClassic() gives the same bytes back.
void toExtended(const ClassicFields& from, const ExtendedFields& to, std::size_t count) noexcept;

/// How many points have what formats 0 to 5 have no place for.
struct ClassicMisfits {
    PointIndex flags = 0;    ///< Overlap or ScannerChannel
    PointIndex returns = 0;  ///< return numbers above 7
    PointIndex angles = 0;   ///< no whole number of degrees, or beyond a byte
    PointIndex classes = 0;  ///< above 31

    void include(const ClassicMisfits& other) noexcept;
    /// "12 points have a return number above 7"; empty where all but classes fits.
    std::string text() const;
};

/// The way back. Classes above 31 become 1 there: whoever writes them does so from a column of their own.
ClassicMisfits toClassic(const ExtendedFields& from, const ClassicFields& to, std::size_t count) noexcept;

}  // namespace punctum
