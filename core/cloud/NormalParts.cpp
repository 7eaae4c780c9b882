// SPDX-License-Identifier: MIT
#include "core/cloud/NormalParts.h"

#include <string>
#include <string_view>

namespace punctum
{

namespace
{

/// Letters, made small, and digits.
std::string plainName(std::string_view name)
{
    std::string plain;
    for (const char c : name) {
        if (c >= 'A' && c <= 'Z')
            plain += char(c - 'A' + 'a');
        else if ((c >= 'a' && c <= 'z') || (c >= '0' && c <= '9'))
            plain += c;
    }
    return plain;
}

constexpr std::array<std::array<std::string_view, 3>, 4> kNormalTriples = {{
    {"normalx", "normaly", "normalz"},
    {"nx", "ny", "nz"},
    {"normalsx", "normalsy", "normalsz"},
    {"normal0", "normal1", "normal2"},  // one field of three values
}};

}  // namespace

std::optional<std::array<const Attribute*, 3>> normalParts(const PointCloud& cloud)
{
    for (const auto& names : kNormalTriples) {
        std::array<const Attribute*, 3> parts{};
        for (const Attribute& a : cloud.attributes()) {
            if (a.standard || a.components != 1 || a.kind == AttributeKind::Opaque) continue;
            const std::string plain = plainName(a.name);
            for (std::size_t c = 0; c < 3; ++c)
                if (parts[c] == nullptr && plain == names[c]) parts[c] = &a;
        }
        if (parts[0] != nullptr && parts[1] != nullptr && parts[2] != nullptr) return parts;
    }
    return {};
}

void addNormalVector(PointCloud& cloud)
{
    if (const auto parts = normalParts(cloud))
        addComposite(cloud, "Normal", AttributeKind::Vector,
                     {(*parts)[0]->name, (*parts)[1]->name, (*parts)[2]->name});
}

}  // namespace punctum
