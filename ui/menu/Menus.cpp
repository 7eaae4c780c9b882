// SPDX-License-Identifier: MIT
#include "ui/menu/Menus.h"

#include "ui/style/Icons.h"

#include <QActionGroup>
#include <QMainWindow>
#include <QMenu>
#include <QMenuBar>
#include <QToolBar>

#include <utility>

namespace punctum::ui
{

namespace
{

/// Properties of an action: the title of its menu, and its name for the help page.
constexpr char kGroup[] = "group", kLastingName[] = "lastingName";

QString withoutMarks(QString text)
{
    return text.remove(QLatin1Char('&')).remove(QStringLiteral("..."));
}

}  // namespace

Menus::Menus(QMainWindow& window) : QObject(&window), m_window(window), m_toolBar(window.addToolBar(tr("Tools")))
{
    m_toolBar->setObjectName(QStringLiteral("tools"));
    m_toolBar->setMovable(false);
    m_toolBar->setIconSize(QSize(20, 20));
    m_toolBar->setContextMenuPolicy(Qt::PreventContextMenu);
}

QMenu& Menus::addMenu(const QString& title)
{
    auto* menu = new QMenu(title, &m_window);
    m_window.menuBar()->insertMenu(m_before ? m_before->menuAction() : nullptr, menu);
    return *menu;
}

QAction* Menus::add(QMenu* menu, const QString& text, const QString& icon, const QList<QKeySequence>& keys,
                    const QString& tip, std::function<void()> act)
{
    auto* action = new QAction(text, &m_window);
    if (!icon.isEmpty()) action->setIcon(lineIcon(icon));
    action->setShortcuts(keys);
    QString hint = tip.isEmpty() ? withoutMarks(text) : tip;
    if (!keys.isEmpty()) hint += QStringLiteral(" (%1)").arg(keys.front().toString(QKeySequence::NativeText));
    action->setToolTip(hint);
    action->setIconVisibleInMenu(false);  // icons in the tool bar, words in the menus
    connect(action, &QAction::triggered, this, [act = std::move(act)] { act(); });
    if (menu) {
        menu->addAction(action);
        action->setProperty(kGroup, menu->title());
    }
    m_window.addAction(action);
    m_all.push_back(action);
    return action;
}

QAction* Menus::addTool(QMenu* menu, QActionGroup* group, int id, const QString& text, const QString& icon,
                        const QList<QKeySequence>& keys, const QString& tip, std::function<void(bool on)> toggled)
{
    QAction* const action = add(menu, text, icon, keys, tip, [] {});
    action->setCheckable(true);
    action->setData(id);
    group->addAction(action);
    group->setExclusionPolicy(QActionGroup::ExclusionPolicy::ExclusiveOptional);
    needsDocument(action);
    connect(action, &QAction::toggled, this, [this, toggled = std::move(toggled)](bool on) {
        toggled(on);
        emit viewWanted();
    });
    return action;
}

void Menus::needsDocument(QAction* action)
{
    m_needDocument.push_back(action);
    action->setEnabled(false);
}

void Menus::setDocumentOpen(bool open)
{
    for (QAction* action : m_needDocument) action->setEnabled(open);
}

void Menus::setLastingName(QAction& action, const QString& name)
{
    action.setProperty(kLastingName, name);
}

std::vector<Menus::Shortcut> Menus::shortcuts() const
{
    std::vector<Shortcut> list;
    for (const QAction* action : m_all) {
        if (action->shortcuts().isEmpty()) continue;
        QStringList keys;
        for (const QKeySequence& key : action->shortcuts()) keys << key.toString(QKeySequence::NativeText);
        const QVariant lasting = action->property(kLastingName);
        list.push_back({withoutMarks(action->property(kGroup).toString()), keys.join(tr(" or ")),
                        withoutMarks(lasting.isValid() ? lasting.toString() : action->text())});
    }
    return list;
}

}  // namespace punctum::ui
