// SPDX-License-Identifier: MIT
#include "core/las/SourceParser.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/las/ChunkProbe.h"
#include "core/las/Compatible.h"
#include "core/las/Crs.h"
#include "core/las/File.h"
#include "core/las/FormatNeeds.h"
#include "core/las/OtherFiles.h"
#include "core/las/TailPoints.h"
#include "core/las/WaveformFile.h"

#include <glm/common.hpp>
#include <glm/vector_relational.hpp>

#include <algorithm>
#include <cmath>
#include <system_error>

namespace punctum::las
{

namespace
{

constexpr std::uint64_t kSmallestHeader = 227;
constexpr std::size_t kSamplePlaces = 128;   ///< LAS: places in the file where points are looked at
constexpr std::size_t kSampleRun = 64;       ///< LAS: neighboring points at each place
constexpr std::size_t kSampleChunks = 1024;  ///< LAZ: chunks whose first point is looked at
constexpr double kLargestCoordinate = 1e18;  ///< beyond it no unit makes sense
constexpr double kHeaderBoxAtMost = 20;      ///< times the sampled extent, else the header's box is not believed
constexpr std::size_t kSamplesToJudge = 32;  ///< fewer samples say little on the extent
constexpr std::uint64_t kSector = 512;       ///< bytes; an interrupted copy lacks whole ones
constexpr std::uint64_t kMostZeros = 16 << 20;

class Parser
{
public:
    Parser(const File& file, const ParseOptions& options)
        : m_file(file), m_options(options), m_source(std::make_shared<SourceFile>()), m_s(*m_source)
    {
    }

    ParsedFile parse()
    {
        m_s.path = m_file.path();
        m_s.fileSize = m_file.size();
        m_s.current->set({m_file.path(), m_file.stamp(), false, true, nullptr});
        readHeader();
        readVlrs();
        readCoordinates();
        const auto records = [&] {
            locatePoints();
            return m_s.extraBytesRecords();
        }();
        m_s.layout =
            makeLayout(m_s.header.pointFormat(), m_s.header.recordLength(), records, m_s.coordinates, m_s.warnings);
        useCompatibility(m_s, m_s.layout, m_s.warnings);
        readOctree();
        sample();
        describe();
        m_parsed.source = m_source;
        return std::move(m_parsed);
    }

private:
    [[noreturn]] void refuse(const std::string& sentence) const { throw Error(m_file.path(), sentence); }
    void warn(const std::string& sentence) { m_s.warnings.push_back(sentence); }
    void warnRecovered(const std::string& sentence)
    {
        warn(sentence);
        m_s.losses.push_back(sentence);
        m_s.recovered = true;
    }

    static std::string announcedAndFound(std::uint64_t announced, const std::string& kind, std::uint64_t found)
    {
        return grouped(announced) + " " + kind + (announced == 1 ? " record is" : " records are") + " announced, " +
               grouped(found) + (found == 1 ? " is" : " are") + " found; the bytes after them are kept.";
    }

    void refuseOtherFiles() const
    {
        std::vector<std::byte> head(std::size_t(std::min<std::uint64_t>(m_file.size(), kTellingBytes)));
        m_file.readAt(0, head);
        if (head.size() >= 4 && std::memcmp(head.data(), "LASF", 4) == 0) return;
        const std::string instead = whatInstead(head);
        refuse(instead.empty() ? "This is not a LAS file: its signature is not LASF." : instead);
    }

    void readHeader()
    {
        Header& h = m_s.header;
        refuseOtherFiles();
        if (m_file.size() < kSmallestHeader) {
            refuse("This is not a LAS file: it has " + std::to_string(m_file.size()) +
                   " bytes, and a header needs " + std::to_string(kSmallestHeader) + ".");
        }
        h.bytes.resize(kSmallestHeader);
        m_file.readAt(0, h.bytes);
        const std::uint16_t size = h.headerSize();
        if (h.versionMajor() != 1 || h.versionMinor() > kNewestMinor)
            refuse("LAS version " + h.version() + " is not supported.");
        if (size < kSmallestHeader)
            refuse("The header size " + std::to_string(size) + " is less than " + std::to_string(kSmallestHeader) +
                   ".");
        if (size > m_file.size())
            refuse("The header size " + std::to_string(size) + " is beyond the end of the file (" +
                   std::to_string(m_file.size()) + " bytes).");
        h.bytes.resize(size);
        m_file.readAt(0, h.bytes);

        const auto formatByte = h.get(at::kPointFormat);
        const std::uint8_t format = h.pointFormat();
        if ((formatByte & 0xC0) == 0xC0 || format > kLastPointFormat)
            refuse("Point format " + std::to_string(formatByte & 0x7F) + " is not supported.");
        if (h.recordLength() < standardRecordLength(format))
            refuse("The point records are " + std::to_string(h.recordLength()) + " bytes long, but point format " +
                   std::to_string(format) + " needs " + std::to_string(standardRecordLength(format)) + ".");
        if (h.pointOffset() < size || h.pointOffset() > m_file.size())
            refuse("The point data starts at " + std::to_string(h.pointOffset()) + ", outside the file.");
        m_s.compressed = h.compressed();

        if (h.versionMinor() > newestMinor(format))
            warn("LAS " + h.version() + " has no point format " + std::to_string(format) +
                 "; the points are read all the same.");
        if (size < standardHeaderSize(h.versionMinor()))
            warn("The header of LAS " + h.version() + " should have " +
                 std::to_string(standardHeaderSize(h.versionMinor())) + " bytes, but has " + std::to_string(size) +
                 "; the missing fields are taken as empty.");
    }

