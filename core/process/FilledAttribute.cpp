// SPDX-License-Identifier: MIT
#include "core/process/FilledAttribute.h"

#include "core/Error.h"

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

template <typename T>
T storedAs(double value) noexcept
{
    if constexpr (std::is_floating_point_v<T>) {
        return T(value);
    } else {
        if (std::isnan(value)) return 0;
        const double rounded = std::round(value);
        if (rounded <= double(std::numeric_limits<T>::min())) return std::numeric_limits<T>::min();
        if (rounded >= double(std::numeric_limits<T>::max())) return std::numeric_limits<T>::max();
        return T(rounded);
    }
}

}  // namespace

FilledAttribute::FilledAttribute(const PointCloud& cloud, Description description)
{
    m_attribute.name = description.name;
    m_attribute.description = description.description;
    m_attribute.unit = description.unit;
    m_attribute.kind = description.kind;
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const there = cloud.findAttribute(description.name);
    ScalarType type = description.type;
    if (there != nullptr) {
        if (isFloating(there->type()) != isFloating(type) || there->scaled || there->components != 1 ||
            there->standard || there->bitWidth != 0 || there->columns[0]->components() != 1)
            throw Error("The cloud's attribute " + description.name + " does not hold plain " +
                        (isFloating(type) ? "decimal" : "whole") +
                        " numbers, so that these values cannot be kept in it; rename or remove it first.");
        type = there->type();
    }
    m_attribute.columns[0] = std::make_shared<Column>(description.name, type, cloud.size());
    m_data = m_attribute.columns[0]->data();
    if (there != nullptr) {
        std::memcpy(m_data, there->columns[0]->data(), cloud.size() * there->columns[0]->elementBytes());
    } else if (description.unset != 0) {
        visitScalar(type, [&](auto zero) {
            using T = decltype(zero);
            std::fill_n(reinterpret_cast<T*>(m_data), cloud.size(), storedAs<T>(description.unset));
        });
    }
}

void FilledAttribute::set(PointIndex point, double value) noexcept
{
    visitScalar(m_attribute.type(), [&](auto zero) {
        using T = decltype(zero);
        reinterpret_cast<T*>(m_data)[point] = storedAs<T>(value);
    });
}

double FilledAttribute::value(PointIndex point) const noexcept
{
    return visitScalar(m_attribute.type(), [&](auto zero) {
        using T = decltype(zero);
        return double(reinterpret_cast<const T*>(m_data)[point]);
    });
}

Attribute composedOf(const std::string& name, AttributeKind kind, const FilledAttribute& x,
                     const FilledAttribute& y, const FilledAttribute& z)
{
    Attribute together = x.attribute();
    together.name = name;
    together.kind = kind;
    together.components = 3;
    together.columns = {x.attribute().columns[0], y.attribute().columns[0], z.attribute().columns[0]};
    return together;
}

}  // namespace punctum
