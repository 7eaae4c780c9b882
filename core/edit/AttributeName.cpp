// SPDX-License-Identifier: MIT
#include "core/edit/AttributeName.h"

#include "core/Error.h"

#include <algorithm>
#include <array>
#include <string_view>

namespace punctum
{

namespace
{

constexpr std::size_t kLongestName = 32;  // bytes

/// Fields of the standard's records, and what is made of them, whether this cloud has them or not.
constexpr std::array<std::string_view, 28> kTaken = {
    "X",         "Y",       "Z",        "Intensity",     "ReturnNumber", "NumberOfReturns", "ScanDirectionFlag",
    "Synthetic", "GpsTime", "KeyPoint", "Withheld",      "Overlap",      "ScannerChannel",  "EdgeOfFlightLine",
    "Red",       "Green",   "Blue",     "NIR",           "RGB",          "Normal",          "Classification",
    "ScanAngle", "XYZ",     "UserData", "PointSourceId", "ClassFlags",   "Waveform",        "ReturnBits"};

}  // namespace

void checkNewName(const PointCloud& cloud, const std::string& name)
{
    if (name.empty()) throw Error("Give the attribute a name.");
    if (name.size() > kLongestName)
        throw Error("The name \"" + name + "\" is too long; files keep " + std::to_string(kLongestName) +
                    " bytes.");
    const auto control = [](char c) { return static_cast<unsigned char>(c) < 32 || c == 127; };
    if (std::any_of(name.begin(), name.end(), control) || name.front() == ' ' || name.back() == ' ')
        throw Error("A name cannot begin or end with a blank or hold control characters.");
    if (cloud.findAttribute(name) != nullptr)
        throw Error("There is an attribute \"" + name + "\" already; choose another name.");
    if (std::find(kTaken.begin(), kTaken.end(), name) != kTaken.end())
        throw Error("\"" + name + "\" is a name of the standard; choose another one.");
}

}  // namespace punctum
