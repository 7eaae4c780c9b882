// SPDX-License-Identifier: MIT
#include "app/Marks.h"

#include "app/Cli.h"
#include "core/Error.h"
#include "core/cloud/DistinctValues.h"
#include "core/cloud/Units.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/marks/LegendOf.h"
#include "ui/screenshot/PictureMarks.h"

#include <CLI/CLI.hpp>

#include <QFont>
#include <QGuiApplication>
#include <QImage>

#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <shared_mutex>

namespace punctum::app
{

namespace
{

/// Fonts belong to an application in Qt: this one needs no display. None is made where there is one already.
class HeadlessFonts
{
public:
    HeadlessFonts()
    {
        if (QCoreApplication::instance() != nullptr) return;
        if (qEnvironmentVariableIsEmpty("QT_QPA_PLATFORM")) qputenv("QT_QPA_PLATFORM", "offscreen");
        const QtMessageHandler handler = qInstallMessageHandler(sayInsteadOfQt);
        m_application = std::make_unique<QGuiApplication>(m_count, m_words);
        qInstallMessageHandler(handler);
    }

private:
    /// Qt's last words are a page on plugins, then abort(): one sentence helps more.
    static void sayInsteadOfQt(QtMsgType type, const QMessageLogContext&, const QString&)
    {
        if (type != QtFatalMsg) return;
        complain("Qt's platform plugin \"offscreen\" cannot be loaded, so no marks can be drawn on the picture.");
        std::_Exit(kFailed);
    }

    int m_count = 1;
    char m_name[8] = "punctum";
    char* m_words[2] = {m_name, nullptr};
    std::unique_ptr<QGuiApplication> m_application;
};

/// The legend of what is shown of all clouds together.
ui::Legend legendFor(const std::vector<DrawableCloud>& clouds, const std::vector<Visibility>& visibility,
                     const render::ProgressiveRenderer& renderer, Progress& progress)
{
    constexpr std::size_t kListedValues = 64;
    const std::string name = renderer.shownAttribute();
    std::optional<Attribute> shown;
    std::array<std::uint64_t, 256> counts{};
    std::map<std::uint32_t, DistinctValue> values;
    bool tooMany = false;
    for (std::size_t k = 0; k < clouds.size(); ++k) {
        const PointCloud& cloud = *clouds[k].cloud;
        const auto hidden = hiddenPoints(cloud, visibility[k], progress);
        const std::shared_lock lock(cloud.mutex());
        const Attribute* const attribute = cloud.findAttribute(name);
        if (attribute == nullptr) continue;
        if (!shown) shown = *attribute;
        if (attribute->kind == AttributeKind::Class) {
            const auto own = countValues(*attribute, progress, hidden.get());
            for (std::size_t code = 0; code < counts.size(); ++code) counts[code] += own[code];
        } else if (attribute->kind == AttributeKind::Category && attribute->integral()) {
            const DistinctValues own = distinctValues(*attribute, kListedValues, progress, hidden.get());
            tooMany = tooMany || own.tooMany;
            for (const DistinctValue& value : own.values) {
                const auto [place, fresh] = values.try_emplace(value.bits, value);
                if (!fresh) place->second.points += value.points;
            }
        }
    }
    if (!shown) return {};
    DistinctValues all;
    all.tooMany = tooMany || values.size() > kListedValues;
    for (const auto& [bits, value] : values) all.values.push_back(value);
    return ui::legendOf(*shown, {&counts, &all}, renderer.range(), renderer.display());
}

QString heightUnit(const PointCloud& cloud)
{
    const Attribute* const z = cloud.findAttribute("Z");
    return z == nullptr ? QString() : ui::toQString(z->unit);
}

}  // namespace

void addMarkOptions(CLI::App& command, MarkOptions& options, CLI::Option& section)
{
    command.add_flag("--legend", options.legend, "Draw a legend on the picture: what its colors mean");
    command.add_flag("--scale-bar", options.scaleBar,
                     "Draw a scale bar; in perspective it holds at the depth of the pivot");
    command.add_flag("--north-arrow", options.northArrow, "Draw a north arrow");
    command.add_flag("--ruler", options.ruler, "Draw heights and distances over a section")->needs(&section);
    command
        .add_option("--mark-scale", options.scale,
                    "How large these are drawn, 0.25 to 20; default: 1 up to 1280x800, then as the picture grows")
        ->type_name("N")
        ->check(CLI::Range(0.25, 20.0));
}

void drawMarks(render::Image& image, const MarkOptions& options, const std::vector<DrawableCloud>& clouds,
               const std::vector<Visibility>& visibility, const render::ProgressiveRenderer& renderer,
               const std::optional<Section>& section, Progress& progress)
{
    if (!options.any()) return;
    const HeadlessFonts fonts;
    const PointCloud& first = *clouds.front().cloud;
    ui::PictureMarks marks;
    marks.style.font = QGuiApplication::font();
    marks.style.scale = options.scale > 0 ? options.scale : ui::markScaleFor(image.width, image.height);
    marks.camera = renderer.camera();
    marks.scaleBar = options.scaleBar;
    marks.northArrow = options.northArrow;
    marks.unit = ui::toQString(trueLengths(first, {}).unit);
    if (options.ruler && section) marks.ruler = {*section, marks.unit, heightUnit(first)};
    if (options.legend) marks.legend = legendFor(clouds, visibility, renderer, progress);
    QImage picture(reinterpret_cast<uchar*>(image.pixels.data()), image.width, image.height,
                   qsizetype(image.width) * 4, QImage::Format_RGBA8888);
    if (picture.isNull()) throw Error("There is not enough memory for a picture of this size.");
    ui::paintMarks(picture, marks);
}

}  // namespace punctum::app
