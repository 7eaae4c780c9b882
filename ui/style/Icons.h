// SPDX-License-Identifier: MIT
#pragma once

#include <QColor>
#include <QIcon>
#include <QPainterPath>
#include <QString>

#include <vector>

namespace punctum::ui
{

/// The line icons of resources/icons: SVG files that keep to a small part of SVG (path with M L H V C Q Z, circle,
/// rect; fill none or currentColor), drawn here so that no SVG plugin is needed. GUI thread.

struct IconShape {
    QPainterPath path;  ///< on a square of 24 x 24
    bool filled = false;
};

/// The shapes of resources/icons/NAME.svg; empty when there is none.
std::vector<IconShape> iconShapes(const QString& name);
/// Reads the part of SVG named above; empty when the text is not of that kind.
std::vector<IconShape> readSvgShapes(const QByteArray& svg);

/// An icon that takes its color from the palette when it is painted, so that it fits a dark and a light window.
QIcon lineIcon(const QString& name);
/// The same in a fixed color.
QIcon lineIcon(const QString& name, const QColor& color);
/// The program's own.
QIcon programIcon();

}  // namespace punctum::ui
