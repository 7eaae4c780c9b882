// SPDX-License-Identifier: MIT
#include "core/shape/NormalColumns.h"

#include "core/Error.h"
#include "core/cloud/NormalParts.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <shared_mutex>
#include <type_traits>

namespace punctum
{

namespace
{

constexpr std::array<const char*, 3> kNormalNames = {"NormalX", "NormalY", "NormalZ"};

void refuseColumn(const std::string& name)
{
    throw Error(
        "The cloud's attribute " + name +
        " does not hold plain decimal numbers, so that these values cannot be kept in it; rename or remove it "
        "first.");
}

}  // namespace

NormalColumns::NormalColumns(const PointCloud& cloud)
{
    const std::shared_lock lock(cloud.mutex());
    const auto parts = normalParts(cloud);
    for (std::size_t c = 0; c < 3; ++c) {
        const Attribute* const there = parts ? (*parts)[c] : cloud.findAttribute(kNormalNames[c]);
        Attribute& ours = m_parts[c];
        if (there == nullptr) {
            ours.name = kNormalNames[c];
            ours.description = "normal";
            ours.columns[0] = std::make_shared<Column>(ours.name, ScalarType::F32, cloud.size());
            continue;
        }
        const bool holds = isFloating(there->type()) ? !there->scaled : there->scaled && there->scale != 0;
        if (!holds || there->components != 1 || there->standard || there->bitWidth != 0 ||
            there->columns[0]->components() != 1)
            refuseColumn(there->name);
        ours = *there;
        ours.columns[0] = std::make_shared<Column>(there->columns[0]->name(), there->type(), cloud.size());
        std::memcpy(ours.columns[0]->data(), there->columns[0]->data(),
                    cloud.size() * there->columns[0]->elementBytes());
    }
}

void NormalColumns::set(PointIndex point, const std::array<float, 3>& normal) noexcept
{
    for (std::size_t c = 0; c < 3; ++c) {
        const Attribute& part = m_parts[c];
        visitScalar(part.type(), [&](auto zero) {
            using T = decltype(zero);
            T* const values = reinterpret_cast<T*>(part.columns[0]->data());
            if constexpr (std::is_floating_point_v<T>) {
                values[point] = T(normal[c]);
            } else {
                const double stored = std::round((double(normal[c]) - part.offset) / part.scale);
                values[point] = stored <= double(std::numeric_limits<T>::min())   ? std::numeric_limits<T>::min()
                                : stored >= double(std::numeric_limits<T>::max()) ? std::numeric_limits<T>::max()
                                                                                  : T(stored);
            }
        });
    }
}

std::array<float, 3> NormalColumns::normal(PointIndex point) const noexcept
{
    std::array<float, 3> normal{};
    for (std::uint32_t c = 0; c < 3; ++c) normal[c] = float(m_parts[c].number(point));
    return normal;
}

std::vector<Attribute> NormalColumns::attributes() const
{
    std::vector<Attribute> all(m_parts.begin(), m_parts.end());
    const auto alike = [](const Attribute& a, const Attribute& b) {
        return a.type() == b.type() && a.scaled == b.scaled && a.scale == b.scale && a.offset == b.offset;
    };
    if (!alike(all[0], all[1]) || !alike(all[0], all[2])) return all;
    Attribute together = all[0];
    together.name = "Normal";
    together.kind = AttributeKind::Vector;
    together.components = 3;
    together.columns = {all[0].columns[0], all[1].columns[0], all[2].columns[0]};
    all.push_back(std::move(together));
    return all;
}

}  // namespace punctum
