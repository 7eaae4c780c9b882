// SPDX-License-Identifier: MIT
#include "ui/ViewSettings.h"

#include <algorithm>
#include <cmath>

namespace punctum::ui
{

ViewSettings::ViewSettings(QObject* parent) : QObject(parent)
{
    m_display.pointSize = 1.0;
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
    }
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
