// SPDX-License-Identifier: MIT
#include "ui/view/StartPage.h"

#include "ui/basic/Text.h"
#include "ui/style/Icons.h"
#include "ui/style/Theme.h"

#include <QDir>
#include <QHBoxLayout>
#include <QLabel>
#include <QPushButton>
#include <QVBoxLayout>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr qsizetype kMostRecent = 6;
constexpr int kRecentWidth = 420;  // px

// It lies on the view's background, which is dark in every appearance.
const QString kTextColor = QStringLiteral("#e3e5e8");
const QString kDimColor = QStringLiteral("#98a0a8");

QLabel* label(const QString& text, const QString& color)
{
    auto* const made = new QLabel(text);
    made->setTextFormat(Qt::PlainText);
    made->setAlignment(Qt::AlignCenter);
    made->setStyleSheet(QStringLiteral("color: %1;").arg(color));
    return made;
}

QString shortFolder(const QString& folder)
{
    const QString home = QDir::homePath();
    return folder == home || folder.startsWith(home + QLatin1Char('/')) ? QLatin1Char('~') + folder.mid(home.size())
                                                                        : folder;
}

}  // namespace

StartPage::StartPage(QWidget* parent)
    : QWidget(parent), m_recent(new QWidget), m_recentColumn(new QVBoxLayout(m_recent))
{
    auto* icon = new QLabel;
    icon->setPixmap(lineIcon(QStringLiteral("cloud"), QColor(120, 128, 138)).pixmap(72, 72));
    icon->setAlignment(Qt::AlignCenter);
    auto* title = label(tr("Drop LAS or LAZ files here"), kTextColor);
    title->setFont(scaledFont(title->font(), 1.7, true));
    title->setWordWrap(true);
    auto* detail =
        label(tr("Files, or whole folders of them. They open as they are: nothing is converted."), kDimColor);
    detail->setWordWrap(true);
    auto* open = new QPushButton(tr("Open..."));
    open->setProperty("primary", true);
    open->setToolTip(tr("Choose files (Ctrl+O)"));
    auto* folder = new QPushButton(tr("Open Folder..."));
    folder->setToolTip(tr("Open all LAS and LAZ files of a folder and of those in it (Ctrl+Shift+O)"));
    connect(open, &QPushButton::clicked, this, &StartPage::openRequested);
    connect(folder, &QPushButton::clicked, this, &StartPage::folderRequested);
    auto* buttons = new QHBoxLayout;
    buttons->addStretch(1);
    for (QPushButton* button : {open, folder}) {
        button->setCursor(Qt::PointingHandCursor);
        buttons->addWidget(button);
    }
    buttons->addStretch(1);

    m_recentColumn->setContentsMargins(0, 0, 0, 0);
    m_recentColumn->setSpacing(0);
    m_recent->setMaximumWidth(kRecentWidth);
    auto* column = new QVBoxLayout(this);
    column->setSpacing(10);
    column->addStretch(4);
    column->addWidget(icon);
    column->addSpacing(6);
    column->addWidget(title);
    column->addWidget(detail);
    column->addSpacing(14);
    column->addLayout(buttons);
    column->addSpacing(18);
    column->addWidget(m_recent, 0, Qt::AlignHCenter);
    column->addStretch(5);
    setRecentFiles({});
}

void StartPage::setRecentFiles(const QStringList& paths)
{
    while (QLayoutItem* const item = m_recentColumn->takeAt(0)) {
        delete item->widget();
        delete item;
    }
    m_recent->setVisible(!paths.isEmpty());
    if (paths.isEmpty()) return;
    m_recentColumn->addWidget(label(tr("Open before"), kDimColor));
    m_recentColumn->addSpacing(4);
    for (const QString& path : paths.mid(0, kMostRecent)) {
        const QString name = pathsText(path), folder = shortFolder(folderOf(path));
        auto* const button = new QPushButton;
        button->setObjectName(QStringLiteral("recent"));
        button->setStyleSheet(
            QStringLiteral("QPushButton { background: transparent; border: 1px solid transparent; "
                           "padding: 5px 12px; color: %1; text-align: left; }"
                           "QPushButton:hover { background: rgba(255, 255, 255, 22); }"
                           "QPushButton:focus { border-color: #58a6ff; }")
                .arg(kTextColor));
        const QFontMetrics metrics(button->font());
        const int room = kRecentWidth - 30;
        const QString shownName = metrics.elidedText(name, Qt::ElideMiddle, room * 2 / 3);
        const QString rest =
            metrics.elidedText(folder, Qt::ElideLeft,
                               std::max(60, room - metrics.horizontalAdvance(shownName + QStringLiteral("  ·  "))));
        QString text = shownName + QStringLiteral("  ·  ") + rest;
        button->setText(text.replace(QLatin1Char('&'), QStringLiteral("&&")));
        button->setToolTip(path);
        button->setCursor(Qt::PointingHandCursor);
        connect(button, &QPushButton::clicked, this, [this, path] { emit recentChosen(path); });
        m_recentColumn->addWidget(button);
    }
}

}  // namespace punctum::ui
