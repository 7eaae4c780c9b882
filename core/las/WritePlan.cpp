// SPDX-License-Identifier: MIT
#include "core/las/WritePlan.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/LeastMost.h"
#include "core/las/ChunkCodec.h"
#include "core/las/Compatible.h"
#include "core/las/CrsPlan.h"
#include "core/las/ExtraBytesPlan.h"
#include "core/las/ExtraBytesRange.h"
#include "core/las/GpsTime.h"
#include "core/las/Parallel.h"
#include "core/task/Progress.h"

#include <glm/common.hpp>

#include <algorithm>
#include <cmath>
#include <utility>

namespace punctum::las
{

namespace
{

constexpr const char* kLaxLeftOut = "The LAX spatial index is left out: it belongs to the old compressed file.";
constexpr std::size_t kSpecialCountAt = 16, kSpecialStartAt = 24;  ///< in the laszip record

const char* isOrAre(PointIndex n)
{
    return n == 1 ? "is" : "are";
}

/// Extent and returns of the points that are written.
struct Summary {
    RawBounds bounds;
    std::array<std::uint64_t, 16> byReturn{};

    void include(const Summary& o)
    {
        bounds.include(o.bounds);
        for (std::size_t k = 0; k < 16; ++k) byReturn[k] += o.byReturn[k];
    }
};

/// Appends a value's bytes.
template <typename T>
void put(std::vector<std::byte>& bytes, const T& value)
{
    const auto* p = reinterpret_cast<const std::byte*>(&value);
    bytes.insert(bytes.end(), p, p + sizeof(T));
}

void putVlr(std::vector<std::byte>& bytes, const Vlr& vlr)
{
    put(bytes, vlr.reserved);
    put(bytes, vlr.userId);
    put(bytes, vlr.recordId);
    if (vlr.extended)
        put(bytes, std::uint64_t(vlr.data.size()));
    else
        put(bytes, std::uint16_t(vlr.data.size()));
    put(bytes, vlr.description);
    bytes.insert(bytes.end(), vlr.data.begin(), vlr.data.end());
}

bool isLax(const Vlr& v)
{
    return v.is("LAStools", 30);
}

/// Makes the plan; one use.
class Planner
{
public:
    Planner(const PointCloud& cloud, const std::filesystem::path& target, const WriteOptions& options,
            Progress& progress)
        : m_cloud(cloud), m_target(target), m_options(options), m_progress(progress)
    {
    }

    WritePlan plan()
    {
        takeSource();
        chooseFormat();
        chooseFields();
        chooseRecords();
        refuseLosses();
        setHeader();
        return std::move(m_plan);
    }

private:
    [[noreturn]] void refuse(const std::string& sentence) const { throw Error(m_target, sentence); }
    void note(const std::string& sentence) { m_plan.notes.push_back(sentence); }

    std::shared_ptr<const Column> column(std::string_view name) const { return findColumn(m_cloud, name); }

    // -- what there is

    void takeSource()
    {
        m_source = m_cloud.source();
        if (m_source == nullptr) m_source = inventSource();
        m_made = m_source->path.empty();
        m_read = m_source->asRead->get();
        const bool damaged = m_source->recovered || !m_read.missing.empty();
        std::error_code ec;
        if (damaged && std::filesystem::equivalent(m_source->path, m_target, ec))
            refuse(
                "This file was damaged when it was opened; save under another name, so that the original stays.");
        m_kept = KeptPoints(readable(m_cloud.size(), m_read.missing));
        if (const PointIndex lost = m_cloud.size() - m_kept.count(); lost != 0)
            note(pointsText(lost) + " that could not be read " + isOrAre(lost) + " left out.");
        if (const PointIndex readable = m_kept.count(); m_cloud.deleted()) {
            m_kept = m_kept.without(*m_cloud.deleted());
            const PointIndex deleted = readable - m_kept.count();
            note(pointsText(deleted) + " that " + (deleted == 1 ? "was" : "were") + " deleted " + isOrAre(deleted) +
                 " left out.");
        }
        m_points = m_kept.count();
        m_header = m_source->header;
        m_vlrs = m_source->vlrs;
        m_plan.evlrs = m_source->evlrs;
        m_plan.gapAfterPoints = m_source->gapAfterPoints;
        m_plan.tail = m_source->tail;
        m_plan.sourcePointDataEnd = m_source->pointDataEnd;
        m_plan.waveformEvlr = m_source->waveformEvlr;
    }

