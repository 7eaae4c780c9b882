// SPDX-License-Identifier: MIT
#pragma once

#include <QPointer>
#include <QWidget>

#include <bitset>
#include <optional>

class QLineEdit;
class QToolButton;

namespace punctum::ui
{

class Document;

/// A field for any number of classes, "2,8-9": written, or checked in a menu that stays open. GUI thread only.
class ClassesField final : public QWidget
{
    Q_OBJECT
public:
    explicit ClassesField(QWidget* parent = nullptr);

    /// Whose classes stand first in the menu; null: none.
    void setDocument(Document* document);
    QString text() const;
    void setText(const QString& text);
    /// Nothing where the text is no list of classes.
    std::optional<std::bitset<256>> classes() const;
    void setClasses(const std::bitset<256>& classes);
    QLineEdit& edit() noexcept { return *m_edit; }
    QToolButton& menuButton() noexcept { return *m_button; }

signals:
    void changed();
    void returnPressed();

private:
    void fillMenu();

    QPointer<Document> m_document;
    QLineEdit* m_edit;
    QToolButton* m_button;
};

/// "2, 8-9"; "none" for none.
QString classListText(const std::bitset<256>& classes);

}  // namespace punctum::ui
