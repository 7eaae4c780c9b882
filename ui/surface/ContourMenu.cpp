// SPDX-License-Identifier: MIT
#include "ui/surface/ContourMenu.h"

#include "ui/basic/Text.h"
#include "ui/menu/Menus.h"
#include "ui/view/ViewSettings.h"

#include <QActionGroup>
#include <QMenu>

#include <array>

namespace punctum::ui
{

namespace
{

constexpr std::array kIntervals{0.25, 0.5, 1.0, 2.0, 5.0, 10.0};  // units of Z

}  // namespace

ContourMenu::ContourMenu(ViewSettings& settings, Menus& menus, QMenu& parent, QObject* owner)
    : QObject(owner), m_settings(settings)
{
    QMenu* const menu = parent.addMenu(tr("Co&ntours"));
    menu->setToolTipsVisible(true);
    auto* const group = new QActionGroup(this);
    const auto add = [&](double choice, const QString& text, const QString& tip) {
        QAction* const action = menus.add(menu, text, {}, {}, tip, [this, choice] {
            m_settings.setContourChoice(choice);
            if (choice != ViewSettings::kNoContours) emit wanted();
        });
        action->setCheckable(true);
        group->addAction(action);
        m_choices[choice] = action;
    };
    add(ViewSettings::kNoContours, tr("&None"), tr("The ground surface without lines of equal height"));
    add(ViewSettings::kSuitableContours, tr("&Automatic"), tr("About twenty between its low and its high ground"));
    menu->addSeparator();
    for (const double interval : kIntervals) add(interval, {}, tr("Lines of equal height, so far apart in height"));
    connect(&m_settings, &ViewSettings::changed, this, &ContourMenu::apply);
    apply();
}

void ContourMenu::setHeights(double range, const QString& unit)
{
    m_suitable = render::suitableInterval(range);
    m_unit = unit;
    apply();
}

void ContourMenu::apply()
{
    const double choice = m_settings.contourChoice();
    m_settings.setContours(choice == ViewSettings::kSuitableContours ? m_suitable : choice);
    for (const auto& [interval, action] : m_choices) {
        if (interval > 0) action->setText(lengthText(interval));
        action->setChecked(interval == choice);
    }
    m_choices[ViewSettings::kSuitableContours]->setText(
        m_suitable > 0 ? tr("&Automatic (%1)").arg(lengthText(m_suitable)) : tr("&Automatic"));
}

QString ContourMenu::text() const
{
    const render::SurfaceContours& contours = m_settings.display().contours;
    return contours.on() ? tr("Contours every %1").arg(lengthText(contours.interval)) : QString();
}

QString ContourMenu::lengthText(double length) const
{
    return m_unit.isEmpty() ? numberText(length) : numberText(length) + QLatin1Char(' ') + m_unit;
}

}  // namespace punctum::ui