    /// For a cloud that came from nowhere: the format that holds the standard columns it has.
    std::shared_ptr<const SourceFile> inventSource() const
    {
        const auto has = [&](const char* name) { return column(name) != nullptr; };
        std::uint8_t format = 6;
        if (has("Classes"))
            format = std::uint8_t((has("GpsTime") ? 1 : 0) + (has("Red") ? 2 : 0));
        else if (has("NIR"))
            format = 8;
        else if (has("Red"))
            format = 7;
        return makeSource(format, {}, m_cloud.coordinates(), {}, m_cloud.size());
    }

    // -- what it becomes

    void chooseFormat()
    {
        const std::uint8_t before = m_source->layout.format;
        FormatNeeds needs;
        if (!m_options.pointFormat) needs = findNeeds(m_cloud, *m_source, m_kept.ranges(), m_progress);
        m_format = m_options.pointFormat.value_or(needs.formatFor(before));
        if (m_format > kLastPointFormat) refuse("There is no point format " + std::to_string(m_format) + ".");
        const std::uint8_t minorBefore = m_header.versionMinor();
        m_minor = m_options.versionMinor.value_or(minorBefore);
        if (m_options.versionMinor) followVersion(before);
        const bool formatAsked = m_format != before || (m_options.versionMinor && m_minor != minorBefore);
        std::uint8_t needed = formatAsked ? oldestMinor(m_format) : std::uint8_t(0);
        const bool many = m_points > UINT32_MAX;
        if (many) needed = 4;
        if (many && m_minor < needed)
            needs.reasons.push_back(grouped(m_points) + " points are more than it can count");
        if (m_minor < needed) {
            if (m_options.versionMinor)
                refuse((many ? grouped(m_points) + " points need"
                             : "Point format " + std::to_string(m_format) + " needs") +
                       " LAS 1." + std::to_string(needed) + " or newer.");
            m_minor = needed;
        }
        if (!needs.reasons.empty())
            upgrade(needs.reasons, before, minorBefore);
        else if (m_minor != minorBefore && !m_options.versionMinor)
            note("The file becomes LAS 1." + std::to_string(m_minor) + ", which point format " +
                 std::to_string(m_format) + " needs.");
        if (m_format != before && m_minor > newestMinor(m_format)) {
            m_minor = newestMinor(m_format);
            note("The file becomes LAS 1." + std::to_string(m_minor) + ", the last version that has point format " +
                 std::to_string(m_format) + ".");
        }
        m_restructured = m_format != before || m_minor != minorBefore;
    }

    /// The version that was asked for decides the format, unless that was asked for, too.
    void followVersion(std::uint8_t before)
    {
        if (m_minor < 2 || m_minor > kNewestMinor)
            refuse("LAS 1." + std::to_string(m_minor) + " cannot be written; choose 1.2, 1.3, 1.4 or 1.5.");
        if (m_options.pointFormat) {
            if (m_minor > newestMinor(m_format))
                refuse("LAS 1." + std::to_string(m_minor) + " has no point format " + std::to_string(m_format) +
                       ", only 6 to 10.");
            return;
        }
        m_format = formatIn(m_format, m_minor);
        if (m_format != before)
            note("The points become point format " + std::to_string(m_format) + ": LAS 1." +
                 std::to_string(m_minor) + " has no point format " + std::to_string(before) + ".");
    }

    /// What there is now does not fit the source's format: another one only if the user says so.
    void upgrade(const std::vector<std::string>& reasons, std::uint8_t before, std::uint8_t minorBefore)
    {
        std::string list;
        for (const std::string& reason : reasons) list += (list.empty() ? "" : ", ") + reason;
        const std::string old =
            "Point format " + std::to_string(before) + " of LAS 1." + std::to_string(minorBefore);
        const std::string now = "point format " + std::to_string(m_format) + " of LAS 1." + std::to_string(m_minor);
        if (!m_options.upgrade)
            throw WriteQuestion(WriteQuestion::Kind::Upgrade, m_target,
                                old + " cannot hold what the points are now: " + list + ".", now);
        note("The file becomes " + now + ", since the former one cannot hold it: " + list + ".");
    }

