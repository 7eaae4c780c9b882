// SPDX-License-Identifier: MIT
#include "core/las/Doctor.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/cloud/ClassNames.h"
#include "core/cloud/ValueText.h"
#include "core/las/Crs.h"
#include "core/las/GeoKeys.h"
#include "core/las/HeaderWords.h"
#include "core/las/Reader.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <set>

namespace punctum::las
{

namespace
{

constexpr double kWeek = 604800.0;     ///< s: GPS times of a week are below it
constexpr double kWeeks = 4.0;         ///< some programs count on when a week ends
constexpr double kLargestTime = 1e11;  ///< s: some thousand years
constexpr double kNavstar = -1e9;      ///< s: adjusted standard GPS time of 1980-01-06
constexpr double kEarliest = -7e8;     ///< s: of 1989; there were no laser scans with GPS before
constexpr std::uint8_t kOverlapClass = 12;
constexpr double kCoarseDegrees = 1e-5;  ///< a step of a meter
constexpr double kHalfStep = 0.5;

/// "1 point has", "3 points have".
std::string pointsHave(std::uint64_t n)
{
    return pointsText(n) + (n == 1 ? " has" : " have");
}

double secondsToday()
{
    using namespace std::chrono;
    const auto since1980 = system_clock::now() - sys_days(year(1980) / January / 6);
    return double(duration_cast<seconds>(since1980).count()) - 1e9;
}

class Doctor
{
public:
    Doctor(const SourceFile& source, const PointFigures& figures) : m_s(source), m_f(figures), m_h(source.header)
    {
        m_result.mended = source.header;
    }

    Diagnosis run()
    {
        counts();
        bounds();
        gpsRange();
        losses();
        records();
        encodingBits();
        waveforms();
        gpsTimes();
        creation();
        format();
        coordinates();
        crs();
        returnNumbers();
        classes();
        extraBytes();
        colors();
        return std::move(m_result);
    }

private:
    void find(std::string fault, std::string mend) { add({std::move(fault), std::move(mend), false}); }
    void findRepairable(std::string fault, std::string mend) { add({std::move(fault), std::move(mend), true}); }
    void add(Finding finding)
    {
        if (m_told.insert(finding.fault).second) m_result.findings.push_back(std::move(finding));
    }
    Header& mended() { return m_result.mended; }
    /// Whether all points that there are were read; of damaged compressed ones nobody knows how many there were.
    bool complete() const { return m_s.asRead->get().missing.empty() && !(m_s.compressed && m_s.recovered); }

    // -- header against points; what cannot be counted in full is not held against the header

    void counts()
    {
        if (!complete()) return;
        const std::uint64_t points = m_f.points;
        const bool legacy = !isExtendedFormat(m_s.layout.format) && points <= UINT32_MAX;
        const std::uint64_t classic = m_h.get(at::kLegacyCount);
        const std::uint64_t first = m_h.extendedCounts() ? m_h.get(at::kPointCount) : classic;
        const std::uint64_t wanted = legacy ? points : 0;
        if (first != points)
            findRepairable("The header says " + grouped(first) + " points, the file holds " + grouped(points) + ".",
                           "The header's count becomes " + grouped(points) + ".");
        else if (classic != wanted)
            findRepairable("The header's legacy count is " + grouped(classic) + ", where it has to be " +
                               grouped(wanted) + (legacy ? "." : " for this point format."),
                           "The legacy count becomes " + grouped(wanted) + ".");
        mended().set(at::kLegacyCount, std::uint32_t(wanted));
        if (m_h.extendedCounts()) mended().set(at::kPointCount, points);
        if (!m_s.layout.compatible) returnsInHeader(legacy);
    }

    void returnsInHeader(bool legacy)
    {
        bool same = true;
        std::uint64_t sum = 0;
        for (std::size_t k = 0; k < 5; ++k) {
            const auto wanted = std::uint32_t(legacy ? m_f.returns[k + 1] : 0);
            same = same && m_h.get(at::kLegacyByReturn[k]) == wanted;
            sum += m_h.get(at::kLegacyByReturn[k]);
            mended().set(at::kLegacyByReturn[k], wanted);
        }
        if (m_h.extendedCounts()) {
            sum = 0;
            for (std::size_t k = 0; k < 15; ++k) {
                same = same && m_h.get(at::kByReturn[k]) == m_f.returns[k + 1];
                sum += m_h.get(at::kByReturn[k]);
                mended().set(at::kByReturn[k], m_f.returns[k + 1]);
            }
        }
        if (same) return;
        findRepairable(sum == 0 ? "The header's points by return are all 0."
                                : "The header's points by return are not those of the points.",
                       "They become the points' own.");
    }

