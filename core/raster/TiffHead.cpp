// SPDX-License-Identifier: MIT
#include "core/raster/TiffHead.h"

#include "core/Error.h"
#include "core/las/GeoKeys.h"

#include <geotiff/geotiff.h>
#include <geotiff/xtiffio.h>
#include <tiffio.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <mutex>

namespace punctum
{

namespace
{

constexpr std::uint32_t kNoDataTag = 42113;  ///< GDAL_NODATA: the value of cells that have none, as text
constexpr std::uint16_t kUserDefinedKey = las::geo::kUserDefined, kPixelIsArea = 1;
constexpr std::uint16_t kMetreCode = 9001, kDegreeCode = 9102;

/// What a reader may rely on (GDAL's "COG -- Cloud Optimized GeoTIFF generator", header ghost area).
constexpr std::string_view kLayout =
    "LAYOUT=IFDS_BEFORE_DATA\n"
    "BLOCK_ORDER=ROW_MAJOR\n"
    "BLOCK_LEADER=SIZE_AS_UINT4\n"
    "BLOCK_TRAILER=LAST_4_BYTES_REPEATED\n"
    "KNOWN_INCOMPATIBLE_EDITION=NO\n ";

/// libtiff asks for names and types of tags that are not TIFF's own.
TIFFExtendProc formerExtender = nullptr;
void addNoDataTag(TIFF* tiff)
{
    static std::array<char, 12> name{"GDALNoData"};
    static const TIFFFieldInfo info = {kNoDataTag, -1, -1, TIFF_ASCII, FIELD_CUSTOM, 1, 0, name.data()};
    TIFFMergeFieldInfo(tiff, &info, 1);
    if (formerExtender != nullptr) formerExtender(tiff);
}
void registerTags()
{
    static std::once_flag once;
    std::call_once(once, [] {
        XTIFFInitialize();
        formerExtender = TIFFSetTagExtender(addNoDataTag);
    });
}

/// A file in memory.
struct HeadBytes {
    std::vector<std::byte> bytes;
    std::uint64_t place = 0;
};

tmsize_t readHead(thandle_t handle, void* to, tmsize_t size)
{
    auto& head = *static_cast<HeadBytes*>(handle);
    if (head.place >= head.bytes.size()) return 0;
    const std::size_t n = std::min(std::size_t(size), head.bytes.size() - std::size_t(head.place));
    std::memcpy(to, head.bytes.data() + head.place, n);
    head.place += n;
    return tmsize_t(n);
}

tmsize_t writeHead(thandle_t handle, void* from, tmsize_t size)
{
    auto& head = *static_cast<HeadBytes*>(handle);
    head.bytes.resize(std::max(head.bytes.size(), std::size_t(head.place) + std::size_t(size)));
    std::memcpy(head.bytes.data() + head.place, from, std::size_t(size));
    head.place += std::uint64_t(size);
    return size;
}

toff_t seekHead(thandle_t handle, toff_t to, int from)
{
    auto& head = *static_cast<HeadBytes*>(handle);
    head.place = (from == SEEK_END ? head.bytes.size() : from == SEEK_CUR ? head.place : 0) + to;
    return head.place;
}

struct FreeOptions {
    void operator()(TIFFOpenOptions* o) const { TIFFOpenOptionsFree(o); }
};
struct CloseTiff {
    void operator()(TIFF* t) const { TIFFClose(t); }
};
struct FreeKeys {
    void operator()(GTIF* g) const { GTIFFree(g); }
};

int beQuiet(TIFF*, void*, const char*, const char*, va_list)
{
    return 1;
}

void writeKeys(TIFF* tiff, const MapCrs& crs)
{
    const std::unique_ptr<GTIF, FreeKeys> keys(GTIFNew(tiff));
    if (!keys) throw Error("There is not enough memory for the coordinate system of the map.");
    const auto number = [&](geokey_t key, std::uint16_t value) {
        GTIFKeySet(keys.get(), key, TYPE_SHORT, 1, int(value));
    };
    const auto text = [&](geokey_t key, const std::string& value) {
        // "|" ends a text in the list of all of them
        std::string clean = value;
        std::replace(clean.begin(), clean.end(), '|', ' ');
        if (!clean.empty()) GTIFKeySet(keys.get(), key, TYPE_ASCII, int(clean.size()) + 1, clean.c_str());
    };
    GTIFSetVersionNumbers(keys.get(), 1, 1, 1);  // 1.1: vertical codes are those of systems
    number(GTRasterTypeGeoKey, kPixelIsArea);
    for (const MapCrs::Key& key : crs.keys) {
        const auto id = geokey_t(key.id);
        if (const auto* whole = std::get_if<std::uint16_t>(&key.value))
            number(id, *whole);
        else if (const auto* real = std::get_if<double>(&key.value))
            GTIFKeySet(keys.get(), id, TYPE_DOUBLE, 1, *real);
        else
            text(id, std::get<std::string>(key.value));
    }
    const auto write = [&] {
        if (GTIFWriteKeys(keys.get()) == 0) throw Error("The coordinate system of the map could not be written.");
    };
    if (!crs.keys.empty()) return write();
    if (crs.known() || crs.geographic)
        number(GTModelTypeGeoKey, crs.geographic ? las::geo::kModelGeographic : las::geo::kModelProjected);
    text(GTCitationGeoKey, crs.name);
    const std::uint16_t code = crs.horizontal != 0 ? crs.horizontal : kUserDefinedKey;
    if (crs.known()) {
        const std::string words = crs.wkt.empty() ? std::string() : "ESRI PE String = " + crs.wkt;
        if (crs.geographic) {
            number(GeographicTypeGeoKey, code);
            text(GeogCitationGeoKey, words);
            number(GeogAngularUnitsGeoKey, crs.unit != 0 ? crs.unit : kDegreeCode);
        } else {
            number(ProjectedCSTypeGeoKey, code);
            text(PCSCitationGeoKey, words);
        }
    }
    if (!crs.geographic && crs.unit != 0) number(ProjLinearUnitsGeoKey, crs.unit);
    if (crs.vertical != 0) number(VerticalCSTypeGeoKey, crs.vertical);
    if (crs.verticalUnit != 0) number(VerticalUnitsGeoKey, crs.verticalUnit);
    write();
}

/// A list of numbers in a directory: where it lies, and how wide they are.
struct TileList {
    std::uint64_t place = 0;
    std::size_t width = 0;
};

}  // namespace

struct TiffHead::Impl {
    HeadBytes head;
    bool big = false;
    std::vector<TileList> offsets, sizes;  ///< by level

