// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Visibility.h"
#include "core/select/Selecting.h"
#include "core/task/Jobs.h"
#include "ui/select/SelectionSteps.h"

#include <QObject>
#include <QPointer>
#include <QString>

#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace punctum::ui
{

class Document;
class ViewFilter;
class ViewRenderer;
class ViewSettings;
class Workspace;
struct ViewSnapshot;

/// Which points of each open document are selected, and how tools change that. Tools work on the active document.
///
/// Each selection that is finished is a step that can be undone; UndoOrder puts these in order with the edits.
///
/// GUI thread only; every call returns at once, the work is done by jobs, one after the other. While a tool is
/// drawing, only the newest shape counts. Points that the view hides (by class, filter or
/// clip) and those of locked classes are never selected.
class Selection final : public QObject
{
    Q_OBJECT
public:
    /// How deep into the picture a tool reaches.
    enum class Depth {
        Through,  ///< everything behind the marked px
        Visible,  ///< the points that can be seen
        Slab,     ///< what lies around the pivot's depth, slabThickness() of the coordinates' units
    };

    Selection(Workspace& workspace, ViewRenderer& renderer, const ViewSettings& settings, const ViewFilter& filter,
              QObject* parent = nullptr);

    SelectMode mode() const noexcept { return m_mode; }
    void setMode(SelectMode mode);
    Depth depth() const noexcept { return m_depth; }
    void setDepth(Depth depth);
    double slabThickness() const noexcept { return m_slab; }
    void setSlabThickness(double units);

    /// Null while nothing of it is selected.
    std::shared_ptr<const PointSet> points(const Document* document) const;
    /// Of the active document.
    PointIndex count() const;
    /// How many of them the view does not show, being behind others or outside of the picture.
    PointIndex hiddenCount() const;
    /// A shape or question is being worked on.
    bool busy() const noexcept { return m_job != 0 || !m_tasks.empty(); }

    // -- what tools draw
    /// What is selected now is what shapes are put together with, until finish() or abandon(). Shapes are drawn in
    /// `view`, of whose points those that `cuts` leave are meant; null: the main view.
    void begin(SelectMode mode, ViewRenderer* view = nullptr, std::vector<ClipPlane> cuts = {});
    bool drawing() const noexcept { return m_drawing; }
    /// The camera has moved: the shapes that follow lie on another picture.
    void viewMoved();
    /// The shape so far; shown as soon as it is worked out.
    void draw(ScreenMask mask);
    void finish(ScreenMask mask);
    void abandon();

    // -- without a shape; by the mode where that makes sense
    void clear();
    void invert();
    void selectAll();
    /// Throws expression::ExpressionError when the text is no condition for the active document.
    void selectByRule(const QString& condition);
    /// Whatever the mode of the tools.
    void selectClass(unsigned code, SelectMode mode);
    /// Those that `find` finds in a job, by the mode.
    void selectFound(const QString& title, std::function<PointSet(const PointCloud&, Progress&)> find);
    /// By a look at neighbors; neighborsTaken() tells what came of it. `distance`: in the document's unit of
    /// length.
    void grow(double distance);
    void shrink(double distance);
    void connectNeighbors(double distance);

    // -- steps back and on, of the active document
    /// What undo() would take back; null: nothing. Those that are being undone count as undone.
    const SelectionSteps::Step* nextUndo() const;
    const SelectionSteps::Step* nextRedo() const;
    void undo() { askStep(Kind::Undo); }
    void redo() { askStep(Kind::Redo); }

signals:
    void changed();          ///< points, or their counts
    void settingsChanged();  ///< mode, depth
    /// Of grow(), shrink() or connectNeighbors(): points that joined, and points that left.
    void neighborsTaken(quint64 joined, quint64 left);

private:
    struct State {
        std::shared_ptr<const PointSet> points;
        PointIndex count = 0;
        PointIndex hidden = 0;
    };
    /// Makes the new selection from the old one (null: nothing), in a job.
    using Work = std::function<PointSet(const std::shared_ptr<const PointSet>& before, const ViewSnapshot& view,
                                        Progress& progress)>;
    /// The selection that a task begins from: that of the moment when it, or the first shape of a drawing, is
    /// begun.
    struct Base {
        bool known = false;
        State state;
    };
    /// The picture that a shape lies on, asked for as soon as there is a shape: the view may close or move on
    /// before it is worked out.
    struct Shot {
        bool answered = false;
        std::shared_ptr<const ViewSnapshot> view;  ///< null: there is none
    };
    enum class Kind {
        New,    ///< a step of its own, once it is finished
        Undo,   ///< of the newest step
        Redo,   ///< of the one that was undone last
        Follow  ///< the points have changed: no step
    };
    struct Task {
        QString title;
        Kind kind = Kind::New;
        Work work;
        bool live = false;       ///< may be left out when a newer one has come
        bool neighbors = false;  ///< ends with neighborsTaken()
        std::shared_ptr<Base> base;
        std::shared_ptr<Shot> shot;
        QPointer<Document> document;
    };

    Document* active() const;
    State state(const Document* document) const;
    void dropDeleted();
    /// What the main view, or another one, shows of the active document.
    std::shared_ptr<Shot> takeShot(ViewRenderer& view);
    void ask(Task task);
    void askShape(ScreenMask mask, bool live);
    void startNext();
    void run(Task task);
    void publish(Document& document, State state);
    void askStep(Kind kind);
    std::size_t asked(Kind kind) const;
    /// A selection of before is kept, and packed by a job.
    std::shared_ptr<KeptSelection> keep(const Document& document, std::shared_ptr<const PointSet> points);
    void noteStep(Document& document, Kind kind, const QString& title, const State& before);
    /// Says in a job which points of a set may be touched; asked for in the GUI thread.
    using WhatTouchable = std::function<Touchable(const PointCloud&, const PointSet& among, Progress&)>;
    WhatTouchable touchable(const std::vector<ClipPlane>& cuts = {}) const;
    /// What is found, as far as it may be touched, is put together with the selection by the mode.
    using Find = std::function<PointSet(const ViewSnapshot& view, Progress& progress)>;
    static Work putTogether(SelectMode mode, WhatTouchable touchable, Find find);
    void askFound(const QString& title, SelectMode mode, Find find);
    void askCondition(const QString& text, SelectMode mode);
    /// One that makes another selection of the present one, looking at neighbors.
    void askNeighbors(const QString& title,
                      std::function<PointSet(const PointSet&, const KdOrder&, Progress&)> change);

    Workspace& m_workspace;
    ViewRenderer& m_renderer;
    const ViewSettings& m_settings;
    const ViewFilter& m_filter;
    SelectMode m_mode = SelectMode::Replace;
    Depth m_depth = Depth::Through;
    double m_slab = 5.0;
    std::map<const Document*, State> m_states;
    std::map<const Document*, SelectionSteps> m_steps;
    bool m_drawing = false;
    SelectMode m_drawMode = SelectMode::Replace;
    std::shared_ptr<Base> m_base;  ///< of the drawing
    std::shared_ptr<Shot> m_shot;  ///< of the drawing; null: none since the camera moved
    ViewRenderer* m_drawView = nullptr;
    std::vector<ClipPlane> m_drawCuts;
    std::deque<Task> m_tasks;
    JobId m_job = 0;
    Kind m_running = Kind::New;      ///< of the task whose job runs
    std::uint64_t m_generation = 0;  ///< answers to questions asked before the last abandon() are dropped
};

}  // namespace punctum::ui
