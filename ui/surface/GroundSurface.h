// SPDX-License-Identifier: MIT
#pragma once

#include "core/surface/Surface.h"
#include "core/task/Jobs.h"
#include "ui/document/Document.h"
#include "ui/surface/SurfaceLine.h"
#include "ui/view/MainView.h"

#include <QDialog>
#include <QObject>
#include <QPointer>
#include <QString>
#include <QTimer>

#include <bitset>
#include <functional>
#include <map>
#include <memory>

class QAction;
class QLabel;

namespace punctum::ui
{

class ContourMenu;
class Menus;
class Sections;
class Selection;

/// The ground surface of what is open: whether the view shows it and how, with which contours, of which classes it
/// is made, and what is asked of it (points above or below it, volumes). It follows each edit.
///
/// GUI thread only; a child of the window. Surfaces are made and brought up to date by jobs, one after the other
/// for each document.
class GroundSurface final : public QObject
{
    Q_OBJECT
public:
    GroundSurface(const MainView& main, Menus& menus, Selection& selection);

    /// Draws it as a line over the section view, too; `sections` outlives this.
    void showIn(Sections& sections);
    const SurfaceLine& line() const noexcept { return *m_line; }

    bool isOn() const noexcept { return m_on; }
    void setOn(bool on);
    void setTinted(bool tinted);
    void setPointsOnTop(bool onTop);
    /// Whether the points that it is made of give way to it: ViewSettings::setGroundReplaced(). Remembered.
    void setOwnPointsHidden(bool hidden);
    /// That make the surface; 2 at first.
    const std::bitset<256>& classes() const noexcept { return m_classes; }
    void setClasses(const std::bitset<256>& classes);
    /// Whether what the view shows is not what the classes say at present.
    bool busy() const;
    /// The surface of a document as it is; null while there is none.
    std::shared_ptr<const Surface> surface(const Document* document) const;

    // -- of the active document
    /// Selects by the mode of the tools the points whose height above the surface lies between these, in the
    /// document's unit of length; each may be infinite.
    void select(double low, double high);
    /// Measures the volume between the surface and a height, within the outline of the selection or, where nothing
    /// is selected, everywhere; a message tells it.
    void measureVolume(double height);

signals:
    /// A surface was made or brought up to date, and the view was told.
    void updated();

private:
    struct Entry {
        QPointer<Document> document;
        std::shared_ptr<Surface> surface;
        JobId job = 0;
        std::shared_ptr<PointSet> changed;  ///< since the surface was asked for last
        bool all = false;                   ///< more than these: everything

        bool beingMade() const noexcept { return job != 0 && !surface; }
    };

    void addMenu(Menus& menus);
    void applyLook();
    void ensure(Document& document);
    void take(Document& document, const ChangeNotice& notice);
    void update(Entry& entry);
    void show(const Entry& entry);
    void forget(const Document* document);
    /// A surface will not come, or is none any longer.
    void lose(const Document* document);
    /// Tells contours and status bar what is shown.
    void tellHeights();
    void tellState();
    void findLine();
    void chooseClasses();
    void askSelection();
    void askVolume();
    /// In a job: the surface that there is, or one made for it.
    std::function<std::shared_ptr<const Surface>(Progress&)> source(Document& document);

    MainView m_main;
    Menus& m_menus;
    Selection& m_selection;
    bool m_on = false, m_tinted = true, m_pointsOnTop = false;
    std::bitset<256> m_classes{4};
    std::map<const Document*, Entry> m_entries;
    QAction* m_show = nullptr;
    QAction* m_tint = nullptr;
    QAction* m_onTop = nullptr;
    QAction* m_hideOwn = nullptr;
    ContourMenu* m_contours = nullptr;
    QLabel* m_state;  ///< in the status bar, while there is something to say
    QTimer m_ticks;   ///< while a surface is made
    QPointer<QDialog> m_dialog;
    Sections* m_sections = nullptr;
    QPointer<SurfaceLine> m_line;
    JobId m_lineJob = 0;
    bool m_lineAgain = false;
};

}  // namespace punctum::ui
