// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

/// What a save asks of the system can fail at each step: Faults.cpp has functions that stand before those of the C
/// library in the test's program, and let the k-th of those that concern the test's folder fail. One at a time.
namespace faults
{

enum class Kind { Error, Short, Nothing, Wrong, KillBefore, KillInside };

struct Step {
    std::string call;     ///< "pwrite"
    bool folder = false;  ///< of the folder itself, not of a file
};

extern std::vector<Step> stepsSeen;   ///< since it was armed
extern std::string failingCall;       ///< these fail, once armed, ...
extern std::size_t failingCallSkips;  ///< ... but for so many first ones

/// From here on the calls are counted; the `step`-th of them fails (from 1; 0: none). `reads`: pread alone is
/// counted, else all but it.
class Armed
{
public:
    Armed(const std::filesystem::path& folder, std::size_t step, Kind kind, int error, bool reads = false);
    ~Armed();
    Armed(const Armed&) = delete;
    Armed& operator=(const Armed&) = delete;
};

}  // namespace faults
