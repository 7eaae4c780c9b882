// SPDX-License-Identifier: MIT
#include "ui/view/ViewSettings.h"

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

ViewSettings::ViewSettings(QObject* parent) : QObject(parent)
{
    m_display.fillHoles = true;
    m_display.sizing = render::PointSizing::Density;  // surfaces close, from near and from afar
    setBackground(Background::Dark);
}

template <typename T>
void ViewSettings::set(T& field, const T& value)
{
    if (field == value) return;
    field = value;
    emit changed();
}

void ViewSettings::setAttribute(const QString& name)
{
    if (name == attribute()) return;
    m_display.attribute = name.toStdString();
    m_display.range.reset();  // a range is of one attribute's values
    emit attributeChanged(name);
    emit changed();
}

void ViewSettings::setColorMap(const QString& name)
{
    if (name == colorMap() || (!name.isEmpty() && !render::findColorMap(name.toStdString()))) return;
    m_display.colorMap = name.toStdString();
    emit changed();
}

void ViewSettings::setRange(std::optional<std::pair<double, double>> range)
{
    if (range && (!std::isfinite(range->first) || !std::isfinite(range->second))) return;
    set(m_display.range, range);
}

void ViewSettings::setPointSize(double px)
{
    set(m_display.pointSize, std::clamp(px, 1.0, 20.0));
}

void ViewSettings::setSizing(render::PointSizing sizing)
{
    set(m_display.sizing, sizing);
}

void ViewSettings::setWorldSize(double size)
{
    if (std::isfinite(size)) set(m_display.worldSize, std::clamp(size, 1e-6, 1e6));
}

void ViewSettings::setSpacings(double spacings)
{
    set(m_display.spacings, std::clamp(spacings, 0.1, 20.0));
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

void ViewSettings::setTone(const render::ColorTone& tone)
{
    if (!std::isfinite(tone.brightness) || !std::isfinite(tone.contrast) || !std::isfinite(tone.gamma)) return;
    set(m_display.tone, {std::clamp(tone.brightness, -1.0, 1.0), std::clamp(tone.contrast, -1.0, 1.0),
                         std::clamp(tone.gamma, 0.1, 10.0)});
}

void ViewSettings::setRound(bool round)
{
    set(m_display.round, round);
}

void ViewSettings::setAveraged(bool averaged)
{
    set(m_display.averaged, averaged);
}

void ViewSettings::setNormals(render::NormalLook look)
{
    set(m_display.normals, look);
}

void ViewSettings::setOwnBackground(render::Rgba8 color)
{
    m_ownBackground = {color.r, color.g, color.b, 255};
    setBackground(Background::Own);
}

void ViewSettings::setSamples(int samples)
{
    set(m_display.samples, render::kSampleCounts[render::sampleCountIndex(samples)]);
}

void ViewSettings::setEyeDome(double strength)
{
    set(m_display.eyeDome, std::clamp(strength, 0.0, 4.0));
}

void ViewSettings::setSurface(render::SurfaceLook look, bool pointsOnTop, const std::bitset<256>& replaces)
{
    set(m_display.surfaceReplaces, replaces);
    set(m_display.pointsOnTop, pointsOnTop);
    set(m_display.surface, look);
}

void ViewSettings::setGroundReplaced(bool replaced)
{
    set(m_groundReplaced, replaced);
}

void ViewSettings::setContourChoice(double choice)
{
    if (choice == kSuitableContours || (std::isfinite(choice) && choice >= 0)) set(m_contourChoice, choice);
}

void ViewSettings::setContours(double interval)
{
    if (std::isfinite(interval) && interval >= 0) set(m_display.contours.interval, interval);
}

void ViewSettings::setBands(int bands)
{
    set(m_display.bands, bands < 2 ? 0 : std::min(bands, 64));
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
        case Background::Gray:
            m_display.backgroundTop = m_display.backgroundBottom = Rgba8{118, 120, 124, 255};
            break;
        case Background::White:
            m_display.backgroundTop = m_display.backgroundBottom = Rgba8{255, 255, 255, 255};
            break;
        case Background::Own:
            m_display.backgroundTop = m_display.backgroundBottom = m_ownBackground;
            break;
    }
    emit changed();
}

void ViewSettings::setClip(const Clip& clip)
{
    set(m_display.clip, clip);
}

void ViewSettings::setClassColor(unsigned code, render::Rgba8 color)
{
    if (code < 256) set(m_display.palette[code], color);
}

void ViewSettings::setClassVisible(unsigned code, bool visible)
{
    if (code < 256) set(m_display.classVisible[code], visible);
}

void ViewSettings::setClassLocked(unsigned code, bool locked)
{
    if (code < 256) set(m_classLocked[code], locked);
}

void ViewSettings::unlockClasses()
{
    set(m_classLocked, {});
}

void ViewSettings::setAllClassesVisible(bool visible)
{
    m_display.classVisible.fill(visible);
    emit changed();
}

void ViewSettings::showOnlyClass(unsigned code)
{
    if (code > 255) return;
    m_display.classVisible.fill(false);
    m_display.classVisible[code] = true;
    emit changed();
}

}  // namespace punctum::ui
