// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "core/edit/Command.h"

#include <memory>
#include <string>
#include <vector>

namespace punctum
{

/// A scalar attribute that a step computes for each point, to be put into an AttributesCommand.
///
/// Where the cloud has an attribute of that name, its type is kept, and so are the values of points that the step
/// does not set; without one, points have `unset`.
class FilledAttribute
{
public:
    struct Description {
        std::string name;
        std::string description;  ///< 32 bytes at most: what extra bytes hold
        std::string unit{};
        ScalarType type = ScalarType::F32;  ///< of a new one
        AttributeKind kind = AttributeKind::Scalar;
        double unset = 0;  ///< NaN is kept as it is by decimal types alone
    };
    /// Takes cloud.mutex() shared. Throws Error where an attribute of the name cannot hold the values: it is one of
    /// the standard's, scaled, has several components, or is decimal where whole numbers are wanted or the other
    /// way round.
    FilledAttribute(const PointCloud& cloud, Description description);

    /// Any thread, each point by one. Whole numbers are cut to what the type holds.
    void set(PointIndex point, double value) noexcept;
    double value(PointIndex point) const noexcept;
    const Attribute& attribute() const noexcept { return m_attribute; }

private:
    Attribute m_attribute;
    std::byte* m_data = nullptr;
};

/// Three of them shown together, where they have one type: NormalX, NormalY, NormalZ as Normal.
Attribute composedOf(const std::string& name, AttributeKind kind, const FilledAttribute& x,
                     const FilledAttribute& y, const FilledAttribute& z);

}  // namespace punctum
