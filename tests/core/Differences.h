// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/Difference.h"

#include <string>

/// Says both texts where they differ, instead of their first characters.
#define QCOMPARE_STRING(actual, expected) QCOMPARE(QString::fromStdString(actual), QString::fromStdString(expected))

/// The attributes that differ, with their points: "Intensity:3 ".
inline std::string names(const punctum::las::Difference& d)
{
    std::string all;
    for (const auto& a : d.attributes) all += a.name + ":" + std::to_string(a.points) + " ";
    return all;
}