    /// Standard fields of the target, from the columns of the same name.
    void chooseFields()
    {
        std::vector<std::string> none;
        m_layout = makeLayout(m_format, standardRecordLength(m_format), {}, m_source->coordinates, none);
        m_layout.attributes.clear();
        m_layout.attributeFields.clear();
        const bool was = isExtendedFormat(m_source->layout.format), is = isExtendedFormat(m_format);
        m_packed = packedColumns(m_cloud, *m_source);
        if (was != is)
            m_conversion = is ? RecordMaker::Conversion::ToExtended : RecordMaker::Conversion::ToClassic;
        else if (!is && m_packed.classes)
            m_conversion = RecordMaker::Conversion::FoldClasses;
        const auto packed = [&](const std::string& name) {
            return name == "Returns" || name == "Classes" || name == "Flags" || name == "Classification" ||
                   name == "ScanAngle";
        };
        for (const RecordField& f : m_layout.fields) {
            std::shared_ptr<const Column> c;
            const int before = m_source->layout.find(f.column);  // extra bytes of the same name stay extra bytes
            const bool extra = before >= 0 && m_source->layout.fields[std::size_t(before)].offset >=
                                                  standardRecordLength(m_source->layout.format);
            const bool converted = m_conversion == RecordMaker::Conversion::FoldClasses
                                       ? f.column == "Classes"
                                       : m_conversion != RecordMaker::Conversion::None && packed(f.column);
            if (!extra && !converted) c = matching(f);
            if (c != nullptr && !extra && f.column == "GpsTime") c = keepTimes(c);
            m_columns.push_back(std::move(c));
        }
        if (m_conversion != RecordMaker::Conversion::None &&
            (!m_packed.returns || !m_packed.flags || !m_packed.angle || (was && !m_packed.classes)))
            refuse("The cloud lacks a field of its point format and cannot be converted.");
        chooseExtraBytes();
    }

    /// Times with an offset, which only LAS 1.5 has, are counted as earlier versions do.
    std::shared_ptr<const Column> keepTimes(const std::shared_ptr<const Column>& times)
    {
        if (m_minor >= 5 || gpsClock(m_source->header) != GpsClock::Offset) return times;
        constexpr double kAdjusted = 1000.0, kSeconds = 1e6;  // of the offset
        const double offset = m_source->header.get(at::kTimeOffset);
        if (offset == kAdjusted) return times;
        std::uint64_t rounded = 0;
        auto shifted = shiftedTimes(*times, (offset - kAdjusted) * kSeconds, m_kept.ranges(), rounded, m_progress);
        note("GPS times are counted as LAS 1." + std::to_string(m_minor) +
             " does: seconds less 1,000,000,000 instead of " + grouped(std::uint64_t(offset * kSeconds)) + ".");
        if (rounded != 0)
            m_plan.losses.push_back({"a GPS time that is rounded when it is counted from another origin",
                                     "is rounded by a ten-millionth of a second or less", rounded});
        return shifted;
    }

    std::shared_ptr<const Column> matching(const RecordField& f) const
    {
        auto c = column(f.column);
        if (c != nullptr && c->type() == f.type && c->components() == f.components) return c;
        return nullptr;
    }

    void addField(const std::shared_ptr<const Column>& c)
    {
        const std::size_t length = m_layout.length + c->elementBytes();
        if (length > UINT16_MAX) refuse("The attributes do not fit a point record of 65535 bytes.");
        m_layout.fields.push_back({c->name(), m_layout.length, c->type(), std::uint16_t(c->components())});
        m_layout.length = std::uint16_t(length);
        m_columns.push_back(c);
    }

    /// The source's extra bytes as they are, unless attributes came or went: then one record describes them all.
    void chooseExtraBytes()
    {
        auto standard = m_columns;
        if (!isExtendedFormat(m_source->layout.format)) standard.push_back(m_packed.classes);
        ExtraBytesPlan extra = planExtraBytes(m_cloud, *m_source, standard);
        for (const auto& c : extra.columns) addField(c);
        updateRanges(extra);
        if (extra.unchanged()) return;
        m_restructured = true;
        replaceExtraBytesRecord(extra.descriptors);
        const auto list = [](const std::vector<std::string>& names) {
            std::string s;
            for (const std::string& n : names) s += (s.empty() ? "" : ", ") + n;
            return s;
        };
        if (!extra.added.empty()) note("Stored as extra bytes: " + list(extra.added) + ".");
        if (!extra.renamed.empty()) note("Renamed: " + list(extra.renamed) + ".");
        if (!extra.gone.empty()) note("No longer in the file: " + list(extra.gone) + ".");
    }