    /// False when no record can begin there.
    bool readRecord(std::uint64_t offset, std::uint64_t end, bool extended, Vlr& vlr) const
    {
        const std::size_t head = extended ? Vlr::kExtendedHeaderSize : Vlr::kHeaderSize;
        if (offset > end || end - offset < head) return false;
        std::array<std::byte, Vlr::kExtendedHeaderSize> raw{};
        m_file.readAt(offset, std::span(raw).first(head));
        std::uint64_t length = 0;
        std::memcpy(&vlr.reserved, raw.data(), 2);
        std::memcpy(vlr.userId.data(), raw.data() + 2, 16);
        std::memcpy(&vlr.recordId, raw.data() + 18, 2);
        std::memcpy(&length, raw.data() + 20, extended ? 8 : 2);
        std::memcpy(vlr.description.data(), raw.data() + (extended ? 28 : 22), 32);
        if (length > end - offset - head) return false;
        vlr.extended = extended;
        vlr.data.resize(std::size_t(length));
        m_file.readAt(offset + head, vlr.data);
        return true;
    }

    void readVlrs()
    {
        const auto announced = m_s.header.get(at::kVlrCount);
        const std::uint64_t end = m_s.header.pointOffset();
        std::uint64_t offset = m_s.header.bytes.size();
        for (std::uint32_t k = 0; k < announced; ++k) {
            Vlr vlr;
            if (!readRecord(offset, end, false, vlr)) {
                warn(announcedAndFound(announced, "variable length", k));
                break;
            }
            offset += vlr.bytesInFile();
            m_s.vlrs.push_back(std::move(vlr));
        }
        m_s.gapBeforePoints.resize(std::size_t(end - offset));
        m_file.readAt(offset, m_s.gapBeforePoints);
    }

    void readCoordinates()
    {
        const char* axes[] = {"X", "Y", "Z"};
        for (std::size_t k = 0; k < 3; ++k) {
            const auto scale = m_s.header.get(at::kScale[k]);
            const auto offset = m_s.header.get(at::kOffset[k]);
            const double largest = std::fabs(offset) + std::fabs(scale) * 2147483648.0;
            if (scale != 0.0 && largest < kLargestCoordinate) {  // false for NaN as well
                m_s.coordinates.scale[int(k)] = scale;
                m_s.coordinates.offset[int(k)] = offset;
                if (scale < 0) warn(std::string("The scale of ") + axes[k] + " is negative.");
            } else {
                m_s.coordinates.scale[int(k)] = 1.0;
                m_s.coordinates.offset[int(k)] = 0.0;
                warn(std::string("The scale or offset of ") + axes[k] +
                     " cannot be used; its stored integers are shown.");
            }
        }
    }

    /// The header's counts of points, the one to be believed first (LAS 1.4 R15, 2.4; the data decides later).
    std::vector<std::uint64_t> statedCounts() const
    {
        const Header& h = m_s.header;
        const std::uint64_t legacy = h.get(at::kLegacyCount);
        if (!h.extendedCounts()) return {legacy};
        const auto count = h.get(at::kPointCount);
        if (legacy == 0 || legacy == count) return {count};
        if (count == 0) return {legacy, 0};
        return {count, legacy};
    }

    /// Whether the header counts as many points by return as it states: whoever wrote it has counted them.
    bool returnsAddUp() const
    {
        const Header& h = m_s.header;
        std::uint64_t sum = 0;
        if (h.extendedCounts())
            for (std::size_t k = 0; k < at::kByReturn.kCount; ++k) sum += h.get(at::kByReturn[k]);
        else
            for (std::size_t k = 0; k < at::kLegacyByReturn.kCount; ++k) sum += h.get(at::kLegacyByReturn[k]);
        return sum == statedCounts().front();
    }

