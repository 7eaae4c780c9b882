// SPDX-License-Identifier: MIT
#include "core/VirtualCloud.h"

#include "core/Error.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <fstream>
#include <optional>
#include <set>
#include <string>
#include <string_view>

namespace punctum
{

namespace
{

namespace fs = std::filesystem;
using nlohmann::json;

constexpr std::uintmax_t kMostBytes = std::uintmax_t(1) << 28;  // of a .vpc; 100,000 files take some 200 MB

const json* member(const json& object, const char* name)
{
    if (!object.is_object()) return nullptr;
    const auto found = object.find(name);
    return found == object.end() ? nullptr : &*found;
}

bool isData(const std::string& name, const json& asset)
{
    const json* const roles = member(asset, "roles");
    if (!roles || !roles->is_array()) return name == "data";
    return std::find(roles->begin(), roles->end(), json("data")) != roles->end();
}

/// "%20" and the like, of a file URL.
std::string decoded(std::string_view text)
{
    std::string plain;
    for (std::size_t k = 0; k < text.size(); ++k) {
        unsigned value = 0;
        if (text[k] == '%' && k + 2 < text.size() && std::isxdigit(static_cast<unsigned char>(text[k + 1])) &&
            std::isxdigit(static_cast<unsigned char>(text[k + 2]))) {
            value = unsigned(std::stoul(std::string(text.substr(k + 1, 2)), nullptr, 16));
            k += 2;
        } else {
            value = static_cast<unsigned char>(text[k]);
        }
        plain += char(value);
    }
    return plain;
}

/// Nothing where it lies on a server.
std::optional<fs::path> placeOf(const std::string& href, const fs::path& folder)
{
    constexpr std::string_view kFile = "file://";
    if (std::string_view(href).starts_with(kFile))
        return fs::path(decoded(std::string_view(href).substr(kFile.size())));
    if (href.find("://") != std::string::npos || href.starts_with("/vsi")) return std::nullopt;
    return (folder / href).lexically_normal();
}

}  // namespace

bool isVirtualCloudName(const fs::path& path)
{
    std::string ending = path.extension().string();
    std::transform(ending.begin(), ending.end(), ending.begin(),
                   [](unsigned char c) { return char(std::tolower(c)); });
    return ending == ".vpc";
}

VirtualCloud readVirtualCloud(const fs::path& path)
{
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(path, error);
    if (error) throw Error(path, "The file cannot be read: " + error.message() + ".");
    if (bytes > kMostBytes) throw Error(path, "This file is too large for a virtual point cloud.");
    std::ifstream file(path, std::ios::binary);
    const json whole = json::parse(file, nullptr, false);
    if (file.bad() || !file.is_open()) throw Error(path, "The file cannot be read.");
    const json* const features = member(whole, "features");
    if (!features || !features->is_array())
        throw Error(path, "This is no virtual point cloud: it has no list of features.");

    VirtualCloud cloud;
    std::set<fs::path> known;
    for (const json& feature : *features) {
        const json* const assets = member(feature, "assets");
        if (!assets || !assets->is_object()) continue;
        for (const auto& [name, asset] : assets->items()) {
            const json* const href = member(asset, "href");
            if (!href || !href->is_string() || !isData(name, asset)) continue;
            const auto place = placeOf(href->get<std::string>(), path.parent_path());
            if (!place)
                ++cloud.remote;
            else if (known.insert(*place).second)
                cloud.files.push_back(*place);
        }
    }
    if (cloud.files.empty())
        throw Error(path, cloud.remote == 0 ? "This virtual point cloud names no file."
                                            : "All files of this virtual point cloud lie on servers; download them "
                                              "first.");
    return cloud;
}

}  // namespace punctum
