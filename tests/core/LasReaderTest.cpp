// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/las/ChunkCodec.h"
#include "core/las/Reader.h"
#include "core/task/Progress.h"
#include "tests/core/ExactBoxes.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <tbb/global_control.h>

#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>

using namespace punctum;
using lasfiles::Bytes;
namespace fs = std::filesystem;

/// Reading LAS and LAZ, judged by LASzip's own API.
class LasReaderTest : public QObject
{
    Q_OBJECT

private slots:
    void sharedFilesAreReadAsLaszipDoes_data();
    void sharedFilesAreReadAsLaszipDoes();
    void sharedFilesHaveTheseAttributes_data();
    void sharedFilesHaveTheseAttributes();
    void everyFormatHasItsAttributes_data();
    void everyFormatHasItsAttributes();
    void batchesCoverEachPointOnceAndSpread_data();
    void batchesCoverEachPointOnceAndSpread();
    void cancelStopsReading();
    void extraBytesAreTyped();
    void idsAreCategories();
    void clashingNamesAreToldApart();
    void firstBoundsAreGood();
    void changedFileIsAnError();
    void damagedChunkLeavesOthers();
    void returnsAndBoundsAreCounted();
    void pointwiseCompressionIsRead();
    void manyDamagedChunksAreOneWarning();
    void wrongCallsAreRefused();

private:
    fs::path make(const std::string& name, const Bytes& bytes) const
    {
        const fs::path path = fs::path(m_dir.path().toStdString()) / name;
        lasfiles::writeFile(path, bytes);
        return path;
    }
    static std::shared_ptr<PointCloud> load(const fs::path& path, las::ReadResult* result = nullptr)
    {
        Progress progress;
        return las::load(path, progress, result);
    }
    static Bytes descriptor(int type, const std::string& name, int options = 0)
    {
        Bytes d(192);
        d[2] = std::byte(type);
        d[3] = std::byte(options);
        std::memcpy(d.data() + 4, name.data(), std::min<std::size_t>(name.size(), 32));
        return d;
    }
    QTemporaryDir m_dir;
};

namespace
{

/// What LASzip's own struct says of the standard attributes; NaN for those the format does not have.
double expected(const laszip_point& p, const std::string& name, bool extended)
{
    if (name == "Intensity") return p.intensity;
    if (name == "ReturnNumber") return extended ? p.extended_return_number : p.return_number;
    if (name == "NumberOfReturns") return extended ? p.extended_number_of_returns : p.number_of_returns;
    if (name == "ScanDirectionFlag") return p.scan_direction_flag;
    if (name == "EdgeOfFlightLine") return p.edge_of_flight_line;
    if (name == "Classification") return extended ? p.extended_classification : p.classification;
    if (name == "Synthetic") return extended ? p.extended_classification_flags & 1 : p.synthetic_flag;
    if (name == "KeyPoint") return extended ? p.extended_classification_flags >> 1 & 1 : p.keypoint_flag;
    if (name == "Withheld") return extended ? p.extended_classification_flags >> 2 & 1 : p.withheld_flag;
    if (name == "Overlap") return p.extended_classification_flags >> 3;
    if (name == "ScannerChannel") return p.extended_scanner_channel;
    if (name == "ScanAngle") return extended ? p.extended_scan_angle * 0.006 : p.scan_angle_rank;
    if (name == "UserData") return p.user_data;
    if (name == "PointSourceId") return p.point_source_ID;
    if (name == "GpsTime") return p.gps_time;
    if (name == "Red") return p.rgb[0];
    if (name == "Green") return p.rgb[1];
    if (name == "Blue") return p.rgb[2];
    if (name == "NIR") return p.rgb[3];
    if (name == "WaveformDescriptorIndex") return p.wave_packet[0];
    return std::numeric_limits<double>::quiet_NaN();
}

std::string attributeNames(const PointCloud& cloud)
{
    std::string names;
    for (const Attribute& a : cloud.attributes()) names += (names.empty() ? "" : " ") + a.name;
    return names;
}

const std::string kClassic =
    "X Y Z Intensity ReturnNumber NumberOfReturns ScanDirectionFlag EdgeOfFlightLine Classification Synthetic "
    "KeyPoint "
    "Withheld ScanAngle UserData PointSourceId";
const std::string kExtended =
    "X Y Z Intensity ReturnNumber NumberOfReturns ScanDirectionFlag EdgeOfFlightLine Classification Synthetic "
    "KeyPoint "
    "Withheld Overlap ScannerChannel ScanAngle UserData PointSourceId GpsTime";
const std::string kWave =
    " WaveformDescriptorIndex WaveformOffset WaveformSize WaveformReturnLocation WaveformX WaveformY WaveformZ";
const std::string kColor = " Red Green Blue";

}  // namespace

