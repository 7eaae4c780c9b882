// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace punctum::app
{

/// The class of PCL that does what a step does, to be timed beside it. PCL is seen by BenchPcl.cpp alone.
class PclPeer
{
public:
    using Points = std::vector<std::array<float, 3>>;
    using Values = std::map<std::string, std::string, std::less<>>;

    virtual ~PclPeer() = default;
    /// Does the work once, its search tree included.
    virtual void run() = 0;

    /// Null where PCL has no such step. `values`: complete; lengths as floats in the unit of the points.
    static std::unique_ptr<PclPeer> make(const std::string& step, const Values& values, const Points& points);
};

}  // namespace punctum::app
