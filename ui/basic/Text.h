// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"

#include <QString>

#include <cstdint>
#include <filesystem>
#include <string>

namespace punctum::ui
{

/// Numbers and names as the window shows them, by the user's locale (ui/basic/Numbers.h). Any thread.

/// "1,204": whole numbers with separators.
QString countText(std::uint64_t count);
/// "1,204 points", "1 point".
QString pointsText(std::uint64_t count);
/// Of what was computed and is no stored value. Up to seven significant digits, or as many as tell apart what lies
/// in a range of this width, without trailing zeros: "0.0251", "4,849.12", "1.2e-09".
QString numberText(double value, double width = 0.0);
/// The same as the program writes it, with a point and without separators.
QString plainNumber(double value, double width = 0.0);
/// A value of an attribute, exact: core/cloud/ValueText.h.
QString shownValue(const Attribute& attribute, const Value& value);
/// Of a point: "none" where its file lacks the attribute. Hold the cloud's mutex shared.
QString shownValueOf(const Attribute& attribute, PointIndex point, std::uint32_t component = 0);
/// A whole number in full.
QString valueText(const Value& value);
/// A coordinate with the decimals of the file's scale and offset: "637,012.24". A stored one is exact.
QString shownCoordinate(const CoordinateScale& coordinates, int axis, double value);
/// The same as the program writes it.
QString plainCoordinate(const CoordinateScale& coordinates, int axis, double value);
/// "603 kB", "2.1 GB".
QString bytesText(std::uint64_t bytes);

/// Several paths with line ends between them, as the list of recent files has them, in a few words: "a.laz" or
/// "a.laz and 3 more".
QString pathsText(const QString& paths);
/// Folder of the first of them.
QString folderOf(const QString& paths);

/// A name in the text of a menu entry or button, where a plain & would mark a key.
QString menuText(QString name);
/// A name in a window title, where a plain [*] would stand for "changed".
QString titleText(QString name);

/// Names of files are bytes. Those that are no UTF-8 are kept, too: each such byte is a lone surrogate from U+DC80
/// on, so that toPath() gives back just the file that was named.
QString toQString(const std::filesystem::path& path);
std::filesystem::path toPath(const QString& path);
/// The same for a path from a dialog or a drop of files, which have U+FFFD where a name is no UTF-8: the file that
/// is there and looks like that, where there is only one. Looks at the disk.
std::filesystem::path findPath(const QString& path);
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

}  // namespace punctum::ui