void LasReaderTest::sharedFilesAreReadAsLaszipDoes_data()
{
    QTest::addColumn<QString>("file");
    for (const auto& f : lasfiles::sharedFiles(PUNCTUM_TEST_DATA))
        QTest::newRow(f.filename().c_str()) << QString::fromStdString(f.string());
    if (lasfiles::sharedFiles(PUNCTUM_TEST_DATA).empty()) QTest::newRow("none") << QString();
}

void LasReaderTest::sharedFilesAreReadAsLaszipDoes()
{
    QFETCH(QString, file);
    if (file.isEmpty()) QSKIP("the shared test data is not here");
    const fs::path path = file.toStdString();
    las::ReadResult result;
    const auto cloud = load(path, &result);
    QVERIFY(result.missing.empty());
    QVERIFY(result.bounds == cloud->computeBounds());
    QVERIFY(boxesAreExact(*cloud));
    const auto& layout = cloud->source()->layout;
    const bool extended = layout.format >= 6;

    std::vector<const Attribute*> standard;
    for (const Attribute& a : cloud->attributes())
        if (a.standard && a.components == 1) standard.push_back(&a);
    std::vector<std::byte> record(layout.length);
    std::size_t i = 0, differing = 0;
    lasfiles::forEachByLaszip(path, cloud->size(), [&](const laszip_point& p) {
        lasfiles::toRecord(p, layout.format, record.data());
        for (std::size_t k = 0; k < layout.fields.size(); ++k) {
            const auto& f = layout.fields[k];
            const std::byte* value = cloud->columns()[k]->data() + i * f.bytes();
            differing += std::memcmp(value, record.data() + f.offset, f.bytes()) != 0;
        }
        if (i % 16 == 0)
            for (const Attribute* a : standard)
                if (const double e = expected(p, a->name, extended); !std::isnan(e))
                    differing += std::fabs(a->number(i) - e) > 1e-9;
        ++i;
    });
    QCOMPARE(i, std::size_t(cloud->size()));
    QCOMPARE(differing, std::size_t(0));
}

void LasReaderTest::sharedFilesHaveTheseAttributes_data()
{
    QTest::addColumn<QString>("file");
    QTest::addColumn<qulonglong>("points");
    QTest::addColumn<QString>("attributes");
    const auto row = [](const char* file, qulonglong points, const std::string& names) {
        QTest::newRow(file) << QString(file) << points << QString::fromStdString(names);
    };
    row("autzen_trim.las", 110000, kClassic + " GpsTime" + kColor + " RGB");
    row("autzen_trim.laz", 110000, kClassic + " GpsTime" + kColor + " RGB");
    row("autzen_trim_7.las", 110000, kExtended + kColor + " RGB");
    row("bcts_1.laz", 531662, kClassic + " GpsTime");
    row("tls_clip.laz", 400754, kExtended);
    row("lone-star.laz", 518862, kClassic + " GpsTime");
    row("lion_takanawa.copc.laz", 341989, kExtended + kColor + " OriginId RGB");
    row("simple1_3.las", 999, kClassic + " GpsTime" + kWave);
    row("fullwave.laz", 10750, kExtended + kColor + " NIR" + kWave + " RGB");
    row("epsg_4326.las", 5380, kClassic);
    row("lots_of_vlr.las", 1, kClassic + " GpsTime");
    row("unregistered_extra_bytes.las", 4, kExtended + " ExtraBytes");
    row("extrabytes.las", 1065,
        kClassic + " GpsTime" + kColor +
            " Colors[0] Colors[1] Colors[2] Reserved Flags[0] Flags[1] Intensity (extra) Time RGB");
}