    void bounds()
    {
        if (!complete() || m_f.points == 0) return;
        const WorldBounds box = m_s.coordinates.headerBox(m_f.bounds);
        std::string axes;
        double most = 0;
        bool none = false;
        for (std::size_t k = 0; k < 3; ++k) {
            if (m_h.get(at::kScale[k]) != m_s.coordinates.scale[int(k)]) continue;  // unusable: told elsewhere
            const double min = m_h.get(at::kMin[k]), max = m_h.get(at::kMax[k]);
            const double step = std::abs(m_s.coordinates.scale[int(k)]) * kHalfStep;
            const double off = std::max(std::abs(min - box.min[int(k)]), std::abs(max - box.max[int(k)]));
            if (off <= step) continue;  // false for NaN
            axes += (axes.empty() ? "" : ", ") + std::string(1, "XYZ"[k]);
            none = none || !std::isfinite(off);
            most = std::max(most, off);
            mended().set(at::kMin[k], box.min[int(k)]);
            mended().set(at::kMax[k], box.max[int(k)]);
        }
        if (axes.empty()) return;
        findRepairable("The header's box is not that of the points (" + axes +
                           (none ? ")." : ", off by up to " + shortestText(float(most)) + ")."),
                       "It becomes the box of the points.");
    }

    /// LAS 1.5: first and last GPS time are in the header.
    void gpsRange()
    {
        if (m_h.versionMinor() < 5 || m_h.bytes.size() < standardHeaderSize(5) || !complete()) return;
        const GpsRange now = m_s.asRead->get().gps;
        if (m_h.get(at::kMinGpsTime) == now.min && m_h.get(at::kMaxGpsTime) == now.max) return;
        findRepairable("The header's first and last GPS time are not those of the points.",
                       "They become the points' own.");
        mended().set(at::kMinGpsTime, now.min);
        mended().set(at::kMaxGpsTime, now.max);
    }

    void losses()
    {
        for (const std::string& loss : m_s.losses)
            find(loss,
                 "What is not in the file cannot be brought back; \"punctum convert\" writes what could be read "
                 "as a sound file.");
        std::uint64_t missing = 0;
        for (const PointRange& range : m_s.asRead->get().missing) missing += range.size();
        if (missing != 0)
            find(pointsText(missing) + " cannot be read, since their chunks are damaged.",
                 "\"punctum convert\" writes the others as a sound file.");
    }

    // -- records

    void records()
    {
        const std::uint64_t vlrs = m_s.vlrs.size();
        if (const std::uint64_t said = m_h.get(at::kVlrCount); said != vlrs) {
            findRepairable("The header announces " + grouped(said) + " records (VLRs), and there " +
                               (vlrs == 1 ? "is 1." : "are " + grouped(vlrs) + "."),
                           "The header's number becomes " + grouped(vlrs) + ".");
            mended().set(at::kVlrCount, std::uint32_t(vlrs));
        }
        if (m_h.extendedCounts()) extendedRecords();
        waveformPosition();
        duplicates();
    }

    void extendedRecords()
    {
        const std::uint64_t there = m_s.evlrs.size();
        const std::uint64_t said = m_h.get(at::kEvlrCount), start = m_h.get(at::kEvlrStart);
        const std::uint64_t at = there == 0 ? 0 : m_s.pointDataEnd + m_s.gapAfterPoints.size();
        if (said != there) {
            const std::string fault = "The header announces " + grouped(said) + " extended records (EVLRs), and " +
                                      grouped(there) + (there == 1 ? " is found." : " are found.");
            if (there == 0) {
                find(fault, "They are not in the file, or nobody knows where.");
            } else {
                findRepairable(fault, "The header's number becomes " + grouped(there) + ".");
                mended().set(at::kEvlrCount, std::uint32_t(there));
            }
        }
        if (there != 0 && start != at) {
            findRepairable("The header says that the extended records (EVLRs) begin at byte " +
                               std::to_string(start) + "; they begin at " + std::to_string(at) + ".",
                           "The header's position becomes " + std::to_string(at) + ".");
            mended().set(at::kEvlrStart, at);
        }
    }