    /// Where the first EVLR (1.3: the waveform record) says to be; 0 when there is none.
    std::uint64_t statedEvlrStart(std::uint32_t& count) const
    {
        const Header& h = m_s.header;
        count = 0;
        if (h.extendedCounts()) {
            count = h.get(at::kEvlrCount);
            return count != 0 ? h.get(at::kEvlrStart) : 0;
        }
        const auto waveform = h.get(at::kWaveformStart);
        if (h.versionMinor() < 3 || waveform == 0 || !h.says(encoding::kInternalWaveform)) return 0;
        count = 1;
        return waveform;
    }

    void locatePoints()
    {
        const std::uint64_t begin = m_s.header.pointOffset();
        std::uint32_t evlrCount = 0;
        std::uint64_t evlrStart = statedEvlrStart(evlrCount);
        if (evlrStart != 0 && !m_s.compressed) evlrStart = unwrapped(evlrStart);
        bool usable = evlrStart >= begin && evlrStart <= m_file.size() &&
                      m_file.size() - evlrStart >= Vlr::kExtendedHeaderSize;
        const std::uint64_t statedEnd = statedPointEnd();
        std::string trouble;
        if (evlrStart != 0 && usable && evlrStart < statedEnd)
            trouble =
                "The extended records begin inside the point data; the points are read and the records are "
                "ignored.";
        else if (evlrCount != 0 && !usable)
            trouble = "The " + std::to_string(evlrCount) + " extended records should begin at " +
                      std::to_string(evlrStart) + ", where they cannot be; they are ignored.";
        usable = usable && trouble.empty();
        const auto find = [&](std::uint64_t from) {
            const std::optional<std::uint64_t> found = findEvlrs(m_file, from, evlrCount);
            if (!found || *found == evlrStart) return;
            warn("The extended records are not where the header says (at " + std::to_string(evlrStart) +
                 ") but at " + std::to_string(*found) + "; they are read there.");
            trouble.clear();
            usable = true;
            evlrStart = *found;
            if (!m_s.header.extendedCounts()) m_s.waveformEvlr = 0;
        };
        const bool lost = evlrCount != 0 && !(usable && endOfEvlrs(m_file, evlrStart, evlrCount));
        if (lost && !m_s.compressed && statedEnd != 0) find(statedEnd);
        const std::uint64_t end = usable ? evlrStart : m_file.size();
        m_s.pointDataEnd = m_s.compressed ? locateCompressed(begin, end) : locatePlain(begin, end);
        if (lost && m_s.compressed) find(m_s.pointDataEnd);
        if (!trouble.empty()) warnRecovered(trouble);

        if (usable) {
            m_s.gapAfterPoints = bytes(m_s.pointDataEnd, evlrStart);
            readEvlrs(evlrStart, evlrCount);
        } else {
            m_s.tail = bytes(m_s.pointDataEnd, m_file.size());
        }
    }

    /// Some programs cut the EVLR offset of files beyond 4 GiB to 32 bits: it is put right where the points end.
    std::uint64_t unwrapped(std::uint64_t start) const
    {
        const std::uint64_t end = statedPointEnd();
        const bool wrapped = start < m_s.header.pointOffset() || start < end;
        return wrapped && end > UINT32_MAX && (end & UINT32_MAX) == start ? end : start;
    }

    /// End of uncompressed points if the header's count is right and they are in the file; else 0.
    /// Compressed: the position of the chunk table, if that can be.
    std::uint64_t statedPointEnd() const
    {
        const std::uint64_t begin = m_s.header.pointOffset();
        if (m_s.compressed) {
            if (m_file.size() - begin < 8) return 0;
            std::uint64_t table = 0;
            m_file.readAt(begin, std::as_writable_bytes(std::span(&table, 1)));
            return table <= m_file.size() && table >= begin ? table : 0;
        }
        const std::uint64_t room = (m_file.size() - begin) / m_s.header.recordLength();
        const std::uint64_t count = statedCounts().front();
        return count <= room ? begin + count * m_s.header.recordLength() : 0;
    }

    std::vector<std::byte> bytes(std::uint64_t from, std::uint64_t to) const
    {
        std::vector<std::byte> b(std::size_t(to > from ? to - from : 0));
        m_file.readAt(from, b);
        return b;
    }

