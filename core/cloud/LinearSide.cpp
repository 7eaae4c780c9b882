// SPDX-License-Identifier: MIT
#include "core/cloud/LinearSide.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>

namespace punctum
{

LinearSide::LinearSide(const glm::dvec3& normal, double constant)
    : m_normal(normal), m_constant(constant), m_normalSize(glm::abs(normal)), m_constantSize(std::abs(constant))
{
}

LinearSide& LinearSide::add(const LinearSide& other, double times)
{
    m_normal += times * other.m_normal;
    m_constant += times * other.m_constant;
    m_normalSize += std::abs(times) * other.m_normalSize;
    m_constantSize += std::abs(times) * other.m_constantSize;
    return *this;
}

LinearSide& LinearSide::add(double constant)
{
    m_constant += constant;
    m_constantSize += std::abs(constant);
    return *this;
}

LinearSide::Box LinearSide::of(const glm::dvec3& low, const glm::dvec3& high, double rounding) const noexcept
{
    double least = m_constant, greatest = m_constant, size = m_constantSize;
    for (int axis = 0; axis < 3; ++axis) {
        const double a = m_normal[axis] * low[axis], b = m_normal[axis] * high[axis];
        least += std::min(a, b);
        greatest += std::max(a, b);
        size += m_normalSize[axis] * std::max(std::abs(low[axis]), std::abs(high[axis]));
    }
    if (greatest < -rounding * size) return Box::Outside;
    return least > rounding * size ? Box::Inside : Box::Across;
}

}  // namespace punctum
