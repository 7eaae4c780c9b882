// SPDX-License-Identifier: MIT
#include "ui/view/MessageArea.h"

#include "ui/style/Icons.h"
#include "ui/style/Theme.h"

#include <QHBoxLayout>
#include <QLabel>
#include <QTimer>
#include <QToolButton>
#include <QVBoxLayout>

namespace punctum::ui
{

namespace
{
constexpr int kMostBars = 4;
constexpr int kNewsLast = 6000;       // ms
constexpr int kWarningsLast = 15000;  // ms
}  // namespace

MessageArea::MessageArea(QWidget* parent) : QWidget(parent)
{
    m_column = new QVBoxLayout(this);
    m_column->setContentsMargins(0, 0, 0, 0);
    m_column->setSpacing(6);
    hide();
}

void MessageArea::add(MessageKind kind, const QString& sentence, const QString& details, const QObject* about)
{
    if (sentence.isEmpty()) return;
    // The same sentence twice says no more than once.
    for (QFrame* old : findChildren<QFrame*>(QStringLiteral("message"), Qt::FindDirectChildrenOnly))
        if (old->property("sentence").toString() == sentence) remove(old);
    const auto bars = findChildren<QFrame*>(QStringLiteral("message"), Qt::FindDirectChildrenOnly);
    if (bars.size() >= kMostBars) remove(bars.front());

    const ThemeColors& colors = themeColors();
    const QColor accent = kind == MessageKind::Error     ? colors.error
                          : kind == MessageKind::Warning ? colors.warning
                                                         : colors.good;
    const QString icon = kind == MessageKind::Error     ? QStringLiteral("error")
                         : kind == MessageKind::Warning ? QStringLiteral("warning")
                                                        : QStringLiteral("check");
    auto* bar = new QFrame(this);
    bar->setObjectName(QStringLiteral("message"));
    bar->setProperty("sentence", sentence);
    bar->setStyleSheet(
        QStringLiteral("QFrame#message { background: %1; border: 1px solid %2; border-left: 3px solid "
                       "%3; border-radius: 7px; }")
            .arg(colors.raised.name(), colors.border.name(), accent.name()));
    auto* mark = new QLabel;
    mark->setPixmap(lineIcon(icon, accent).pixmap(20, 20));
    auto* text = new QLabel(sentence);
    text->setTextFormat(Qt::PlainText);
    text->setWordWrap(true);
    text->setTextInteractionFlags(Qt::TextSelectableByMouse);
    auto* close = new QToolButton;
    close->setIcon(lineIcon(QStringLiteral("close")));
    close->setIconSize(QSize(14, 14));
    close->setToolTip(tr("Close this message"));
    close->setAccessibleName(tr("Close this message"));
    connect(close, &QToolButton::clicked, this, [this, bar] { remove(bar); });

    auto* row = new QHBoxLayout(bar);
    row->setContentsMargins(12, 7, 7, 7);
    row->setSpacing(10);
    row->addWidget(mark, 0, Qt::AlignTop);
    row->addWidget(text, 1);
    if (!details.isEmpty()) {
        auto* more = new QToolButton;
        more->setObjectName(QStringLiteral("details"));
        more->setText(tr("Details"));
        more->setToolTip(tr("Show all that there is to say"));
        connect(more, &QToolButton::clicked, this, [this, details] { emit detailsWanted(details); });
        row->addWidget(more, 0, Qt::AlignTop);
    }
    row->addWidget(close, 0, Qt::AlignTop);
    m_column->addWidget(bar);
    if (kind != MessageKind::Error)
        QTimer::singleShot(kind == MessageKind::Info && details.isEmpty() ? kNewsLast : kWarningsLast, bar,
                           [this, bar] { remove(bar); });
    if (about) connect(about, &QObject::destroyed, bar, [this, bar] { remove(bar); });
    show();
    raise();
    emit resized();
}

QStringList MessageArea::sentences() const
{
    QStringList list;
    for (const QFrame* bar : findChildren<QFrame*>(QStringLiteral("message"), Qt::FindDirectChildrenOnly))
        list << bar->property("sentence").toString();
    return list;
}

int MessageArea::heightForWidth(int width) const
{
    return m_column->heightForWidth(width);
}

void MessageArea::clear()
{
    for (QFrame* bar : findChildren<QFrame*>(QStringLiteral("message"), Qt::FindDirectChildrenOnly)) remove(bar);
}

void MessageArea::remove(QFrame* bar)
{
    m_column->removeWidget(bar);
    bar->setObjectName(QStringLiteral("removed"));
    bar->hide();
    bar->deleteLater();
    setVisible(!sentences().isEmpty());
    emit resized();
}

}  // namespace punctum::ui
