// SPDX-License-Identifier: MIT
// punctum render: a picture of clouds, with no display and no GPU.
#include "app/Console.h"
#include "app/Files.h"
#include "app/Marks.h"
#include "app/Picture.h"
#include "app/Renderer.h"
#include "app/commands/Command.h"
#include "app/commands/MapOptions.h"
#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/Section.h"
#include "core/cloud/ShownExtent.h"
#include "core/expression/Condition.h"
#include "core/surface/Surface.h"
#include "core/task/Progress.h"
#include "render/camera/CameraFile.h"
#include "render/color/ColorMap.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <memory>

namespace punctum::app
{

namespace
{

struct RenderOptions {
    std::vector<std::string> files;
    std::string out;
    PictureSize size;
    std::string attribute;
    std::string colorMap;  ///< empty: the one that suits the attribute
    std::string range;
    std::string view;
    std::string projection;  ///< empty: as the view is seen
    std::string camera;
    int samples = 4;
    double pointSize = 0;  ///< 0: none given
    double worldSize = 0;  ///< 0: none given
    double spacings = 1;
    render::ColorTone tone;
    bool strays = false;
    bool round = false;
    bool average = false;
    std::string normals = "lit";
    bool eyeDome = false;
    std::string surface = "none";
    std::string contours;  ///< an interval, or kSuitable
    bool pointsOnTop = false;
    bool groundPoints = false;
    int bands = 0;
    std::string backend = "auto";
    std::string background;
    std::string clip;
    std::vector<std::string> planes;
    std::string filter;
    std::string section;
    double sectionWidth = 1.0;
    double exaggeration = 1.0;
    MarkOptions marks;
    bool bruteForce = false;
    bool json = false;
};

/// The interval of contours that suits the surface.
const std::string kSuitable = "auto";

/// The options with a grammar of their own, understood.
struct RenderRequest {
    RenderOptions options;
    std::optional<std::pair<double, double>> range;
    Background background;
    Clip clip;
    std::optional<Section> section;
};

std::pair<double, double> parseRange(const std::string& text)
{
    // the colon that parts the numbers; neither has one of its own
    const std::size_t colon = text.find(':');
    double low = 0;
    double high = 0;
    if (colon != std::string::npos && CLI::detail::lexical_cast(text.substr(0, colon), low) &&
        CLI::detail::lexical_cast(text.substr(colon + 1), high) && std::isfinite(low) && std::isfinite(high) &&
        low < high)
        return {low, high};
    throw std::invalid_argument("\"" + text + "\" is no range; write LOW:HIGH, the lower number first.");
}

/// Numbers with commas between them.
std::vector<double> parseNumbers(const std::string& text)
{
    std::vector<double> numbers;
    for (const std::string& part : CLI::detail::split(text, ',')) {
        double number = 0;
        if (!CLI::detail::lexical_cast(part, number) || !std::isfinite(number)) return {};
        numbers.push_back(number);
    }
    return numbers;
}

WorldBounds parseBox(const std::string& text)
{
    const std::size_t colon = text.find(':');
    const std::vector<double> a = parseNumbers(text.substr(0, colon));
    const std::vector<double> b = parseNumbers(colon == std::string::npos ? "" : text.substr(colon + 1));
    WorldBounds box;
    bool fine = a.size() == 3 && b.size() == 3;
    for (std::size_t axis = 0; axis < 3 && fine; ++axis) {
        box.min[int(axis)] = a[axis];
        box.max[int(axis)] = b[axis];
        fine = a[axis] <= b[axis];
    }
    if (fine) return box;
    throw std::invalid_argument("\"" + text +
                                "\" is no box; write XMIN,YMIN,ZMIN:XMAX,YMAX,ZMAX, the lower numbers first.");
}

ClipPlane parsePlane(const std::string& text)
{
    const std::vector<double> n = parseNumbers(text);
    if (n.size() == 4 && (n[0] != 0 || n[1] != 0 || n[2] != 0)) return {{n[0], n[1], n[2]}, n[3]};
    throw std::invalid_argument("\"" + text +
                                "\" is no plane; write A,B,C,D to keep what has A x + B y + C z >= D.");
}

Section parseSection(const std::string& text, double width)
{
    const std::size_t colon = text.find(':');
    const std::vector<double> a = parseNumbers(text.substr(0, colon));
    const std::vector<double> b = parseNumbers(colon == std::string::npos ? "" : text.substr(colon + 1));
    if (a.size() == 2 && b.size() == 2) {
        const Section section{{a[0], a[1]}, {b[0], b[1]}, width, glm::dvec3(1.0)};
        if (section.usable()) return section;
    }
    throw std::invalid_argument("\"" + text +
                                "\" is no line of a section; write X1,Y1:X2,Y2, two different places.");
}

/// The camera of a section that all heights of its points fill; `shown`: of each cloud.
render::Camera cameraOf(const Section& section, const std::vector<DrawableCloud>& clouds,
                        const std::vector<Visibility>& shown, double exaggeration, glm::dvec2 size,
                        Progress& progress)
{
    ShownHeights heights;
    for (std::size_t k = 0; k < clouds.size(); ++k) {
        const PointCloud& cloud = *clouds[k].cloud;
        heights.include(shownHeights(cloud, hiddenPoints(cloud, shown[k], progress).get(), progress));
    }
    if (heights.points == 0) {
        const bool others = std::any_of(shown.begin(), shown.end(), [&](const Visibility& v) {
            return v.filtered || v.clip.box || v.clip.planes.size() > section.sides().size();
        });
        throw Error(others ? "No point that the filter and the clip leave lies in the section."
                           : "No point lies in the section. Is its line on the cloud?");
    }
    return render::sectionCamera(section, heights.low, heights.high, size, exaggeration);
}

/// Where the points are that are drawn; `shown`: of each cloud.
ShownExtent shownExtentOf(const std::vector<DrawableCloud>& clouds, const std::vector<Visibility>& shown,
                          const glm::dvec3& stretch, Progress& progress)
{
    ShownExtent extent;
    for (std::size_t k = 0; k < clouds.size(); ++k) {
        const PointCloud& cloud = *clouds[k].cloud;
        if (cloud.size() == 0) continue;
        const auto hidden = hiddenPoints(cloud, shown[k], progress);
        extent.include(shownExtent(cloud, clouds[k].bounds, hidden.get(), stretch, progress));
    }
    return extent;
}

std::string listOf(const PointCloud& cloud)
{
    std::string names;
    for (const Attribute& attribute : cloud.attributes())
        if (attribute.kind != AttributeKind::Opaque) names += (names.empty() ? "" : ", ") + attribute.name;
    return names;
}

/// The attribute's name as the first cloud that has it spells it. Throws Error when none has.
std::string findAttribute(const std::vector<DrawableCloud>& clouds, const std::string& name)
{
    for (const bool exact : {true, false})
        for (const DrawableCloud& c : clouds)
            for (const Attribute& attribute : c.cloud->attributes()) {
                if (attribute.kind == AttributeKind::Opaque) continue;
                const bool same = exact ? attribute.name == name
                                        : CLI::detail::to_lower(attribute.name) == CLI::detail::to_lower(name);
                if (same) return attribute.name;
            }
    throw Error("There is no attribute \"" + name + "\" to show; there are " + listOf(*clouds.front().cloud) + ".");
}

/// The contours that are asked for, of surfaces whose heights have this range.
render::SurfaceContours contoursOf(const std::string& interval, double range)
{
    render::SurfaceContours contours;
    if (interval == kSuitable)
        contours.interval = render::suitableInterval(range);
    else if (!interval.empty())
        contours.interval = std::stod(interval);
    return contours;
}

void runRender(const RenderRequest& request, Progress& progress)
{
    const auto start = std::chrono::steady_clock::now();
    const RenderOptions& options = request.options;
    if (const auto folder = std::filesystem::path(options.out).parent_path(); !std::filesystem::exists(options.out))
        checkFolder(options.out);

    HeadlessRenderer headless(options.backend);
    std::vector<DrawableCloud> clouds;
    WorldBounds bounds;
    PointIndex points = 0;
    clouds.push_back(loadDrawable(inputFiles(options.files, progress), progress));
    for (const std::string& warning : clouds.back().warnings) note(warning);
    if ((points = clouds.back().cloud->size()) != 0)
        bounds = clouds.back().cloud->coordinates().toWorld(clouds.back().bounds);
    if (points == 0) throw Error(options.files.front(), "There is no point to draw.");

    render::ProgressiveRenderer& renderer = headless.renderer();
    render::DisplaySettings display;
    if (!options.attribute.empty()) display.attribute = findAttribute(clouds, options.attribute);
    display.colorMap = options.colorMap;
    display.range = request.range;
    if (options.worldSize > 0) {
        display.sizing = render::PointSizing::World;
        display.worldSize = options.worldSize;
    } else if (options.pointSize > 0) {
        display.pointSize = options.pointSize;
    } else {
        display.sizing = render::PointSizing::Density;
        display.spacings = options.spacings;
    }
    display.tone = options.tone;
    display.round = options.round;
    display.averaged = options.average;
    display.normals = options.normals == "lit" ? render::NormalLook::Lit : render::NormalLook::Direction;
    display.samples = options.samples;
    display.eyeDome = options.eyeDome ? 1.0 : 0.0;
    display.bands = options.bands;
    const bool contours = !options.contours.empty();
    display.surface = options.surface == "gray"                  ? render::SurfaceLook::Gray
                      : options.surface == "heights" || contours ? render::SurfaceLook::Heights
                                                                 : render::SurfaceLook::None;
    display.pointsOnTop = options.pointsOnTop;
    if (!options.groundPoints) display.surfaceReplaces = SurfaceSettings().classes;
    display.backgroundTop = request.background.top;
    display.backgroundBottom = request.background.bottom;
    const glm::dvec3 stretch = trueLengths(*clouds.front().cloud, bounds).stretch;
    std::optional<Section> section = request.section;
    Clip clip = request.clip;
    if (section) {
        section->stretch = stretch;
        for (const ClipPlane& side : section->sides()) clip.planes.push_back(side);
    }
    display.clip = clip;
    renderer.setDisplay(display);
    std::vector<Visibility> visibility(clouds.size());
    double heights = 0;
    for (std::size_t k = 0; k < clouds.size(); ++k) {
        const PointCloud& cloud = *clouds[k].cloud;
        renderer.addCloud(clouds[k].store);
        renderer.loadingEnded(cloud, clouds[k].bounds);
        visibility[k].clip = clip;
        if (display.surface != render::SurfaceLook::None) {
            const auto surface = Surface(clouds[k].cloud, {}, progress).view();
            renderer.setSurface(cloud, surface);
            heights = std::max(heights, (surface->high - surface->low) * cloud.coordinates().scale.z);
        }
        if (options.filter.empty()) continue;
        const expression::Condition filter(options.filter, cloud);
        visibility[k].filtered = expression::selectOthers(cloud, filter, progress);
        renderer.hide(cloud, visibility[k].filtered.get());
    }
    display.contours = contoursOf(options.contours, heights);
    renderer.setDisplay(display);

    const auto [width, height] = options.size;
    const glm::dvec2 size(width, height);
    render::Camera camera;
    const std::string view = options.view.empty() ? "iso" : options.view;
    camera.setView(view);
    camera.orthographic =
        options.projection.empty() ? render::seenInParallel(view) : options.projection == "orthographic";
    camera.stretch = stretch;
    const ShownExtent extent = shownExtentOf(clouds, visibility, stretch, progress);
    if (extent.points == 0 && !section) {
        const bool box = request.clip.box && request.clip.planes.empty() && options.filter.empty();
        throw Error(box ? "No point lies in the box of --clip."
                        : "The filter and the clip leave no point to draw.");
    }
    const WorldBounds shown = options.strays ? extent.all : extent.typical;
    camera.fit(shown, size);
    const bool fitted = !section && options.camera.empty();
    if (fitted && extent.strays > 0 && !options.strays)
        note((extent.strays == 1 ? std::string("One point lies") : grouped(extent.strays) + " points lie") +
             " far away from all the others and outside of the picture; --with-strays fits it to them, too.");
    if (section) camera = cameraOf(*section, clouds, visibility, options.exaggeration, size, progress);
    if (!options.camera.empty()) camera = render::readCameraFile(options.camera, camera, shown, size);
    renderer.setCamera(camera);

    Picture picture = drawPicture(renderer, width, height, options.bruteForce, progress);
    drawMarks(picture.image, options.marks, clouds, visibility, renderer, section, progress);
    writePng(picture.image, options.out);

    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
    if (options.json)
        printJson({{"file", options.out},
                   {"width", width},
                   {"height", height},
                   {"points", points},
                   {"backend", render::nameOf(renderer.backend().kind())},
                   {"device", renderer.backend().description()},
                   {"attribute", renderer.shownAttribute()},
                   {"range", {renderer.range().first, renderer.range().second}},
                   {"covered", picture.covered},
                   {"shown", extent.points},
                   {"strays", extent.strays},
                   {"contours", display.contours.interval},
                   {"camera", Json::parse(render::cameraText(camera))},
                   {"seconds", seconds.count()}});
    else
        print(options.out + ": " + std::to_string(width) + " x " + std::to_string(height) + " px, " +
              pointsText(points) + ", " + renderer.shownAttribute() + "\n");
}

}  // namespace

void addRender(CLI::App& root, Action& action)
{
    CLI::App& command =
        addCommand(root, "render", "Draw clouds into one picture (PNG), with no display and no GPU.");
    const auto options = std::make_shared<RenderOptions>();
    std::vector<std::string> maps;
    for (const render::ColorMap& map : render::colorMaps()) maps.push_back(map.name);

    command.add_option("FILE", options->files, "LAS or LAZ files, folders or .vpc, drawn together as one survey")
        ->required();
    command.add_option("-o,--output", options->out, "Picture to write: .png")->required()->type_name("OUT.png");
    addSize(command, options->size);
    command
        .add_option("--attribute", options->attribute,
                    "Attribute to show, such as Z, Intensity, Classification, RGB or an extra one; "
                    "default: RGB if there are colors, else Intensity, Classification or Z")
        ->type_name("NAME");
    command
        .add_option("--surface", options->surface,
                    "The ground points (class 2) as a lit surface: gray, or heights for a tint by height")
        ->type_name("LOOK")
        ->check(CLI::IsMember({"none", "gray", "heights"}));
    command
        .add_option(
            "--contours", options->contours,
            "Lines of equal height on the surface, so many units of Z apart; without INTERVAL about twenty. "
            "Brings --surface heights")
        ->type_name("[INTERVAL]")
        ->expected(0, 1)
        ->default_str(kSuitable)
        ->check(moreThanNothing() | CLI::IsMember({kSuitable}));
    command.add_flag("--points-on-top", options->pointsOnTop,
                     "With --surface: points below or behind the surface are seen through it");
    command.add_flag("--ground-points", options->groundPoints,
                     "With --surface: draws the ground points, too, which else give way to it");
    command
        .add_option("--color-map", options->colorMap,
                    "Colors of a quantity: " + CLI::detail::join(maps, ", ") +
                        "; default: grey for Intensity, else viridis")
        ->type_name("NAME")
        ->check([maps](const std::string& name) {
            return std::find(maps.begin(), maps.end(), name) != maps.end()
                       ? std::string()
                       : "There is no color map \"" + name + "\"; there are " + CLI::detail::join(maps, ", ") + ".";
        });
    command
        .add_option("--range", options->range,
                    "Values that get the first and last color; default: 2nd to 98th percentile")
        ->type_name("LO:HI");
    CLI::Option* view =
        command.add_option("--view", options->view, "top, bottom, front, back, left, right or iso; default iso")
            ->type_name("VIEW")
            ->check(CLI::IsMember({"top", "bottom", "front", "back", "left", "right", "iso"}));
    CLI::Option* projection =
        command
            .add_option("--projection", options->projection,
                        "orthographic or perspective; default: orthographic for all views but iso")
            ->type_name("KIND")
            ->check(CLI::IsMember({"orthographic", "perspective"}));
    command
        .add_option("--camera", options->camera,
                    "JSON file with eye [x, y, z], yaw, pitch and fov in degrees, pivot [x, y, z], orthographic; "
                    "without eye, the clouds fill the picture")
        ->type_name("FILE.json")
        ->excludes(view)
        ->excludes(projection);
    command.add_option("--samples", options->samples, "Samples a pixel: 1, 4, 8 or 16; default 4")
        ->type_name("N")
        ->check([](const std::string& n) {
            for (const int count : render::kSampleCounts)
                if (n == std::to_string(count)) return std::string();
            return std::string("A pixel has 1, 4, 8 or 16 samples.");
        });
    CLI::Option* pointSize = command
                                 .add_option("--point-size", options->pointSize,
                                             "Width of a point in px, 0.1 to 64, the same everywhere")
                                 ->type_name("PX")
                                 ->check(CLI::Range(0.1, 64.0));
    CLI::Option* worldSize =
        command
            .add_option("--world-size", options->worldSize,
                        "Width of a point in units of the coordinates (meters for degrees): near points are larger")
            ->type_name("LENGTH")
            ->check(CLI::Range(1e-6, 1e6))
            ->excludes(pointSize);
    command
        .add_option(
            "--adaptive-size", options->spacings,
            "Width of a point in spacings of the cloud's points, which is found out; default 1, which closes "
            "surfaces")
        ->type_name("N")
        ->check(CLI::Range(0.1, 20.0))
        ->excludes(pointSize)
        ->excludes(worldSize);
    command
        .add_option("--brightness", options->tone.brightness,
                    "Brighter or darker colors of the file, -1 to 1; default 0")
        ->type_name("B")
        ->check(CLI::Range(-1.0, 1.0));
    command.add_option("--contrast", options->tone.contrast, "More or less contrast in them, -1 to 1; default 0")
        ->type_name("C")
        ->check(CLI::Range(-1.0, 1.0));
    command
        .add_option("--gamma", options->tone.gamma,
                    "Above 1 dark colors of the file become brighter, 0.1 to 10; default 1")
        ->type_name("G")
        ->check(CLI::Range(0.1, 10.0));
    command.add_flag("--with-strays", options->strays,
                     "Fit the picture to points far away from all the others, too");
    command.add_flag("--round", options->round, "Points are circles instead of squares, where wider than 1.5 px");
    command.add_flag("--average", options->average,
                     "Show the mean color of the points within 1 % of the nearest one's depth: less noise");
    command.add_option("--normals", options->normals, "Directions as lit surfaces or as colors: lit, colors")
        ->type_name("LOOK")
        ->check(CLI::IsMember({"lit", "colors"}));
    command.add_flag("--edl", options->eyeDome, "Eye-dome lighting: shapes and edges stand out by shading alone");
    command.add_option("--bands", options->bands, "Show a quantity in so many steps of color, 2 to 64")
        ->type_name("N")
        ->check(CLI::Range(2, 64));
    command.add_option("--clip", options->clip, "Draw only what lies in this box of coordinates")
        ->type_name("XMIN,YMIN,ZMIN:XMAX,YMAX,ZMAX");
    command
        .add_option("--clip-plane", options->planes, "Draw only points with A x + B y + C z >= D; up to six times")
        ->type_name("A,B,C,D")
        ->expected(1)
        ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
    command
        .add_option("--filter", options->filter,
                    "Draw only points for which this holds, such as \"Intensity > 2000 and ReturnNumber == 1\"")
        ->type_name("CONDITION");
    CLI::Option* section =
        command
            .add_option("--section", options->section,
                        "Draw the section along this line, the first place on the left, seen from the side")
            ->type_name("X1,Y1:X2,Y2")
            ->excludes(view)
            ->excludes(projection)
            ->excludes("--camera");
    command
        .add_option("--section-width", options->sectionWidth,
                    "How wide the section is, half to each side of its line; default 1 (meters for degrees)")
        ->type_name("W")
        ->check(CLI::Range(1e-6, 1e9))
        ->needs(section);
    command
        .add_option("--exaggeration", options->exaggeration,
                    "Draw the heights of a section so many times as high, 0.1 to 100; default 1")
        ->type_name("N")
        ->check(CLI::Range(0.1, 100.0))
        ->needs(section);
    addMarkOptions(command, options->marks, *section);
    addBackendOption(command, options->backend);
    command
        .add_option("--background", options->background,
                    "A color (white, #202830), transparent, or TOP:BOTTOM for a gradient")
        ->type_name("COLOR");
    command.add_flag("--brute-force", options->bruteForce, "Draw all points in one pass: the reference picture");
    command.add_flag("--json", options->json, "Report in JSON, with the camera");
    command.callback([options, &action] {
        RenderRequest request;
        request.options = *options;
        try {
            if (!options->range.empty()) request.range = parseRange(options->range);
            if (!options->clip.empty()) request.clip.box = parseBox(options->clip);
            for (const std::string& plane : options->planes) request.clip.planes.push_back(parsePlane(plane));
            if (request.clip.planes.size() > render::kMostCuts)
                throw std::invalid_argument("There may be at most six planes that clip.");
            if (!options->section.empty()) request.section = parseSection(options->section, options->sectionWidth);
            if (!options->filter.empty()) expression::Condition::check(options->filter);
            if (!options->background.empty()) request.background = parseBackground(options->background);
            if (CLI::detail::to_lower(std::filesystem::path(options->out).extension().string()) != ".png")
                throw std::invalid_argument("The picture to write, " + options->out + ", must end in .png.");
        } catch (const std::invalid_argument& wrong) {
            throw CLI::ValidationError(wrong.what());
        } catch (const Error& wrong) {
            throw CLI::ValidationError(wrong.what());
        }
        action = [request](Progress& p) { runRender(request, p); };
    });
}

}  // namespace punctum::app
