// SPDX-License-Identifier: MIT
#pragma once

#include <QDockWidget>
#include <QPointer>
#include <QStringList>

class QTextBrowser;

namespace punctum::ui
{

class Document;

/// What the active document's file is: all of it text that can be selected and copied. GUI thread only.
class PropertiesDock final : public QDockWidget
{
    Q_OBJECT
public:
    explicit PropertiesDock(QWidget* parent = nullptr);
    void setDocument(Document* document);
    QString text() const;

signals:
    void detailsWanted(const QString& details);

protected:
    void changeEvent(QEvent* event) override;

private:
    void update();
    QPointer<Document> m_document;
    QTextBrowser* m_text = nullptr;
    QStringList m_details;  ///< what the links lead to
};

}  // namespace punctum::ui
