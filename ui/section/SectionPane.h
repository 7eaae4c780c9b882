// SPDX-License-Identifier: MIT
#pragma once

#include <QWidget>

class QDoubleSpinBox;
class QBoxLayout;
class QLabel;
class QToolButton;

namespace punctum::ui
{

class ViewRenderer;
class ViewSettings;
class Viewport;

/// A section view with the bar above it: what it shows, its width, how high heights look, and buttons to walk. GUI
/// thread only. Borrows renderer and settings, which must outlive it.
class SectionPane final : public QWidget
{
    Q_OBJECT
public:
    SectionPane(ViewRenderer& renderer, ViewSettings& settings, bool openGl, QWidget* parent = nullptr);

    Viewport& viewport() noexcept { return *m_viewport; }
    /// Beside the main view: the title stands above the fields instead of before them.
    void setNarrow(bool narrow);
    void setTitle(const QString& title);
    QString title() const;
    void setWidth(double width, const QString& unit);
    void setExaggeration(double times);
    QDoubleSpinBox& widthField() noexcept { return *m_width; }
    QDoubleSpinBox& exaggerationField() noexcept { return *m_exaggeration; }
    QToolButton& closeButton() noexcept { return *m_close; }

signals:
    void widthChosen(double width);
    void exaggerationChosen(double times);
    /// In widths: ahead is positive.
    void walked(double steps);
    void turnWanted();
    void fitWanted();
    /// From below the main view to beside it, or back.
    void moveWanted();
    void closeWanted();

private:
    QToolButton* addButton(QBoxLayout& row, const QString& icon, const QString& tip);

    QBoxLayout* m_bar;
    QLabel* m_title;
    QDoubleSpinBox* m_width;
    QDoubleSpinBox* m_exaggeration;
    QToolButton* m_close = nullptr;
    Viewport* m_viewport;
};

}  // namespace punctum::ui
