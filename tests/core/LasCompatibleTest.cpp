// SPDX-License-Identifier: MIT
#include "core/edit/Command.h"
#include "core/las/Compatible.h"
#include "core/las/Diff.h"
#include "core/las/Reader.h"
#include "core/session/Session.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"

#include <QTemporaryDir>
#include <QTest>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
namespace fs = std::filesystem;

/// LAS 1.4 in the older form: written and judged by LASzip's own API.
class LasCompatibleTest : public QObject
{
    Q_OBJECT

private slots:
    void showsWhatLaszipShows_data() { formats(); }
    void showsWhatLaszipShows();
    void savesByteForByte_data() { formats(); }
    void savesByteForByte();
    void editsGoIntoTheExtraBytes_data() { formats(); }
    void editsGoIntoTheExtraBytes();
    void becomesNative_data() { formats(); }
    void becomesNative();
    void waveformsAndOtherAttributes();
    void diffGoesByMeaning();
    void keepsItsFormInASurvey_data() { formats(); }
    void keepsItsFormInASurvey();
    void fieldsThatAreNotThere_data();
    void fieldsThatAreNotThere();

private:
    static void formats()
    {
        QTest::addColumn<int>("format");
        QTest::addColumn<bool>("compressed");
        for (const int format : {6, 7, 8})
            for (const bool compressed : {false, true})
                QTest::addRow("format %d, %s", format, compressed ? "LAZ" : "LAS") << format << compressed;
    }
    fs::path path(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    fs::path make(int format, bool compressed, const Bytes& records) const;
    static void save(const PointCloud& cloud, const fs::path& file, std::optional<std::uint8_t> format = {},
                     std::optional<std::uint8_t> minor = {})
    {
        Progress progress;
        las::WriteOptions options;
        options.compressed = las::isCompressedName(file);
        options.pointFormat = format;
        options.versionMinor = minor;
        las::write(cloud, file, options, progress);
    }

    QTemporaryDir m_dir;
};

namespace
{

constexpr std::size_t kCount = 3000;

std::uint16_t lengthOf(int format)
{
    return lasfiles::recordLength(std::uint8_t(format));
}

/// Random records that compatibility mode can hold: returns that are possible, and whole bytes else.
Bytes makeRecords(int format)
{
    const std::uint16_t length = lengthOf(format);
    Bytes r = lasfiles::randomRecords(std::uint8_t(format), length, kCount, 77);
    for (std::size_t i = 0; i < kCount; ++i) {
        const unsigned of = 1 + i % 15, number = 1 + (i / 15) % of;
        r[i * length + 14] = std::byte(number | of << 4);
        const auto angle = std::int16_t(int(i * 7919 % 60001) - 30000);
        lasfiles::set(r, i * length + 18, angle);
        for (std::size_t k = 0; k < 3; ++k)
            lasfiles::set<std::int32_t>(r, i * length + 4 * k, std::int32_t(i * (k + 3) % 1009));
    }
    return r;
}

/// The records of a file in compatibility mode, as LASzip's reader puts them together again.
Bytes meantByLaszip(const fs::path& file, int format)
{
    laszip_POINTER laszip = nullptr;
    laszip_create(&laszip);
    lasfiles::check(laszip, laszip_request_compatibility_mode(laszip, 1));
    laszip_BOOL compressed = 0;
    lasfiles::check(laszip, laszip_open_reader(laszip, file.c_str(), &compressed));
    laszip_point* point = nullptr;
    lasfiles::check(laszip, laszip_get_point_pointer(laszip, &point));
    const std::uint16_t length = lengthOf(format);
    Bytes records(kCount * length);
    for (std::size_t i = 0; i < kCount; ++i) {
        lasfiles::check(laszip, laszip_read_point(laszip));
        laszip_point plain = *point;
        plain.num_extra_bytes = 0;
        lasfiles::toRecord(plain, std::uint8_t(format), records.data() + i * length);
    }
    laszip_close_reader(laszip);
    laszip_destroy(laszip);
    return records;
}

/// The records that the attributes of the cloud show, put together from the standard's table.
Bytes shownBy(const PointCloud& cloud, int format)
{
    const std::uint16_t length = lengthOf(format);
    Bytes r(kCount * length);
    const auto number = [&](const char* name, PointIndex i) {
        const Attribute* a = cloud.findAttribute(name);
        if (a == nullptr) throw std::runtime_error(std::string("no ") + name);
        Attribute raw = *a;
        raw.scaled = false;
        return std::visit([](auto v) { return std::int64_t(v); }, raw.value(i));
    };
    for (std::size_t i = 0; i < kCount; ++i) {
        const std::size_t at = i * length;
        lasfiles::set(r, at, std::int32_t(number("X", i)));
        lasfiles::set(r, at + 4, std::int32_t(number("Y", i)));
        lasfiles::set(r, at + 8, std::int32_t(number("Z", i)));
        lasfiles::set(r, at + 12, std::uint16_t(number("Intensity", i)));
        lasfiles::set(r, at + 14, std::uint8_t(number("ReturnNumber", i) | number("NumberOfReturns", i) << 4));
        lasfiles::set(
            r, at + 15,
            std::uint8_t(number("Synthetic", i) | number("KeyPoint", i) << 1 | number("Withheld", i) << 2 |
                         number("Overlap", i) << 3 | number("ScannerChannel", i) << 4 |
                         number("ScanDirectionFlag", i) << 6 | number("EdgeOfFlightLine", i) << 7));
        lasfiles::set(r, at + 16, std::uint8_t(number("Classification", i)));
        lasfiles::set(r, at + 17, std::uint8_t(number("UserData", i)));
        lasfiles::set(r, at + 18, std::int16_t(number("ScanAngle", i)));
        lasfiles::set(r, at + 20, std::uint16_t(number("PointSourceId", i)));
        std::memcpy(r.data() + at + 22, cloud.findAttribute("GpsTime")->columns[0]->data() + 8 * i, 8);
        if (format >= 7)
            for (std::size_t k = 0; k < 3; ++k) {
                constexpr const char* kNames[] = {"Red", "Green", "Blue"};
                lasfiles::set(r, at + 30 + 2 * k, std::uint16_t(number(kNames[k], i)));
            }
        if (format == 8) lasfiles::set(r, at + 36, std::uint16_t(number("NIR", i)));
    }
    return r;
}

}  // namespace

fs::path LasCompatibleTest::make(int format, bool compressed, const Bytes& records) const
{
    const fs::path file = path(compressed ? "made.laz" : "made.las");
    const std::uint16_t length = lengthOf(format);
    laszip_POINTER laszip = nullptr;
    laszip_create(&laszip);
    laszip_header_struct* header = nullptr;
    lasfiles::check(laszip, laszip_get_header_pointer(laszip, &header));
    header->version_major = 1;
    header->version_minor = 4;
    header->header_size = 375;
    header->offset_to_point_data = 375;
    header->global_encoding = 17;
    header->point_data_format = laszip_U8(format);
    header->point_data_record_length = length;
    header->extended_number_of_point_records = kCount;
    header->x_scale_factor = header->y_scale_factor = header->z_scale_factor = 0.01;
    lasfiles::check(laszip, laszip_request_compatibility_mode(laszip, 1));
    lasfiles::check(laszip, laszip_set_chunk_size(laszip, 700));
    lasfiles::check(laszip, laszip_open_writer(laszip, file.c_str(), compressed ? 1 : 0));
    laszip_point* point = nullptr;
    lasfiles::check(laszip, laszip_get_point_pointer(laszip, &point));
    for (std::size_t i = 0; i < kCount; ++i) {
        lasfiles::setPoint(*point, records.data() + i * length, std::uint8_t(format), length);
        lasfiles::check(laszip, laszip_write_point(laszip));
        lasfiles::check(laszip, laszip_update_inventory(laszip));
    }
    lasfiles::check(laszip, laszip_close_writer(laszip));
    laszip_destroy(laszip);
    return file;
}

void LasCompatibleTest::showsWhatLaszipShows()
{
    QFETCH(int, format);
    QFETCH(bool, compressed);
    const Bytes records = makeRecords(format);
    const fs::path file = make(format, compressed, records);
    QVERIFY(meantByLaszip(file, format) == records);
    const auto cloud = load(file);
    const las::SourceFile& source = *cloud->source();
    QVERIFY(source.layout.compatible.has_value());
    QCOMPARE(int(source.layout.format), format == 6 ? 1 : 3);
    QCOMPARE(int(source.layout.shownFormat()), format);
    QVERIFY(shownBy(*cloud, format) == records);
    QVERIFY(cloud->findAttribute("LAS 1.4 scan angle") == nullptr);
    QVERIFY(cloud->findAttribute("ScanAngle")->scaled);
    QCOMPARE(cloud->findAttribute("Classification")->maxBits(), std::uint64_t(255));
    QVERIFY(std::any_of(source.warnings.begin(), source.warnings.end(),
                        [](const std::string& w) { return w.find("compatibility mode") != std::string::npos; }));
    QVERIFY(!source.recovered);
}

void LasCompatibleTest::savesByteForByte()
{
    QFETCH(int, format);
    QFETCH(bool, compressed);
    const fs::path file = make(format, compressed, makeRecords(format));
    const auto cloud = load(file);
    const fs::path out = path(compressed ? "out.laz" : "out.las");
    save(*cloud, out);
    QVERIFY(lasfiles::readFile(out) == lasfiles::readFile(file));
    save(*cloud, path("other.las"));
    save(*load(path("other.las")), path("other.laz"));
    Progress progress;
    QVERIFY(las::diffFiles(file, path("other.laz"), {}, progress).contentEqual());
}

void LasCompatibleTest::editsGoIntoTheExtraBytes()
{
    QFETCH(int, format);
    QFETCH(bool, compressed);
    Bytes records = makeRecords(format);
    const fs::path file = make(format, compressed, records);
    const auto cloud = load(file);
    // by a step, as users do: a class that the older format could not hold
    Progress progress;
    const Step* step = findStep("reclassify");
    auto command = step->run(
        *cloud,
        completeValues(*step, {{"attribute", "Intensity"}, {"min", "0"}, {"max", "20000"}, {"class", "64"}}),
        progress);
    QVERIFY(command->changedPoints() > 100);
    command->apply(*cloud);
    // and everything else
    const std::uint16_t length = lengthOf(format);
    const auto column = [&](const char* name) { return cloud->findAttribute(name)->columns[0]; };
    column("ReturnNumber")->values<std::uint8_t>()[5] = 12 | 13 << 4;
    column("ReturnNumber")->values<std::uint8_t>()[9] = 3 | 12 << 4;
    column("Withheld")->values<std::uint8_t>()[6] ^= 0xFF;
    column("ScanAngle")->values<std::int16_t>()[7] = -29999;
    column("Intensity")->values<std::uint16_t>()[8] ^= 1;
    for (std::size_t i = 0; i < kCount; ++i)
        if (lasfiles::get<std::uint16_t>(records, i * length + 12) <= 20000)
            records[i * length + 16] = std::byte(64);
    records[5 * length + 14] = std::byte(12 | 13 << 4);
    records[9 * length + 14] = std::byte(3 | 12 << 4);
    records[6 * length + 15] ^= std::byte(0xFF);
    lasfiles::set<std::int16_t>(records, 7 * length + 18, -29999);
    records[8 * length + 12] ^= std::byte(1);

    const fs::path out = path(compressed ? "edited.laz" : "edited.las");
    las::WriteOptions options;
    options.compressed = compressed;
    const las::SavePreview preview = las::previewSave(*cloud, file, out, options, progress);
    save(*cloud, out);
    QVERIFY(meantByLaszip(out, format) == records);
    QVERIFY(shownBy(*load(out), format) == records);
    const las::Difference d = las::diffFiles(file, out, {}, progress);
    std::vector<std::string> names;
    for (const auto& a : d.attributes) names.push_back(a.name);
    for (const char* name : {"Classification", "ReturnNumber", "Withheld", "ScanAngle", "Intensity"})
        QVERIFY2(std::find(names.begin(), names.end(), name) != names.end(), las::report(d, "a", "b").c_str());
    QCOMPARE(preview.difference.differing, d.differing);
    QVERIFY(std::none_of(names.begin(), names.end(), [](const auto& n) { return n.starts_with("LAS 1.4"); }));
    // counts: in the record's copy of the header, too
    const Bytes bytes = lasfiles::readFile(out);
    std::array<std::uint64_t, 16> byReturn{};
    for (std::size_t i = 0; i < kCount; ++i) ++byReturn[std::to_integer<unsigned>(records[i * length + 14]) & 15];
    const auto source = load(out)->source();
    const las::Vlr* record = source->findVlr(las::kCompatibleUser, las::kCompatibleRecordId);
    for (std::size_t k = 1; k < 16; ++k) {
        std::uint64_t n = 0;
        std::memcpy(&n, record->data.data() + 8 + 28 + 8 * (k - 1), 8);
        QCOMPARE(n, byReturn[k]);
    }
}

void LasCompatibleTest::becomesNative()
{
    QFETCH(int, format);
    QFETCH(bool, compressed);
    const Bytes records = makeRecords(format);
    const fs::path file = make(format, compressed, records);
    const fs::path out = path(compressed ? "native.laz" : "native.las");
    save(*load(file), out, std::uint8_t(format));
    const auto native = load(out);
    const las::SourceFile& source = *native->source();
    QCOMPARE(int(source.header.pointFormat()), format);
    QCOMPARE(int(source.header.versionMinor()), 4);
    QCOMPARE(source.layout.length, lengthOf(format));
    QVERIFY(!source.layout.compatible && source.findVlr(las::kCompatibleUser, las::kCompatibleRecordId) == nullptr);
    QVERIFY(lasfiles::recordsByLaszip(out, std::uint8_t(format), lengthOf(format), kCount) == records);
    Progress progress;
    const las::Difference d = las::diffFiles(file, out, {}, progress);
    QVERIFY2(d.attributes.empty() && d.differing == 0, las::report(d, "a", "b").c_str());

    save(*load(file), path("newest.las"), {}, std::uint8_t(5));  // which has no such form
    const auto newest = load(path("newest.las"));
    QCOMPARE(int(newest->source()->header.versionMinor()), 5);
    QVERIFY(!newest->source()->layout.compatible);
    QVERIFY(las::diffFiles(file, path("newest.las"), {}, progress).attributes.empty());
}

void LasCompatibleTest::waveformsAndOtherAttributes()
{
    constexpr std::size_t kPoints = 50;
    for (const int format : {9, 10}) {
        const auto stored = std::uint8_t(format - 5);
        std::vector<std::pair<int, const char*>> fields{{4, "LAS 1.4 scan angle"},
                                                        {1, "LAS 1.4 extended returns"},
                                                        {1, "LAS 1.4 classification"},
                                                        {1, "LAS 1.4 flags and channel"}};
        if (format == 10) fields.emplace_back(3, "LAS 1.4 NIR band");
        fields.emplace_back(1, "Mine");
        Bytes descriptors;
        for (const auto& [type, name] : fields) {
            Bytes d(192);
            d[2] = std::byte(type);
            std::memcpy(d.data() + 4, name, std::strlen(name));
            lasfiles::append(descriptors, d);
        }
        const auto length = std::uint16_t(lengthOf(stored) + (format == 10 ? 8 : 6));
        const fs::path file = path("waves.las"), out = path("native.las");
        lasfiles::writeFile(file, lasfiles::file(lasfiles::header(3, stored, length, kPoints),
                                                 {lasfiles::record("lascompatible", 22204, Bytes(156)),
                                                  lasfiles::record("LASF_Spec", 4, descriptors)},
                                                 lasfiles::randomRecords(stored, length, kPoints, 5)));
        const auto cloud = load(file);
        QVERIFY(cloud->source()->layout.compatible.has_value());
        QCOMPARE(int(cloud->source()->layout.shownFormat()), format);
        QVERIFY(cloud->findAttribute("Mine") != nullptr && cloud->findAttribute("WaveformSize") != nullptr);
        QCOMPARE(cloud->findAttribute("NIR") != nullptr, format == 10);
        save(*cloud, out, std::uint8_t(format));
        const auto native = load(out)->source();
        QVERIFY(!native->layout.compatible);
        QCOMPARE(int(native->layout.format), format);
        QCOMPARE(int(native->layout.length), lengthOf(format) + 1);  // "Mine" is the only one that stays
        Progress progress;
        const las::Difference d = las::diffFiles(file, out, {}, progress);
        QVERIFY2(d.attributes.empty() && d.differing == 0, las::report(d, "a", "b").c_str());
        cloud->removeAttribute("Mine");
        save(*cloud, out, std::uint8_t(format));
        QCOMPARE(load(out)->source()->layout.length, lengthOf(format));
    }
}

void LasCompatibleTest::diffGoesByMeaning()
{
    // the same class in two ways: 8 as 5 + 3 and as 8 + 0
    const Bytes records = makeRecords(6);
    const fs::path file = make(6, false, records);
    const auto source = load(file)->source();
    Bytes bytes = lasfiles::readFile(file);
    const std::size_t first = source->header.pointOffset();
    const auto offset = [&](const char* name) {
        return source->layout.fields[std::size_t(source->layout.find(name))].offset;
    };
    bytes[first + 15] = std::byte(8);
    bytes[first + offset("LAS 1.4 classification")] = std::byte(0);
    lasfiles::writeFile(path("one.las"), bytes);
    bytes[first + 15] = std::byte(5);
    bytes[first + offset("LAS 1.4 classification")] = std::byte(3);
    lasfiles::writeFile(path("two.las"), bytes);
    Progress progress;
    const las::Difference d = las::diffFiles(path("one.las"), path("two.las"), {}, progress);
    QVERIFY(d.contentEqual());
    // and what nobody edits is not put in order
    save(*load(path("two.las")), path("three.las"));
    QVERIFY(lasfiles::readFile(path("three.las")) == bytes);
}

/// Among files of other formats, edited or not, it gets the bytes that it gets alone.
void LasCompatibleTest::keepsItsFormInASurvey()
{
    QFETCH(int, format);
    QFETCH(bool, compressed);
    const fs::path file = make(format, compressed, makeRecords(format));
    const fs::path alone = path("alone" + file.extension().string()), other = path("other.las");
    fs::copy_file(file, alone, fs::copy_options::overwrite_existing);
    const std::uint16_t length = lasfiles::recordLength(3);
    lasfiles::writeFile(other, lasfiles::file(lasfiles::header(lasfiles::minorFor(3), 3, length, kCount), {},
                                              lasfiles::randomRecords(3, length, kCount, 5)));
    Progress progress;
    las::WriteOptions options;
    options.copyChunks = false;
    for (const bool edited : {false, true}) {
        for (const bool single : {true, false}) {
            const auto session =
                Session::open(single ? std::vector{alone} : std::vector{file, other}, {}, progress);
            session->read(progress);
            const fs::path out = path(single ? "out1" : "out2");
            fs::create_directory(out);
            if (edited) {
                auto within = std::make_shared<PointSet>(session->cloud()->size());
                const PointIndex first = session->parts()[0].path == other ? kCount : 0;
                within->insert(PointRange{first, first + kCount});
                session->edit({"set", {{"rule", "Classification = 40 if UserData < 128"}}, within}, progress);
            }
            session->save({.target = single ? out / alone.filename() : out, .options = options, .compare = false},
                          progress);
        }
        QVERIFY(lasfiles::readFile(path("out1") / alone.filename()) ==
                lasfiles::readFile(path("out2") / file.filename()));
    }
}

void LasCompatibleTest::fieldsThatAreNotThere_data()
{
    QTest::addColumn<QString>("how");
    for (const char* how : {"no extra bytes", "renamed", "other type", "another user", "beyond the point"})
        QTest::newRow(how) << how;
}

void LasCompatibleTest::fieldsThatAreNotThere()
{
    QFETCH(QString, how);
    const fs::path file = make(6, false, makeRecords(6));
    const auto source = load(file)->source();
    Bytes bytes = lasfiles::readFile(file);
    std::size_t at = source->header.headerSize(), compatible = 0, extra = 0;
    for (const las::Vlr& vlr : source->vlrs) {
        if (vlr.is(las::kCompatibleUser, las::kCompatibleRecordId)) compatible = at;
        if (vlr.is("LASF_Spec", 4)) extra = at;
        at += vlr.bytesInFile();
    }
    QVERIFY(compatible != 0 && extra != 0);
    if (how == "no extra bytes") bytes[extra + 18] = std::byte(200);
    if (how == "renamed") bytes[extra + 54 + 4] = std::byte('l');
    if (how == "other type") bytes[extra + 54 + 2] = std::byte(3);
    if (how == "another user") bytes[compatible + 2] = std::byte('L');
    if (how == "beyond the point") bytes[extra + 54 + 2] = std::byte(24);  // 3 x int16: the rest does not fit
    lasfiles::writeFile(path("wrong.las"), bytes);
    const auto cloud = load(path("wrong.las"));
    QVERIFY(!cloud->source()->layout.compatible);
    QCOMPARE(cloud->findAttribute("Classification")->maxBits(), std::uint64_t(31));
    if (how != "another user")
        QVERIFY(
            std::any_of(cloud->source()->warnings.begin(), cloud->source()->warnings.end(),
                        [](const std::string& w) { return w.find("compatibility mode") != std::string::npos; }));
    save(*cloud, path("saved.las"));
    QVERIFY(lasfiles::readFile(path("saved.las")) == bytes);
}

QTEST_GUILESS_MAIN(LasCompatibleTest)
#include "LasCompatibleTest.moc"
