// SPDX-License-Identifier: MIT
#include "ui/ViewSettings.h"

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

ViewSettings::ViewSettings(QObject* parent) : QObject(parent)
{
    m_display.fillHoles = true;
    setBackground(Background::Dark);
}

void ViewSettings::notify()
{
    emit changed();
}

void ViewSettings::setAttribute(const QString& name)
{
    if (name == attribute()) return;
    m_display.attribute = name.toStdString();
    m_display.range.reset();  // a range is of one attribute's values
    emit attributeChanged(name);
    notify();
}

void ViewSettings::setColorMap(const QString& name)
{
    if (name == colorMap() || (!name.isEmpty() && !render::findColorMap(name.toStdString()))) return;
    m_display.colorMap = name.toStdString();
    notify();
}

void ViewSettings::setRange(std::optional<std::pair<double, double>> range)
{
    if (range && (!std::isfinite(range->first) || !std::isfinite(range->second))) return;
    if (range == m_display.range) return;
    m_display.range = range;
    notify();
}

void ViewSettings::setPointSize(double px)
{
    px = std::clamp(px, 1.0, 20.0);
    if (px == m_display.pointSize) return;
    m_display.pointSize = px;
    notify();
}

void ViewSettings::setSizing(render::PointSizing sizing)
{
    if (sizing == m_display.sizing) return;
    m_display.sizing = sizing;
    notify();
}

void ViewSettings::setWorldSize(double size)
{
    size = std::isfinite(size) ? std::clamp(size, 1e-6, 1e6) : m_display.worldSize;
    if (size == m_display.worldSize) return;
    m_display.worldSize = size;
    notify();
}

void ViewSettings::setSpacings(double spacings)
{
    spacings = std::clamp(spacings, 0.1, 20.0);
    if (spacings == m_display.spacings) return;
    m_display.spacings = spacings;
    notify();
}

double ViewSettings::size() const noexcept
{
    switch (m_display.sizing) {
        case render::PointSizing::World:
            return m_display.worldSize;
        case render::PointSizing::Density:
            return m_display.spacings;
        case render::PointSizing::Pixels:
            break;
    }
    return m_display.pointSize;
}

void ViewSettings::setSize(double size)
{
    switch (m_display.sizing) {
        case render::PointSizing::World:
            return setWorldSize(size);
        case render::PointSizing::Density:
            return setSpacings(size);
        case render::PointSizing::Pixels:
            return setPointSize(size);
    }
}

void ViewSettings::enlargePoints(bool larger)
{
    constexpr double kStep = 1.25;
    if (m_display.sizing != render::PointSizing::Pixels) return setSize(larger ? size() * kStep : size() / kStep);
    const double px = m_display.pointSize;
    setPointSize(larger ? px + (px < 4.0 ? 0.5 : 1.0) : px - (px <= 4.0 ? 0.5 : 1.0));
}

void ViewSettings::setRound(bool round)
{
    if (round == m_display.round) return;
    m_display.round = round;
    notify();
}

void ViewSettings::setAveraged(bool averaged)
{
    if (averaged == m_display.averaged) return;
    m_display.averaged = averaged;
    notify();
}

void ViewSettings::setNormals(render::NormalLook look)
{
    if (look == m_display.normals) return;
    m_display.normals = look;
    notify();
}

void ViewSettings::setOwnBackground(render::Rgba8 color)
{
    m_ownBackground = {color.r, color.g, color.b, 255};
    setBackground(Background::Own);
}

void ViewSettings::setSamples(int samples)
{
    samples = render::kSampleCounts[render::sampleCountIndex(samples)];
    if (samples == m_display.samples) return;
    m_display.samples = samples;
    notify();
}

void ViewSettings::setEyeDome(double strength)
{
    strength = std::clamp(strength, 0.0, 4.0);
    if (strength == m_display.eyeDome) return;
    m_display.eyeDome = strength;
    notify();
}

void ViewSettings::setBands(int bands)
{
    bands = bands < 2 ? 0 : std::min(bands, 64);
    if (bands == m_display.bands) return;
    m_display.bands = bands;
    notify();
}

void ViewSettings::setBackground(Background background)
{
    using render::Rgba8;
    m_background = background;
    switch (background) {
        case Background::Dark:
            m_display.backgroundTop = Rgba8{34, 38, 44, 255};
            m_display.backgroundBottom = Rgba8{18, 20, 23, 255};
            break;
        case Background::Grey:
            m_display.backgroundTop = m_display.backgroundBottom = Rgba8{118, 120, 124, 255};
            break;
        case Background::White:
            m_display.backgroundTop = m_display.backgroundBottom = Rgba8{255, 255, 255, 255};
            break;
        case Background::Own:
            m_display.backgroundTop = m_display.backgroundBottom = m_ownBackground;
            break;
    }
    notify();
}

void ViewSettings::setClip(const Clip& clip)
{
    if (clip == m_display.clip) return;
    m_display.clip = clip;
    notify();
}

void ViewSettings::setClassColor(unsigned code, render::Rgba8 color)
{
    if (code > 255 || m_display.palette[code] == color) return;
    m_display.palette[code] = color;
    notify();
}

void ViewSettings::setClassVisible(unsigned code, bool visible)
{
    if (code > 255 || m_display.classVisible[code] == visible) return;
    m_display.classVisible[code] = visible;
    notify();
}

void ViewSettings::setClassLocked(unsigned code, bool locked)
{
    if (code > 255 || m_classLocked[code] == locked) return;
    m_classLocked[code] = locked;
    notify();
}

void ViewSettings::setAllClassesVisible(bool visible)
{
    m_display.classVisible.fill(visible);
    notify();
}

void ViewSettings::showOnlyClass(unsigned code)
{
    if (code > 255) return;
    m_display.classVisible.fill(false);
    m_display.classVisible[code] = true;
    notify();
}

}  // namespace punctum::ui
