// SPDX-License-Identifier: MIT
#pragma once

#include <QWidget>

class QLineEdit;
class QTreeWidget;
class QTreeWidgetItem;

namespace punctum
{
class Step;
}

namespace punctum::ui
{

/// All steps in their groups, with a field that finds them by title, name, group and the words of their help. GUI
/// thread only.
class StepChooser final : public QWidget
{
    Q_OBJECT
public:
    explicit StepChooser(QWidget* parent = nullptr);

    QLineEdit& search() noexcept { return *m_search; }
    QTreeWidget& list() noexcept { return *m_list; }
    /// Marks the step in the list.
    void mark(const Step* step);

signals:
    void chosen(const QString& name);

protected:
    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void find(const QString& words);
    void choose(const QTreeWidgetItem* item);

    QLineEdit* m_search;
    QTreeWidget* m_list;
};

}  // namespace punctum::ui