    static bool isWaveforms(const Vlr& vlr) { return vlr.recordId == 65535 && vlr.user() == "LASF_Spec"; }

    /// The header names the place of one record by itself, since LAS 1.3.
    void waveformPosition()
    {
        const auto found = std::find_if(m_s.evlrs.begin(), m_s.evlrs.end(), isWaveforms);
        if (found == m_s.evlrs.end() || m_h.says(encoding::kExternalWaveform)) return;
        std::uint64_t at = m_s.pointDataEnd + m_s.gapAfterPoints.size();
        for (auto vlr = m_s.evlrs.begin(); vlr != found; ++vlr) at += vlr->bytesInFile();
        if (m_h.get(at::kWaveformStart) == at) return;
        findRepairable("The header's position of the waveforms is not where they are.",
                       "It becomes " + std::to_string(at) + ".");
        mended().set(at::kWaveformStart, at);
    }

    void duplicates()
    {
        std::set<std::pair<std::string, std::uint16_t>> seen;
        for (const auto* list : {&m_s.vlrs, &m_s.evlrs})
            for (const Vlr& vlr : *list) {
                const std::string user = vlr.user();
                const bool meant = (user == "LASF_Spec" && vlr.recordId == kExtraBytesRecordId) ||
                                   (user != "LASF_Spec" && user != geo::kUser && user != "liblas");
                if (meant || seen.insert({user, vlr.recordId}).second) continue;
                find("There is more than one record " + user + "/" + std::to_string(vlr.recordId) + ".",
                     "Programs differ in which of them they take; the one that is wrong has to go.");
            }
    }

    // -- encoding bits and what they speak of

    void encodingBits()
    {
        const Vlr* const wkt = m_s.findVlr(geo::kUser, geo::kWktId);
        const Vlr* const keys = m_s.findVlr(geo::kUser, geo::kKeysId);
        const bool extended = isExtendedFormat(m_s.layout.format);
        const bool says = m_h.says(encoding::kWkt);
        if (!says && extended && (wkt != nullptr || keys == nullptr))
            setBit(encoding::kWkt, true,
                   "Point format " + std::to_string(m_s.layout.format) +
                       " asks for a coordinate system in WKT, but the header does not announce one.");
        else if (!says && extended)
            find("Point format " + std::to_string(m_s.layout.format) +
                     " asks for a coordinate system in WKT, and the file has GeoTIFF keys alone.",
                 "Write the system as WKT; most programs read the keys all the same.");
        else if (!says && wkt != nullptr && keys == nullptr && m_h.versionMinor() >= 4)
            setBit(encoding::kWkt, true, "The coordinate system is given in WKT, but the header does not say so.");
        else if (says && wkt == nullptr && keys != nullptr && !extended)
            setBit(encoding::kWkt, false,
                   "The header says that the coordinate system is given in WKT, and the file has GeoTIFF keys.");
        else if (says && wkt == nullptr && keys != nullptr)
            find("The header says that the coordinate system is given in WKT, and the file has GeoTIFF keys alone.",
                 "Write the system as WKT; most programs read the keys all the same.");
        if (wkt != nullptr && keys != nullptr)
            find("There is a coordinate system in WKT and another one in GeoTIFF keys.",
                 "Programs go by the one that the header's encoding names (here: " +
                     std::string(says || extended ? "WKT" : "GeoTIFF") + "); the other one should go.");
    }

    void setBit(std::uint16_t bit, bool on, const std::string& fault)
    {
        findRepairable(fault, on ? "The header's bit is set." : "The header's bit is cleared.");
        const std::uint16_t now = mended().globalEncoding();
        mended().set(at::kGlobalEncoding, std::uint16_t(on ? now | bit : now & ~bit));
    }