void LasReaderTest::sharedFilesHaveTheseAttributes()
{
    QFETCH(QString, file);
    QFETCH(qulonglong, points);
    QFETCH(QString, attributes);
    const fs::path path = fs::path(PUNCTUM_TEST_DATA) / file.toStdString();
    if (!fs::exists(path)) QSKIP((file + " is not here").toUtf8().constData());
    const auto reader = las::Reader::open(path);
    QCOMPARE(qulonglong(reader->source()->pointCount), points);
    QCOMPARE(QString::fromStdString(attributeNames(*reader->createCloud())), attributes);
}

void LasReaderTest::everyFormatHasItsAttributes_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<QString>("attributes");
    const std::string names[] = {kClassic,
                                 kClassic + " GpsTime",
                                 kClassic + kColor + " RGB",
                                 kClassic + " GpsTime" + kColor + " RGB",
                                 kClassic + " GpsTime" + kWave,
                                 kClassic + " GpsTime" + kColor + kWave + " RGB",
                                 kExtended,
                                 kExtended + kColor + " RGB",
                                 kExtended + kColor + " NIR RGB",
                                 kExtended + kWave,
                                 kExtended + kColor + " NIR" + kWave + " RGB"};
    for (int f = 0; f <= 10; ++f) QTest::addRow("format %d", f) << f << QString::fromStdString(names[f]);
}

void LasReaderTest::everyFormatHasItsAttributes()
{
    QFETCH(int, format);
    QFETCH(QString, attributes);
    const auto f = std::uint8_t(format);
    std::vector<std::string> warnings;
    const auto layout = las::makeLayout(f, lasfiles::recordLength(f), {}, {}, warnings);
    PointCloud cloud(3);
    las::makeColumns(cloud, layout);
    QCOMPARE(QString::fromStdString(attributeNames(cloud)), attributes);
    std::uint32_t at = 0;
    for (const auto& field : layout.fields) {
        QCOMPARE(std::uint32_t(field.offset), at);
        at += field.bytes();
    }
    QCOMPARE(at, std::uint32_t(lasfiles::recordLength(f)));
    QCOMPARE(las::standardRecordLength(f), lasfiles::recordLength(f));
    QCOMPARE(cloud.findAttribute("Classification")->maxBits(), std::uint64_t(f < 6 ? 31 : 255));
    QCOMPARE(cloud.findAttribute("Classification")->kind, AttributeKind::Class);
    QCOMPARE(las::standardRecordLength(11), std::uint16_t(0));
}

void LasReaderTest::batchesCoverEachPointOnceAndSpread_data()
{
    QTest::addColumn<bool>("compressed");
    QTest::addColumn<int>("threads");
    QTest::newRow("las") << false << 1;
    QTest::newRow("laz") << true << 1;
    QTest::newRow("las by two") << false << 2;
    QTest::newRow("laz by two") << true << 2;
}

