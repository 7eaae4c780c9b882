// SPDX-License-Identifier: MIT
#include "core/las/Diff.h"

#include "core/Error.h"
#include "core/cloud/Buffer.h"
#include "core/las/Alignment.h"
#include "core/las/Compatible.h"
#include "core/las/CopcPlan.h"
#include "core/las/File.h"
#include "core/las/Reader.h"
#include "core/las/RecordComparer.h"
#include "core/las/SourceDiff.h"
#include "core/las/WritePlan.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <atomic>
#include <mutex>
#include <shared_mutex>

namespace punctum::las
{

namespace
{

constexpr std::size_t kPieceBytes = std::size_t(1) << 18;  ///< of records fetched at once; stays in the cache
constexpr std::size_t kBlockBytes = std::size_t(1) << 20;  ///< of files compared byte by byte

/// Calls f for the parts of `range` that are in none of `gaps` (in order, without overlap).
template <typename F>
void forEachOutside(PointRange range, const std::vector<PointRange>& gaps, F&& f)
{
    auto gap = std::upper_bound(gaps.begin(), gaps.end(), range.first,
                                [](PointIndex i, const PointRange& g) { return i < g.last; });
    while (!range.empty()) {
        const PointIndex end = gap == gaps.end() ? range.last : std::clamp(gap->first, range.first, range.last);
        if (end > range.first) f(PointRange{range.first, end});
        if (gap == gaps.end()) return;
        range.first = std::max(end, std::min(gap->last, range.last));
        ++gap;
    }
}

/// Records that can be had in any order, from several threads.
class Records
{
public:
    virtual ~Records() = default;
    virtual PointIndex points() const = 0;
    /// Records of the points of `range`: in `scratch`, or where they are kept.
    virtual const std::byte* get(PointRange range, std::vector<std::byte>& scratch) const = 0;
    /// Points that have no record.
    virtual const std::vector<PointRange>& missing() const = 0;
};

/// Of a LAS file.
class PlainRecords final : public Records
{
public:
    explicit PlainRecords(const SourceFile& source)
        : m_file(source.path),
          m_offset(source.header.pointOffset()),
          m_length(source.layout.length),
          m_points(source.pointCount)
    {
    }
    PointIndex points() const override { return m_points; }
    const std::byte* get(PointRange range, std::vector<std::byte>& scratch) const override
    {
        scratch.resize(std::size_t(range.size() * m_length));
        m_file.readAt(m_offset + range.first * m_length, scratch);
        return scratch.data();
    }
    const std::vector<PointRange>& missing() const override { return m_none; }

private:
    File m_file;
    std::uint64_t m_offset, m_length;
    PointIndex m_points;
    std::vector<PointRange> m_none;
};

/// Of a LAZ file, decoded into memory.
class DecodedRecords final : public Records
{
public:
    DecodedRecords(const Reader& reader, Progress& progress, std::vector<std::string>& warnings)
        : m_length(reader.source()->layout.length),
          m_points(reader.source()->pointCount),
          m_records(std::size_t(m_points * m_length), BufferUse::Points)
    {
        progress.begin("Reading " + reader.source()->path.filename().string(), m_points);
        ReadResult result =
            reader.visitRecords(progress, [&](PointRange range, std::span<const std::byte> records) {
                std::memcpy(m_records.data() + range.first * m_length, records.data(), records.size());
            });
        m_missing = std::move(result.missing);
        warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
    }
    PointIndex points() const override { return m_points; }
    const std::byte* get(PointRange range, std::vector<std::byte>&) const override
    {
        return m_records.data() + range.first * m_length;
    }
    const std::vector<PointRange>& missing() const override { return m_missing; }

private:
    std::uint64_t m_length;
    PointIndex m_points;
    Buffer m_records;
    std::vector<PointRange> m_missing;
};

/// Of a file that holds a part of the points of another one, or the other way round, at the places of that one.
class AlignedRecords final : public Records
{
public:
    /// `shared`: the points of the longer file that the shorter one holds. `ofLonger`: `records` are those of it.
    /// `length`: bytes of a record.
    AlignedRecords(std::unique_ptr<Records> records, std::size_t length, const KeptPoints& shared,
                   PointIndex longer, bool ofLonger)
        : m_records(std::move(records)),
          m_length(length),
          m_shared(shared),
          m_points(ofLonger ? shared.count() : longer),
          m_ofLonger(ofLonger)
    {
        if (!ofLonger)
            forEachOutside({0, longer}, shared.ranges(), [&](PointRange gap) { m_missing.push_back(gap); });
    }
    PointIndex points() const override { return m_points; }
    const std::byte* get(PointRange range, std::vector<std::byte>& scratch) const override
    {
        if (!m_ofLonger) {
            const PointIndex first = m_shared.placeOf(range.first);
            return m_records->get({first, first + range.size()}, scratch);
        }
        thread_local std::vector<std::byte> run;
        scratch.clear();
        m_shared.forEachRun(range, [&](PointRange points, PointIndex) {
            const std::byte* const from = m_records->get(points, run);
            scratch.insert(scratch.end(), from, from + points.size() * m_length);
        });
        return scratch.data();
    }
    const std::vector<PointRange>& missing() const override { return m_missing; }

private:
    std::unique_ptr<Records> m_records;
    std::size_t m_length;
    const KeptPoints& m_shared;
    PointIndex m_points;
    bool m_ofLonger;
    std::vector<PointRange> m_missing;
};

/// That would be written, at the places of the file that holds the cloud at present.
class PlannedRecords final : public Records
{
public:
    /// `held`: the points of the cloud that the file holds.
    PlannedRecords(const RecordMaker& maker, const KeptPoints& held) : m_maker(maker), m_held(held)
    {
        const auto& stay = maker.kept().ranges();
        auto next = stay.begin();
        for (const PointRange& run : held.ranges()) {
            const PointIndex place = held.placeOf(run.first);
            const auto leaveOut = [&](PointIndex first, PointIndex last) {
                if (first < last) m_leftOut.push_back({place + (first - run.first), place + (last - run.first)});
            };
            PointIndex at = run.first;
            for (; next != stay.end() && next->first < run.last; ++next) {
                leaveOut(at, std::max(at, next->first));
                at = std::clamp(next->last, at, run.last);
                if (next->last > run.last) break;
            }
            leaveOut(at, run.last);
        }
    }
    PointIndex points() const override { return m_held.count(); }
    const std::byte* get(PointRange range, std::vector<std::byte>& scratch) const override
    {
        scratch.resize(std::size_t(range.size()) * length());
        m_held.forEachRun(range, [&](PointRange run, PointIndex place) {
            const PointIndex first = m_maker.kept().placeOf(run.first);
            m_maker.make({first, first + run.size()}, scratch.data() + (place - range.first) * length());
        });
        return scratch.data();
    }
    const std::vector<PointRange>& missing() const override { return m_leftOut; }

private:
    std::size_t length() const { return m_maker.layout().length; }