    /// Minimum and maximum in the descriptors that state them, where edits changed them: what is wrong from the
    /// start stays as it is.
    void updateRanges(ExtraBytesPlan& extra)
    {
        if (!m_read.complete) return;
        const auto now = extraBytesRanges(m_cloud, *m_source, m_kept.ranges(), m_progress);
        for (const ExtraBytesRange& range : now) {
            if (std::find(m_read.extra.begin(), m_read.extra.end(), range) != m_read.extra.end()) continue;
            const ExtraBytesPlan::SourceItem& item = extra.sourceItems[range.item];
            if (item.descriptor) setRange(extra.descriptors[*item.descriptor].bytes.data(), range);
            std::size_t record = 0;
            for (auto* list : {&m_vlrs, &m_plan.evlrs})
                for (Vlr& vlr : *list)
                    if (vlr.is("LASF_Spec", kExtraBytesRecordId) && record++ == item.record)
                        setRange(vlr.data.data() + item.place, range);
        }
    }

    void replaceExtraBytesRecord(const std::vector<ExtraBytesDescriptor>& descriptors)
    {
        std::vector<std::byte> data;
        for (const ExtraBytesDescriptor& d : descriptors) data.insert(data.end(), d.bytes.begin(), d.bytes.end());
        const bool large = data.size() > UINT16_MAX;
        if (large && m_minor < 4)
            refuse(grouped(descriptors.size()) + " attributes are more than the " +
                   grouped(UINT16_MAX / ExtraBytesDescriptor::kSize) + " that LAS 1." + std::to_string(m_minor) +
                   " can describe; LAS 1.4 can.");
        bool placed = descriptors.empty();
        for (auto* list : {&m_vlrs, &m_plan.evlrs}) {
            for (std::size_t k = 0; k < list->size();) {
                Vlr& vlr = (*list)[k];
                if (!vlr.is("LASF_Spec", kExtraBytesRecordId)) {
                    ++k;
                } else if (!placed && (!large || vlr.extended)) {
                    vlr.data = data;
                    placed = true;
                    ++k;
                } else {
                    erase(*list, k);
                }
            }
        }
        if (placed) return;
        Vlr record = makeVlr("LASF_Spec", kExtraBytesRecordId, "Extra Bytes Record", std::move(data), large);
        (large ? m_plan.evlrs : m_vlrs).push_back(std::move(record));
    }

    void erase(std::vector<Vlr>& list, std::size_t k)
    {
        if (&list == &m_plan.evlrs)
            m_plan.eraseEvlr(k);
        else
            list.erase(list.begin() + std::ptrdiff_t(k));
    }

    template <typename Which>
    std::size_t dropRecords(const Which& which)
    {
        return m_plan.dropRecords(m_vlrs, which);
    }

    // -- records besides the points

    void chooseRecords()
    {
        if (dropRecords([](const Vlr& v) {
                return v.user() == "copc" && (v.recordId == 1 || v.recordId == 1000 || v.recordId == 10000);
            }) != 0)
            note("The spatial index of the COPC file is left out: it becomes an ordinary " +
                 std::string(m_options.compressed ? "LAZ" : "LAS") + " file.");
        // In a file that stays compressed, the index in an EVLR is right while the points are where they were: what
        // is written tells (WritePlan::setCompression).
        const bool stays = m_options.compressed && m_minor >= 4;
        if (m_source->compressed &&
            dropRecords([&](const Vlr& v) { return isLax(v) && !(stays && v.extended); }) != 0)
            note(kLaxLeftOut);

        m_plan.compressed = m_options.compressed;
        if (m_options.compressed)
            chooseCompression();
        else if (m_source->compressed)  // in a plain file it is just a record that somebody left there
            std::erase_if(m_vlrs, isLaszip);
        if (m_minor < 4) shortenEvlrs();
    }