    template <typename T>
    T get(std::uint64_t place) const
    {
        T value{};
        if (place > head.bytes.size() || sizeof(T) > head.bytes.size() - place)
            throw Error("The head of the map is not as it was meant.");
        std::memcpy(&value, head.bytes.data() + place, sizeof(T));
        return value;
    }

    /// Finds the lists of tiles in all directories.
    void findLists()
    {
        std::uint64_t at = big ? get<std::uint64_t>(8) : get<std::uint32_t>(4);
        while (at != 0) {
            const std::uint64_t entries = big ? get<std::uint64_t>(at) : get<std::uint16_t>(at);
            const std::uint64_t first = at + (big ? 8u : 2u), step = big ? 20u : 12u;
            for (std::uint64_t e = first; e < first + entries * step; e += step) {
                const auto tag = get<std::uint16_t>(e), type = get<std::uint16_t>(e + 2);
                if (tag != TIFFTAG_TILEOFFSETS && tag != TIFFTAG_TILEBYTECOUNTS) continue;
                const std::uint64_t count = big ? get<std::uint64_t>(e + 4) : get<std::uint32_t>(e + 4),
                                    inside = e + (big ? 12u : 8u);
                const std::size_t width = type == TIFF_SHORT ? 2 : type == TIFF_LONG ? 4 : 8;
                if (width < 4) throw Error("libtiff wrote another head than was asked for.");
                const bool here = count * width <= (big ? 8u : 4u);
                const std::uint64_t place = here  ? inside
                                            : big ? get<std::uint64_t>(inside)
                                                  : get<std::uint32_t>(inside);
                (tag == TIFFTAG_TILEOFFSETS ? offsets : sizes).push_back({place, width});
            }
            const std::uint64_t next = first + entries * step;
            at = big ? get<std::uint64_t>(next) : get<std::uint32_t>(next);
        }
    }

