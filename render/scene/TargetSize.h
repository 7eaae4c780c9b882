// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace punctum::render
{

/// Picture size in px, and samples a pixel: one of kSampleCounts.
struct TargetSize {
    int width = 0;
    int height = 0;
    int samples = 1;
    friend bool operator==(const TargetSize&, const TargetSize&) = default;
};

constexpr std::array<int, 4> kSampleCounts{1, 4, 8, 16};
/// Which of kSampleCounts it is; 0 for another number.
std::size_t sampleCountIndex(int samples) noexcept;
/// Throws Error when it is none of kSampleCounts.
void checkSampleCount(int samples);

/// Samples lie on a grid of so many steps a px.
constexpr int kSampleSteps = 16;
/// Where in its pixel a sample lies, in steps from the pixel's top left corner.
using SamplePlace = std::uint8_t[2];
/// The places of one pixel's samples, `samples` of them: the standard patterns of Direct3D, which most OpenGL
/// drivers have too. `samples` is one of kSampleCounts.
const SamplePlace* samplePlaces(int samples) noexcept;

}  // namespace punctum::render
