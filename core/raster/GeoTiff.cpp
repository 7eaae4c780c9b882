// SPDX-License-Identifier: MIT
#include "core/raster/GeoTiff.h"

#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/raster/TiffHead.h"
#include "core/task/Progress.h"

#include <tbb/parallel_for.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

namespace punctum
{

namespace
{

constexpr std::size_t kTiffSide = TiffHead::kTileSide;
constexpr int kDeflateLevel = 6;          ///< of deflate
constexpr std::size_t kTilesAtOnce = 64;  ///< tiles that are packed before they are written
constexpr float kNoDataFloat = -9999.0f;

static_assert(std::endian::native == std::endian::little);

/// The half of a raster: a cell for four.
Raster halved(const Raster& full, GeoTiffOptions::Overview kind)
{
    RasterFrame frame = full.frame();
    frame.columns = (frame.columns + 1) / 2;
    frame.rows = (frame.rows + 1) / 2;
    Raster half(frame);
    tbb::parallel_for(std::size_t(0), frame.rows, [&](std::size_t r) {
        for (std::size_t c = 0; c < frame.columns; ++c) {
            double sum = 0;
            int n = 0;
            float first = Raster::kNone;
            for (std::size_t k = 0; k < 4; ++k) {
                const std::size_t row = 2 * r + k / 2, column = 2 * c + k % 2;
                if (row >= full.rows() || column >= full.columns()) continue;
                const float value = full.at(column, row);
                if (std::isnan(value)) continue;
                if (n == 0) first = value;
                sum += double(value);
                ++n;
            }
            if (n != 0) half.at(c, r) = kind == GeoTiffOptions::Overview::Mean ? float(sum / n) : first;
        }
    });
    return half;
}

/// A row of floats as predictor 3 has it (TIFF Technical Note 3): the bytes of all numbers apart, the highest
/// first, each less the one before.
void predictFloats(const float* values, std::uint8_t* out)
{
    for (std::size_t i = 0; i < kTiffSide; ++i) {
        const auto bits = std::bit_cast<std::uint32_t>(values[i]);
        for (std::size_t b = 0; b < 4; ++b) out[b * kTiffSide + i] = std::uint8_t(bits >> (24 - 8 * b));
    }
    for (std::size_t i = 4 * kTiffSide - 1; i > 0; --i) out[i] = std::uint8_t(out[i] - out[i - 1]);
}

/// A row of bytes as predictor 2 has it: each less the one before.
void predictBytes(const float* values, std::uint8_t* out)
{
    for (std::size_t i = 0; i < kTiffSide; ++i)
        out[i] =
            std::isnan(values[i]) ? std::uint8_t(0) : std::uint8_t(std::clamp(std::lround(values[i]), 1L, 255L));
    for (std::size_t i = kTiffSide - 1; i > 0; --i) out[i] = std::uint8_t(out[i] - out[i - 1]);
}

/// A tile as it stands in the file: its size, the deflated bytes, the last four of them again.
std::vector<std::byte> packTile(const Raster& raster, std::size_t column, std::size_t row,
                                GeoTiffOptions::Sample sample)
{
    const bool floats = sample == GeoTiffOptions::Sample::Float;
    const std::size_t rowBytes = kTiffSide * (floats ? 4 : 1);
    std::vector<std::uint8_t> plain(kTiffSide * rowBytes);
    std::vector<float> line(kTiffSide);
    for (std::size_t r = 0; r < kTiffSide; ++r) {
        std::fill(line.begin(), line.end(), Raster::kNone);
        if (row + r < raster.rows()) {
            const auto values = raster.row(row + r).subspan(column, std::min(kTiffSide, raster.columns() - column));
            std::copy(values.begin(), values.end(), line.begin());
        }
        if (floats) {
            for (float& v : line)
                if (std::isnan(v)) v = kNoDataFloat;
            predictFloats(line.data(), &plain[r * rowBytes]);
        } else {
            predictBytes(line.data(), &plain[r * rowBytes]);
        }
    }
    uLongf size = compressBound(uLong(plain.size()));
    std::vector<std::byte> out(4 + size + 4);
    if (compress2(reinterpret_cast<Bytef*>(out.data() + 4), &size, plain.data(), uLong(plain.size()),
                  kDeflateLevel) != Z_OK)
        throw Error("There is not enough memory to pack the map.");
    const auto bytes = std::uint32_t(size);
    std::memcpy(out.data(), &bytes, 4);
    std::memcpy(out.data() + 4 + size, out.data() + size, 4);
    out.resize(4 + size + 4);
    return out;
}

/// Copies of half the size, and half again, until one tile holds all.
std::vector<Raster> overviewsOf(const Raster& raster, GeoTiffOptions::Overview kind, const Progress& progress)
{
    std::vector<Raster> copies;
    const auto holdsMore = [](const Raster& map) { return map.columns() > kTiffSide || map.rows() > kTiffSide; };
    while (holdsMore(copies.empty() ? raster : copies.back())) {
        progress.check();
        copies.push_back(halved(copies.empty() ? raster : copies.back(), kind));
    }
    return copies;
}

}  // namespace

std::uint64_t writeGeoTiff(const std::filesystem::path& path, const Raster& raster, const MapCrs& crs,
                           const GeoTiffOptions& options, Progress& progress)
{
    if (raster.frame().cells() == 0) throw Error("There are no cells to write.");
    const std::vector<Raster> copies = overviewsOf(raster, options.overview, progress);
    std::vector<const Raster*> levels{&raster};
    for (const Raster& copy : copies) levels.push_back(&copy);

    const bool floats = options.sample == GeoTiffOptions::Sample::Float;
    std::uint64_t tiles = 0;
    std::vector<TiffHead::Level> sizes;
    for (const Raster* level : levels) {
        sizes.push_back({level->columns(), level->rows()});
        tiles += sizes.back().tiles();
    }
    // what deflate may make of a tile at worst, and what surrounds it
    const std::uint64_t most =
        tiles * (compressBound(kTiffSide * kTiffSide * (floats ? 4 : 1)) + 8 + 16) + (1u << 20);
    const bool big = options.big == GeoTiffOptions::Big::Yes || most >= std::numeric_limits<std::uint32_t>::max();

    TiffHead head(sizes, raster.frame(), crs, floats, floats ? "-9999" : "0", big);
    las::AtomicFile file(path);
    progress.begin("Writing the map", tiles);
    std::uint64_t end = head.bytes();
    for (std::size_t l = levels.size(); l-- > 0;) {
        const std::size_t across = sizes[l].across(), count = sizes[l].tiles();
        for (std::size_t first = 0; first < count; first += kTilesAtOnce) {
            const std::size_t n = std::min(kTilesAtOnce, count - first);
            std::vector<std::vector<std::byte>> packed(n);
            tbb::parallel_for(std::size_t(0), n, [&](std::size_t k) {
                if (progress.cancelled()) return;
                const std::size_t tile = first + k;
                packed[k] =
                    packTile(*levels[l], tile % across * kTiffSide, tile / across * kTiffSide, options.sample);
            });
            progress.check();
            for (std::size_t k = 0; k < n; ++k) {
                file.writeAt(end, packed[k]);
                head.setTile(l, first + k, end + 4, packed[k].size() - 8);
                end += packed[k].size();
            }
            progress.add(n);
        }
    }
    file.writeAt(0, head.finish());
    progress.check();
    file.commit();
    return end;
}

}  // namespace punctum
