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
    void setTitle(const QString& title);
    QString title() const;
    void setWidth(double width, const QString& unit);
    void setExaggeration(double times);
    QDoubleSpinBox& widthField() noexcept { return *m_width; }
    /// As narrow as the bar's longest part; it has up to three lines then.
    QSize minimumSizeHint() const override;
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

protected:
    void resizeEvent(QResizeEvent* event) override;

private:
    void makeFields();
    void addButtons();
    QToolButton* addButton(const QString& icon, const QString& tip);

    QLabel* m_title;
    QBoxLayout* m_bar;  ///< the title, and what can be done
    QBoxLayout* m_row;  ///< that: the fields and the buttons
    QBoxLayout* m_fields;
    QBoxLayout* m_buttons;
    QDoubleSpinBox* m_width;
    QDoubleSpinBox* m_exaggeration;
    QToolButton* m_close = nullptr;
    Viewport* m_viewport;
};

}  // namespace punctum::ui
