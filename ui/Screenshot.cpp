// SPDX-License-Identifier: MIT
#include "ui/Screenshot.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "ui/Text.h"
#include "ui/ViewRenderer.h"
#include "ui/Workspace.h"

#include <QFileInfo>
#include <QImage>
#include <QImageWriter>
#include <QSaveFile>

#include <chrono>
#include <condition_variable>
#include <mutex>

namespace punctum::ui
{

namespace
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

void ScreenshotPicture::deliver(std::shared_ptr<const render::Image> image)
{
    {
        const std::lock_guard lock(m_mutex);
        m_image = std::move(image);
        m_delivered = true;
    }
    m_arrived.notify_all();
}

std::shared_ptr<const render::Image> ScreenshotPicture::wait(const Progress& progress)
{
    std::unique_lock lock(m_mutex);
    while (!m_arrived.wait_for(lock, std::chrono::milliseconds(50), [this] { return m_delivered; }))
        progress.check();
    if (!m_image) throw Error("The view ended before its picture was finished.");
    return m_image;
}

/// Waits for the picture and writes it.
void writeScreenshot(ScreenshotPicture& picture, const QString& path, Progress& progress)
{
    progress.begin("Drawing all points", 1);
    const auto image = picture.wait(progress);
    progress.begin("Writing the picture", 1);
    const QImage wrapped(reinterpret_cast<const uchar*>(image->pixels.data()), image->width, image->height,
                         image->width * 4, QImage::Format_RGBA8888);
    QSaveFile file(path);
    const auto fail = [&](const QString& reason) {
        file.cancelWriting();
        throw Error(toPath(path), "The picture could not be written: " + reason.toStdString() + ".");
    };
    if (!file.open(QIODevice::WriteOnly)) fail(file.errorString());
    QImageWriter writer(&file, "png");
    if (!writer.write(wrapped)) fail(writer.errorString());
    progress.check();
    if (!file.commit()) fail(file.errorString());
}

}  // namespace

void saveScreenshot(Workspace& workspace, ViewRenderer& view, const QString& path, bool transparent,
                    const QString& sentence)
{
    const auto picture = std::make_shared<ScreenshotPicture>();
    view.capture(transparent,
                 [picture](std::shared_ptr<const render::Image> image) { picture->deliver(std::move(image)); });
    workspace.startJob(
        Workspace::tr("Export %1").arg(QFileInfo(path).fileName()),
        [picture, path](Progress& progress) { writeScreenshot(*picture, path, progress); },
        [&workspace, sentence](const JobInfo& info) {
            if (info.state == JobState::Failed) workspace.say(MessageKind::Error, toQString(info.error));
            if (info.state == JobState::Finished) workspace.say(MessageKind::Info, sentence);
        });
}

}  // namespace punctum::ui