    std::uint64_t locatePlain(std::uint64_t begin, std::uint64_t end)
    {
        const std::uint64_t length = m_s.header.recordLength();
        const std::uint64_t held = (end - begin) / length;
        const std::vector<std::uint64_t> counts = statedCounts();
        if (std::find(counts.begin(), counts.end(), held) != counts.end()) {
            m_s.pointCount = held;
            if (counts.size() > 1)
                warn("The header's two point counts differ (" + grouped(counts[0]) + " and " + grouped(counts[1]) +
                     "); the file holds " + grouped(held) + ".");
        } else {
            const std::uint64_t stated = counts.front();
            m_s.pointCount = stated < held ? recordsAfterAll(m_file, m_s, begin, stated, held) : held;
            const std::string sentence =
                "The header says " + grouped(stated) + " points, the file holds " + grouped(m_s.pointCount) + ".";
            if (m_s.pointCount < stated)
                warnRecovered(sentence);
            else if (m_s.pointCount > stated)
                warn(sentence);
            else if (counts.size() > 1)
                warn("The header's two point counts differ (" + grouped(counts[0]) + " and " + grouped(counts[1]) +
                     "); the first is used.");
            else if (stated == 0)
                warn("The header says 0 points, and the " + grouped(end - begin) +
                     " bytes that follow do not look like any; they are kept.");
        }
        const std::uint64_t pointsEnd = begin + m_s.pointCount * length;
        const std::uint64_t zeros = pointsEnd - zerosBefore(m_file, begin, pointsEnd, kMostZeros);
        if (zeros / length > 1 && zeros >= kSector)
            warn(std::string(zeros >= kMostZeros ? "At least the" : "The") + " last " + grouped(zeros / length) +
                 " points are nothing but zero bytes, as after an interrupted copy.");
        return pointsEnd;
    }

    std::uint64_t locateCompressed(std::uint64_t begin, std::uint64_t end)
    {
        const Vlr* record = nullptr;
        for (const Vlr& vlr : m_s.vlrs)
            if (vlr.is(kLaszipUser, kLaszipRecordId)) record = &vlr;
        if (record == nullptr) refuse("The points are compressed, but the compression record is missing.");
        try {
            m_parsed.laz = LazInfo::parse(*record, m_s.header.pointFormat(), m_s.header.recordLength());
        } catch (const Error& e) {
            refuse(e.what());
        }
        const auto counts = statedCounts();
        const OnlyChunk only = returnsAddUp() ? m_options.only : OnlyChunk::Prove;
        ChunkList list = findChunks(m_file, begin, end, m_parsed.laz, counts, only);
        m_s.warnings.insert(m_s.warnings.end(), list.warnings.begin(), list.warnings.end());
        m_s.losses.insert(m_s.losses.end(), list.losses.begin(), list.losses.end());
        m_s.recovered = m_s.recovered || !list.losses.empty();
        m_s.pointCount = list.points;
        m_parsed.chunks = std::move(list.chunks);
        m_parsed.unproved = list.unproved;
        return list.end;
    }

    void readEvlrs(std::uint64_t offset, std::uint32_t count)
    {
        const auto waveform = m_s.header.get(at::kWaveformStart);
        for (std::uint32_t k = 0; k < count; ++k) {
            Vlr vlr;
            if (!readRecord(offset, m_file.size(), true, vlr)) {
                warnRecovered(announcedAndFound(count, "extended", k));
                break;
            }
            if (offset == waveform) m_s.waveformEvlr = m_s.evlrs.size();
            if (m_hierarchyAt == 0 && isCopcHierarchy(vlr)) m_hierarchyAt = offset + Vlr::kExtendedHeaderSize;
            offset += vlr.bytesInFile();
            m_s.evlrs.push_back(std::move(vlr));
        }
        m_s.tail = bytes(offset, m_file.size());
    }

    void readOctree()
    {
        m_s.copc = readCopc(m_s, m_hierarchyAt, m_parsed.laz, m_parsed.chunks, m_s.copcTrouble);
        if (!m_s.copcTrouble.empty())
            warn("The spatial index of the COPC file does not belong to its points and is not used: " +
                 m_s.copcTrouble + ".");
    }