    const RecordMaker& m_maker;
    const KeptPoints& m_held;
    std::vector<PointRange> m_leftOut;
};

PointIndex total(const std::vector<PointRange>& ranges)
{
    PointIndex n = 0;
    for (const PointRange& r : ranges) n += r.size();
    return n;
}

/// Both lists as one, in order, without overlap.
std::vector<PointRange> merged(std::vector<PointRange> a, const std::vector<PointRange>& b)
{
    a.insert(a.end(), b.begin(), b.end());
    std::sort(a.begin(), a.end(), [](const PointRange& x, const PointRange& y) { return x.first < y.first; });
    std::vector<PointRange> all;
    for (const PointRange& r : a) {
        if (!all.empty() && r.first <= all.back().last)
            all.back().last = std::max(all.back().last, r.last);
        else
            all.push_back(r);
    }
    return all;
}

/// Streams the points of one file past the records of the other, which are kept.
/// `streamedIsA`: which of the two is A.
void comparePoints(const Reader& streamed, const Records& kept, const RecordLayout& keptLayout, bool streamedIsA,
                   Progress& progress, std::vector<std::string>& warnings, Difference& d)
{
    const SourceFile& source = *streamed.source();
    const RecordComparer comparer =
        streamedIsA ? RecordComparer(source.layout, keptLayout) : RecordComparer(keptLayout, source.layout);
    const PointIndex both = std::min(source.pointCount, kept.points());
    const std::uint64_t length = source.layout.length;
    const PointIndex piece =
        std::max<PointIndex>(1, kPieceBytes / std::max(length, std::uint64_t(keptLayout.length)));
    RecordComparer::Tally all;
    const auto pass = [&](const std::vector<PointRange>& gaps) {
        std::mutex mutex;
        all = {};
        progress.begin("Comparing points", source.pointCount);
        return streamed.visitRecords(progress, [&](PointRange range, std::span<const std::byte> records) {
            thread_local std::vector<std::byte> scratch;
            RecordComparer::Tally tally;
            const PointIndex start = range.first;
            range.last = std::min(range.last, both);
            forEachOutside(range, gaps, [&](PointRange part) {
                for (PointIndex first = part.first; first < part.last; first += piece) {
                    const PointRange now{first, std::min(first + piece, part.last)};
                    const std::byte* const theirs = records.data() + (first - start) * length;
                    const std::byte* const ours = kept.get(now, scratch);
                    comparer.compare(streamedIsA ? theirs : ours, streamedIsA ? ours : theirs,
                                     std::size_t(now.size()), first, tally);
                }
            });
            if (tally.counts.empty()) return;
            const std::lock_guard lock(mutex);
            all.add(tally);
        });
    };
    std::vector<PointRange> gaps = merged(kept.missing(), {});
    ReadResult result = pass(gaps);
    if (!result.missing.empty()) {  // their first records were compared before the damage was seen
        gaps = merged(gaps, result.missing);
        result = pass(gaps);
    }
    warnings.insert(warnings.end(), result.warnings.begin(), result.warnings.end());
    (streamedIsA ? d.unreadableA : d.unreadableB) = total(result.missing);
    PointIndex outside = 0;
    forEachOutside({0, both}, gaps, [&](PointRange r) { outside += r.size(); });
    d.compared = outside;
    d.differing = all.differing;
    d.attributes = comparer.differences(all);
}

/// First byte in which two files differ; nothing when they are the same.
std::optional<std::uint64_t> firstDifferentByte(const std::filesystem::path& a, const std::filesystem::path& b,
                                                Progress& progress)
{
    const File x(a), y(b);
    const std::uint64_t both = std::min(x.size(), y.size());
    progress.begin("Comparing bytes", both);
    std::vector<std::byte> p, q;
    for (std::uint64_t at = 0; at < both; at += kBlockBytes) {
        progress.check();
        const auto n = std::size_t(std::min<std::uint64_t>(kBlockBytes, both - at));
        p.resize(n);
        q.resize(n);
        x.readAt(at, p);
        y.readAt(at, q);
        const auto differs = std::mismatch(p.begin(), p.end(), q.begin()).first;
        if (differs != p.end()) return at + std::uint64_t(differs - p.begin());
        progress.add(n);
    }
    if (x.size() != y.size()) return both;
    return std::nullopt;
}

/// What will be in the file besides the points, as if it had been read.
SourceFile plannedSource(WritePlan& plan, const CoordinateScale& coordinates)
{
    SourceFile s;
    // How long compressed points will be is not known, and no part of the content.
    s.pointDataEnd = plan.prefix.size() + plan.maker->points() * plan.maker->layout().length;
    plan.setPointDataEnd(s.pointDataEnd);
    s.header = Header::of(plan.prefix);
    std::size_t at = s.header.bytes.size();
    s.vlrs = plan.vlrs;
    for (Vlr& vlr : s.vlrs) {  // what is said of compression has been brought up to date in the prefix
        std::copy_n(plan.prefix.begin() + std::ptrdiff_t(at + Vlr::kHeaderSize), vlr.data.size(), vlr.data.begin());
        at += std::size_t(vlr.bytesInFile());
    }
    s.gapBeforePoints.assign(plan.prefix.begin() + std::ptrdiff_t(at), plan.prefix.end());
    s.gapAfterPoints = plan.gapAfterPoints;
    s.evlrs = plan.evlrs;
    s.tail = plan.tail;
    s.waveformEvlr = plan.waveformEvlr;
    s.compressed = plan.compressed;
    s.copc = plannedCopc(plan);
    s.coordinates = coordinates;
    s.pointCount = plan.maker->points();
    std::vector<std::string> ignored;
    s.layout = makeLayout(plan.maker->layout().format, plan.maker->layout().length, s.extraBytesRecords(),
                          coordinates, ignored);
    useCompatibility(s, s.layout, ignored);
    return s;
}

/// The history's word for what the points would tell.
void addKnown(const std::vector<AttributeChange>& changes, Difference& d)
{
    for (const AttributeChange& change : changes) {
        const auto found = std::find_if(d.attributes.begin(), d.attributes.end(),
                                        [&](const AttributeDifference& a) { return a.name == change.attribute; });
        AttributeDifference& a = found != d.attributes.end() ? *found : d.attributes.emplace_back();
        a.name = change.attribute;
        a.points = change.points;
    }
}

}  // namespace

bool dropsOrUpgrades(const Difference& d)
{
    const auto removed = [](const auto& x) { return x.change == std::decay_t<decltype(x)>::Change::Removed; };
    return d.onlyA != 0 || std::any_of(d.attributes.begin(), d.attributes.end(), removed) ||
           std::any_of(d.records.begin(), d.records.end(), removed) ||
           std::any_of(d.header.begin(), d.header.end(), [](const FieldDifference& f) {
               return f.name == "point_format" || f.name == "version_minor";
           });
}

Difference diffFiles(const std::filesystem::path& a, const std::filesystem::path& b, const DiffOptions& options,
                     Progress& progress, std::vector<std::string>* warnings)
{
    progress.begin("Opening", 0);
    const auto readerA = Reader::open(a), readerB = Reader::open(b);
    const SourceFile &x = *readerA->source(), &y = *readerB->source();
    std::vector<std::string> said;
    for (const SourceFile* s : {&x, &y})
        for (const std::string& w : s->warnings) said.push_back(s->path.filename().string() + ": " + w);

    Difference d;
    d.pointsA = x.pointCount;
    d.pointsB = y.pointCount;
    d.onlyA = d.pointsA - std::min(d.pointsA, d.pointsB);
    d.onlyB = d.pointsB - std::min(d.pointsA, d.pointsB);
    compareSources(x, y, d);
    // Records of LAS are where they are; of two LAZ files, the smaller one is kept decoded.
    const bool keepA =
        !x.compressed || (y.compressed && x.pointCount * x.layout.length < y.pointCount * y.layout.length);
    const Reader& kept = keepA ? *readerA : *readerB;
    const Reader& streamed = keepA ? *readerB : *readerA;
    const SourceFile& k = *kept.source();
    std::unique_ptr<Records> records;
    if (k.compressed)
        records = std::make_unique<DecodedRecords>(kept, progress, said);
    else
        records = std::make_unique<PlainRecords>(k);
    (keepA ? d.unreadableA : d.unreadableB) = total(records->missing());
    // Where points were deleted, the others are compared with themselves, not with those at the same place.
    std::optional<KeptPoints> shared;
    const bool longerA = d.pointsA > d.pointsB;
    if (d.pointsA != d.pointsB && records->missing().empty())
        shared = partOf(longerA ? *readerA : *readerB, longerA ? *readerB : *readerA, progress);
    if (shared)
        records = std::make_unique<AlignedRecords>(std::move(records), k.layout.length, *shared,
                                                   std::max(d.pointsA, d.pointsB), keepA == longerA);
    comparePoints(streamed, *records, k.layout, !keepA, progress, said, d);
    if (options.bytes) d.firstByte = firstDifferentByte(a, b, progress);
    if (warnings != nullptr) *warnings = std::move(said);
    return d;
}

SavePreview previewSave(const PointCloud& cloud, const std::filesystem::path& original,
                        const std::filesystem::path& target, const WriteOptions& options, Progress& progress,
                        const std::vector<AttributeChange>* changes, const KnownPlan& known)
{
    progress.begin("Comparing with the file", 0);
    storeCompatible(cloud);
    const auto reader = Reader::open(original, nullptr);
    const std::shared_lock lock(cloud.mutex());
    SavePreview preview;
    preview.plan = known.fits(target, options)
                       ? known.plan
                       : std::make_shared<const WritePlan>(planWrite(cloud, target, options, progress));
    WritePlan plan = *preview.plan;
    const SourceFile& x = *reader->source();
    const CurrentFile place = cloud.source() ? cloud.source()->current->get() : CurrentFile();
    const KeptPoints held = place.kept && place.path == original ? *place.kept : KeptPoints::all(cloud.size());
    if (x.pointCount != held.count())
        throw Error(original, "The file no longer holds the points that were read from it.");
    const RecordLayout layout = plannedSource(plan, cloud.coordinates()).layout;

    Difference& d = preview.difference;
    d.pointsA = x.pointCount;
    d.pointsB = plan.maker->points();
    const PlannedRecords records(*plan.maker, held);
    d.onlyA = total(records.missing());
    d.onlyB = d.pointsB - (d.pointsA - d.onlyA);
    if (changes != nullptr) {
        d.attributes = RecordComparer(x.layout, layout).differences({});
        addKnown(*changes, d);
    } else {
        std::vector<std::string> said;
        comparePoints(*reader, records, layout, true, progress, said, d);
    }
    if (plan.compressed) {
        // As write() finds out: chunks that no edit touched stay where they are, if all before them does.
        const bool stay = d.attributes.empty() && d.onlyA == 0 && d.onlyB == 0 && plan.chunks.copies() &&
                          plan.prefix.size() == x.header.pointOffset();
        plan.setCompression(stay, !stay);
    }
    compareSources(x, plannedSource(plan, cloud.coordinates()), d);
    std::erase_if(d.container, [](const FieldDifference& f) { return f.name == "file_size"; });
    preview.notes = std::move(plan.notes);
    return preview;
}

}  // namespace punctum::las
