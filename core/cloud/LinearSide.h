// SPDX-License-Identifier: MIT
#pragma once

#include <glm/vec3.hpp>

namespace punctum
{

/// A linear function of a place, dot(normal, place) + constant, that is negative outside of something: one side of
/// a frustum, a clip, a region. Tells of whole boxes whether all of their places are outside, or inside. A value;
/// places in any frame, the same for all of its calls.
class LinearSide
{
public:
    enum class Box { Outside, Across, Inside };

    LinearSide(const glm::dvec3& normal, double constant);
    /// Adds another function, `times` so much.
    LinearSide& add(const LinearSide& other, double times);
    LinearSide& add(double constant);

    /// For the box between two corners, both included. `rounding`: of the sum of its terms' sizes, what the
    /// function may be off by where it is computed for single places; where that could matter, the box is Across.
    Box of(const glm::dvec3& low, const glm::dvec3& high, double rounding) const noexcept;

private:
    glm::dvec3 m_normal;
    double m_constant;
    /// Sums of the sizes of what was added up: differences of large numbers are as little exact as these are.
    glm::dvec3 m_normalSize;
    double m_constantSize;
};

}  // namespace punctum
