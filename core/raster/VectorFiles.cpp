// SPDX-License-Identifier: MIT
#include "core/raster/VectorFiles.h"

#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cctype>
#include <span>

namespace punctum
{

namespace
{

std::string smallEnding(const std::filesystem::path& path)
{
    std::string ending = path.extension().string();
    for (char& c : ending) c = char(std::tolower(static_cast<unsigned char>(c)));
    return ending;
}

}  // namespace

bool isVectorName(const std::filesystem::path& path)
{
    const std::string ending = smallEnding(path);
    return ending == ".geojson" || ending == ".json" || ending == ".dxf";
}

void writeVectors(const std::filesystem::path& path, const VectorMap& map, const MapCrs& crs,
                  const VectorOptions& options, Progress& progress)
{
    if (!isVectorName(path)) throw Error(path, "The name must end in .geojson or .dxf.");
    const bool dxf = smallEnding(path) == ".dxf";
    if (dxf && options.wgs84) throw Error(path, "DXF has no longitude and latitude; write GeoJSON instead.");
    const std::string text = dxf ? dxfText(map, options, progress) : geoJsonText(map, crs, options, progress);
    las::AtomicFile file(path, text.size());
    file.writeAt(0, std::as_bytes(std::span(text)));
    progress.check();
    file.commit();
}

}  // namespace punctum
