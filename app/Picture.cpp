// SPDX-License-Identifier: MIT
#include "app/Picture.h"

#include "app/Files.h"
#include "core/Error.h"

#include <CLI/CLI.hpp>

#include <QBuffer>
#include <QColor>
#include <QImage>

#include <charconv>
#include <stdexcept>

namespace punctum::app
{

namespace
{

constexpr int kMostPixels = 16384;

render::Rgba8 parseColor(const std::string& text)
{
    const QColor color(QString::fromStdString(text));
    if (!color.isValid())
        throw std::invalid_argument("\"" + text + "\" is no color; write a name such as white, or #RRGGBB.");
    return {std::uint8_t(color.red()), std::uint8_t(color.green()), std::uint8_t(color.blue()),
            std::uint8_t(color.alpha())};
}

}  // namespace

void writePng(const render::Image& image, const std::filesystem::path& path)
{
    const QImage view(reinterpret_cast<const uchar*>(image.pixels.data()), image.width, image.height,
                      qsizetype(image.width) * 4, QImage::Format_RGBA8888);
    QBuffer bytes;
    bytes.open(QIODevice::WriteOnly);
    if (!view.save(&bytes, "PNG")) throw Error(path, "The picture could not be made into a PNG.");
    writeWhole(path, {bytes.data().constData(), std::size_t(bytes.data().size())});
}

PictureSize parseSize(const std::string& text)
{
    int width = 0;
    int height = 0;
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, width);
    if (first.ec == std::errc() && first.ptr != end && *first.ptr == 'x') {
        const auto second = std::from_chars(first.ptr + 1, end, height);
        if (second.ec == std::errc() && second.ptr == end && width >= 1 && height >= 1 && width <= kMostPixels &&
            height <= kMostPixels)
            return {width, height};
    }
    throw std::invalid_argument("\"" + text + "\" is no size; write WIDTHxHEIGHT in px, each 1 to 16384.");
}

std::string sizeText(PictureSize size)
{
    return std::to_string(size.width) + 'x' + std::to_string(size.height);
}

void addSize(CLI::App& command, PictureSize& size)
{
    const auto take = [&size](const std::string& text) {
        try {
            size = parseSize(text);
        } catch (const std::invalid_argument& wrong) {
            throw CLI::ValidationError(wrong.what());
        }
    };
    command.add_option_function<std::string>("--size", take, "Width and height in px; default " + sizeText({}))
        ->type_name("WxH");
}

Background parseBackground(const std::string& text)
{
    const std::size_t colon = text.find(':');
    if (colon != std::string::npos) return {parseColor(text.substr(0, colon)), parseColor(text.substr(colon + 1))};
    const render::Rgba8 color = parseColor(text);
    return {color, color};
}

}  // namespace punctum::app