    void waveforms()
    {
        const bool inside = m_h.says(encoding::kInternalWaveform), beside = m_h.says(encoding::kExternalWaveform);
        const bool record = std::any_of(m_s.evlrs.begin(), m_s.evlrs.end(), isWaveforms);
        if (inside && beside)
            find("The header says that the waveforms are in this file and in one beside it.",
                 "One of both bits has to be cleared.");
        if (hasWaveform(m_s.layout.format) && !inside && !beside) {
            if (record)
                setBit(encoding::kInternalWaveform, true,
                       "The waveforms are in this file, but the header does not say so.");
            else
                find("The points have wave packets, but the header does not say where the waveforms are.",
                     "If there is a .wdp file, the header's bit 2 has to be set.");
        }
    }

    void gpsTimes()
    {
        if (!m_f.gpsTime) return;
        const auto [first, last] = *m_f.gpsTime;
        if (first == 0.0 && last == 0.0) return;  // there are none
        if (gpsClock(m_h) == GpsClock::Offset) return;
        const bool ofWeek = first >= 0.0 && last <= kWeek;
        const std::string span = shortestText(first) + " to " + shortestText(last);
        const bool adjusted = m_h.says(encoding::kAdjustedGpsTime);
        if (!adjusted && !ofWeek && m_h.versionMinor() >= 2) {
            if (first >= kEarliest && last <= secondsToday() && (first > kWeeks * kWeek || last < 0.0))
                setBit(encoding::kAdjustedGpsTime, true,
                       "GPS times are said to be seconds of a week, but go from " + span +
                           ", which are adjusted standard GPS times (" + gpsDay(first) + " to " + gpsDay(last) +
                           ").");
            else
                find("GPS times are said to be seconds of a week, but go from " + span + ".",
                     oddTimes(first, last));
        } else if (adjusted && ofWeek) {
            find("GPS times are said to be adjusted standard ones, and all of them lie in the week from " +
                     gpsDay(0.0) + " on (" + span + ").",
                 "If the points were not taken in that week, they are seconds of a week, and the header's bit 0 "
                 "has to be cleared.");
        } else if (adjusted &&
                   (first < kNavstar || last > secondsToday() || std::isinf(first) || std::isinf(last))) {
            find("GPS times are said to be adjusted standard ones, but go from " + span +
                     ", which is before there was GPS or in the future.",
                 oddTimes(first, last));
        }
    }

    /// What may be behind times that are none of what the header says.
    static std::string oddTimes(double first, double last)
    {
        if (!(std::abs(first) < kLargestTime) || !(std::abs(last) < kLargestTime))
            return "Some of them cannot be times.";
        if (last > secondsToday())
            return "They look like GPS or Unix time that was not adjusted; it has to be known which, to subtract "
                   "the "
                   "right seconds.";
        return "Points of several kinds of time, or without one, may be mixed.";
    }

    void creation()
    {
        const unsigned day = m_h.get(at::kCreationDay), year = m_h.get(at::kCreationYear);
        const auto now = std::chrono::floor<std::chrono::days>(std::chrono::system_clock::now());
        const int today = int(std::chrono::year_month_day(now).year());
        if (day == 0 && year == 0)
            find("The header does not say when the file was made.", "Nobody but its maker can know.");
        else if (day == 0 || day > 366 || year < 1980 || int(year) > today + 1)
            find("The file is said to be made on day " + std::to_string(day) + " of the year " +
                     std::to_string(year) + ", which cannot be.",
                 "Nobody but its maker can know.");
    }

    void format()
    {
        const std::uint8_t f = m_s.layout.format;
        const int least = f >= 6 ? 4 : f >= 4 ? 3 : f >= 2 ? 2 : 0;
        if (m_h.versionMinor() < least)
            find("Point format " + std::to_string(f) + " does not exist in LAS " + m_h.version() + ".",
                 "\"punctum convert --las-version 1." + std::to_string(std::uint64_t(least)) +
                     "\" writes a version that has it.");
        if (m_h.headerSize() < standardHeaderSize(m_h.versionMinor()))
            find("The header of LAS " + m_h.version() + " should have " +
                     std::to_string(standardHeaderSize(m_h.versionMinor())) + " bytes, but has " +
                     std::to_string(m_h.headerSize()) + ".",
                 "\"punctum convert\" writes a whole one.");
        if (m_f.points == 0 && complete()) find("The file has no points.", "There is nothing to mend.");
    }

