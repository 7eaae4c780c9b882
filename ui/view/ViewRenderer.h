// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/ProgressiveRenderer.h"
#include "ui/view/PickedPoint.h"
#include "ui/view/SharedContext.h"

#include <QObject>
#include <QString>

#include <condition_variable>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>
#include <vector>

namespace punctum::render
{
struct Arrangement;
}

namespace punctum::ui
{

/// Which backend was the fastest when they were measured.
struct FastestBackend {
    render::BackendKind kind = render::BackendKind::Cpu;
    std::optional<std::string> device;  ///< render::BackendMeasurement::device; none: never measured
};

/// A finished picture, and what it shows. Immutable once published.
struct Frame {
    render::Image image;                          ///< empty where there is a texture
    std::shared_ptr<const FrameTexture> texture;  ///< the picture on the device; null: it is in memory
    bool empty() const noexcept { return !texture && image.width <= 0; }
    render::Camera camera;  ///< that it was drawn with
    render::FrameReport report;
    std::pair<double, double> range;  ///< of scalar colors
    QString attribute;                ///< that it is colored by
    std::uint64_t number = 0;         ///< 1, 2, 3, ...
};

/// What selecting needs to know of a finished picture, for one cloud.
struct ViewSnapshot {
    std::shared_ptr<const PointCloud> cloud;
    PictureProjection projection;
    double pivotDepth = 0.0;                  ///< as the projection tells depths
    std::shared_ptr<const PointSet> visible;  ///< the points that can be seen
};

/// What is to be seen, where that is new to the picture.
struct ViewWish {
    std::optional<std::pair<int, int>> size;
    std::optional<render::Camera> camera;
    std::optional<render::DisplaySettings> display;
    bool any() const { return size || camera || display; }
};

class Still;
class ViewPicture;

/// The render thread: owns the progressive renderer and its backend, and draws a frame whenever something changed
/// or the picture is not finished. An idle view costs no processor time.
///
/// Every member may be called from the GUI thread and returns at once; signals come in the GUI thread. Of cameras,
/// sizes and settings only the newest counts. While files load and nobody moves the camera, frames come in a calm
/// rhythm, so that loading gets the cores.
///
/// A view may have others beside it, of the same clouds: its thread draws them in turn, each a share of the frame's
/// time while several are unfinished.
class ViewRenderer final : public QObject
{
    Q_OBJECT
public:
    /// `backend`: none for the fastest. That is `fastest`, if the device is still the same; otherwise the processor
    /// draws until nothing has happened for some seconds, and then all backends are measured.
    ///
    /// `shared`: for OpenGL, whose pictures then stay on the device (Frame::texture); null: they come to memory.
    /// `whyNotShared`: a sentence that is told where OpenGL draws then; empty: nobody wanted to.
    ViewRenderer(std::optional<render::BackendKind> backend, FastestBackend fastest, QObject* parent = nullptr,
                 std::unique_ptr<SharedContext> shared = nullptr, const QString& whyNotShared = {});
    /// Another view of what `first` shows, drawn by the processor from the same stores, so that it takes memory for
    /// its picture alone. Off until setOn(true). What is told of clouds is told to `first`, which must outlive it.
    explicit ViewRenderer(ViewRenderer& first, QObject* parent = nullptr);
    ~ViewRenderer() override;

    /// Of a view beside another one. Off, it has no picture and costs nothing; picks and snapshots give none. What
    /// was asked for before is still given.
    void setOn(bool on);

    void setSize(int widthPx, int heightPx);
    void setCamera(const render::Camera& camera);
    void setDisplay(const render::DisplaySettings& display);
    /// Time of a frame in seconds, 1/60 at first; `points`: drawn in each frame whatever the time, 0: as time
    /// allows.
    void setBudget(double seconds, PointIndex points);
    /// None: the fastest.
    void setBackend(std::optional<render::BackendKind> kind);

