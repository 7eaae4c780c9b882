// SPDX-License-Identifier: MIT
#include "core/las/WaveformFile.h"

#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <system_error>

namespace punctum::las
{

namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kCopyBytes = std::size_t(4) << 20;

}  // namespace

std::optional<fs::path> findWaveforms(const fs::path& file)
{
    std::error_code ignored;
    for (const char* ending : {".wdp", ".WDP"}) {
        fs::path packets = file;
        if (fs::is_regular_file(packets.replace_extension(ending), ignored)) return packets;
    }
    return {};
}

std::unique_ptr<AtomicFile> copyWaveforms(const fs::path& source, const AtomicFile& target,
                                          std::vector<std::string>& notes, Progress& progress)
{
    const auto from = findWaveforms(source);
    if (!from) return nullptr;
    fs::path to = target.target();
    to.replace_extension(from->extension());
    std::error_code ec;
    if (fs::equivalent(*from, to, ec)) return nullptr;
    if (findWaveforms(target.target()) && !target.replaces()) {
        notes.emplace_back(
            "The waveforms were not copied: beside the new name there are some of another file. Copy the .wdp file "
            "by hand.");
        return nullptr;
    }
    const File file(*from);
    auto copy = std::make_unique<AtomicFile>(to, file.size(), target.whenProtected());
    progress.begin("Copying waveforms", file.size());
    std::vector<std::byte> piece;
    for (std::uint64_t at = 0; at < file.size(); at += piece.size()) {
        progress.check();
        piece.resize(std::size_t(std::min<std::uint64_t>(kCopyBytes, file.size() - at)));
        file.readAt(at, piece);
        copy->writeAt(at, piece);
        progress.add(piece.size());
    }
    file.checkUnchanged();
    copy->sync();
    notes.emplace_back("The waveforms were copied as well, into a .wdp file beside it.");
    return copy;
}

}  // namespace punctum::las
