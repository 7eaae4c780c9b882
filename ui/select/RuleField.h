// SPDX-License-Identifier: MIT
#pragma once

#include <QPlainTextEdit>

namespace punctum::ui
{

/// A field for a rule or condition: as long as it has to be, over some lines, with the place marked where it is
/// wrong. Enter is done with it; a new line is written with Shift. GUI thread only.
class RuleField final : public QPlainTextEdit
{
    Q_OBJECT
public:
    explicit RuleField(QWidget* parent = nullptr);

    /// Lines are one text, with a blank for each end of a line: columns count in it.
    QString text() const;
    void setText(const QString& text) { setPlainText(text); }
    /// Marks the field, and what stands at the place that the sentence names ("Column 16: ..."), `before` columns
    /// further on. Empty: it is well again.
    void markProblem(const QString& sentence, int before = 0);
    /// What is marked; empty when nothing is.
    QString marked() const;

signals:
    void returnPressed();

protected:
    void keyPressEvent(QKeyEvent* event) override;

private:
    void adjustHeight();
};

}  // namespace punctum::ui
