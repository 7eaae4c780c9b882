// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"

#include <QString>

#include <cstdint>
#include <filesystem>
#include <string>

namespace punctum::ui
{

struct PickedPoint;

/// Numbers and names as the window shows them. Any thread.

/// "1,204": whole numbers with separators.
QString countText(std::uint64_t count);
/// "1,204 points", "1 point".
QString pointsText(std::uint64_t count);
/// Up to seven significant digits, without trailing zeros: "0.0251", "4,849.12", "1.2e-09".
QString numberText(double value);
/// An attribute's value: whole numbers in full, others as numberText().
QString valueText(const Value& value);
/// A coordinate with the decimals that its scale (the file's resolution) makes sense of: "637,012.24".
QString coordinateText(double value, double scale);
/// "603 kB", "2.1 GB".
QString bytesText(std::uint64_t bytes);

QString toQString(const std::filesystem::path& path);
std::filesystem::path toPath(const QString& path);
inline QString toQString(std::string_view text)
{
    return QString::fromUtf8(text.data(), qsizetype(text.size()));
}
inline QString toQString(const std::string& text)
{
    return QString::fromStdString(text);
}

/// "6 Building".
QString classText(unsigned code);
/// What the status bar says of the point under the cursor: its place, class, and value of what is shown.
QString readOutText(const PickedPoint& point);

}  // namespace punctum::ui
