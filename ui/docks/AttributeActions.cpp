// SPDX-License-Identifier: MIT
#include "ui/docks/AttributeActions.h"

#include "core/cloud/ScalarType.h"
#include "ui/basic/Text.h"
#include "ui/docks/AttributesDock.h"
#include "ui/docks/AttributesModel.h"
#include "ui/document/Workspace.h"

#include <QComboBox>
#include <QDialogButtonBox>
#include <QFormLayout>
#include <QInputDialog>
#include <QLineEdit>
#include <QMenu>
#include <QPushButton>

namespace punctum::ui
{

AttributeActions::AttributeActions(Workspace& workspace, AttributesModel& model, AttributesView& view,
                                   QObject* parent)
    : QObject(parent), m_workspace(workspace), m_model(model), m_view(view)
{
    m_view.setContextMenuPolicy(Qt::CustomContextMenu);
    connect(&m_view, &QWidget::customContextMenuRequested, this, [this](const QPoint& place) {
        if (!m_model.document() || m_model.document()->loading()) return;
        QMenu* const menu = makeMenu(m_view.indexAt(place));
        connect(menu, &QMenu::aboutToHide, menu, &QObject::deleteLater);
        menu->popup(m_view.viewport()->mapToGlobal(place));
    });
}

QMenu* AttributeActions::makeMenu(const QModelIndex& index)
{
    const QString name = index.data(AttributesModel::NameRole).toString();
    const Attribute* const attribute =
        m_model.document() && index.isValid() ? m_model.document()->findAttribute(name) : nullptr;
    auto* menu = new QMenu(&m_view);
    menu->setToolTipsVisible(true);
    menu->addAction(tr("&Add Attribute..."), this, &AttributeActions::askAdd);
    if (attribute == nullptr) return menu;
    QAction* const rename =
        menu->addAction(tr("&Rename %1...").arg(menuText(name)), this, [this, name] { askRename(name); });
    QAction* const remove = menu->addAction(tr("Re&move %1").arg(menuText(name)), this, [this, name] {
        run(tr("Remove %1").arg(name), {"remove", {{"attribute", name.toStdString()}}, nullptr});
    });
    rename->setEnabled(!attribute->standard && attribute->components == 1 &&
                       attribute->kind != AttributeKind::Opaque);
    remove->setEnabled(!attribute->standard);
    if (attribute->standard)
        for (QAction* action : {rename, remove})
            action->setToolTip(tr("%1 is a field of the LAS point format, and stays.").arg(name));
    return menu;
}

void AttributeActions::askAdd()
{
    auto* dialog = new QDialog(&m_view);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Add attribute"));
    auto* form = new QFormLayout(dialog);
    auto* name = new QLineEdit;
    auto* type = new QComboBox;
    auto* value = new QLineEdit(QStringLiteral("0"));
    for (int t = 0; t <= int(ScalarType::F64); ++t) type->addItem(toQString(std::string(nameOf(ScalarType(t)))));
    type->setCurrentText(toQString(std::string(nameOf(ScalarType::F32))));
    value->setToolTip(tr("A number, or an expression over attributes such as Z - 120"));
    form->addRow(tr("&Name"), name);
    form->addRow(tr("&Type"), type);
    form->addRow(tr("&Value"), value);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Ok | QDialogButtonBox::Cancel);
    buttons->button(QDialogButtonBox::Ok)->setText(tr("&Add"));
    form->addRow(buttons);
    connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::reject);
    connect(buttons, &QDialogButtonBox::accepted, dialog, [this, dialog, name, type, value] {
        const QString text = name->text().trimmed();
        if (text.isEmpty()) return name->setFocus();
        const QString mark = text.contains(QLatin1Char('"')) ? QStringLiteral("'") : QStringLiteral("\"");
        const QString rule = mark + text + mark + QStringLiteral(" = ") + value->text().trimmed();
        run(tr("Add %1").arg(text),
            {"set", {{"rule", rule.toStdString()}, {"new", type->currentText().toStdString()}}, nullptr});
        dialog->accept();
    });
    dialog->open();
}

void AttributeActions::askRename(const QString& name)
{
    auto* dialog = new QInputDialog(&m_view);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setWindowTitle(tr("Rename attribute"));
    dialog->setLabelText(tr("New name of %1").arg(name));
    dialog->setTextValue(name);
    dialog->setOkButtonText(tr("&Rename"));
    connect(dialog, &QInputDialog::textValueSelected, this, [this, name](const QString& text) {
        const QString to = text.trimmed();
        if (to == name) return;
        const bool shown = m_model.shown() == name;
        run(tr("Rename %1").arg(name),
            {"rename", {{"attribute", name.toStdString()}, {"to", to.toStdString()}}, nullptr}, [this, shown, to] {
                if (shown) emit shownRenamed(to);
            });
    });
    dialog->open();
}

void AttributeActions::run(const QString& title, const Recipe& recipe, std::function<void()> done)
{
    Document* const document = m_model.document();
    if (!document || document->loading()) return;
    m_workspace.edit(*document, title, recipe,
                     [this, title, done = std::move(done)](const JobInfo& info, const EditOutcome&) {
                         if (info.state == JobState::Failed)
                             m_workspace.say(MessageKind::Error, tr("%1: %2").arg(title, toQString(info.error)));
                         if (info.state == JobState::Finished && done) done();
                     });
}

}  // namespace punctum::ui
