// SPDX-License-Identifier: MIT
#pragma once

#include "render/camera/Camera.h"
#include "render/progressive/DisplaySettings.h"
#include "render/progressive/WholePicture.h"
#include "render/scene/Image.h"
#include "ui/view/ViewPicture.h"

#include <QString>

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <utility>

namespace punctum
{
class Progress;
}

namespace punctum::ui
{

/// A picture to be drawn beside the view, of any size, camera and settings.
struct StillRequest {
    int width = 0, height = 0;  ///< px
    render::Camera camera;
    render::DisplaySettings display;
};

/// The picture that came of it, and what its colors mean.
struct StillPicture {
    render::Image image;
    std::pair<double, double> range;  ///< of scalar colors
    QString attribute;                ///< that it is colored by
};

/// A still on its way from the render thread to whoever waits for it. Any thread.
class Still
{
public:
    explicit Still(StillRequest request) : m_request(std::move(request)) {}

    const StillRequest& request() const noexcept { return m_request; }
    /// Waits for it. Throws Cancelled, after which nobody draws it; Error when there will be none.
    StillPicture wait(Progress& progress);

    // -- of the render thread
    bool cancelled() const noexcept { return m_cancelled; }
    void setShare(double share) noexcept { m_share = share; }
    void deliver(StillPicture picture);
    void refuse(const std::string& sentence);

private:
    const StillRequest m_request;
    std::atomic<bool> m_cancelled = false;
    std::atomic<double> m_share = 0.0;
    std::mutex m_mutex;
    std::condition_variable m_arrived;
    std::optional<StillPicture> m_picture;
    std::string m_failure;
};

/// A still that is being drawn by the processor, from the stores that the views show. Render thread only.
class StillDrawing
{
public:
    /// Of these clouds, whose attribute on screen is the one of the request.
    StillDrawing(std::shared_ptr<Still> still, std::span<const DrawnCloud> clouds);
    ~StillDrawing();

    /// Calls change(renderer), and begins the picture anew: no picture is half of before and half of after.
    template <typename Change>
    void follow(Change change)
    {
        try {
            change(m_renderer);
            m_picture.reset();
        } catch (const std::exception& e) {
            refuse(e.what());
        }
    }
    /// The views show another attribute from now on, and so do the stores.
    void attributeChosen(const std::string& name);
    /// Goes on for about so many seconds, not while clouds load. True: it is over, and whoever waits knows.
    bool draw(std::span<const DrawnCloud> clouds, double seconds);

private:
    void refuse(const std::string& sentence);

    std::shared_ptr<Still> m_still;
    render::ProgressiveRenderer m_renderer;
    std::optional<render::WholePicture> m_picture;
    bool m_over = false;
};

}  // namespace punctum::ui
