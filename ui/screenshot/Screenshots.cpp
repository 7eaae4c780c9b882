// SPDX-License-Identifier: MIT
#include "ui/screenshot/Screenshots.h"

#include "core/Error.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/document/Workspace.h"
#include "ui/marks/LegendOf.h"
#include "ui/measure/Measurements.h"
#include "ui/screenshot/PictureMarks.h"
#include "ui/screenshot/ScreenshotDialog.h"
#include "ui/section/Sections.h"
#include "ui/settings/WindowSettings.h"
#include "ui/view/Still.h"
#include "ui/view/ViewRenderer.h"
#include "ui/view/Viewport.h"

#include <QApplication>
#include <QFileDialog>
#include <QFileInfo>
#include <QImageWriter>
#include <QSaveFile>

#include <algorithm>

namespace punctum::ui
{

namespace
{

void writePng(const QImage& picture, const QString& path, Progress& progress)
{
    progress.begin("Writing the picture", 1);
    QSaveFile file(path);
    const auto fail = [&](const QString& reason) {
        file.cancelWriting();
        throw Error(toPath(path), "The picture could not be written: " + reason.toStdString() + ".");
    };
    if (!file.open(QIODevice::WriteOnly)) fail(file.errorString());
    QImageWriter writer(&file, "png");
    if (!writer.write(picture)) fail(writer.errorString());
    progress.check();
    if (!file.commit()) fail(file.errorString());
}

}  // namespace

/// A picture that is being drawn, and what comes on it.
struct Screenshots::Order {
    std::shared_ptr<Still> still;
    PictureMarks marks;
    std::function<Legend(const StillPicture&)> legend;  ///< any thread; empty: none is wanted

