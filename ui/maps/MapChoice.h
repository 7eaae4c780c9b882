// SPDX-License-Identifier: MIT
#pragma once

#include "core/raster/Contours.h"
#include "core/raster/Maps.h"

namespace punctum::ui
{

/// A map as the user asks for it.
struct MapChoice {
    enum class Form {
        Raster,    ///< GeoTIFF
        Contours,  ///< GeoJSON or DXF
        Outlines,  ///< likewise
        Trees      ///< CSV, GeoJSON or DXF
    };
    Form form = Form::Raster;
    MapRequest request;
    ContourOptions contours;
    bool wgs84 = false;  ///< GeoJSON in longitude and latitude
};

}  // namespace punctum::ui