    void coordinates()
    {
        for (std::size_t k = 0; k < 3; ++k) {
            const double scale = m_h.get(at::kScale[k]), offset = m_h.get(at::kOffset[k]);
            const std::string axis(1, "XYZ"[k]);
            // what is no number differs from any
            if (scale != m_s.coordinates.scale[int(k)] || offset != m_s.coordinates.offset[int(k)])
                find("The scale or offset of " + axis + " cannot be used (" + shortestText(scale) + ", " +
                         shortestText(offset) + ").",
                     "Nobody but the file's maker can know it.");
            else if (scale < 0)
                find("The scale of " + axis + " is negative.", "Many programs take it for a mistake.");
            else if (k < 2 && m_s.units.kind == CoordinateUnits::Kind::Degrees && scale > kCoarseDegrees)
                find("A step of " + axis + " is " + shortestText(scale) + " degrees, some " +
                         decimalText(scale * 111320.0, scale * 111320.0 < 100 ? 1 : 0) + " m.",
                     "Digits that were not written are lost; write the file anew from its origin.");
        }
        if (m_f.strays != 0)
            find(pointsText(m_f.strays) + (m_f.strays == 1 ? " lies" : " lie") +
                     " farther than 20 times the extent of the others away from them.",
                 "Delete them: " + strayCondition());
    }

    /// A command that deletes what is outside the common box.
    std::string strayCondition() const
    {
        std::string condition;
        const WorldBounds& box = m_f.common;
        for (int k = 0; k < 3; ++k) {
            const CoordinateScale& grid = m_s.coordinates;
            const int decimals = decimalsOf(grid, k);
            const auto face = [&](double v) { return decimals < 0 ? shortestText(v) : roundedText(v, decimals); };
            condition += (condition.empty() ? "" : " or ") + std::string(1, "XYZ"[k]) + " not in " +
                         face(box.min[k] - grid.scale[k]) + ".." + face(box.max[k] + grid.scale[k]);
        }
        return "punctum process IN -o OUT --step 'delete where=\"" + condition + "\"'.";
    }

    void crs()
    {
        const bool any = m_s.findVlr(geo::kUser, geo::kWktId) != nullptr ||
                         m_s.findVlr("liblas", geo::kWktId) != nullptr ||
                         m_s.findVlr(geo::kUser, geo::kKeysId) != nullptr;
        if (m_s.crs.empty())
            find(any ? "The record on the coordinate system cannot be understood."
                     : "The file does not say its coordinate system.",
                 "Nobody but its maker can know it.");
        else if (m_s.units.kind == CoordinateUnits::Kind::Unknown)
            find("The coordinate system that the file states is not understood; its units are unknown.",
                 "Nobody but its maker can know it.");
    }

    // -- points

    void returnNumbers()
    {
        if (m_s.layout.attributes.size() < 4) return;
        const std::uint64_t zero = m_f.returns[0];
        if (zero != 0)
            find(pointsHave(zero) + " return number 0; they begin at 1.",
                 zero == m_f.points ? "If there was one return a pulse: --step 'set rule=\"ReturnNumber = 1\"'."
                                    : "It has to be known which return they are.");
        if (m_f.noReturns != 0 && m_f.noReturns != zero)
            find(pointsHave(m_f.noReturns) + " 0 returns of their pulse.",
                 "It has to be known how many there were.");
        if (m_f.returnsAbove != 0)
            find(pointsHave(m_f.returnsAbove) + " a return number above the number of returns.",
                 "It has to be known which of both is right.");
        if (!isExtendedFormat(m_s.layout.shownFormat()) && m_f.scanAngleMost > 90.0)
            find("Scan angles go up to " + shortestText(float(m_f.scanAngleMost)) +
                     " degrees; point formats 0 to 5 have them from -90 to 90.",
                 "Nobody but the file's maker can know them.");
    }

