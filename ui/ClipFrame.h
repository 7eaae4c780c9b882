// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"

#include <QWidget>

#include <optional>

namespace punctum::ui
{

/// The edges of the clip box over the picture; lets the mouse through. GUI thread only.
class ClipFrame final : public QWidget
{
    Q_OBJECT
public:
    explicit ClipFrame(QWidget* parent);

    void setBox(const std::optional<WorldBounds>& box);
    void setCamera(const render::Camera& camera);

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::optional<WorldBounds> m_box;
    render::Camera m_camera;
};

}  // namespace punctum::ui