void LasReaderTest::batchesCoverEachPointOnceAndSpread()
{
    QFETCH(bool, compressed);
    const std::size_t count = compressed ? 100000 : 3000000;
    const Bytes points(count * 20);
    const fs::path path =
        make("spread", compressed ? lasfiles::lazFile(0, 20, points, 1000)
                                  : lasfiles::file(lasfiles::header(2, 0, 20, count), {}, points));
    // With several threads a busy machine may hold one of them back, and the batches of its place with it.
    QFETCH(int, threads);
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
    const auto reader = las::Reader::open(path);
    const auto cloud = reader->createCloud();
    std::vector<std::atomic<int>> seen(count / 1000);
    std::mutex mutex;
    std::vector<PointIndex> order;
    Progress progress;
    reader->read(*cloud, progress, [&](PointRange r) {
        for (PointIndex i = r.first; i < r.last; ++i)
            if (i % 1000 == 0) ++seen[std::size_t(i / 1000)];
        const std::lock_guard lock(mutex);
        order.push_back(r.first);
        if (r.size() > 65536) order.push_back(~PointIndex(0));
    });
    for (const auto& n : seen) QCOMPARE(n.load(), 1);
    QVERIFY(order.size() >= 64);
    QCOMPARE(progress.fraction(), 1.0);
    if (threads != 1) return;
    // Among the first batches, four in a row, there is one in each eighth of the cloud.
    std::uint32_t eighths = 0;
    for (std::size_t k = 0; k < 48; ++k) eighths |= 1u << (order[k] * 8 / count);
    QCOMPARE(eighths, 0xFFu);
}

void LasReaderTest::cancelStopsReading()
{
    const std::size_t count = 300000;
    for (const bool compressed : {false, true}) {
        const Bytes points(count * 20);
        const fs::path path =
            make("cancel", compressed ? lasfiles::lazFile(0, 20, points, 5000)
                                      : lasfiles::file(lasfiles::header(2, 0, 20, count), {}, points));
        const auto reader = las::Reader::open(path);
        const auto cloud = reader->createCloud();
        Progress progress;
        std::atomic<PointIndex> arrived{0};
        QVERIFY_EXCEPTION_THROWN(reader->read(*cloud, progress,
                                              [&](PointRange r) {
                                                  arrived += r.size();
                                                  progress.cancel();
                                              }),
                                 Cancelled);
        QVERIFY(arrived < count);
        // and again, as if nothing had been
        Progress second;
        reader->read(*reader->createCloud(), second);
    }
}

void LasReaderTest::extraBytesAreTyped()
{
    // all ten scalar types, an unsigned 64-bit value beyond doubles, scale, offset, no data; then opaque bytes
    Bytes descriptors;
    std::uint16_t extra = 0;
    for (int type = 1; type <= 10; ++type) {
        Bytes d = descriptor(type, "t" + std::to_string(type));
        if (type == 3) {
            d[3] = std::byte(8 | 16 | 1);
            lasfiles::set<double>(d, 112, 0.5);
            lasfiles::set<double>(d, 136, 100);
            lasfiles::set<std::uint64_t>(d, 40, 7);
        }
        if (type == 4) lasfiles::set<double>(d, 112, 0.0);  // a scale of 0 whose bit is clear
        lasfiles::append(descriptors, d);
        extra = std::uint16_t(extra + sizeOf(ScalarType(type - 1)));
    }
    lasfiles::append(descriptors, descriptor(23, "vector"));  // three uint16
    lasfiles::append(descriptors, descriptor(0, "blob", 5));
    extra = std::uint16_t(extra + 6 + 5 + 3);  // and three that nobody describes
    const auto length = std::uint16_t(20 + extra);
    const std::size_t count = 300;
    Bytes points = lasfiles::randomRecords(0, length, count, 77);
    const std::size_t u64At = 20 + 1 + 1 + 2 + 2 + 4 + 4;
    lasfiles::set<std::uint64_t>(points, u64At, 9007199254740993ull);  // 2^53 + 1
    lasfiles::set<std::uint16_t>(points, 22, 7);
    lasfiles::set<std::uint16_t>(points, 22 + length, 8);
    // in two records, the second of which goes on where the first ends
    const Bytes first(descriptors.begin(), descriptors.begin() + 192 * 4);
    const Bytes second(descriptors.begin() + 192 * 4, descriptors.end());
    const fs::path path =
        make("extra.las",
             lasfiles::file(lasfiles::header(2, 0, length, count),
                            {lasfiles::record("LASF_Spec", 4, first), lasfiles::record("LASF_Spec", 4, second)},
                            points));
    las::ReadResult result;
    const auto cloud = load(path, &result);
    QVERIFY(result.warnings.empty());
    for (int type = 1; type <= 10; ++type) {
        const Attribute* a = cloud->findAttribute("t" + std::to_string(type));
        QVERIFY(a != nullptr);
        QCOMPARE(a->type(), ScalarType(type - 1));
        QVERIFY(!a->standard);
        QCOMPARE(a->scaled, type == 3);
    }
    QCOMPARE(std::get<std::uint64_t>(cloud->findAttribute("t7")->value(0)), std::uint64_t(9007199254740993ull));
    QVERIFY(std::isnan(cloud->findAttribute("t3")->number(0)));
    QCOMPARE(cloud->findAttribute("t3")->number(1), 104.0);
    QCOMPARE(cloud->findAttribute("vector[2]")->type(), ScalarType::U16);
    QCOMPARE(cloud->findAttribute("blob")->kind, AttributeKind::Opaque);
    QCOMPARE(cloud->findAttribute("blob")->columns[0]->components(), 5u);
    QCOMPARE(cloud->findAttribute("ExtraBytes")->columns[0]->components(), 3u);
    const auto& layout = cloud->source()->layout;
    for (std::size_t k = 0; k < layout.fields.size(); ++k)
        for (std::size_t i = 0; i < count; ++i)
            QVERIFY(std::memcmp(cloud->columns()[k]->data() + i * layout.fields[k].bytes(),
                                points.data() + i * length + layout.fields[k].offset,
                                layout.fields[k].bytes()) == 0);
}

