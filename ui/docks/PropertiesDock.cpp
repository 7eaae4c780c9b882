// SPDX-License-Identifier: MIT
#include "ui/docks/PropertiesDock.h"

#include "ui/Document.h"
#include "ui/docks/DocumentProperties.h"
#include "ui/style/Theme.h"

#include <QEvent>
#include <QScrollBar>
#include <QTextBrowser>
#include <QVBoxLayout>

namespace punctum::ui
{

PropertiesDock::PropertiesDock(QWidget* parent) : QDockWidget(tr("File"), parent), m_text(new QTextBrowser)
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
        for (const PropertySection& section : documentProperties(*m_document)) {
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
                    html += QStringLiteral("<tr><td colspan='2'>%1</td></tr>").arg(value.toHtmlEscaped());
                else
                    html += QStringLiteral(
                                "<tr><td width='44%' style='color:%1; padding-right:10px'>%2</td><td>%3</td></tr>")
                                .arg(colors.dim.name(), name.toHtmlEscaped(),
                                     value.toHtmlEscaped().replace(QLatin1Char('\n'), QLatin1String("<br>")));
            }
        }
        html += QStringLiteral("</table>");
    }
    const int place = m_text->verticalScrollBar()->value();
    m_text->setHtml(html);
    m_text->verticalScrollBar()->setValue(place);
}

}  // namespace punctum::ui
