// SPDX-License-Identifier: MIT
#include "ui/window/HelpPages.h"

#include "ui/style/Icons.h"
#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QDialog>
#include <QDialogButtonBox>
#include <QGridLayout>
#include <QHBoxLayout>
#include <QLabel>
#include <QScreen>
#include <QVBoxLayout>

#include <oneapi/tbb/version.h>
#include <glm/detail/setup.hpp>

#include <algorithm>
#include <utility>
#include <vector>

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

/// What keys or hands do, in lines, under a title.
struct KeyGroup {
    QString title;
    std::vector<std::pair<QString, QString>> lines;
};

constexpr int kHelpColumns = 3;
constexpr std::size_t kTitleLines = 2;  ///< that a title takes, with the room above it

/// What no menu tells.
std::vector<KeyGroup> handGroups()
{
    return {
        {QObject::tr("In the view"),
         {{QObject::tr("Left drag"), QObject::tr("Turn the view about the pivot")},
          {QObject::tr("Right or middle drag"),
           QObject::tr("Move the view sideways, with what is under the mouse")},
          {QObject::tr("Wheel"), QObject::tr("Zoom to what is under the cursor")},
          {QObject::tr("Double-click or middle click"), QObject::tr("Make this point the pivot")},
          {QObject::tr("Click an end of the axes"), QObject::tr("Look from there; the middle: perspective or not")},
          {QObject::tr("Hold C"), QObject::tr("The points without the preview, or before the last edit")},
          {QObject::tr("Drop an attribute"), QObject::tr("Color the points by it")},
          {QObject::tr("Drop files or folders"), QObject::tr("Open them, anywhere on the window")}}},
        {QObject::tr("While a tool is on"),
         {{QObject::tr("Hold Space"), QObject::tr("Turn and move the view meanwhile")},
          {QObject::tr("Shift, Ctrl, both"), QObject::tr("Add to the selection, take away, keep what is in both")},
          {QObject::tr("Enter, double-click, right click"), QObject::tr("Finish a polygon, a line or an area")},
          {QObject::tr("Backspace"), QObject::tr("Take back the last corner or point")},
          {QObject::tr("Escape"), QObject::tr("Give up the shape, then the tool")},
          {QObject::tr("Wheel with the brush"), QObject::tr("Size of the brush")}}},
        {QObject::tr("In a section"),
         {{QObject::tr("Arrow keys"), QObject::tr("Walk by its width, with Shift by half")},
          {QObject::tr("Ctrl and wheel"), QObject::tr("Width of the section")},
          {QObject::tr("F"), QObject::tr("Show all of it")},
          {QObject::tr("Escape"), QObject::tr("Close it")}}},
        {QObject::tr("Saved Views"),
         {{QObject::tr("Alt+1 to Alt+9"), QObject::tr("Go to a saved view, in the order of the menu")}}}};
}

QLabel* keyLabel(const QString& text)
{
    auto* label = new QLabel(text);
    label->setFont(scaledFont(label->font(), 1.0, true));
    return label;
}

QLayout* groupLayout(const KeyGroup& group)
{
    auto* const grid = new QGridLayout;
    grid->setHorizontalSpacing(18);
    grid->setVerticalSpacing(5);
    auto* const title = dimLabel(group.title);
    title->setFont(scaledFont(title->font(), 1.0, true));
    grid->addWidget(title, 0, 0, 1, 2);
    int row = 1;
    for (const auto& [keys, what] : group.lines) {
        grid->addWidget(keyLabel(keys), row, 0, Qt::AlignTop);
        grid->addWidget(new QLabel(what), row++, 1, Qt::AlignTop);
    }
    grid->setColumnStretch(1, 1);
    return grid;
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

void showShortcutsPage(QWidget* parent, const std::vector<Menus::Shortcut>& shortcuts)
{
    std::vector<KeyGroup> groups = handGroups();
    for (const Menus::Shortcut& shortcut : shortcuts) {
        const QString title = shortcut.group.isEmpty() ? QObject::tr("Other keys") : shortcut.group;
        auto group =
            std::find_if(groups.begin(), groups.end(), [&](const KeyGroup& g) { return g.title == title; });
        if (group == groups.end()) group = groups.insert(groups.end(), {title, {}});
        group->lines.emplace_back(shortcut.keys, shortcut.what);
    }
    std::size_t lines = 0;
    for (const KeyGroup& group : groups) lines += group.lines.size() + kTitleLines;

    QDialog* dialog = makeDialog(parent, QObject::tr("Mouse and keyboard"));
    auto* const content = new QWidget;
    auto* const columns = new QHBoxLayout(content);
    columns->setContentsMargins(0, 0, 12, 0);
    columns->setSpacing(36);
    QVBoxLayout* column = nullptr;
    std::size_t inColumn = 0;
    for (const KeyGroup& group : groups) {
        const std::size_t own = group.lines.size() + kTitleLines;
        if (!column || (inColumn + own / 2 > lines / kHelpColumns && columns->count() < kHelpColumns)) {
            column = new QVBoxLayout;
            column->setSpacing(16);
            columns->addLayout(column);
            inColumn = 0;
        }
        column->addLayout(groupLayout(group));
        inColumn += own;
    }
    for (int k = 0; k < columns->count(); ++k)
        static_cast<QVBoxLayout*>(columns->itemAt(k)->layout())->addStretch(1);

    auto* const area = scrollColumn(content);
    area->setHorizontalScrollBarPolicy(Qt::ScrollBarAsNeeded);
    auto* const layout = static_cast<QVBoxLayout*>(dialog->layout());
    layout->addWidget(area, 1);
    finish(*dialog);
    const QSize room = parent->screen()->availableSize() * 0.94, wanted = content->sizeHint() + QSize(74, 130);
    dialog->resize(wanted.boundedTo(room));
}

}  // namespace punctum::ui
