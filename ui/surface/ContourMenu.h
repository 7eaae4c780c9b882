// SPDX-License-Identifier: MIT
#pragma once

#include <QObject>
#include <QString>

#include <map>

class QAction;
class QMenu;

namespace punctum::ui
{

class Menus;
class ViewSettings;

/// The menu by which a person chooses the contours of the ground surface: none, as suits the surface, or an
/// interval. Keeps ViewSettings::contourChoice(), and the view's contours to it. GUI thread only.
class ContourMenu final : public QObject
{
    Q_OBJECT
public:
    /// Adds it to `parent`. `settings` outlives it.
    ContourMenu(ViewSettings& settings, Menus& menus, QMenu& parent, QObject* owner);

    /// Of the surface that the view shows: from its low to its high ground, and in which unit (empty: not known).
    void setHeights(double range, const QString& unit);
    /// "Contours every 2 m"; empty where there are none.
    QString text() const;

signals:
    /// A person has chosen contours, and not none.
    void wanted();

private:
    void apply();
    QString lengthText(double length) const;

    ViewSettings& m_settings;
    std::map<double, QAction*> m_choices;
    double m_suitable = 0;  ///< 0: no surface is known
    QString m_unit;
};

}  // namespace punctum::ui
