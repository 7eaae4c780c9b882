// SPDX-License-Identifier: MIT
#include "ui/select/RuleField.h"

#include "ui/style/Theme.h"
#include "ui/style/Widgets.h"

#include <QKeyEvent>
#include <QRegularExpression>
#include <QTextBlock>

#include <algorithm>

namespace punctum::ui
{

namespace
{

constexpr int kLeastLines = 2, kMostFieldLines = 6;

/// Up to the end of the word, or the sign, that begins there.
int endOfWord(const QString& text, int from)
{
    int end = from;
    while (end < text.size() && (text[end].isLetterOrNumber() || text[end] == QLatin1Char('_'))) ++end;
    return std::min(int(text.size()), std::max(end, from + 1));
}

}  // namespace

RuleField::RuleField(QWidget* parent) : QPlainTextEdit(parent)
{
    setObjectName(QStringLiteral("rule"));
    setTabChangesFocus(true);
    setHorizontalScrollBarPolicy(Qt::ScrollBarAlwaysOff);
    connect(this, &QPlainTextEdit::textChanged, this, [this] {
        markProblem({});
        adjustHeight();
    });
    adjustHeight();
}

QString RuleField::text() const
{
    return toPlainText().replace(QLatin1Char('\n'), QLatin1Char(' '));
}

void RuleField::adjustHeight()
{
    const int lines = std::clamp(int(document()->size().height()), kLeastLines, kMostFieldLines);
    const int around = 2 * (frameWidth() + int(document()->documentMargin())) + 6;
    setFixedHeight(lines * fontMetrics().lineSpacing() + around);
}

void RuleField::markProblem(const QString& sentence, int before)
{
    markWrong(*this, sentence);
    QList<QTextEdit::ExtraSelection> marks;
    static const QRegularExpression place(QStringLiteral("^Column (\\d+): "));
    if (const auto match = place.match(sentence); match.hasMatch()) {
        const QString all = text();
        const int column = std::clamp(match.captured(1).toInt() - 1 + before, 0, int(all.size()));
        // what is missing behind the end is missing behind the last sign
        const int from = column < all.size() ? column : std::max(0, int(all.size()) - 1);
        QTextEdit::ExtraSelection mark;
        mark.cursor = QTextCursor(document());
        mark.cursor.setPosition(from);
        mark.cursor.setPosition(endOfWord(all, from), QTextCursor::KeepAnchor);
        mark.format.setUnderlineStyle(QTextCharFormat::WaveUnderline);
        mark.format.setUnderlineColor(themeColors().error);
        QColor back = themeColors().error;
        back.setAlpha(70);
        mark.format.setBackground(back);
        marks << mark;
    }
    setExtraSelections(marks);
}

QString RuleField::marked() const
{
    const auto marks = extraSelections();
    return marks.isEmpty() ? QString() : marks.front().cursor.selectedText();
}

void RuleField::keyPressEvent(QKeyEvent* event)
{
    const bool enter = event->key() == Qt::Key_Return || event->key() == Qt::Key_Enter;
    if (enter && !(event->modifiers() & Qt::ShiftModifier)) {
        emit returnPressed();
        return;
    }
    QPlainTextEdit::keyPressEvent(event);
}

}  // namespace punctum::ui