    void set(const TileList& list, std::size_t tile, std::uint64_t value) noexcept
    {
        std::memcpy(head.bytes.data() + list.place + tile * list.width, &value, list.width);
    }
};

TiffHead::TiffHead(const std::vector<Level>& levels, const RasterFrame& frame, const MapCrs& crs, bool floats,
                   const std::string& noData, bool big)
    : m_impl(std::make_unique<Impl>())
{
    registerTags();
    m_impl->big = big;
    HeadBytes& head = m_impl->head;
    const std::unique_ptr<TIFFOpenOptions, FreeOptions> options(TIFFOpenOptionsAlloc());
    if (!options) throw Error("There is not enough memory to write the map.");
    TIFFOpenOptionsSetErrorHandlerExtR(options.get(), beQuiet, nullptr);
    TIFFOpenOptionsSetWarningHandlerExtR(options.get(), beQuiet, nullptr);
    const std::unique_ptr<TIFF, CloseTiff> tiff(TIFFClientOpenExt(
        "map", big ? "wl8" : "wl", &head, readHead, writeHead, seekHead, [](thandle_t) { return 0; },
        [](thandle_t handle) { return toff_t(static_cast<HeadBytes*>(handle)->bytes.size()); },
        [](thandle_t, void**, toff_t*) { return 0; }, [](thandle_t, void*, toff_t) {}, options.get()));
    if (!tiff) throw Error("libtiff could not begin the map.");
    // directly behind the header, where readers look for it
    std::string size = std::to_string(kLayout.size());
    size.insert(0, 6 - size.size(), '0');
    std::string ghost = "GDAL_STRUCTURAL_METADATA_SIZE=" + size + " bytes\n" + std::string(kLayout);
    seekHead(&head, 0, SEEK_END);
    writeHead(&head, ghost.data(), tmsize_t(ghost.size()));

    TIFF* const t = tiff.get();
    for (std::size_t l = 0; l < levels.size(); ++l) {
        TIFFSetField(t, TIFFTAG_SUBFILETYPE, l == 0 ? 0 : FILETYPE_REDUCEDIMAGE);
        TIFFSetField(t, TIFFTAG_IMAGEWIDTH, std::uint32_t(levels[l].columns));
        TIFFSetField(t, TIFFTAG_IMAGELENGTH, std::uint32_t(levels[l].rows));
        TIFFSetField(t, TIFFTAG_BITSPERSAMPLE, floats ? 32 : 8);
        TIFFSetField(t, TIFFTAG_SAMPLESPERPIXEL, 1);
        TIFFSetField(t, TIFFTAG_SAMPLEFORMAT, floats ? SAMPLEFORMAT_IEEEFP : SAMPLEFORMAT_UINT);
        TIFFSetField(t, TIFFTAG_COMPRESSION, COMPRESSION_ADOBE_DEFLATE);
        TIFFSetField(t, TIFFTAG_PREDICTOR, floats ? PREDICTOR_FLOATINGPOINT : PREDICTOR_HORIZONTAL);
        TIFFSetField(t, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_MINISBLACK);
        TIFFSetField(t, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
        TIFFSetField(t, TIFFTAG_TILEWIDTH, std::uint32_t(kTileSide));
        TIFFSetField(t, TIFFTAG_TILELENGTH, std::uint32_t(kTileSide));
        TIFFSetField(t, kNoDataTag, noData.c_str());
        if (l == 0) {
            TIFFSetField(t, TIFFTAG_SOFTWARE, "Punctum");
            const double scale[3] = {frame.cell, frame.cell, 0.0};
            const double tie[6] = {0, 0, 0, frame.west(0), frame.north(0), 0};
            TIFFSetField(t, TIFFTAG_GEOPIXELSCALE, 3, scale);
            TIFFSetField(t, TIFFTAG_GEOTIEPOINTS, 6, tie);
            writeKeys(t, crs);
        }
        if (TIFFWriteCheck(t, 1, "map") == 0 || TIFFWriteDirectory(t) == 0)
            throw Error("libtiff could not write the head of the map.");
    }
    m_impl->findLists();
    if (m_impl->offsets.size() != levels.size() || m_impl->sizes.size() != levels.size())
        throw Error("libtiff wrote another head than was asked for.");
    head.bytes.resize((head.bytes.size() + 15) / 16 * 16);
}

TiffHead::~TiffHead() = default;

std::uint64_t TiffHead::bytes() const noexcept
{
    return m_impl->head.bytes.size();
}

void TiffHead::setTile(std::size_t level, std::size_t tile, std::uint64_t offset, std::uint64_t size) noexcept
{
    m_impl->set(m_impl->offsets[level], tile, offset);
    m_impl->set(m_impl->sizes[level], tile, size);
}

const std::vector<std::byte>& TiffHead::finish()
{
    return m_impl->head.bytes;
}

}  // namespace punctum