    void addCloud(std::shared_ptr<render::PointStore> store);
    void loadingEnded(std::shared_ptr<const PointCloud> cloud, const RawBounds& bounds);
    /// Other slots for what is drawn of a cloud that is loaded: render::PointStore::arrangement().
    void arrange(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<render::Arrangement> arrangement);
    void removeCloud(std::shared_ptr<const PointCloud> cloud);
    void valuesChanged(std::shared_ptr<const PointCloud> cloud, const ChangeNotice& notice);

    /// Points that are not drawn; null: none.
    void hide(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const PointSet> points);
    /// Points drawn as selected; null: none.
    void setSelection(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const PointSet> selection);
    /// Colors as they would be after a change; null: as they are.
    void setPreview(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const Preview> preview);
    /// The ground surface of a cloud, drawn where the settings say so; null: none.
    void setSurface(std::shared_ptr<const PointCloud> cloud, std::shared_ptr<const SurfaceView> surface);
    using SnapshotReply = std::function<void(const std::shared_ptr<const ViewSnapshot>&)>;
    /// The view of a cloud once the picture is finished; `reply` is called in the thread of `receiver`, unless that
    /// is gone, with null when the cloud is.
    void snapshot(std::shared_ptr<const PointCloud> cloud, QObject* receiver, SnapshotReply reply);

    using PickReply = std::function<void(const std::optional<PickedPoint>&)>;
    /// The point nearest to this px of the picture, up to `radius` px away; `reply` is called in the thread of
    /// `receiver`, unless that is gone.
    void pick(int x, int y, QObject* receiver, PickReply reply, int radius = kPickRadius);
    static constexpr int kPickRadius = 4;  ///< px

    /// Draws a picture beside the view, once no cloud loads, while the view goes on; whoever waits for the still
    /// gets it. Its attribute has to be the one on screen.
    void draw(std::shared_ptr<Still> still);

    /// The newest picture; null before the first. Any thread.
    std::shared_ptr<const Frame> frame() const;

signals:
    /// There is a newer frame() than at the last signal.
    void frameReady();
    void backendChanged(punctum::render::BackendKind kind, const QString& description);
    void backendsMeasured(const punctum::ui::FastestBackend& fastest);
    /// A sentence for the user: the view goes on with another backend, or stands still.
    void failed(const QString& sentence);

private:
    struct Thread;
    struct Command {
        ViewRenderer* view;  ///< whose picture it is about
        std::function<void(Thread&)> act;
    };

    void post(std::function<void(Thread&)> command);
    /// Changes the wish for this view's picture.
    template <typename Change>
    void wish(Change change);
    void run(std::optional<render::BackendKind> backend, FastestBackend fastest);
    void useBackend(Thread& thread, render::BackendKind kind);
    void applyChoice(Thread& thread);
    void measureBackends(Thread& thread);
    /// A frame of each view that wants one, in the time of one, and a bit of the still that waits.
    void drawFrames(Thread& thread);
    ViewPicture& pictureOf(Thread& thread) const;
    std::unique_ptr<ViewPicture> makePicture();
    /// Makes current what the thread's OpenGL backend draws in; nothing where the processor draws.
    void makeCurrent(Thread& thread);
    void settleFailures(Thread& thread);
    void publish(std::shared_ptr<const Frame> frame);
    void announceFailure(const QString& sentence);

    ViewRenderer& m_first;  ///< whose thread draws this one; itself
    // All views are guarded by the first one's mutex.
    mutable std::mutex m_mutex;
    ViewWish m_wish;
    bool m_on = true;
    std::shared_ptr<const Frame> m_frame;
    bool m_announced = false;  ///< frameReady is on its way and not yet delivered
    // Of the first alone.
    std::condition_variable m_wake;
    std::vector<ViewRenderer*> m_views;  ///< this one, and those beside it
    std::vector<Command> m_commands;
    std::unique_ptr<SharedContext> m_shared;  ///< used by the render thread; dropped there when it does not work
    QString m_whyNotShared;                   ///< for the render thread
    bool m_stop = false;
    std::thread m_thread;  // last: starts when everything else is there
};

}  // namespace punctum::ui