void LasReaderTest::idsAreCategories()
{
    struct Named {
        const char* name;
        int type;
        bool category;
    };
    const Named all[] = {{"TreeId", 5, true},     {"treeID", 3, true},   {"tree id", 6, true},
                         {"segment_ID", 7, true}, {"ID", 1, true},       {"Grid", 5, false},
                         {"valid", 1, false},     {"TreeId2", 5, false}, {"MeanTreeId", 9, false}};
    Bytes descriptors;
    std::uint16_t length = 20;
    for (const Named& one : all) {
        lasfiles::append(descriptors, descriptor(one.type, one.name));
        length = std::uint16_t(length + sizeOf(ScalarType(one.type - 1)));
    }
    const auto cloud = load(make("ids.las", lasfiles::file(lasfiles::header(2, 0, length, 10),
                                                           {lasfiles::record("LASF_Spec", 4, descriptors)},
                                                           lasfiles::randomRecords(0, length, 10, 1))));
    for (const Named& one : all) {
        const Attribute* const found = cloud->findAttribute(one.name);
        QVERIFY2(found != nullptr, one.name);
        QVERIFY2((found->kind == AttributeKind::Category) == one.category, one.name);
    }
}

void LasReaderTest::clashingNamesAreToldApart()
{
    Bytes d;
    for (const char* name : {"Intensity", "Same", "Same", "", "Normal", "Flags", "Same"})
        lasfiles::append(d, descriptor(1, name));
    lasfiles::append(d, descriptor(1, std::string("caf\xE9 with 32 bytes and no NUL...", 32)));
    const fs::path path =
        make("names.las", lasfiles::file(lasfiles::header(4, 6, 38, 0), {lasfiles::record("LASF_Spec", 4, d)}, {}));
    const std::string expectedNames =
        kExtended +
        " Intensity (extra) Same Same#2 ExtraBytes Normal (extra) Flags (extra) Same#3 "
        "caf\xC3\xA9 with 32 bytes and no NUL...";
    QCOMPARE(attributeNames(*load(path)), expectedNames);
}