    /// Waits for it. In a job.
    QImage finish(Progress& progress)
    {
        auto picture = std::make_unique<StillPicture>(still->wait(progress));
        if (legend) marks.legend = legend(*picture);
        render::Image& image = picture->image;
        auto* const pixels = reinterpret_cast<uchar*>(image.pixels.data());
        const QSize size(image.width, image.height);
        const auto drop = [](void* kept) { delete static_cast<StillPicture*>(kept); };
        QImage drawn(pixels, size.width(), size.height(), qsizetype(size.width()) * 4, QImage::Format_RGBA8888,
                     drop, picture.release());
        if (drawn.isNull()) throw Error("There is not enough memory for a picture of this size.");
        paintMarks(drawn, marks);
        return drawn;
    }
};

Screenshots::Screenshots(QWidget& window, Workspace& workspace, Viewport& view, Sections& sections,
                         const Measurements& measurements, WindowSettings& settings)
    : QObject(&window),
      m_window(window),
      m_workspace(workspace),
      m_view(view),
      m_sections(sections),
      m_measurements(measurements),
      m_settings(settings)
{
}

Viewport& Screenshots::viewport(bool section) const
{
    return section ? m_sections.viewport() : m_view;
}

bool Screenshots::hasSection() const
{
    return m_sections.section().has_value();
}

QSize Screenshots::viewSize(bool section) const
{
    return viewport(section).pictureSize();
}

ScreenshotOptions Screenshots::preset() const
{
    ScreenshotOptions options = m_settings.screenshot();
    options.section = hasSection() && m_window.focusWidget() == &m_sections.viewport();
    options.size = viewSize(options.section);
    return options;
}

void Screenshots::choose()
{
    if (!m_workspace.active()) return;
    auto* const dialog = new ScreenshotDialog(*this, preset(), &m_window);
    connect(dialog, &ScreenshotDialog::wanted, this, [this](const ScreenshotOptions& options) {
        m_settings.setScreenshot(options);
        const Document* const active = m_workspace.active();
        if (!active) return;
        const QString base = QFileInfo(active->fileName()).completeBaseName();
        QString path = QFileDialog::getSaveFileName(
            &m_window, options.section ? tr("Save the picture of the section") : tr("Save the picture"),
            m_settings.folder() + QLatin1Char('/') + base + QStringLiteral(".png"), tr("PNG picture (*.png)"));
        if (path.isEmpty()) return;
        if (QFileInfo(path).suffix().isEmpty()) path += QStringLiteral(".png");
        save(path, options);
    });
    dialog->open();
}

std::shared_ptr<Screenshots::Order> Screenshots::order(const ScreenshotOptions& options, QSize size, double shrink)
{
    Viewport& view = viewport(options.section);
    // What is measured in px in the view is as much larger in the picture.
    const double larger = double(options.size.height()) / std::max(1, view.height());
    StillRequest request;
    request.width = size.width();
    request.height = size.height();
    request.camera = view.camera();
    request.display = view.displayFor(larger * shrink);
    request.display.samples = options.samples;
    if (options.transparent) request.display.backgroundTop.a = request.display.backgroundBottom.a = 0;

    auto order = std::make_shared<Order>();
    order->still = std::make_shared<Still>(request);
    PictureMarks& marks = order->marks;
    marks.style.font = QApplication::font();
    marks.style.scale = std::max(1.0, larger) * shrink;
    marks.camera = request.camera;
    marks.scaleBar = options.scaleBar && !options.section;
    marks.northArrow = options.northArrow && !options.section;
    const Document* const active = m_workspace.active();
    if (active) marks.unit = active->lengthUnit();
    if (options.measurements)
        for (const Measurements::Entry& entry : m_measurements.entries()) {
            const auto& points = entry.measurement.points;
            if (std::all_of(points.begin(), points.end(), [&](const auto& p) { return view.keeps(p.world); }))
                marks.measurements.push_back(entry.measurement);
        }
    if (options.section && options.ruler) marks.ruler = m_sections.rulerMarks();
    // The range of its colors is known when it has been drawn; what else the legend says is known now.
    if (const auto frame = view.renderer().frame(); options.legend && active && frame) {
        const Legend now = legendOf(*active, frame->attribute, frame->range, request.display);
        const Attribute* const attribute = active->findAttribute(frame->attribute);
        order->legend = [now, attribute = now.bar && attribute ? std::optional(*attribute) : std::nullopt,
                         display = request.display](const StillPicture& picture) {
            return attribute && picture.attribute == now.title
                       ? legendOf(*attribute, LegendFacts(), picture.range, display)
                       : now;
        };
    }
    view.renderer().draw(order->still);
    return order;
}

void Screenshots::save(const QString& path, const ScreenshotOptions& options)
{
    Workspace& workspace = m_workspace;
    const QString name = QFileInfo(path).fileName();
    const QString sentence = options.section ? tr("Saved the section as %1.").arg(name) : tr("Saved %1.").arg(name);
    workspace.startJob(
        tr("Export %1").arg(name),
        [order = order(options, options.size, 1.0), path](Progress& progress) {
            writePng(order->finish(progress), path, progress);
        },
        [&workspace, sentence](const JobInfo& info) {
            if (info.state == JobState::Failed) workspace.say(MessageKind::Error, toQString(info.error));
            if (info.state == JobState::Finished) workspace.say(MessageKind::Info, sentence);
        });
}

JobId Screenshots::preview(const ScreenshotOptions& options, QSize size, std::function<void(const QImage&)> done)
{
    const auto picture = std::make_shared<QImage>();
    const double shrink = double(size.height()) / std::max(1, options.size.height());
    return m_workspace.startJob(
        tr("Preview"),
        [order = order(options, size, shrink), picture](Progress& progress) { *picture = order->finish(progress); },
        [picture, done = std::move(done)](const JobInfo& info) {
            if (info.state == JobState::Finished) done(*picture);
        },
        true);
}

void Screenshots::cancel(JobId job)
{
    m_workspace.cancel(job);
}

}  // namespace punctum::ui
