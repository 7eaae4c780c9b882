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

private:
    void takeFilter();
    void takeClip();
    void applyBox();
    void fillBox(const WorldBounds& box);
    std::optional<WorldBounds> boxOfView() const;
    void cutHere();

    ViewFilter& m_filter;
    ViewSettings& m_settings;
    Viewport& m_viewport;
    Document* m_document = nullptr;
    QLineEdit* m_condition = nullptr;
    QLabel* m_state = nullptr;
    QCheckBox* m_useBox = nullptr;
    std::array<QLineEdit*, 6> m_fields{};  ///< x, y, z: least; then most
    QPushButton* m_boxOfView = nullptr;
    QPushButton* m_boxOfFile = nullptr;
    QPushButton* m_cut = nullptr;
    QPushButton* m_uncut = nullptr;
};

}  // namespace punctum::ui
