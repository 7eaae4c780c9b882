// SPDX-License-Identifier: MIT
#include "ui/HelpPages.h"

#include "ui/style/Icons.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QDialog>
#include <QDialogButtonBox>
#include <QGridLayout>
#include <QLabel>
#include <QVBoxLayout>

#include <oneapi/tbb/version.h>
#include <glm/detail/setup.hpp>

#include <utility>

namespace punctum::ui
{

namespace
{

QDialog* makeDialog(QWidget* parent, const QString& title)
{
    auto* dialog = new QDialog(parent);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(title);
    auto* column = new QVBoxLayout(dialog);
    column->setContentsMargins(24, 22, 24, 16);
    column->setSpacing(12);
    return dialog;
}

void finish(QDialog& dialog)
{
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    QObject::connect(buttons, &QDialogButtonBox::rejected, &dialog, &QDialog::close);
    dialog.layout()->addWidget(buttons);
    dialog.show();
}

QLabel* keyLabel(const QString& text)
{
    auto* label = new QLabel(text);
    label->setFont(scaledFont(label->font(), 1.0, true));
    return label;
}

}  // namespace

void showAboutPage(QWidget* parent, const QString& backend, bool openGlView)
{
    QDialog* dialog = makeDialog(parent, QObject::tr("About Punctum"));
    auto* column = static_cast<QVBoxLayout*>(dialog->layout());
    auto* icon = new QLabel;
    icon->setPixmap(programIcon().pixmap(64, 64));
    auto* name = new QLabel(QObject::tr("Punctum %1").arg(QStringLiteral(PUNCTUM_VERSION)));
    name->setFont(scaledFont(name->font(), 1.6, true));
    column->addWidget(icon);
    column->addWidget(name);
    column->addWidget(
        dimLabel(QObject::tr("Look at, classify, process and edit laser scans (LAS/LAZ).\nMIT License.")));
    auto* parts = new QLabel(
        QObject::tr("Qt %1\noneTBB %2\nGLM %3\nLASzip, PCL, libepoxy\nPoints drawn by: %4\nView: %5")
            .arg(QLatin1String(qVersion()), QLatin1String(TBB_VERSION_STRING),
                 QStringLiteral("%1.%2.%3").arg(GLM_VERSION_MAJOR).arg(GLM_VERSION_MINOR).arg(GLM_VERSION_PATCH),
                 backend, openGlView ? QObject::tr("OpenGL") : QObject::tr("without OpenGL")));
    parts->setTextInteractionFlags(Qt::TextSelectableByMouse);
    column->addWidget(parts);
    finish(*dialog);
}

void showShortcutsPage(QWidget* parent, const std::vector<MainMenu::Shortcut>& shortcuts)
{
    QDialog* dialog = makeDialog(parent, QObject::tr("Mouse and keyboard"));
    auto* column = static_cast<QVBoxLayout*>(dialog->layout());
    const std::pair<QString, QString> mouse[] = {
        {QObject::tr("Left drag"), QObject::tr("Turn the view about the pivot")},
        {QObject::tr("Right or middle drag"), QObject::tr("Move the view sideways, with what is under the mouse")},
        {QObject::tr("Wheel"), QObject::tr("Zoom to what is under the cursor")},
        {QObject::tr("Double-click or middle click"), QObject::tr("Make this point the pivot")},
        {QObject::tr("Arrow keys"), QObject::tr("Turn the view; walk the section that is open")},
        {QObject::tr("Ctrl and arrow keys"), QObject::tr("Move the view sideways")},
        {QObject::tr("Ctrl++ and Ctrl+-, page up and down"), QObject::tr("Zoom in and out")},
        {QObject::tr("Ctrl and wheel over a section"), QObject::tr("Width of the section")},
        {QObject::tr("Drop an attribute"), QObject::tr("Color the points by it")},
        {QObject::tr("Drop files"), QObject::tr("Open them")},
    };
    auto* grid = new QGridLayout;
    grid->setHorizontalSpacing(28);
    grid->setVerticalSpacing(6);
    int row = 0;
    for (const auto& [hand, what] : mouse) {
        grid->addWidget(keyLabel(hand), row, 0);
        grid->addWidget(new QLabel(what), row++, 1);
    }
    grid->setRowMinimumHeight(row++, 10);
    const int half = int((shortcuts.size() + 1) / 2);
    for (int i = 0; i < int(shortcuts.size()); ++i) {
        const MainMenu::Shortcut& shortcut = shortcuts[std::size_t(i)];
        const int column0 = i < half ? 0 : 2;
        grid->addWidget(keyLabel(shortcut.keys), row + i % half, column0);
        grid->addWidget(new QLabel(shortcut.what), row + i % half, column0 + 1);
    }
    column->addLayout(grid);
    finish(*dialog);
}

}  // namespace punctum::ui
