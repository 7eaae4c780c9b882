// SPDX-License-Identifier: MIT
#pragma once

#include "core/edit/Command.h"
#include "tests/core/MadeCloud.h"

#include <cstring>
#include <memory>
#include <string>
#include <vector>

namespace punctum
{

/// Every `step`th point of the cloud.
inline std::shared_ptr<PointSet> everyNth(PointIndex size, PointIndex step)
{
    auto points = std::make_shared<PointSet>(size);
    for (PointIndex i = 0; i < size; i += step) points->insert(i);
    return points;
}

template <typename T>
std::vector<std::byte> repeated(T value, PointIndex count)
{
    std::vector<std::byte> bytes(count * sizeof(T));
    for (PointIndex i = 0; i < count; ++i) std::memcpy(bytes.data() + i * sizeof(T), &value, sizeof(T));
    return bytes;
}

template <typename T>
std::unique_ptr<Command> setValue(const PointCloud& cloud, const std::string& name, PointIndex step, T value)
{
    auto points = everyNth(cloud.size(), step);
    const PointIndex count = points->count();
    return std::make_unique<ValueCommand>("set " + name, *cloud.findAttribute(name), std::move(points),
                                          repeated(value, count));
}

/// A float32 attribute whose values are `value`, with its own column.
inline Attribute filled(const std::string& name, PointIndex size, float value)
{
    Attribute a;
    a.name = name;
    a.columns[0] = std::make_shared<Column>(name, ScalarType::F32, size);
    for (float& v : a.columns[0]->values<float>()) v = value;
    return a;
}

/// Three components and the vector that shows them.
inline std::vector<Attribute> normals(PointIndex size, float value)
{
    std::vector<Attribute> list{filled("NormalX", size, value), filled("NormalY", size, value + 1),
                                filled("NormalZ", size, value + 2)};
    Attribute vector = list[0];
    vector.name = "Normal";
    vector.kind = AttributeKind::Vector;
    vector.components = 3;
    for (std::size_t c = 0; c < 3; ++c) vector.columns[c] = list[c].columns[0];
    list.push_back(vector);
    return list;
}

}  // namespace punctum