    /// The file's own laszip record and chunks stay wherever they say the same as LASzip's present ones.
    void chooseCompression()
    {
        LazInfo& laz = m_plan.laz;
        laz = LazInfo::standard(m_format, m_layout.length);
        const auto found = std::find_if(m_vlrs.rbegin(), m_vlrs.rend(), isLaszip);  // the last one counts
        std::optional<LazInfo> own;
        if (found != m_vlrs.rend()) own = fitting(*found);
        const bool ownSize = own && !own->variable() && own->chunkSize <= kDefaultChunkSize;
        m_plan.chunks = planChunks(*m_source, laz, m_kept, ownSize ? own->chunkSize : kDefaultChunkSize);
        if (!m_options.copyChunks) {
            m_plan.chunks.file.reset();
            m_plan.chunks.allOrNone = false;
        }
        laz.setChunkSize(m_plan.chunks.chunkSize);

        if (found == m_vlrs.rend()) {
            m_vlrs.push_back(makeVlr(kLaszipUser, kLaszipRecordId, "by Punctum with LASzip", laz.payload));
        } else if (!own || own->items != (m_plan.chunks.allOrNone ? m_plan.chunks.laz.items : laz.items)) {
            found->data = laz.payload;
        } else if (own->chunkSize != laz.chunkSize) {
            own->setChunkSize(laz.chunkSize);
            std::copy(own->payload.begin(), own->payload.end(), found->data.begin());
        }
    }

    /// What the record says, if chunks that we write can be of that kind.
    std::optional<LazInfo> fitting(const Vlr& record)
    {
        try {
            LazInfo info = LazInfo::parse(record, m_format, m_layout.length);
            if (info.compressor == m_plan.laz.compressor) return info;
            if (info.compressor == LazInfo::Pointwise)
                note("The points, until now compressed in one stream, are compressed in chunks.");
        } catch (const Error&) {  // of another point format
        }
        return {};
    }

    /// Before 1.4 there are no EVLRs but the waveform record of 1.3.
    void shortenEvlrs()
    {
        if (m_header.versionMinor() < 4) return;
        std::vector<Vlr> stay;
        std::optional<std::size_t> waveform;
        for (std::size_t k = 0; k < m_plan.evlrs.size(); ++k) {
            Vlr& vlr = m_plan.evlrs[k];
            if (m_minor == 3 && m_plan.waveformEvlr == k) {
                waveform = stay.size();
                stay.push_back(std::move(vlr));
            } else if (vlr.data.size() > UINT16_MAX) {
                m_plan.losses.push_back({"the extended record " + vlr.user() + "/" + std::to_string(vlr.recordId) +
                                             " of " + grouped(vlr.data.size()) + " bytes",
                                         "is left out", 0});
            } else {
                note("The extended record " + vlr.user() + "/" + std::to_string(vlr.recordId) +
                     " becomes an ordinary one.");
                vlr.extended = false;
                m_vlrs.push_back(std::move(vlr));
            }
        }
        m_plan.evlrs = std::move(stay);
        m_plan.waveformEvlr = waveform;
    }

    // -- what would be lost

    void refuseLosses()
    {
        const std::uint8_t from = m_source->layout.format;
        std::vector<Loss>& losses = m_plan.losses;
        for (Loss& loss : findLosses(m_cloud, *m_source, m_kept.ranges(), m_format, m_progress))
            losses.push_back(std::move(loss));
        const std::string target =
            "point format " + std::to_string(m_format) + " of LAS 1." + std::to_string(m_minor);
        if (!losses.empty() && !m_options.lossy) {
            std::string list;
            for (const Loss& loss : losses) list += (list.empty() ? "" : ", ") + loss.text();
            throw WriteQuestion(WriteQuestion::Kind::Lossy, m_target,
                                "P" + target.substr(1) + " cannot hold all that is there: " + list + ".", target);
        }
        for (const Loss& loss : losses) note(sentence(loss));
        if (m_format == from) return;
        if (isExtendedFormat(m_format) && !hasGpsTime(from) && findColumn(m_cloud, "GpsTime") == nullptr)
            note("Point format " + std::to_string(m_format) + " has a GPS time, which is 0 for all points.");
        if (hasNir(m_format) && !hasNir(from) && findColumn(m_cloud, "NIR") == nullptr)
            note("Point format " + std::to_string(m_format) + " has near infrared, which is 0 for all points.");
    }

