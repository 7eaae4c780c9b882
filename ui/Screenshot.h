// SPDX-License-Identifier: MIT
#pragma once

#include "render/resolve/Image.h"

#include <QString>

#include <condition_variable>
#include <memory>
#include <mutex>

namespace punctum
{
class Progress;
}

namespace punctum::ui
{

/// A picture on its way from the render thread to the job that writes it. Any thread.
class ScreenshotPicture
{
public:
    /// Null: there will be none.
    void deliver(std::shared_ptr<const render::Image> image);
    /// Waits for it. Throws Cancelled; Error when there will be none.
    std::shared_ptr<const render::Image> wait(const Progress& progress);

private:
    std::mutex m_mutex;
    std::condition_variable m_arrived;
    std::shared_ptr<const render::Image> m_image;
    bool m_delivered = false;
};

/// Waits for the picture and writes it as PNG, whole or not at all. In a job. Throws Error or Cancelled.
void writeScreenshot(ScreenshotPicture& picture, const QString& path, Progress& progress);

}  // namespace punctum::ui
