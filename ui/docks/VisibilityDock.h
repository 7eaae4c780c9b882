// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"

#include <QDockWidget>

#include <array>
#include <optional>

class QCheckBox;
class QLabel;
class QLineEdit;
class QPushButton;

namespace punctum::ui
{

class Document;
class NumberField;
class ViewFilter;
class ViewSettings;
class Viewport;

/// What of the clouds is shown beside their classes: a filter by attributes, a box, and planes that cut. GUI thread
/// only; borrows all that it is given.
class VisibilityDock final : public QDockWidget
{
    Q_OBJECT
public:
    VisibilityDock(ViewFilter& filter, ViewSettings& settings, Viewport& viewport, QWidget* parent = nullptr);

    void setDocument(Document* document);

    bool eventFilter(QObject* watched, QEvent* event) override;

private:
    void takeFilter();
    void takeClip();
    void applyBox();
    /// Moves the face of a field along its axis by a hundredth of the box.
    void nudge(std::size_t field, bool up);
    void fillBox(const WorldBounds& box);
    void putFace(const WorldBounds& box, std::size_t field);
    /// What the fields say; nothing where they say no box, and are marked then.
    std::optional<WorldBounds> typedBox();
    std::optional<WorldBounds> boxOfView() const;
    void cutHere();

    ViewFilter& m_filter;
    ViewSettings& m_settings;
    Viewport& m_viewport;
    Document* m_document = nullptr;
    QLineEdit* m_condition = nullptr;
    QLabel* m_state = nullptr;
    QCheckBox* m_useBox = nullptr;
    std::array<NumberField*, 6> m_fields{};  ///< x, y, z: least; then most
    QLabel* m_boxProblem = nullptr;
    QPushButton* m_boxOfView = nullptr;
    QPushButton* m_boxOfFile = nullptr;
    QPushButton* m_cut = nullptr;
    QPushButton* m_uncut = nullptr;
};

}  // namespace punctum::ui
