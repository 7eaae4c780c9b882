// SPDX-License-Identifier: MIT
#include "core/las/StagedWrite.h"

#include "core/las/Leftovers.h"

#include <system_error>
#include <utility>

namespace punctum::las
{

namespace
{

std::string lowerExtension(const std::filesystem::path& path)
{
    std::string ending = path.extension().string();
    for (char& c : ending)
        if (c >= 'A' && c <= 'Z') c = char(c - 'A' + 'a');
    return ending;
}

bool isCopcName(const std::filesystem::path& path)
{
    return isCompressedName(path) && lowerExtension(path.stem()) == ".copc";
}

/// LAStools finds points by NAME.lax without a look whether the index is older than the points.
void setIndexAside(const AtomicFile& file, std::vector<std::string>& notes)
{
    std::filesystem::path index = file.target();
    index.replace_extension(".lax");
    std::error_code ec;
    if (!std::filesystem::is_regular_file(index, ec)) return;
    std::filesystem::path aside = index;
    aside += ".old";
    if (!file.replaces())
        notes.emplace_back(
            "The .lax index beside it belongs to another file, but LAStools would go by it: remove it.");
    else if (std::filesystem::rename(index, aside, ec); ec)
        notes.push_back("The .lax index beside it belongs to the old file and should be removed (" + ec.message() +
                        ").");
    else
        notes.emplace_back("The .lax index beside it belonged to the old file; its name ends in .lax.old now.");
}

}  // namespace

bool isCompressedName(const std::filesystem::path& path)
{
    return lowerExtension(path) == ".laz";
}

StagedWrite::StagedWrite(std::unique_ptr<State> state) : m_state(std::move(state)) {}
StagedWrite::~StagedWrite() = default;
StagedWrite::StagedWrite(StagedWrite&& other) noexcept = default;
StagedWrite& StagedWrite::operator=(StagedWrite&& other) noexcept = default;

const std::filesystem::path& StagedWrite::target() const noexcept
{
    return m_state->file->target();
}

WriteReport StagedWrite::commit()
{
    AtomicFile& file = *m_state->file;
    AtomicFile* const waveforms = m_state->waveforms.get();
    return withName(m_state->path, [&] {
        if (waveforms != nullptr) waveforms->commit();
        FileStamp stamp;
        try {
            stamp = file.commit();
        } catch (...) {
            std::error_code ignored;
            if (waveforms != nullptr && !waveforms->replaces())
                std::filesystem::remove(waveforms->target(), ignored);
            throw;
        }
        return m_state->finish(stamp, Leftovers(folderOf(file.target())).of(file.target()));
    });
}

WriteReport StagedWrite::State::finish(const FileStamp& stamp, std::vector<std::string> leftovers)
{
    std::vector<std::string>& notes = report.notes;
    for (std::string& sentence : leftovers) notes.push_back(std::move(sentence));
    notes.insert(notes.end(), file->notes().begin(), file->notes().end());
    if (!pristine) setIndexAside(*file, notes);
    if (isCopcName(path) && !copc)
        notes.emplace_back(
            "The name ends in .copc.laz, but the file is an ordinary LAZ file; give it another name.");
    if (source != nullptr) source->current->set({file->target(), stamp, true, pristine, kept});
    return std::move(report);
}

}  // namespace punctum::las
