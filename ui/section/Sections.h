// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Section.h"
#include "core/task/Jobs.h"
#include "ui/view/MainView.h"

#include <QObject>
#include <QPointer>
#include <QStringList>
#include <QTimer>

#include <array>
#include <memory>
#include <optional>

class QSplitter;

namespace punctum::ui
{

class Document;
class MeasureTools;
class Menus;
class PointMark;
struct RulerMarks;
class SectionBand;
class SectionPane;
class SectionRuler;
class SectionTool;
class SelectTools;
class ShownPill;
class WindowSettings;

/// The section view: its tool and menu, the pane below or beside the main view, and how it walks. Whatever is
/// chosen to be seen holds for both views; tools work in both; a point under the mouse in one is marked in the
/// other.
///
/// GUI thread only. Brings a second view of the renderer, which is off while no section is open. Delete it before
/// the window's main view.
class Sections final : public QObject
{
    Q_OBJECT
public:
    Sections(const MainView& main, Menus& menus, SelectTools& select, MeasureTools& measure, QSplitter& splitter,
             WindowSettings& settings);
    ~Sections() override;

    /// None: no section is open.
    const std::optional<Section>& section() const noexcept { return m_section; }
    /// Shows a section that is usable(); the heights are those of its ends.
    void open(const Section& section, double fromHeight, double toHeight);
    void close();
    void setWidth(double width);
    void setExaggeration(double times);
    /// In widths, ahead or back.
    void walk(double steps);
    void turn();
    /// Shows the whole section.
    void fit();

    /// Its points have changed and are not counted yet.
    bool counting() const { return m_job != 0 || m_countTimer.isActive(); }

    SectionTool& tool() noexcept { return *m_tool; }
    SectionPane& pane() noexcept { return *m_pane; }
    Viewport& viewport() noexcept;
    ShownPill& shownPill() noexcept { return *m_pill; }
    const SectionBand& band() const noexcept { return *m_band; }
    /// Heights and distances as the section view shows them; none: no section is open.
    std::optional<RulerMarks> rulerMarks() const;
    /// Of the main view, and of the section.
    const PointMark& mainMark() const noexcept { return *m_mainMark; }
    const PointMark& sectionMark() const noexcept { return *m_sectionMark; }

    bool eventFilter(QObject* watched, QEvent* event) override;

signals:
    void sectionChanged();  ///< section()

private:
    void addMenu(Menus& menus);
    void linkPoints();
    void draw(const glm::dvec3& from, const glm::dvec3& to);
    void change(const std::optional<Section>& section);
    void show();
    void place(bool beside);
    void count();
    /// `all`: how many points there are in the section, hidden ones among them.
    void take(const ShownHeights& found, PointIndex all);
    /// Of a section of this length that is opened in a file with this unit of length.
    double firstWidth(double length, const QString& unit) const;

    MainView m_main;
    SelectTools& m_select;
    MeasureTools& m_measure;
    QSplitter& m_splitter;
    WindowSettings& m_settings;
    std::unique_ptr<ViewRenderer> m_renderer;
    SectionPane* m_pane;
    SectionBand* m_band;
    SectionTool* m_tool;
    SectionRuler* m_ruler;
    ShownPill* m_pill;
    PointMark* m_mainMark;
    PointMark* m_sectionMark;
    std::optional<Section> m_section;
    QPointer<Document> m_document;  ///< the one that was active when it was drawn
    double m_fromHeight = 0.0, m_toHeight = 0.0;
    std::optional<PointIndex> m_points;  ///< in the section, once they are counted
    double m_low = 0.0, m_high = 0.0;    ///< heights (world) that the view shows when it is fitted
    bool m_heightsKnown = false;         ///< of the section as it was drawn
    double m_exaggeration = 1.0;
    std::array<bool, 256> m_countedClasses{};  ///< that were shown when points were counted last ...
    Clip m_countedClip;                        ///< ... and where ...
    QStringList m_countedReasons;              ///< ... and what hides points (ShownState)
    QTimer m_countTimer;
    JobId m_job = 0;
};

}  // namespace punctum::ui
