// SPDX-License-Identifier: MIT
#include "ui/process/ClassesField.h"

#include "core/process/Values.h"
#include "render/color/ColorMap.h"
#include "ui/basic/Text.h"
#include "ui/document/Document.h"
#include "ui/style/Swatch.h"
#include "ui/style/Theme.h"

#include <QAction>
#include <QHBoxLayout>
#include <QKeyEvent>
#include <QLineEdit>
#include <QMenu>
#include <QMouseEvent>
#include <QToolButton>

namespace punctum::ui
{

namespace
{

constexpr unsigned kUsualClasses = 19;  ///< 0 to 18: those that the standard names

/// A menu of check marks that stays open while they are set.
class CheckMenu final : public QMenu
{
public:
    using QMenu::QMenu;

protected:
    void mouseReleaseEvent(QMouseEvent* event) override
    {
        if (!toggle(actionAt(event->pos()))) QMenu::mouseReleaseEvent(event);
    }
    void keyPressEvent(QKeyEvent* event) override
    {
        if (event->key() != Qt::Key_Space || !toggle(activeAction())) QMenu::keyPressEvent(event);
    }

private:
    static bool toggle(QAction* action)
    {
        if (action == nullptr || !action->isCheckable() || !action->isEnabled()) return false;
        action->trigger();
        return true;
    }
};

}  // namespace

QString classListText(const std::bitset<256>& classes)
{
    QStringList parts;
    for (unsigned first = 0; first < classes.size(); ++first) {
        if (!classes[first]) continue;
        unsigned last = first;
        while (last + 1 < classes.size() && classes[last + 1]) ++last;
        if (last > first + 1)
            parts << QStringLiteral("%1-%2").arg(first).arg(last);
        else
            for (unsigned code = first; code <= last; ++code) parts << QString::number(code);
        first = last;
    }
    return parts.isEmpty() ? QStringLiteral("none") : parts.join(QStringLiteral(", "));
}

ClassesField::ClassesField(QWidget* parent) : QWidget(parent), m_edit(new QLineEdit), m_button(new QToolButton)
{
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(0, 0, 0, 0);
    row->setSpacing(4);
    row->addWidget(m_edit, 1);
    row->addWidget(m_button);
    setFocusProxy(m_edit);
    m_edit->setPlaceholderText(tr("2, 8-9"));
    m_edit->setMinimumWidth(40);
    m_button->setArrowType(Qt::DownArrow);
    m_button->setStyleSheet(QStringLiteral("QToolButton::menu-indicator { image: none; }"));  // one arrow will do
    m_button->setPopupMode(QToolButton::InstantPopup);
    m_button->setFocusPolicy(Qt::StrongFocus);
    m_button->setAccessibleName(tr("Choose classes"));
    m_button->setToolTip(tr("Choose classes from a list"));
    m_button->setFixedHeight(kFieldHeight);
    auto* menu = new CheckMenu(m_button);
    m_button->setMenu(menu);
    connect(menu, &QMenu::aboutToShow, this, &ClassesField::fillMenu);
    connect(m_edit, &QLineEdit::textChanged, this, &ClassesField::changed);
    connect(m_edit, &QLineEdit::returnPressed, this, &ClassesField::returnPressed);
}

void ClassesField::setDocument(Document* document)
{
    m_document = document;
}

QString ClassesField::text() const
{
    return m_edit->text().trimmed();
}

void ClassesField::setText(const QString& text)
{
    m_edit->setText(text);
}

std::optional<std::bitset<256>> ClassesField::classes() const
{
    return parseClasses(text().toStdString());
}

void ClassesField::setClasses(const std::bitset<256>& classes)
{
    setText(classListText(classes));
}

void ClassesField::fillMenu()
{
    QMenu* const menu = m_button->menu();
    menu->clear();
    const std::bitset<256> chosen = classes().value_or(std::bitset<256>());
    const auto add = [&](unsigned code, const QString& text) {
        QAction* action = menu->addAction(swatchIcon(render::asprsClasses()[code].color), text);
        action->setCheckable(true);
        action->setChecked(chosen[code]);
        connect(action, &QAction::toggled, this, [this, code](bool on) {
            std::bitset<256> now = classes().value_or(std::bitset<256>());
            now[code] = on;
            setClasses(now);
        });
    };
    const auto counts = m_document ? m_document->classCounts() : std::nullopt;
    std::bitset<256> listed;
    if (counts)
        for (unsigned code = 0; code < counts->size(); ++code)
            if ((*counts)[code] != 0 || chosen[code]) {
                add(code, QStringLiteral("%1   %2").arg(menuText(classText(code)), countText((*counts)[code])));
                listed.set(code);
            }
    if (listed.any()) menu->addSeparator();
    for (unsigned code = 0; code < kUsualClasses; ++code)
        if (!listed[code]) add(code, menuText(classText(code)));
}

}  // namespace punctum::ui
