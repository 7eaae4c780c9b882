// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

class AtomicFile;

/// The waveform packets beside a LAS or LAZ file: the same name, ending in .wdp or .WDP.
std::optional<std::filesystem::path> findWaveforms(const std::filesystem::path& file);

/// Writes the packets that belong to `source` beside `target`, under its name, but leaves it to the caller to
/// commit them. Null when there is nothing to do: there are none, they are there already, or they would replace
/// packets of a file that `target` does not replace; the last is said in `notes`. Throws Error or Cancelled.
std::unique_ptr<AtomicFile> copyWaveforms(const std::filesystem::path& source, const AtomicFile& target,
                                          std::vector<std::string>& notes, Progress& progress);

}  // namespace punctum::las