    /// "34 points have a class above 31, which becomes class 1."
    static std::string sentence(const Loss& loss)
    {
        std::string s = loss.text() + (loss.points == 0 ? " " : ", which ") + loss.becomes + ".";
        if (s[0] >= 'a' && s[0] <= 'z') s[0] = char(s[0] - 'a' + 'A');
        return s;
    }

    // -- header

    void resizeHeader()
    {
        const std::uint8_t before = m_header.versionMinor();
        if (before == m_minor) return;
        std::vector<std::byte>& b = m_header.bytes;
        const std::size_t standard = m_header.standardEnd();
        std::vector<std::byte> user(b.begin() + std::ptrdiff_t(standard), b.end());
        if (m_minor >= 5 && !user.empty()) {  // "may not be extended by users": LAS 1.5, 2.3
            m_plan.userBytes = std::exchange(user, {});
            note("The " + grouped(m_plan.userBytes.size()) +
                 " bytes after the header, which LAS 1.5 allows no longer, are kept before the points.");
        }
        b.resize(standard);
        b.resize(standardHeaderSize(m_minor));
        b.insert(b.end(), user.begin(), user.end());
        if (b.size() > UINT16_MAX)
            refuse("The header has too many user bytes for LAS 1." + std::to_string(m_minor) + ".");
        m_header.set(at::kHeaderSize, std::uint16_t(b.size()));
        m_header.set(at::kVersionMinor, m_minor);
        if (before < 2) m_header.set(at::kGlobalEncoding, 0);  // was a reserved field
    }

    Summary summarize() const
    {
        const RecordLayout& from = m_source->layout;
        const auto returns = from.compatible ? column(from.derived.front().column) : column("Returns");
        const std::uint8_t mask = isExtendedFormat(from.shownFormat()) ? 15 : 7;
        return reducePoints<Summary>(m_kept.ranges(), m_progress, [&](Summary& s, PointRange r) {
            const std::int32_t* axes[] = {m_cloud.rawX().data(), m_cloud.rawY().data(), m_cloud.rawZ().data()};
            std::int32_t low[3], high[3];
            for (int a = 0; a < 3; ++a) {
                const LeastMost part = leastAndMost(axes[a] + r.first, std::size_t(r.size()));
                low[a] = part.least;
                high[a] = part.most;
            }
            s.bounds.include(low[0], low[1], low[2]);
            s.bounds.include(high[0], high[1], high[2]);
            if (returns == nullptr) return;
            const auto* p = reinterpret_cast<const std::uint8_t*>(returns->data());
            for (PointIndex i = r.first; i < r.last; ++i) ++s.byReturn[p[i] & mask];
        });
    }

    bool headerCountIs(std::uint64_t points) const
    {
        const Header& h = m_source->header;
        const auto legacy = h.get(at::kLegacyCount);
        if (!h.extendedCounts()) return legacy == points;
        // a legacy count of 0 says nothing there
        return h.get(at::kPointCount) == points || (legacy == points && legacy != 0);
    }

    void setFigures()
    {
        const Summary now = summarize();
        const bool changed = m_made || !m_read.complete || m_points != m_source->pointCount ||
                             now.bounds != m_read.bounds || now.byReturn != m_read.byReturn ||
                             !headerCountIs(m_points);
        const bool moved = (m_minor >= 4) != (m_source->header.versionMinor() >= 4) ||
                           (m_minor >= 5) != (m_source->header.versionMinor() >= 5) ||
                           isExtendedFormat(m_format) != isExtendedFormat(m_source->layout.format);
        if (changed || moved) setCounts(now);
        if (const std::uint64_t beyond = now.byReturn[6] + now.byReturn[7]; moved && m_minor < 4 && beyond != 0)
            note(pointsText(beyond) + " of the sixth and seventh return " + isOrAre(beyond) +
                 " not in the header's counts by return, which end at the fifth.");
        if (changed && m_source->layout.compatible)
            for (auto* list : {&m_vlrs, &m_plan.evlrs})
                for (Vlr& vlr : *list)
                    if (vlr.is(kCompatibleUser, kCompatibleRecordId))
                        setCompatibleCounts(vlr, m_points, now.byReturn);
        if (changed) {
            setBounds(now.bounds);
            m_restructured = true;
        }
        if (m_minor >= 5) setGpsRange();
        const bool otherPoints = m_points != m_source->pointCount || now.bounds != m_read.bounds;
        if (!m_made && m_read.complete && otherPoints) {
            if (dropRecords([](const Vlr& v) { return v.is("LAStools", 10) || v.is("LAStools", 20); }) != 0)
                note("LAStools' records on the tile that the points were are left out: they are other points now.");
        }
    }

