// SPDX-License-Identifier: MIT
#pragma once

#include "core/select/Selecting.h"
#include "render/camera/Camera.h"
#include "render/camera/Projection.h"
#include "render/progressive/DisplaySettings.h"
#include "render/progressive/FramePicture.h"
#include "render/progressive/FrameReport.h"
#include "render/progressive/FrameScheduler.h"
#include "render/progressive/SharedLegend.h"
#include "render/progressive/ViewLook.h"
#include "render/progressive/WordStream.h"
#include "render/raster/Backend.h"
#include "render/surface/SurfaceRaster.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace punctum::render
{

/// What is under the cursor.
struct PickResult {
    std::size_t cloud = 0;  ///< index into the clouds, in the order they were added
    PointIndex index = 0;
    glm::dvec3 world{0.0};
};

/// The progressive picture of one view (Schuetz et al. 2019, section 3.4): each frame reprojects what was visible,
/// then draws further runs of slots until the frame's time is spent; a still view converges to the image of all
/// points, then idles.
///
/// It knows what a view is told, and the order of a frame; which slots are drawn is FrameScheduler's business,
/// words are WordStream's, the attribute and range that all clouds share SharedLegend's, the picture
/// FramePicture's.
///
/// One thread (the render thread) calls everything; loader threads meanwhile fill the stores. Takes each cloud's
/// mutex() shared while it reads columns. Errors: Error from the backend.
///
/// Several renderers of one thread may draw the same stores. They show the same attribute then; what one is told by
/// valuesChanged(), setSelection(), setPreview() or hide() it does to the stores, and the others are told by
/// storesChanged().
class ProgressiveRenderer
{
public:
    explicit ProgressiveRenderer(std::unique_ptr<RasterBackend> backend);
    ~ProgressiveRenderer();

    RasterBackend& backend() noexcept { return *m_backend; }
    /// Goes on with another backend; the picture starts anew there.
    void setBackend(std::unique_ptr<RasterBackend> backend);

    // -- clouds
    /// Throws Error where a view cannot number so many points; nothing has changed then.
    void addCloud(std::shared_ptr<PointStore> store);
    void removeCloud(const PointCloud& cloud);
    /// Call after a change of values or attributes (from any ChangeNotice) and when loading has ended.
    void valuesChanged(const PointCloud& cloud, const ChangeNotice& notice);
    void loadingEnded(const PointCloud& cloud, const RawBounds& bounds);
    /// Points that are drawn as selected; null: none.
    void setSelection(const PointCloud& cloud, std::shared_ptr<const PointSet> selection);
    /// Colors as they would be after a change, PointStore::setPreview(); null: as they are.
    void setPreview(const PointCloud& cloud, std::shared_ptr<const Preview> preview);

    /// Points that are not drawn from now on, beside hidden classes and what the clip cuts off; null: none.
    void hide(const PointCloud& cloud, const PointSet* points);

    /// Goes on with other slots of a store, PointStore::arrangement(); what the picture shows is seen anew in them.
    void arrange(const PointCloud& cloud, Arrangement&& arrangement);

    /// The ground surface of a cloud, drawn where the display says how; null: none.
    void setSurface(const PointCloud& cloud, std::shared_ptr<const SurfaceView> surface);

    enum class StoreChange { Values, Selection, Hidden, Slots };
    /// Another renderer has changed stores that this one draws, too.
    void storesChanged(StoreChange change);

    // -- view
    void setSize(int width, int height);
    /// Draws a part, of setSize(), of a larger picture; none: all of it. A part knows of the picture as a whole
    /// what it is told: `eyeDomeExtent` (EyeDomeSettings::extent), without which it has no eye-dome lighting.
    void setPart(std::optional<PicturePart> part, float eyeDomeExtent = 0.0f);
    void setCamera(const Camera& camera);
    const Camera& camera() const noexcept { return m_look.camera; }
    void setDisplay(const DisplaySettings& display);
    const DisplaySettings& display() const noexcept { return m_look.display; }
    /// Range that scalar colors are drawn over at present (world values of the attribute).
    std::pair<double, double> range() const noexcept { return m_legend.range(); }
    /// Name of the attribute on screen: the display's where a cloud has it, else what the first cloud shows.
    std::string shownAttribute() const { return SharedLegend::shownAttribute(m_clouds, m_look.display); }

    // -- frames
    /// Draws exactly so many slots a frame (rounded up to windows of the order), whatever the time; 0, as at first:
    /// as many as renderFrame() has time for.
    void setPointsAFrame(PointIndex points) noexcept { m_scheduler.setPointsAFrame(points); }
    PointIndex pointsAFrame() const noexcept { return m_scheduler.pointsAFrame(); }
    /// Draws for about `budget` seconds into image(). Does nothing (converged, 0 points) when nothing changed.
    FrameReport renderFrame(double budget);
    /// All points in one pass, no progression: the reference image. Of a cloud beyond memory it has more points
    /// than renderFrame() asks for.
    FrameReport renderBruteForce();
    /// The picture. Brings it over where it is on the device.
    const Image& image() { return m_picture.image(*m_backend); }
    /// Pictures stay on the device, where the backend has one, until image() or copyPicture() asks for them. Off at
    /// first.
    void keepOnDevice(bool keep) noexcept { m_picture.keepOnDevice(keep); }
    /// Whether the last picture stayed on the device.
    bool onDevice() const noexcept { return m_picture.onDevice(); }
    /// Whether a picture was made.
    bool hasPicture() const noexcept { return m_picture.made(); }
    /// Copies it to an RGBA8 texture of the picture's size, row 0 at the top, and waits for that; false where it is
    /// not on the device.
    bool copyPicture(unsigned texture);
    /// Of each pixel, as VisibilityBuffer::depths().
    void depths(std::vector<float>& out) { m_backend->depths(out); }
    bool converged() const noexcept;
    /// Points that a full picture of the present view looks at, about: those of stretches in sight.
    PointIndex pointsInSight() const noexcept;

    /// The points of a cloud that the picture shows; say so once it has converged.
    PointSet visiblePoints(const PointCloud& cloud);
    /// How the picture shows the raw coordinates of a cloud.
    PictureProjection projectionOf(const PointCloud& cloud) const;
    /// The point nearest to a px, of those on screen.
    std::optional<PickResult> pick(int x, int y, int radius = 4);
    /// Share of the pixels that have a point.
    double coveredShare() { return m_backend->coveredShare(); }

private:
    ViewCloud* find(const PointCloud& cloud) noexcept;
    /// Shows the display's attribute of a cloud that has it.
    void applyDisplay(ViewCloud& cloud);
    /// Words of visible points may be others from now on, and so the picture.
    void outdateWords() noexcept;
    /// Words are others: sums of their colors are worth nothing, either.
    void outdateColors();
    /// Called in the frame that brings the last words, or finds that another renderer has.
    void wordsFresh() noexcept;
    /// Stores have other slots: remembers the points that the picture shows.
    void keepThroughArranging();
    /// Before a frame: clouds agree on what is shown, and on colors that are judged right.
    void agree();
    void refreshVisible();
    /// Makes the scene of the next frame from what the view was told.
    void updateScene();
    bool drawsPartly() const noexcept;
    bool current() const noexcept;
    void noteArrivals();
    void resolveImage(ResolveSettings settings);
    bool showsSurface() const noexcept;
    /// Finds out which pixels show a point that gives way to the surface.
    void findReplaced(const ResolveSettings& settings);
    /// Puts surface and points together; draws the surface anew where what is seen of it has changed.
    void composeSurface(const ResolveSettings& settings);

    std::unique_ptr<RasterBackend> m_backend;
    ViewClouds m_clouds;
    FrameScene m_scene;
    ViewLook m_look;
    TargetSize m_size;
    FrameScheduler m_scheduler;
    WordStream m_words;
    SharedLegend m_legend;
    FramePicture m_picture;
    SurfaceRaster m_surface;
    bool m_surfaceChanged = true;          ///< what is to be seen of it
    bool m_surfaceCoarse = false;          ///< it was drawn in a hurry
    bool m_moving = false;                 ///< this frame shows another view than the one before
    std::vector<float> m_depths;           ///< of the points, for composeSurface()
    std::vector<PointId> m_nearest;        ///< of each px, for ...
    std::vector<std::uint8_t> m_replaced;  ///< ... SurfaceRaster::Points
    FrameReport::Passes m_passes;          ///< of this frame
    std::vector<PointId> m_kept;  ///< what the picture showed when slots became others, by what they are now
    bool m_targetChanged = true;  ///< size or samples: a new, empty buffer is needed
    bool m_layersChanged = true;  ///< ids have new meanings: the buffer must be emptied
    bool m_slotsChanged = false;  ///< ids have new meanings, and m_kept has those of what the buffer shows
    bool m_viewChanged = true;    ///< camera, point size, hidden classes: what is visible must be seen anew
};

}  // namespace punctum::render
