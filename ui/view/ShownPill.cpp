// SPDX-License-Identifier: MIT
#include "ui/view/ShownPill.h"

#include "ui/view/ShownCount.h"
#include "ui/view/ViewScope.h"
#include "ui/view/Viewport.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>

namespace punctum::ui
{

ShownPill::ShownPill(Viewport& viewport, ViewScope& scope)
    : QFrame(&viewport), m_viewport(viewport), m_text(new QLabel), m_showAll(new QPushButton(tr("Show all")))
{
    setObjectName(QStringLiteral("shown"));
    // It lies on the picture, as the title does: dark in every appearance.
    setStyleSheet(QStringLiteral(
        "QFrame#shown { background: rgba(12, 14, 16, 200); border: 1px solid #d9a441; border-radius: 8px; }"
        "QFrame#shown QLabel { color: #eceef1; background: transparent; }"
        "QFrame#shown QPushButton { color: #79b8ff; background: transparent; border: none; padding: 2px 4px; }"
        "QFrame#shown QPushButton:hover { color: #ffffff; }"
        "QFrame#shown QPushButton:focus { text-decoration: underline; }"));
    m_text->setTextFormat(Qt::PlainText);
    m_showAll->setCursor(Qt::PointingHandCursor);
    m_showAll->setFocusPolicy(Qt::TabFocus);
    m_showAll->setToolTip(tr("Takes the filter, the box and the cuts away, and shows all classes and files"));
    auto* row = new QHBoxLayout(this);
    row->setContentsMargins(11, 4, 9, 4);
    row->setSpacing(8);
    row->addWidget(m_text);
    row->addWidget(m_showAll);
    connect(m_showAll, &QPushButton::clicked, &scope, &ViewScope::showAll);
    viewport.setUnderTitle(this);
    take({});
}

QString ShownPill::text() const
{
    return isHidden() ? QString() : m_text->text();
}

void ShownPill::take(const ShownState& state)
{
    const QString text = state.text();
    m_text->setText(text);
    m_text->setToolTip(state.reasons.isEmpty()
                           ? tr("Select > Restore All Deleted brings them back; saving leaves them out.")
                           : QString());
    m_showAll->setVisible(!state.reasons.isEmpty());
    setVisible(!text.isEmpty());
    adjustSize();
    m_viewport.updateTitle();
}

}  // namespace punctum::ui
