// SPDX-License-Identifier: MIT
#pragma once

#include "ui/document/Workspace.h"

#include <QFrame>
#include <QStringList>

class QVBoxLayout;

namespace punctum::ui
{

/// Sentences to the user, over the top of the view, newest last. Errors stay until closed; news, and warnings
/// (which the properties keep), go by themselves. Nothing waits for an answer. GUI thread only.
class MessageArea final : public QWidget
{
    Q_OBJECT
public:
    explicit MessageArea(QWidget* parent);

    /// `details`: what a button behind the sentence leads to; none when empty.
    /// `about`: it goes with this object.
    void add(MessageKind kind, const QString& sentence, const QString& details = {},
             const QObject* about = nullptr);
    /// What is shown at present, oldest first.
    QStringList sentences() const;
    void clear();
    /// What the bars take, their sentences wrapped to this width.
    int heightForWidth(int width) const override;

signals:
    void resized();
    void detailsWanted(const QString& details);

private:
    void remove(QFrame* bar);
    QVBoxLayout* m_column = nullptr;
};

}  // namespace punctum::ui
