// SPDX-License-Identifier: MIT
#include "core/process/ClassEdit.h"

#include "core/Error.h"
#include "core/las/SourceFile.h"

#include <array>
#include <mutex>
#include <string_view>

namespace punctum {

std::string classLabel(std::uint32_t code)
{
    static constexpr std::array<std::string_view, 23> kNames = {"Never Classified",
                                                                "Unclassified",
                                                                "Ground",
                                                                "Low Vegetation",
                                                                "Medium Vegetation",
                                                                "High Vegetation",
                                                                "Building",
                                                                "Low Noise",
                                                                "",
                                                                "Water",
                                                                "Rail",
                                                                "Road Surface",
                                                                "",
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
    std::string label = std::to_string(code);
    if (code < kNames.size() && !kNames[code].empty()) label += " " + std::string(kNames[code]);
    return label;
}

Attribute classAttribute(const PointCloud& cloud, std::uint32_t code)
{
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const found = cloud.findAttribute("Classification");
    if (found == nullptr || found->components != 1 || found->columns[0]->components() != 1 ||
        found->type() != ScalarType::U8)
        throw Error("This cloud has no classes; nothing can be classified.");
    if (const std::uint64_t most = found->maxBits(); code > most) {
        const std::string held = "holds classes 0 to " + std::to_string(most);
        if (cloud.source() != nullptr && most == 31)
            throw Error("Point format " + std::to_string(cloud.source()->layout.format) + " " + held + "; class " +
                        std::to_string(code) + " needs point format 6 or later.");
        throw Error("This cloud " + held + "; class " + std::to_string(code) + " does not fit.");
    }
    return *found;
}

std::unique_ptr<Command> makeClassCommand(std::string name, const Attribute& classes,
                                          std::shared_ptr<const PointSet> points, std::uint32_t code)
{
    const PointIndex count = points->count();
    if (count == 0) return nullptr;
    // ValueCommand takes from these bytes the bits of the class field alone, so that flags beside it need no copy.
    std::vector<std::byte> values(count, std::byte(code << classes.bitShift));
    return std::make_unique<ValueCommand>(std::move(name), classes, std::move(points), std::move(values));
}

}  // namespace punctum