    void describe()
    {
        CrsInfo crs = m_options.crs != nullptr ? m_options.crs->of(m_s) : readCrs(m_s);
        m_s.crs = std::move(crs.text);
        for (const std::string& sentence : crs.warnings) warn(sentence);
        m_s.setUnits(likelyUnits(crs.units, m_s.coordinates, m_s.firstBounds, m_s.warnings));
        if (isExtendedFormat(m_s.layout.format) && !m_s.header.says(encoding::kWkt))
            warn("Point format " + std::to_string(m_s.layout.format) +
                 " asks for a coordinate system in WKT, but the file does not announce one.");
        if (m_s.header.versionMinor() >= 5 && m_s.header.says(encoding::kTimeOffset) &&
            !m_s.header.says(encoding::kAdjustedGpsTime))
            warn(
                "The file announces GPS times with an offset, and denies it by another bit; they are taken as "
                "seconds "
                "of the week.");
        if (m_s.layout.compatible)
            warn("The file holds LAS 1.4 (point format " + std::to_string(m_s.layout.shownFormat()) +
                 ") in the form of LAS " + m_s.header.version() + " (point format " +
                 std::to_string(m_s.layout.format) + ", LASzip's compatibility mode); saving keeps that form.");
        if (hasWaveform(m_s.layout.format) && m_s.header.says(encoding::kExternalWaveform)) describeWaveform();
    }

    void describeWaveform()
    {
        if (findWaveforms(m_s.path)) return;
        warn("The waveforms are in a separate .wdp file, which is not there.");
    }

    void includeSample(const std::byte* record)
    {
        std::int32_t p[3];
        std::memcpy(p, record, sizeof p);
        m_s.sampledBounds.include(p[0], p[1], p[2]);
        ++m_samples;
    }

    void sample()
    {
        if (m_s.compressed) {
            const std::size_t step = std::max<std::size_t>(1, m_parsed.chunks.size() / kSampleChunks);
            for (std::size_t k = 0; k < m_parsed.chunks.size(); k += step) {
                std::array<std::byte, 12> record{};
                if (m_parsed.chunks[k].bytes < record.size()) continue;
                m_file.readAt(m_parsed.chunks[k].offset, record);
                includeSample(record.data());
            }
        } else if (m_s.pointCount != 0) {
            const std::uint64_t length = m_s.layout.length;
            const std::uint64_t run = std::min<std::uint64_t>(kSampleRun, m_s.pointCount);
            const std::uint64_t places = std::min<std::uint64_t>(kSamplePlaces, m_s.pointCount / run);
            std::vector<std::byte> records(std::size_t(run * length));
            for (std::uint64_t k = 0; k < places; ++k) {
                const std::uint64_t last = m_s.pointCount - run;
                const std::uint64_t first =
                    places < 2 ? 0 : last / (places - 1) * k + last % (places - 1) * k / (places - 1);
                m_file.readAt(m_s.header.pointOffset() + first * length, records);
                for (std::uint64_t i = 0; i < run; ++i) includeSample(records.data() + i * length);
            }
        }
        m_s.firstBounds = m_s.coordinates.toWorld(m_s.sampledBounds);
        const WorldBounds stated = headerBounds();
        if (believable(stated)) m_s.firstBounds.include(stated);
    }

    WorldBounds headerBounds() const
    {
        WorldBounds b;
        for (std::size_t k = 0; k < 3; ++k) {
            b.max[int(k)] = m_s.header.get(at::kMax[k]);
            b.min[int(k)] = m_s.header.get(at::kMin[k]);
        }
        return b;
    }

    bool believable(const WorldBounds& stated) const
    {
        const WorldBounds& sampled = m_s.firstBounds;
        if (sampled.empty()) return false;
        const glm::dvec3 slack = glm::abs(m_s.coordinates.scale);
        for (int k = 0; k < 3; ++k) {
            const double size = stated.max[k] - stated.min[k];
            if (!(size >= 0) || !(std::fabs(stated.min[k]) < kLargestCoordinate) ||
                !(std::fabs(stated.max[k]) < kLargestCoordinate))
                return false;
            if (sampled.min[k] < stated.min[k] - slack[k] || sampled.max[k] > stated.max[k] + slack[k])
                return false;
        }
        if (m_samples < kSamplesToJudge) return true;
        const glm::dvec3 a = stated.max - stated.min, b = sampled.max - sampled.min;
        return std::max({a.x, a.y, a.z}) <= kHeaderBoxAtMost * std::max({b.x, b.y, b.z});
    }

    const File& m_file;
    const ParseOptions& m_options;
    std::shared_ptr<SourceFile> m_source;
    SourceFile& m_s;
    ParsedFile m_parsed;
    std::size_t m_samples = 0;
    std::uint64_t m_hierarchyAt = 0;  ///< data of the first such record of COPC; 0: there is none
};

}  // namespace

ParsedFile parseFile(const File& file, const ParseOptions& options)
{
    return Parser(file, options).parse();
}

}  // namespace punctum::las
