// SPDX-License-Identifier: MIT
#pragma once

#include <QDockWidget>
#include <QPointer>
#include <QStringList>

class QPushButton;
class QTextBrowser;

namespace punctum::ui
{

class Document;
class FileDoctor;

/// What the active document's file is: all of it text that can be selected and copied; what is wrong with it, and a
/// button that repairs it. GUI thread only.
class PropertiesDock final : public QDockWidget
{
    Q_OBJECT
public:
    explicit PropertiesDock(FileDoctor& doctor, QWidget* parent = nullptr);
    void setDocument(Document* document);
    QString text() const;

signals:
    void detailsWanted(const QString& details);

protected:
    void changeEvent(QEvent* event) override;

private:
    void update();
    void repair();

    FileDoctor& m_doctor;
    QPointer<Document> m_document;
    QTextBrowser* m_text = nullptr;
    QPushButton* m_repair = nullptr;
    QStringList m_details;  ///< what the links lead to
};

}  // namespace punctum::ui
