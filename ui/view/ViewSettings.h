// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/ProgressiveRenderer.h"

#include <QObject>
#include <QString>

#include <bitset>

namespace punctum::ui
{

/// What the user chose to see: attribute, color map, range, palette, hidden classes, point size, samples,
/// background. One for the view, shared by the docks and menus that change it. GUI thread only.
class ViewSettings final : public QObject
{
    Q_OBJECT
public:
    enum class Background { Dark, Gray, White, Own };

    explicit ViewSettings(QObject* parent = nullptr);

    const render::DisplaySettings& display() const noexcept { return m_display; }

    /// Empty: each cloud by its own first attribute.
    QString attribute() const { return QString::fromStdString(m_display.attribute); }
    void setAttribute(const QString& name);
    /// Empty: the map that suits the attribute.
    QString colorMap() const { return QString::fromStdString(m_display.colorMap); }
    void setColorMap(const QString& name);
    void setRange(std::optional<std::pair<double, double>> range);
    /// 1 to 20, in logical px.
    void setPointSize(double px);
    void setSizing(render::PointSizing sizing);
    /// In units of the view, 1e-6 to 1e6.
    void setWorldSize(double size);
    /// 0.1 to 20.
    void setSpacings(double spacings);
    /// The width of points by the sizing that is on.
    double size() const noexcept;
    void setSize(double size);
    /// By a step that suits the sizing.
    void enlargePoints(bool larger);
    void setTone(const render::ColorTone& tone);
    void setRound(bool round);
    void setAveraged(bool averaged);
    void setNormals(render::NormalLook look);
    void setSamples(int samples);
    /// Strength, 0 to 4; 0: none.
    void setEyeDome(double strength);
    /// The ground surface, whether points are seen through it, and of which classes they give way to it.
    void setSurface(render::SurfaceLook look, bool pointsOnTop, const std::bitset<256>& replaces);
    /// Which contours it has: kNoContours, kSuitableContours, or an interval in units of Z. Remembered.
    static constexpr double kNoContours = 0, kSuitableContours = -1;
    void setContourChoice(double choice);
    double contourChoice() const noexcept { return m_contourChoice; }
    /// The interval of those that are drawn; 0: none.
    void setContours(double interval);
    /// Whether the ground's own points give way to the surface; so at first.
    void setGroundReplaced(bool replaced);
    bool groundReplaced() const noexcept { return m_groundReplaced; }
    /// Steps of the color map, up to 64; less than 2: smooth.
    void setBands(int bands);
    /// Own: the color of setOwnBackground().
    void setBackground(Background background);
    void setOwnBackground(render::Rgba8 color);
    render::Rgba8 ownBackground() const noexcept { return m_ownBackground; }
    Background background() const noexcept { return m_background; }
    void setClip(const Clip& clip);
    void setClassColor(unsigned code, render::Rgba8 color);
    void setClassVisible(unsigned code, bool visible);
    void setAllClassesVisible(bool visible);
    /// Tools leave the points of a locked class alone.
    void setClassLocked(unsigned code, bool locked);
    void unlockClasses();
    const std::array<bool, 256>& lockedClasses() const noexcept { return m_classLocked; }
    bool classLocked(unsigned code) const noexcept { return m_classLocked[code & 255u]; }
    /// Which of these classes alone are drawn by double-click in the list.
    void showOnlyClass(unsigned code);

signals:
    void changed();
    void attributeChanged(const QString& name);

private:
    /// One of the fields below; says so if it is another value.
    template <typename T>
    void set(T& field, const T& value);

    render::DisplaySettings m_display;
    Background m_background = Background::Dark;
    render::Rgba8 m_ownBackground{46, 60, 84, 255};
    std::array<bool, 256> m_classLocked{};
    bool m_groundReplaced = true;
    double m_contourChoice = kNoContours;
};

}  // namespace punctum::ui