    void setGpsRange()
    {
        const GpsRange now = gpsRange(m_cloud, m_kept.ranges(), m_progress);
        if (!m_made && m_read.complete && m_source->header.versionMinor() >= 5 && now == m_read.gps) return;
        m_header.set(at::kMaxGpsTime, now.max);
        m_header.set(at::kMinGpsTime, now.min);
        m_restructured = true;
    }

    void setCounts(const Summary& now)
    {
        const bool legacy = !isExtendedFormat(m_format) && m_points <= UINT32_MAX;
        m_header.set(at::kLegacyCount, legacy ? std::uint32_t(m_points) : 0u);
        for (std::size_t k = 0; k < 5; ++k)
            m_header.set(at::kLegacyByReturn[k], legacy ? std::uint32_t(now.byReturn[k + 1]) : 0u);
        if (!m_header.extendedCounts()) return;
        m_header.set(at::kPointCount, std::uint64_t(m_points));
        for (std::size_t k = 0; k < 15; ++k) m_header.set(at::kByReturn[k], now.byReturn[k + 1]);
    }

    void setBounds(const RawBounds& raw)
    {
        const WorldBounds b =
            raw.empty() ? WorldBounds{glm::dvec3(0), glm::dvec3(0)} : m_source->coordinates.headerBox(raw);
        for (std::size_t k = 0; k < 3; ++k) {
            // The header's own scale may be unusable; then its box means nothing, and stays.
            if (m_header.get(at::kScale[k]) != m_source->coordinates.scale[int(k)]) continue;
            m_header.set(at::kMax[k], b.max[int(k)]);
            m_header.set(at::kMin[k], b.min[int(k)]);
        }
    }

    void setSignature()
    {
        m_header.setText(at::kSoftware, "Punctum");
        m_header.setCreation();
    }

    /// LAS 1.3 has nothing but the header's position for its one extended record: where that is not there, a
    /// position kept would make the new file a damaged one as well.
    void forgetLostWaveforms()
    {
        if (m_minor != 3 || !m_source->recovered || m_plan.waveformEvlr || m_header.get(at::kWaveformStart) == 0 ||
            !m_header.says(encoding::kInternalWaveform))
            return;
        m_header.set(at::kWaveformStart, std::uint64_t(0));
        note("The waveforms, which could not be read, are left out.");
    }

    void setHeader()
    {
        resizeHeader();
        planCrs(m_plan, m_vlrs, *m_source, m_format, m_minor, m_header);
        if (hasWaveform(m_source->layout.format) && !hasWaveform(m_format))
            m_header.set(at::kGlobalEncoding,
                         m_header.globalEncoding() &
                             std::uint16_t(~(encoding::kInternalWaveform | encoding::kExternalWaveform)));
        setFigures();
        if (m_restructured) setSignature();
        if (const auto announced = m_header.get(at::kVlrCount); !m_made && announced != m_source->vlrs.size())
            note("The header announced " + grouped(announced) +
                 " variable length records; it says now how many there are.");
        m_header.set(at::kVlrCount, std::uint32_t(m_vlrs.size()));
        const auto formatByte = std::uint8_t(m_format | (m_options.compressed ? 0x80 : 0));
        m_header.set(at::kPointFormat, formatByte);
        m_header.set(at::kRecordLength, m_layout.length);

        forgetLostWaveforms();
        std::uint64_t offset = m_header.bytes.size();
        for (const Vlr& vlr : m_vlrs) offset += vlr.bytesInFile();
        offset += m_plan.userBytes.size() + m_source->gapBeforePoints.size();
        if (offset > UINT32_MAX)
            refuse("The records before the points are larger than the 4 GiB that a file can have.");
        m_header.set(at::kPointOffset, std::uint32_t(offset));

        std::vector<std::byte>& prefix = m_plan.prefix;
        prefix = m_header.bytes;
        for (const Vlr& vlr : m_vlrs) {
            if (isLaszip(vlr)) m_plan.laszipAt = prefix.size() + Vlr::kHeaderSize;
            putVlr(prefix, vlr);
        }
        prefix.insert(prefix.end(), m_plan.userBytes.begin(), m_plan.userBytes.end());
        prefix.insert(prefix.end(), m_source->gapBeforePoints.begin(), m_source->gapBeforePoints.end());
        m_plan.vlrs = std::move(m_vlrs);
        m_plan.maker = std::make_unique<RecordMaker>(std::move(m_layout), std::move(m_columns), m_conversion,
                                                     std::move(m_packed), std::move(m_kept));
    }

