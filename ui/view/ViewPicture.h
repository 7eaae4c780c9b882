// SPDX-License-Identifier: MIT
#pragma once

#include "ui/view/ViewRenderer.h"

#include <QString>

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

namespace punctum::ui
{

class FramePool;

/// A cloud that views draw, in their renderers' order.
struct DrawnCloud {
    std::shared_ptr<render::PointStore> store;
    bool loading = true;
    std::shared_ptr<const SurfaceView> surface{};  ///< of its ground; null: none is known
};

/// One view, as the render thread knows it: its renderer, the newest wishes, and who waits for the finished
/// picture. Render thread only; throws what the renderer throws.
class ViewPicture
{
public:
    using Publish = std::function<void(std::shared_ptr<const Frame>)>;
    using SnapshotDone = std::function<void(std::shared_ptr<const ViewSnapshot>)>;

    /// `publish` gets each new picture.
    ViewPicture(const ViewRenderer* view, Publish publish);
    ~ViewPicture();

    /// Where pictures go that stay on the device; null: nowhere, they come to memory.
    void setTextures(FrameTextures* textures) noexcept { m_textures = textures; }
    /// Whose picture it is.
    const ViewRenderer* view() const noexcept { return m_view; }

    std::unique_ptr<render::ProgressiveRenderer> renderer;  ///< null while the view is off
    ViewWish known;                                         ///< the newest of each
    bool fresh = false;                                     ///< the renderer was told nothing of what is known
    bool dirty = false;                                     ///< something changed what is to be seen
    bool broken = false;                                    ///< the backend failed; wait for a change
    std::optional<QString> failure;                         ///< what happened in attempt(), until it is settled

    /// Whatever goes wrong is this view's failure.
    template <typename Work>
    void attempt(Work work)
    {
        try {
            work();
        } catch (const std::exception& e) {
            failure = QString::fromLocal8Bit(e.what());
        }
    }
    void apply(const ViewWish& wish);
    bool finished() const { return broken || !renderer || (!dirty && renderer->converged()); }
    /// While files load, there may be more to draw at any time.
    bool wantsFrame(bool loading) const { return !finished() || (loading && renderer && !broken); }

    /// `done`: called once the picture is finished; with null by refuse().
    void askSnapshot(std::shared_ptr<const PointCloud> cloud, SnapshotDone done);
    /// Draws for this long, publishes, and gives what was asked for when the picture is finished.
    void renderNext(std::span<const DrawnCloud> clouds, double seconds);
    /// What waits for a finished picture gets it now, before the view is switched off.
    void finishAndServe(std::span<const DrawnCloud> clouds);
    void refuse();
    std::optional<PickedPoint> pick(int x, int y, int radius, std::span<const DrawnCloud> clouds) const;

private:
    struct Snapshot {
        std::shared_ptr<const PointCloud> cloud;
        SnapshotDone done;
    };
    void publish(const render::FrameReport& report);
    /// `most`: seconds after which it ends in any case.
    void converge(double most);
    void serveSnapshots(std::span<const DrawnCloud> clouds);
    std::shared_ptr<ViewSnapshot> snapshotOf(const std::shared_ptr<const PointCloud>& cloud);

    const ViewRenderer* m_view;
    Publish m_publish;
    std::shared_ptr<FramePool> m_pool;
    FrameTextures* m_textures = nullptr;
    std::vector<Snapshot> m_snapshots;
    std::uint64_t m_frames = 0;
};

/// Whether points of one of them are still being read.
bool anyLoading(std::span<const DrawnCloud> clouds);

}  // namespace punctum::ui