void LasReaderTest::firstBoundsAreGood()
{
    const std::size_t count = 50000;
    Bytes points(count * 20);
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t a = 0; a < 3; ++a)
            lasfiles::set<std::int32_t>(points, i * 20 + 4 * a, std::int32_t(i * (a + 1)));
    Bytes head = lasfiles::header(2, 0, 20, count);
    const auto bounds = [&](double factor) {
        for (std::size_t a = 0; a < 3; ++a)
            lasfiles::set<double>(head, 179 + 16 * a, factor * 50000 * 0.01 * double(a + 1));
        return las::Reader::open(make("box.las", lasfiles::file(head, {}, points)))->source()->firstBounds;
    };
    QVERIFY(bounds(0).max.x > 490);     // a header without a box: the samples say enough
    QCOMPARE(bounds(1).max.z, 1500.0);  // a good box is taken
    QVERIFY(bounds(1000).max.x < 501);  // one that is far too large is not
    QVERIFY(bounds(std::nan("")).max.x < 501);
    QVERIFY(bounds(1e300).max.x < 501);
}

void LasReaderTest::changedFileIsAnError()
{
    const std::size_t count = 400000;
    const fs::path path =
        make("shrinks.las", lasfiles::file(lasfiles::header(2, 0, 20, count), {}, Bytes(count * 20)));
    const auto reader = las::Reader::open(path);
    fs::resize_file(path, 1000000);
    Progress progress;
    QVERIFY_EXCEPTION_THROWN(reader->read(*reader->createCloud(), progress), Error);

    // the same size, but other contents
    const fs::path other = make("rewritten.las", lasfiles::file(lasfiles::header(2, 0, 20, 10), {}, Bytes(200)));
    const auto second = las::Reader::open(other);
    fs::last_write_time(other, fs::file_time_type::clock::now() + std::chrono::seconds(5));
    QVERIFY_EXCEPTION_THROWN(second->read(*second->createCloud(), progress), Error);

    // deleted: what was opened can be read to its end
    const fs::path gone = make("gone.las", lasfiles::file(lasfiles::header(2, 0, 20, 10), {}, Bytes(200)));
    const auto third = las::Reader::open(gone);
    fs::remove(gone);
    third->read(*third->createCloud(), progress);
}

void LasReaderTest::damagedChunkLeavesOthers()
{
    for (const std::uint8_t format : {3, 7}) {
        const auto length = lasfiles::recordLength(format);
        const Bytes points = lasfiles::randomRecords(format, length, 1000, 12);
        Bytes laz = lasfiles::lazFile(format, length, points, 100);
        // somewhere in the middle of the fourth of the ten chunks, which are nearly of one size
        const std::size_t begin = lasfiles::get<std::uint32_t>(laz, 96) + 8;
        const auto table = std::size_t(lasfiles::get<std::int64_t>(laz, begin - 8));
        const std::size_t at = begin + (table - begin) * 35 / 100;
        for (std::size_t k = 0; k < 40; ++k) laz[at + k] ^= std::byte(0xA5);
        las::ReadResult result;
        const auto cloud = load(make("damaged.laz", laz), &result);
        for (const PointRange& m : result.missing) QCOMPARE(m, (PointRange{300, 400}));
        QVERIFY(boxesAreExact(*cloud));  // the damaged points are at 0
        QVERIFY(result.bounds == cloud->computeBounds() || !result.missing.empty());
        if (format == 3) {
            QCOMPARE(result.missing.size(), std::size_t(1));
            QVERIFY(!result.warnings.empty());
        }
        for (std::size_t i = 0; i < 1000; ++i)
            if (i < 300 || i >= 400) QVERIFY(cloud->rawX()[i] == lasfiles::get<std::int32_t>(points, i * length));
    }
}

void LasReaderTest::returnsAndBoundsAreCounted()
{
    const std::size_t count = 70001;
    const Bytes points = lasfiles::randomRecords(6, 30, count, 33);
    const auto cloud = load(make("count.las", lasfiles::file(lasfiles::header(4, 6, 30, count), {}, points)));
    const auto summary = cloud->source()->asRead->get();
    QVERIFY(summary.complete);
    QVERIFY(summary.bounds == cloud->computeBounds());
    QVERIFY(boxesAreExact(*cloud));
    std::array<std::uint64_t, 16> expectedReturns{};
    for (std::size_t i = 0; i < count; ++i) ++expectedReturns[std::size_t(points[i * 30 + 14]) & 15];
    QVERIFY(summary.byReturn == expectedReturns);
}

