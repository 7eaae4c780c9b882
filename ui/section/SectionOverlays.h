// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Section.h"
#include "render/camera/Camera.h"

#include <QPolygonF>
#include <QString>
#include <QWidget>

#include <optional>
#include <vector>

class QPainter;

namespace punctum::ui
{

class Viewport;

/// What is drawn over all of a view and follows its camera; lets the mouse through. GUI thread only.
class ViewLayer : public QWidget
{
    Q_OBJECT
public:
    explicit ViewLayer(Viewport& viewport);

    bool eventFilter(QObject* watched, QEvent* event) override;

protected:
    /// Places of the world on this widget, without what lies behind the eye.
    QPolygonF projected(const std::vector<glm::dvec3>& corners) const;
    const render::Camera& camera() const;

private:
    Viewport& m_viewport;
};

/// Where a section lies, in the view that it was drawn in: its slab as a band, and which way one looks.
class SectionBand final : public ViewLayer
{
    Q_OBJECT
public:
    using ViewLayer::ViewLayer;
    /// With the heights (world) of its two ends; none: no section.
    void setSection(const std::optional<Section>& section, double fromHeight = 0.0, double toHeight = 0.0);
    /// A line that is being drawn, instead of the section.
    void setDraft(const std::optional<std::pair<glm::dvec3, glm::dvec3>>& line);
    const std::optional<Section>& section() const noexcept { return m_section; }
    const std::optional<std::pair<glm::dvec3, glm::dvec3>>& draft() const noexcept { return m_draft; }

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::optional<Section> m_section;
    std::optional<std::pair<glm::dvec3, glm::dvec3>> m_draft;
    double m_fromHeight = 0.0, m_toHeight = 0.0;
};

/// What the lines and numbers over a section view go by.
struct RulerMarks {
    Section section;
    QString unit;        ///< of distances
    QString heightUnit;  ///< of Z
};
/// Draws them over a picture of this size (logical px) that the camera took. Any thread, as painting on images is.
void paintRuler(QPainter& painter, const RulerMarks& marks, const render::Camera& camera, QSizeF size);

/// Lines and numbers over a section view: heights at the left, distances from the line's left end below.
class SectionRuler final : public ViewLayer
{
    Q_OBJECT
public:
    using ViewLayer::ViewLayer;
    /// `unit`: of distances; `heightUnit`: of Z.
    void setSection(const std::optional<Section>& section, const QString& unit, const QString& heightUnit);
    /// None: no section.
    const std::optional<RulerMarks>& marks() const noexcept { return m_marks; }

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::optional<RulerMarks> m_marks;
};

/// A ring at a place of the world: the point that the mouse is at in the other view.
class PointMark final : public ViewLayer
{
    Q_OBJECT
public:
    using ViewLayer::ViewLayer;
    void setPlace(const std::optional<glm::dvec3>& world);
    const std::optional<glm::dvec3>& place() const noexcept { return m_place; }

protected:
    void paintEvent(QPaintEvent* event) override;

private:
    std::optional<glm::dvec3> m_place;
};

}  // namespace punctum::ui
