// SPDX-License-Identifier: MIT
#include "ui/window/SaveDialogs.h"

#include "ui/style/Icons.h"
#include "ui/style/Theme.h"

#include <QApplication>
#include <QClipboard>
#include <QDialog>
#include <QDialogButtonBox>
#include <QFontDatabase>
#include <QMessageBox>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QVBoxLayout>

#include <algorithm>

namespace punctum::ui
{

namespace
{
constexpr int kColumns = 96;  ///< characters that are seen at once
constexpr int kMostLines = 32;

/// The program's own, in the colors of the window.
void giveSign(QMessageBox& box)
{
    box.setIconPixmap(lineIcon(QStringLiteral("warning"), themeColors().warning).pixmap(32, 32));
}

}  // namespace

void showReport(QWidget* parent, const QString& title, const QString& text)
{
    auto* dialog = new QDialog(parent);
    dialog->setAttribute(Qt::WA_DeleteOnClose);
    dialog->setObjectName(QStringLiteral("report"));
    dialog->setWindowTitle(title);
    auto* lines = new QPlainTextEdit(text);
    lines->setReadOnly(true);
    lines->setLineWrapMode(QPlainTextEdit::NoWrap);
    lines->setFont(QFontDatabase::systemFont(QFontDatabase::FixedFont));
    lines->setAccessibleName(title);
    const QFontMetrics metrics(lines->font());
    const auto shown = int(std::min<qsizetype>(kMostLines, text.count(QLatin1Char('\n')) + 2));
    lines->setMinimumSize(metrics.averageCharWidth() * kColumns / 2, metrics.lineSpacing() * 8);
    auto* buttons = new QDialogButtonBox(QDialogButtonBox::Close);
    QPushButton* copy = buttons->addButton(QObject::tr("&Copy"), QDialogButtonBox::ActionRole);
    QObject::connect(copy, &QPushButton::clicked, dialog, [text] { QApplication::clipboard()->setText(text); });
    QObject::connect(buttons, &QDialogButtonBox::rejected, dialog, &QDialog::close);
    auto* column = new QVBoxLayout(dialog);
    column->setContentsMargins(16, 16, 16, 12);
    column->addWidget(lines);
    column->addWidget(buttons);
    dialog->resize(metrics.averageCharWidth() * kColumns + 60, metrics.lineSpacing() * shown + 110);
    dialog->show();
}

void askQuestion(QWidget* parent, const Question& question, std::function<void(bool)> then)
{
    auto* box = new QMessageBox(QMessageBox::NoIcon, QStringLiteral("Punctum"), question.text,
                                QMessageBox::Save | QMessageBox::Cancel, parent);
    box->setObjectName(QStringLiteral("savingQuestion"));
    giveSign(*box);
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->setTextFormat(Qt::PlainText);
    box->setInformativeText(question.reason);
    box->button(QMessageBox::Save)->setText(question.yes);
    if (!question.no.isEmpty()) box->button(QMessageBox::Cancel)->setText(question.no);
    box->setDefaultButton(question.yesByDefault ? QMessageBox::Save : QMessageBox::Cancel);
    QObject::connect(box, &QMessageBox::finished, box,
                     [then = std::move(then)](int answer) { then(answer == QMessageBox::Save); });
    box->open();
}

void askRecovery(QWidget* parent, const Question& question, std::function<void(RecoveryAnswer)> then)
{
    auto* box = new QMessageBox(QMessageBox::NoIcon, QStringLiteral("Punctum"), question.text,
                                QMessageBox::NoButton, parent);
    box->setObjectName(QStringLiteral("recoveryQuestion"));
    giveSign(*box);
    box->setAttribute(Qt::WA_DeleteOnClose);
    box->setTextFormat(Qt::PlainText);
    box->setInformativeText(question.reason);
    QPushButton* const recover = box->addButton(question.yes, QMessageBox::AcceptRole);
    QPushButton* const aside = box->addButton(QObject::tr("&Set Aside"), QMessageBox::DestructiveRole);
    QPushButton* const later = box->addButton(question.no, QMessageBox::RejectRole);
    box->setDefaultButton(recover);
    box->setEscapeButton(later);
    QObject::connect(box, &QMessageBox::finished, box, [box, recover, aside, then = std::move(then)] {
        const QAbstractButton* const clicked = box->clickedButton();
        then(clicked == recover ? RecoveryAnswer::Recover
             : clicked == aside ? RecoveryAnswer::SetAside
                                : RecoveryAnswer::Later);
    });
    box->open();
}

void askBeforeSaving(QWidget* parent, const QString& name, const QString& what, std::function<void(bool)> then)
{
    askQuestion(parent,
                {QObject::tr("%1 will differ from the opened file in more than your edits.").arg(name), what,
                 QObject::tr("&Save")},
                std::move(then));
}

UnsavedAnswer askAboutUnsaved(QWidget* parent, const QString& name, const QString& changes)
{
    QMessageBox box(parent);
    giveSign(box);
    box.setWindowTitle(QObject::tr("Unsaved changes"));
    box.setText(QObject::tr("%1 has unsaved changes.").arg(name));
    box.setTextFormat(Qt::PlainText);
    const QString lost = QObject::tr("Without saving they are lost.");
    box.setInformativeText(changes.isEmpty() ? lost : changes + QLatin1Char('\n') + lost);
    box.setStandardButtons(QMessageBox::Save | QMessageBox::Discard | QMessageBox::Cancel);
    box.setDefaultButton(QMessageBox::Save);
    switch (box.exec()) {
        case QMessageBox::Save:
            return UnsavedAnswer::Save;
        case QMessageBox::Discard:
            return UnsavedAnswer::Discard;
        default:
            return UnsavedAnswer::Cancel;
    }
}

}  // namespace punctum::ui