    const PointCloud& m_cloud;
    const std::filesystem::path& m_target;
    const WriteOptions& m_options;
    Progress& m_progress;
    std::shared_ptr<const SourceFile> m_source;
    PointsAsRead m_read;
    bool m_made = false;          ///< the cloud was made here
    bool m_restructured = false;  ///< the record or the points' figures change: the file is no longer its maker's
    KeptPoints m_kept;
    PointIndex m_points = 0;
    Header m_header;
    std::vector<Vlr> m_vlrs;
    std::uint8_t m_format = 0, m_minor = 0;
    RecordLayout m_layout;
    std::vector<std::shared_ptr<const Column>> m_columns;
    RecordMaker::Conversion m_conversion = RecordMaker::Conversion::None;
    PackedColumns m_packed;
    WritePlan m_plan;
};

}  // namespace

void WritePlan::setCompression(bool originVersions, bool moved)
{
    std::byte* const payload = prefix.data() + laszipAt;
    if (chunks.allOrNone && !originVersions) std::copy(laz.payload.begin(), laz.payload.end(), payload);
    if (!moved) return;
    std::int64_t special = 0;
    std::memcpy(&special, payload + kSpecialCountAt, sizeof special);
    if (special > 0) {
        special = -1;
        std::memcpy(payload + kSpecialCountAt, &special, sizeof special);
        std::memcpy(payload + kSpecialStartAt, &special, sizeof special);
        notes.push_back(kLaxLeftOut);
    }
    for (std::size_t k = evlrs.size(); k-- > 0;) {
        if (!isLax(evlrs[k])) continue;
        eraseEvlr(k);
        notes.push_back(kLaxLeftOut);
    }
}

void WritePlan::eraseEvlr(std::size_t k)
{
    if (waveformEvlr && *waveformEvlr == k)
        waveformEvlr.reset();
    else if (waveformEvlr && *waveformEvlr > k)
        --*waveformEvlr;
    evlrs.erase(evlrs.begin() + std::ptrdiff_t(k));
}

void WritePlan::setPointDataEnd(std::uint64_t end)
{
    Header h = Header::of(prefix);
    const std::uint64_t evlrStart = end + gapAfterPoints.size();
    // What lies behind the points moves as a whole.
    const auto moved = [&](std::uint64_t before) {
        const bool behind = sourcePointDataEnd != 0 && before >= sourcePointDataEnd;
        return behind ? before - sourcePointDataEnd + end : before;
    };
    if (h.extendedCounts()) {
        const bool some = !evlrs.empty() || h.get(at::kEvlrCount) != 0;
        if (some) {
            h.set(at::kEvlrStart, evlrs.empty() ? std::uint64_t(0) : evlrStart);
            h.set(at::kEvlrCount, std::uint32_t(evlrs.size()));
        } else if (const auto before = h.get(at::kEvlrStart); before != 0) {
            h.set(at::kEvlrStart, moved(before));
        }
    }
    if (const auto before = h.get(at::kWaveformStart); h.versionMinor() >= 3 && before != 0) {
        std::uint64_t now = moved(before);
        if (waveformEvlr) {
            now = evlrStart;
            for (std::size_t k = 0; k < *waveformEvlr; ++k) now += evlrs[k].bytesInFile();
        }
        h.set(at::kWaveformStart, now);
    }
    std::copy(h.bytes.begin(), h.bytes.end(), prefix.begin());
}

std::vector<std::byte> WritePlan::suffix() const
{
    std::vector<std::byte> bytes = gapAfterPoints;
    for (const Vlr& vlr : evlrs) putVlr(bytes, vlr);
    bytes.insert(bytes.end(), tail.begin(), tail.end());
    return bytes;
}

WritePlan planWrite(const PointCloud& cloud, const std::filesystem::path& target, const WriteOptions& options,
                    Progress& progress)
{
    return Planner(cloud, target, options, progress).plan();
}

}  // namespace punctum::las
