// SPDX-License-Identifier: MIT
// A whole file: opened, saved as LAS and as LAZ, opened again. What was opened can be saved, the points are the
// same, and an undamaged LAS file is the same byte for byte.
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/fuzz/Fuzz.h"

#include <cmath>
#include <cstring>

using namespace punctum;
using fuzz::promise;
using lasfiles::Bytes;
namespace fs = std::filesystem;

namespace
{

constexpr PointIndex kMostPoints = 20000;
constexpr std::size_t kMostBytes = std::size_t(1) << 22;  ///< of records

/// A folder in memory where there is one, removed at the end.
class Folder
{
public:
    Folder()
    {
        std::error_code ec;
        std::string name = (fs::is_directory("/dev/shm", ec) ? "/dev/shm" : fs::temp_directory_path().string()) +
                           "/punctum-fuzz-XXXXXX";
        promise(::mkdtemp(name.data()) != nullptr, "a folder can be made");
        m_path = name;
    }
    ~Folder()
    {
        std::error_code ec;
        fs::remove_all(m_path, ec);
    }
    Folder(const Folder&) = delete;
    Folder& operator=(const Folder&) = delete;
    const fs::path& path() const { return m_path; }

private:
    fs::path m_path;
};

Bytes recordsOf(const las::Reader& reader, std::vector<PointRange>& missing)
{
    const std::size_t length = reader.source()->layout.length;
    Bytes all(std::size_t(reader.source()->pointCount) * length);
    Progress progress;
    missing = reader
                  .visitRecords(progress,
                                [&](PointRange r, std::span<const std::byte> bytes) {
                                    std::memcpy(all.data() + r.first * length, bytes.data(), bytes.size());
                                })
                  .missing;
    return all;
}

Bytes without(const Bytes& records, std::size_t length, const std::vector<PointRange>& missing)
{
    Bytes rest;
    std::size_t at = 0;
    for (const PointRange& m : missing) {
        rest.insert(rest.end(), records.begin() + std::ptrdiff_t(at * length),
                    records.begin() + std::ptrdiff_t(m.first * length));
        at = std::size_t(m.last);
    }
    rest.insert(rest.end(), records.begin() + std::ptrdiff_t(at * length), records.end());
    return rest;
}

bool hasNegativeZeroTime(const Bytes& records, const las::RecordLayout& layout)
{
    const int field = layout.find("GpsTime");
    if (field < 0) return false;
    for (std::size_t at = 0; at < records.size(); at += layout.length) {
        double time = 1;
        std::memcpy(&time, records.data() + at + layout.fields[std::size_t(field)].offset, sizeof time);
        if (time == 0 && std::signbit(time)) return true;
    }
    return false;
}

las::WriteReport save(const PointCloud& cloud, const fs::path& path)
{
    Progress progress;
    las::WriteOptions options;
    options.compressed = las::isCompressedName(path);
    return las::write(cloud, path, options, progress);
}

std::shared_ptr<PointCloud> load(const las::Reader& reader)
{
    auto cloud = reader.createCloud();
    Progress progress;
    fuzz::checkSentences(reader.read(*cloud, progress).warnings);
    return cloud;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    fuzz::oneThread();
    static fuzz::MemoryFile memory;
    static const Folder folder;
    const std::span input(reinterpret_cast<const std::byte*>(data), size);
    memory.set(input);
    std::unique_ptr<las::Reader> reader;
    std::shared_ptr<PointCloud> cloud;
    Bytes records;
    std::vector<PointRange> missing;
    try {
        reader = las::Reader::open(memory.path());
        const las::SourceFile& s = *reader->source();
        if (s.pointCount > kMostPoints || s.pointCount * s.layout.length > kMostBytes) return -1;
        cloud = load(*reader);
        records = without(recordsOf(*reader, missing), s.layout.length, missing);
    } catch (const Error& e) {
        fuzz::checkSentence(e);
        return 0;
    }
    const las::SourceFile& source = *reader->source();
    const bool sound = !source.recovered && missing.empty();

    for (const char* name : {"out.las", "out.laz"}) {
        const fs::path path = folder.path() / name;
        las::WriteReport report;
        try {
            report = save(*cloud, path);
        } catch (const Error& e) {
            fuzz::checkSentence(e);
            // LASzip does not compress wave packets of more than 2^31 bytes as they are, and takes a GPS time of -0
            // for the 0 before it: found out, and refused.
            if (las::isCompressedName(path) &&
                (las::hasWaveform(source.layout.format) || hasNegativeZeroTime(records, source.layout)))
                continue;
            std::fprintf(stderr, "%s\n", e.what());
            promise(false, "what was opened can be saved");
        }
        fuzz::checkSentences(report.notes);
        const auto again = las::Reader::open(path);
        promise(!again->source()->recovered, "what we write is sound");
        promise(again->source()->layout.format == source.layout.format &&
                    again->source()->layout.length == source.layout.length,
                "the record stays");
        std::vector<PointRange> none;
        promise(recordsOf(*again, none) == records && none.empty(), "every point is as it was");
        const bool plain = !las::isCompressedName(path);
        if (plain && sound && !source.compressed && report.notes.empty()) {
            const Bytes written = lasfiles::readFile(path);
            promise(std::equal(written.begin(), written.end(), input.begin(), input.end()),
                    "a file that is saved without an edit stays as it is");
        }
        // Saved a second time, there is nothing left to put right.
        const fs::path second = folder.path() / (plain ? "second.las" : "second.laz");
        const las::WriteReport nothing = save(*load(*again), second);
        promise(lasfiles::readFile(second) == lasfiles::readFile(path), "saving again changes nothing");
    }
    return 0;
}
