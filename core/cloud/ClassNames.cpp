// SPDX-License-Identifier: MIT
#include "core/cloud/ClassNames.h"

#include <algorithm>
#include <array>
#include <cctype>

namespace punctum
{

namespace
{

constexpr std::array<std::string_view, 23> kNames = {"Never Classified",
                                                     "Unclassified",
                                                     "Ground",
                                                     "Low Vegetation",
                                                     "Medium Vegetation",
                                                     "High Vegetation",
                                                     "Building",
                                                     "Low Noise",
                                                     "Model Key-Point",
                                                     "Water",
                                                     "Rail",
                                                     "Road Surface",
                                                     "Overlap Points",
                                                     "Wire Guard",
                                                     "Wire Conductor",
                                                     "Transmission Tower",
                                                     "Wire Connector",
                                                     "Bridge Deck",
                                                     "High Noise",
                                                     "Overhead Structure",
                                                     "Ignored Ground",
                                                     "Snow",
                                                     "Temporal Exclusion"};

}  // namespace

std::string_view classNameOf(std::uint32_t code) noexcept
{
    return code < kNames.size() ? kNames[code] : std::string_view();
}

std::string classLabel(std::uint32_t code)
{
    std::string label = std::to_string(code);
    if (const std::string_view name = classNameOf(code); !name.empty()) label += " " + std::string(name);
    return label;
}

std::optional<std::uint32_t> classOfName(std::string_view name) noexcept
{
    const auto same = [](char a, char b) {
        return std::tolower(static_cast<unsigned char>(a)) == std::tolower(static_cast<unsigned char>(b));
    };
    for (std::uint32_t code = 0; code < kNames.size(); ++code)
        if (!name.empty() && std::equal(name.begin(), name.end(), kNames[code].begin(), kNames[code].end(), same))
            return code;
    return {};
}

}  // namespace punctum
