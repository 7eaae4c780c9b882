// SPDX-License-Identifier: MIT
#include "ui/docks/PropertiesDock.h"

#include "ui/docks/DocumentProperties.h"
#include "ui/document/Document.h"
#include "ui/document/FileDoctor.h"
#include "ui/style/Theme.h"

#include <QDir>
#include <QEvent>
#include <QFileDialog>
#include <QFileInfo>
#include <QPushButton>
#include <QScrollBar>
#include <QTextBrowser>
#include <QVBoxLayout>

namespace punctum::ui
{

PropertiesDock::PropertiesDock(FileDoctor& doctor, QWidget* parent)
    : QDockWidget(tr("File"), parent),
      m_doctor(doctor),
      m_text(new QTextBrowser),
      m_repair(new QPushButton(tr("Repair to a New File...")))
{
    setObjectName(QStringLiteral("properties"));
    m_text->setOpenLinks(false);
    m_text->setAccessibleName(tr("Properties of the file"));
    m_text->document()->setDocumentMargin(10);
    connect(m_text, &QTextBrowser::anchorClicked, this,
            [this](const QUrl& url) { emit detailsWanted(m_details.value(url.toString().toInt())); });
    auto* content = new QWidget;
    auto* column = new QVBoxLayout(content);
    column->setContentsMargins(8, 8, 10, 8);
    column->addWidget(m_text);
    m_repair->setObjectName(QStringLiteral("repair"));
    m_repair->setToolTip(
        tr("Puts right in the header what can be without guessing. Points and records stay as they are"));
    connect(m_repair, &QPushButton::clicked, this, &PropertiesDock::repair);
    column->addWidget(m_repair);
    connect(&m_doctor, &FileDoctor::examined, this, [this](const Document* document) {
        if (document == m_document) update();
    });
    setWidget(content);
    update();
}

QString PropertiesDock::text() const
{
    return m_text->toPlainText();
}

void PropertiesDock::setDocument(Document* document)
{
    if (m_document) m_document->disconnect(this);
    m_document = document;
    if (document) connect(document, &Document::stateChanged, this, &PropertiesDock::update);
    update();
}

void PropertiesDock::repair()
{
    if (!m_document) return;
    const QFileInfo file(m_document->path());
    const QString suggested =
        file.dir().filePath(file.completeBaseName() + QStringLiteral("-repaired.") + file.suffix());
    const QString path = QFileDialog::getSaveFileName(window(), tr("Repair %1 to a new file").arg(file.fileName()),
                                                      suggested, tr("Point clouds (*.%1)").arg(file.suffix()));
    if (!path.isEmpty() && m_document) m_doctor.repair(*m_document, path);
}

void PropertiesDock::changeEvent(QEvent* event)
{
    QDockWidget::changeEvent(event);
    if (event->type() == QEvent::PaletteChange && m_text) update();
}

void PropertiesDock::update()
{
    const ThemeColors& colors = themeColors();
    QString html;
    m_details.clear();
    if (!m_document) {
        html = QStringLiteral("<p style='color:%1'>%2</p>").arg(colors.dim.name(), tr("Nothing is open."));
    } else {
        html = QStringLiteral("<table width='100%' cellspacing='0' cellpadding='2'>");
        bool first = true;
        for (const PropertySection& section : documentProperties(*m_document, m_doctor.of(*m_document))) {
            html += QStringLiteral(
                        "<tr><td colspan='2' style='padding-top:%1px; padding-bottom:2px; color:%2; "
                        "font-weight:600'>%3</td></tr>")
                        .arg(first ? 0 : 12)
                        .arg(colors.accent.name(), section.title.toHtmlEscaped());
            first = false;
            for (const auto& [name, value, details] : section.rows) {
                if (!details.isEmpty()) {
                    html += QStringLiteral("<tr><td colspan='2'><a style='color:%1' href='%2'>%3</a></td></tr>")
                                .arg(colors.accent.name())
                                .arg(m_details.size())
                                .arg(value.toHtmlEscaped());
                    m_details << details;
                } else if (name.isEmpty())
                    html += QStringLiteral("<tr><td colspan='2'>%1</td></tr>")
                                .arg(value.toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
                else
                    html += QStringLiteral(
                                "<tr><td width='44%' style='color:%1; padding-right:10px'>%2</td><td>%3</td></tr>")
                                .arg(colors.dim.name(), name.toHtmlEscaped(),
                                     value.toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
            }
        }
        html += QStringLiteral("</table>");
    }
    const Inspection* const found = m_document ? m_doctor.of(*m_document) : nullptr;
    m_repair->setVisible(found && found->repairable());
    const int place = m_text->verticalScrollBar()->value();
    m_text->setHtml(html);
    m_text->verticalScrollBar()->setValue(place);
}

}  // namespace punctum::ui
