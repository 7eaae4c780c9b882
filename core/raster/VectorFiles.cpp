// SPDX-License-Identifier: MIT
#include "core/raster/VectorFiles.h"

#include "core/Error.h"
#include "core/cloud/ValueText.h"
#include "core/las/AtomicFile.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cctype>
#include <cmath>
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

bool isTableName(const std::filesystem::path& path)
{
    return isVectorName(path) || smallEnding(path) == ".csv";
}

std::string csvText(const MapTable& table, const MapCrs& crs, const VectorOptions& options, Progress& progress)
{
    const int decimals = options.decimals + (crs.geographic ? 4 : 0);
    const auto number = [](double value, int digits) {
        return std::isnan(value) ? std::string() : roundedText(value, digits);
    };
    std::string text;
    for (std::size_t k = 0; k < table.columns.size(); ++k) {
        text += (k == 0 ? "" : ",") + table.columns[k].name;
        if (k == 0) text += ",x,y";
    }
    text += '\n';
    progress.begin("Writing CSV", table.rows.size());
    for (const MapTable::Row& row : table.rows) {
        progress.check();
        progress.add(1);
        for (std::size_t k = 0; k < row.values.size(); ++k) {
            text += (k == 0 ? "" : ",") + number(row.values[k], table.columns[k].decimals);
            if (k == 0) text += ',' + number(row.place.x, decimals) + ',' + number(row.place.y, decimals);
        }
        text += '\n';
    }
    return text;
}

void writeVectors(const std::filesystem::path& path, const VectorMap& map, const MapCrs& crs,
                  const VectorOptions& options, Progress& progress)
{
    const bool dxf = smallEnding(path) == ".dxf", csv = smallEnding(path) == ".csv";
    if (csv && map.table.columns.empty()) throw Error(path, "CSV has no lines and areas; write GeoJSON instead.");
    if (!isTableName(path))
        throw Error(path, map.table.columns.empty() ? "The name must end in .geojson or .dxf."
                                                    : "The name must end in .csv, .geojson or .dxf.");
    if ((dxf || csv) && options.wgs84)
        throw Error(path,
                    std::string(dxf ? "DXF" : "CSV") +
                        " has the coordinates of the points, not longitude and latitude; write GeoJSON instead.");
    const std::string text = csv   ? csvText(map.table, crs, options, progress)
                             : dxf ? dxfText(map, options, progress)
                                   : geoJsonText(map, crs, options, progress);
    las::AtomicFile file(path, text.size());
    file.writeAt(0, std::as_bytes(std::span(text)));
    progress.check();
    file.commit();
}

}  // namespace punctum