    void classes()
    {
        const bool extended = isExtendedFormat(m_s.layout.shownFormat());
        if (extended && m_f.classes[kOverlapClass] != 0)
            find(pointsHave(m_f.classes[kOverlapClass]) +
                     " class 12, which point formats 6 to 10 reserve; overlap is a flag there.",
                 "Set the flag, and give them a class: --step 'set rule=\"Overlap = 1 if Classification == 12\"'.");
        if (extended && m_f.classes[8] != 0)
            find(pointsHave(m_f.classes[8]) +
                     " class 8, which point formats 6 to 10 reserve; model key points have a flag there.",
                 "Set the flag, and give them a class: --step 'set rule=\"KeyPoint = 1 if Classification == 8\"'.");
        std::uint64_t reserved = 0;
        std::string codes;
        const unsigned first = extended ? 23 : 13;  // LAS 1.4 R15, tables 9 and 17; 13 and on: other formats' names
        for (unsigned code = first; code < (extended ? 64u : 32u); ++code) {
            if (m_f.classes[code] == 0 || (!extended && !classNameOf(code).empty())) continue;
            reserved += m_f.classes[code];
            codes += (codes.empty() ? "" : ", ") + std::to_string(code);
        }
        if (reserved != 0)
            find(pointsHave(reserved) + " classes that are reserved: " + codes + ".",
                 extended ? "Classes of one's own are 64 to 255."
                          : "Point format 6 and above has classes of one's own.");
    }

    void extraBytes()
    {
        const auto records = m_s.extraBytesRecords();
        std::vector<std::string> problems;
        const std::uint32_t first = standardRecordLength(m_s.layout.format);
        const auto items = parseExtraBytes(records, first, m_s.layout.length, problems);
        for (const std::string& problem : problems)
            find(problem, "The description has to be made anew by who knows what the bytes mean.");
        std::uint32_t described = first;
        std::set<std::string> names;
        for (const ExtraBytesItem& item : items) {
            described = std::max(described, item.offset + item.bytes);
            const std::string name = item.descriptor.name();
            if (!item.opaque && name.empty())
                find("Extra bytes have a description without a name.", "Rename the attribute.");
            else if (!name.empty() && !names.insert(name).second)
                find("Two attributes of extra bytes have the name \"" + name + "\".", "Rename one of them.");
        }
        if (problems.empty() && described < m_s.layout.length)
            find(std::to_string(m_s.layout.length - described) + " bytes of each point are not described.",
                 "They are kept; who knows what they mean can describe them.");
    }

    void colors()
    {
        if (m_f.colorBits != 0 && m_f.colorBits < 256)
            find("Colors go up to " + std::to_string(m_f.colorBits) +
                     " at most: they are of 8 bits, where 16 are asked for.",
                 "Multiply them by 257: --step 'set rule=\"Red = Red * 257\"', and likewise Green and Blue.");
    }

    const SourceFile& m_s;
    const PointFigures& m_f;
    const Header& m_h;
    Diagnosis m_result;
    std::set<std::string> m_told;
};

/// Header and records of the file that the cloud was saved to.
std::shared_ptr<const SourceFile> savedSource(const PointCloud& cloud, const CurrentFile& place,
                                              const std::vector<PointRange>& leftOut, Progress& progress)
{
    auto source = Reader::open(place.path)->source();
    if (!(source->current->get().stamp == place.stamp))
        throw Error(place.path, "The file changed since it was saved.");
    PointsAsRead points;  // what is asked of them here
    if (source->header.versionMinor() >= 5) points.gps = gpsRange(cloud, readable(cloud.size(), leftOut), progress);
    source->asRead->set(std::move(points));
    return source;
}

}  // namespace

bool Diagnosis::repairable() const
{
    return std::any_of(findings.begin(), findings.end(), [](const Finding& f) { return f.repairable; });
}

Diagnosis diagnose(const SourceFile& source, const PointFigures& figures)
{
    return Doctor(source, figures).run();
}

Examination examine(const PointCloud& cloud, Progress& progress)
{
    const auto source = cloud.source();  // NOLINT(performance-unnecessary-copy-initialization): may be replaced
    const CurrentFile place = source->current->get();
    std::vector<PointRange> leftOut;
    if (!place.saved)
        leftOut = source->asRead->get().missing;
    else if (place.kept)
        leftOut = readable(cloud.size(), place.kept->ranges());  // all that is not kept
    std::optional<PointSet> others;
    if (!leftOut.empty()) {
        others.emplace(cloud.size());
        for (const PointRange& range : leftOut) others->insert(range);
    }
    Examination result;
    result.source = place.saved ? savedSource(cloud, place, leftOut, progress) : source;
    result.figures = computePointFigures(cloud, others ? &*others : nullptr, progress);
    result.diagnosis = diagnose(*result.source, result.figures);
    return result;
}

}  // namespace punctum::las