void LasReaderTest::pointwiseCompressionIsRead()
{
    // The oldest LAZ: one stream, which is what a single chunk holds, without table and position.
    for (const std::uint8_t format : {0, 1, 3, 5}) {
        const auto length = lasfiles::recordLength(format);
        const std::size_t count = 150000;
        const Bytes points = lasfiles::randomRecords(format, length, count, format, true);
        Bytes laz = lasfiles::lazFile(format, length, points, 1000000);
        const std::size_t begin = lasfiles::get<std::uint32_t>(laz, 96);
        const auto table = std::size_t(lasfiles::get<std::int64_t>(laz, begin));
        laz.resize(table);
        laz.erase(laz.begin() + std::ptrdiff_t(begin), laz.begin() + std::ptrdiff_t(begin) + 8);
        lasfiles::set<std::uint16_t>(laz, lasfiles::get<std::uint16_t>(laz, 94) + 54u, 1);
        las::ReadResult result;
        const fs::path path = make("pointwise.laz", laz);
        const auto cloud = load(path, &result);
        QVERIFY2(result.warnings.empty(), result.warnings.empty() ? "" : result.warnings[0].c_str());
        QVERIFY(lasfiles::recordsByLaszip(path, format, length, count) == points);
        for (std::size_t i = 0; i < count; ++i)
            QVERIFY(cloud->rawX()[i] == lasfiles::get<std::int32_t>(points, i * length));
        // cut: what was read before is there, the rest is told
        laz.resize(laz.size() / 2);
        const auto half = load(make("half.laz", laz), &result);
        QCOMPARE(result.missing.size(), std::size_t(1));
        QVERIFY(boxesAreExact(*half));
        QVERIFY(result.missing[0].first > 0 && result.missing[0].last == count);
    }
}

void LasReaderTest::manyDamagedChunksAreOneWarning()
{
    const Bytes points = lasfiles::randomRecords(6, 30, 2000, 12);
    Bytes laz = lasfiles::lazFile(6, 30, points, 10);
    const std::size_t begin = lasfiles::get<std::uint32_t>(laz, 96) + 8;
    const auto table = std::size_t(lasfiles::get<std::int64_t>(laz, begin - 8));
    const std::size_t chunk = (table - begin) / 200;
    for (std::size_t k = 1; k < 199; ++k) laz[begin + k * chunk + 20] = std::byte(0);
    std::fill(laz.begin() + std::ptrdiff_t(begin + 2 * chunk), laz.begin() + std::ptrdiff_t(table - 2 * chunk),
              std::byte(0));
    las::ReadResult result;
    const auto cloud = load(make("many.laz", laz), &result);
    QVERIFY(result.missing.size() > 100);
    QVERIFY(boxesAreExact(*cloud));
    QVERIFY(result.warnings.size() < 15);
    QVERIFY(std::is_sorted(result.missing.begin(), result.missing.end(),
                           [](const PointRange& a, const PointRange& b) { return a.first < b.first; }));
}

void LasReaderTest::wrongCallsAreRefused()
{
    const auto reader = las::Reader::open(
        make("ten.las", lasfiles::file(lasfiles::header(2, 0, 20, 10), {}, lasfiles::randomRecords(0, 20, 10, 1))));
    Progress progress;
    PointCloud other(9);
    QVERIFY_EXCEPTION_THROWN(reader->read(other, progress), Error);
    std::vector<std::string> warnings;
    QVERIFY_EXCEPTION_THROWN(las::makeLayout(11, 100, {}, {}, warnings), Error);
    QVERIFY_EXCEPTION_THROWN(las::makeLayout(6, 29, {}, {}, warnings), Error);
    QVERIFY_EXCEPTION_THROWN(las::encodeChunk(las::LazInfo::standard(6, 30), {}, progress), Error);
}

QTEST_GUILESS_MAIN(LasReaderTest)
#include "LasReaderTest.moc"
