// SPDX-License-Identifier: MIT
#pragma once

#include "core/select/Selecting.h"
#include "render/camera/Camera.h"
#include "render/camera/Projection.h"
#include "render/progressive/DisplaySettings.h"
#include "render/progressive/FrameCostModel.h"
#include "render/raster/Backend.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace punctum::render
{

/// What one call of renderFrame did.
struct FrameReport {
    double seconds = 0;      ///< from call to return
    PointIndex filled = 0;   ///< slots drawn in the fill pass
    double share = 0;        ///< of all slots drawn with the present camera, 0 to 1
    bool converged = false;  ///< image equals the brute-force image and nothing streams
    /// Seconds of its parts. Where the device keeps the time, of reprojecting and filling by its clock.
    struct Passes {
        double reproject = 0;  ///< what was visible, drawn anew
        double fill = 0;       ///< further slots
        double resolve = 0;    ///< colors, light, holes; the picture brought over, where it is
        double stream = 0;     ///< words of another attribute, or after a change
    } passes;
    std::uint64_t bytesUp = 0;    ///< brought to the device ...
    std::uint64_t bytesDown = 0;  ///< ... and back; 0 where the processor draws
};

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

    enum class StoreChange { Values, Selection, Hidden };
    /// Another renderer has changed stores that this one draws, too.
    void storesChanged(StoreChange change);

    // -- view
    void setSize(int width, int height);
    /// Draws a part, of setSize(), of a larger picture; none: all of it. A part knows of the picture as a whole
    /// what it is told: `eyeDomeExtent` (EyeDomeSettings::extent), without which it has no eye-dome lighting.
    void setPart(std::optional<PicturePart> part, float eyeDomeExtent = 0.0f);
    void setCamera(const Camera& camera);
    const Camera& camera() const noexcept { return m_camera; }
    void setDisplay(const DisplaySettings& display);
    const DisplaySettings& display() const noexcept { return m_display; }
    /// Range that scalar colors are drawn over at present (world values of the attribute).
    std::pair<double, double> range() const noexcept { return m_range; }
    /// Name of the attribute on screen: the display's where a cloud has it, else what the first cloud shows.
    std::string shownAttribute() const;

    // -- frames
    /// Draws exactly so many slots a frame (rounded up to windows of the order), whatever the time; 0, as at first:
    /// as many as renderFrame() has time for.
    void setPointsAFrame(PointIndex points) noexcept { m_pointsAFrame = points; }
    PointIndex pointsAFrame() const noexcept { return m_pointsAFrame; }
    /// Draws for about `budget` seconds into image(). Does nothing (converged, 0 points) when nothing changed.
    FrameReport renderFrame(double budget);
    /// All points in one pass, no progression: the reference image.
    FrameReport renderBruteForce();
    /// The picture. Brings it over where it is on the device.
    const Image& image();
    /// Pictures stay on the device, where the backend has one, until image() or copyPicture() asks for them. Off at
    /// first.
    void keepOnDevice(bool keep) noexcept { m_keepOnDevice = keep; }
    /// Whether the last picture stayed on the device.
    bool onDevice() const noexcept { return m_onDevice; }
    /// Whether a picture was made.
    bool hasPicture() const noexcept { return m_onDevice || m_image.width > 0; }
    /// Copies it to an RGBA8 texture of the picture's size, row 0 at the top, and waits for that; false where it is
    /// not on the device.
    bool copyPicture(unsigned texture);
    /// Of each pixel, as RasterBackend::depths().
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
    struct Entry;
    Entry* find(const PointCloud& cloud) noexcept;
    bool ready() const noexcept;
    void applyDisplay(Entry& entry);
    /// Whether a cloud has this attribute, and did not show it already.
    bool show(Entry& entry, const std::string& name);
    /// One legend serves all clouds: what the first of those shows that are colored by a range, all of these show
    /// that have it.
    void agreeOnAttribute();
    /// Name of the attribute that the range is of; empty when no cloud is colored by one.
    std::string scalarInLegend() const;
    void judgeColors();
    void updateScene();
    void updateRange();
    void beginPass() noexcept;
    void refreshVisible();
    bool anyStale() const noexcept;
    void streamAttributes(double deadline);
    void wordsFresh() noexcept;
    PointStyle styleOf(Entry& entry) const;
    /// Draws further slots until then.
    void fill(double deadline);
    /// The same by a device that keeps the time; countTimed() tells afterwards what it came to.
    void fillTimed(double deadline);
    void countTimed();
    /// Clouds that are all drawn, but have got more points meanwhile, begin once more.
    void beginGrown() noexcept;
    bool partial() const noexcept;
    ResolveSettings colorSettings() const;
    /// Once all points are drawn: goes on adding colors, from the start when they have become others.
    void addColors(const ResolveSettings& settings, double deadline);
    void resolveImage(ResolveSettings settings);

    std::unique_ptr<RasterBackend> m_backend;
    std::vector<std::unique_ptr<Entry>> m_entries;
    FrameScene m_scene;
    Camera m_camera;
    DisplaySettings m_display;
    TargetSize m_size;
    std::optional<PicturePart> m_part;
    float m_partExtent = 0;
    std::pair<double, double> m_range{0.0, 1.0};
    Image m_image;
    bool m_imageThere = true;  ///< else it is on the device alone
    bool m_onDevice = false;
    bool m_keepOnDevice = false;
    FrameReport::Passes m_passes;  ///< of this frame
    FrameCostModel m_cost;         ///< of drawing
    FrameCostModel m_colorCost;    ///< of addColors()
    ResolveSettings m_colors;      ///< that colors were added with
    std::vector<PointId> m_visible;
    PointIndex m_pointsAFrame = 0;
    PointIndex m_filled = 0;                      ///< slots drawn in this frame
    std::vector<RasterBackend::Run> m_timedRuns;  ///< that the backend draws as many of as it has time for
    double m_clockStarted = 0;                    ///< when that time began
    double m_fillDone = 0;                        ///< when the backend was done with them
    double m_resolveSeconds = 0;                  ///< what making the picture costs, learnt
    bool m_targetChanged = true;                  ///< size or samples: a new, empty buffer is needed
    bool m_layersChanged = true;                  ///< ids have new meanings: the buffer must be emptied
    bool m_viewChanged = true;  ///< camera, point size, hidden classes: what is visible must be seen anew
    bool m_resolveNeeded = true;
    bool m_rangeNeeded = true;
    bool m_agreementNeeded = true;   ///< on the attribute of the legend
    bool m_visibleOutdated = true;   ///< words of visible points may not be those of the present values
    bool m_streaming = false;        ///< words were out of date in the last frame
    bool m_redrawWhenFresh = false;  ///< classes changed while some are hidden
};

}  // namespace punctum::render
