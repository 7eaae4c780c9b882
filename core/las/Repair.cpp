// SPDX-License-Identifier: MIT
#include "core/las/Repair.h"

#include "core/Error.h"
#include "core/las/AtomicFile.h"
#include "core/las/Diff.h"
#include "core/las/File.h"
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"

#include <algorithm>

namespace punctum::las
{

namespace
{

constexpr std::size_t kCopyBlock = std::size_t(4) << 20;  ///< bytes copied between two looks at the cancel flag

/// What is wrong with a file, all of it read.
struct Examined {
    std::shared_ptr<const SourceFile> source;
    Diagnosis diagnosis;
    std::uint64_t missing = 0;
};

Examined examineFile(const std::filesystem::path& path, Progress& progress)
{
    Examined examined;
    ReadResult result;
    const auto cloud = load(path, progress, &result);
    examined.source = cloud->source();
    examined.diagnosis = examine(*cloud, progress).diagnosis;
    for (const PointRange& range : result.missing) examined.missing += range.size();
    return examined;
}

void copyBehind(const File& from, const Header& header, AtomicFile& to, Progress& progress)
{
    progress.begin("Copying", from.size());
    to.writeAt(0, header.bytes);
    std::vector<std::byte> block(kCopyBlock);
    for (std::uint64_t at = header.bytes.size(); at < from.size();) {
        progress.check();
        const auto bytes =
            std::span(block).first(std::size_t(std::min<std::uint64_t>(kCopyBlock, from.size() - at)));
        from.readAt(at, bytes);
        to.writeAt(at, bytes);
        at += bytes.size();
        progress.add(bytes.size());
    }
    to.sync();
}

/// Whether `copy` is `from` with this header, to the byte.
bool isCopyBehind(const File& from, const Header& header, const File& copy, Progress& progress)
{
    if (copy.size() != from.size()) return false;
    std::vector<std::byte> ours(header.bytes.size()), theirs;
    copy.readAt(0, ours);
    if (ours != header.bytes) return false;
    for (std::uint64_t at = header.bytes.size(); at < from.size(); at += ours.size()) {
        progress.check();
        ours.resize(std::size_t(std::min<std::uint64_t>(kCopyBlock, from.size() - at)));
        theirs.resize(ours.size());
        from.readAt(at, theirs);
        copy.readAt(at, ours);
        if (ours != theirs) return false;
    }
    return true;
}

/// Reads the new file, and throws unless it holds what the old one does.
void prove(const File& from, const Header& header, const std::filesystem::path& written,
           const std::filesystem::path& out, Progress& progress)
{
    const std::filesystem::path& in = from.path();
    const auto refuse = [&](const std::string& what) {
        throw Error(out, "What was written is not right: " + what + "; nothing was kept.");
    };
    if (!isCopyBehind(from, header, File(written), progress)) refuse("its bytes are not those that were meant");
    // The same bytes with another header may be other points.
    const Difference d = diffFiles(in, written, {}, progress);
    if (d.onlyA != 0 || d.onlyB != 0 || d.differing != 0 || !d.attributes.empty() || d.unreadableA != d.unreadableB)
        refuse("its points differ from those of " + in.filename().string());
    if (!d.records.empty() || d.recordsReordered) refuse("its records differ");
    for (const Finding& finding : examineFile(written, progress).diagnosis.findings)
        if (finding.repairable) refuse("a fault is still there (" + finding.fault + ")");
}

}  // namespace

RepairReport repair(const std::filesystem::path& in, const std::filesystem::path& out, Progress& progress)
{
    std::error_code code;
    if (std::filesystem::equivalent(in, out, code))
        throw Error(in, "The repaired file needs another name, so that the original is kept.");
    RepairReport report;
    const Examined examined = examineFile(in, progress);
    for (const Finding& finding : examined.diagnosis.findings)
        (finding.repairable ? report.mended : report.left).push_back(finding);
    if (report.mended.empty()) return report;
    const SourceFile& source = *examined.source;
    if (isCompressedName(out) != source.compressed)
        throw Error(out, std::string("Points stay as they are stored: the name must end in ") +
                             (source.compressed ? ".laz." : ".las."));

    const File file(in);
    if (!(file.stamp() == source.current->get().stamp)) throw Error(in, "The file changed while it was read.");
    AtomicFile target(out, file.size());
    copyBehind(file, examined.diagnosis.mended, target, progress);
    prove(file, examined.diagnosis.mended, target.temporary(), out, progress);
    target.commit();

    report.written = true;
    report.points = source.pointCount - examined.missing;
    report.bytes = source.fileSize;
    report.notes = target.notes();
    if (hasWaveform(source.layout.format) && source.header.says(encoding::kExternalWaveform))
        report.notes.emplace_back(
            "The waveforms are in a .wdp file beside the original; the new file needs a copy.");
    return report;
}

}  // namespace punctum::las
