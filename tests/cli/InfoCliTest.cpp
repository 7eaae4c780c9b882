// SPDX-License-Identifier: MIT
// punctum info on every real file: counts, attributes and ranges against LASzip's own reading.
#include "tests/cli/LaszipPoints.h"
#include "tests/cli/Program.h"

#include <QJsonArray>
#include <QTemporaryDir>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <limits>
#include <map>

using namespace punctum::test;

namespace
{

struct Range {
    double min = std::numeric_limits<double>::infinity();
    double max = -std::numeric_limits<double>::infinity();
    double sum = 0;

    void include(double value)
    {
        min = std::min(min, value);
        max = std::max(max, value);
        sum += value;
    }
};

bool near(double a, double b, double relative)
{
    return std::abs(a - b) <= relative * (1.0 + std::abs(b));
}

/// Name, type code and options of the extra bytes that a file of VLRs describes (LAS 1.4 R15, table 24).
struct Extra {
    QString name;
    int type = 0;
    int options = 0;

    /// Bytes of a point (LAS 1.4 R15, table 24): type 0 says how many in its options, 11 to 30 are vectors.
    int bytes() const
    {
        constexpr int kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
        return type == 0 ? options : kSizes[(type - 1) % 10] * ((type - 1) / 10 + 1);
    }
};

std::vector<Extra> extraBytes(const QString& path)
{
    const QByteArray file = contentOf(path);
    const auto u16 = [&](qsizetype at) { return quint16(quint8(file[at]) | quint8(file[at + 1]) << 8); };
    std::vector<Extra> all;
    qsizetype at = u16(94);
    const int count = u16(100);
    for (int k = 0; k < count && at + 54 <= file.size(); ++k) {
        const qsizetype length = u16(at + 20);
        if (qstrncmp(file.constData() + at + 2, "LASF_Spec", 16) == 0 && u16(at + 18) == 4)
            for (qsizetype d = at + 54; d + 192 <= at + 54 + length; d += 192) {
                const QByteArray name = file.mid(d + 4, 32);
                all.push_back({QString::fromUtf8(name.left(qstrnlen(name.constData(), 32))), quint8(file[d + 2]),
                               quint8(file[d + 3])});
            }
        at += 54 + length;
    }
    return all;
}

}  // namespace

/// A LAS 1.2 file of format 0 with one point, changed before it is written.
static void writeOnePoint(const QString& path, const std::function<void(QByteArray&)>& change)
{
    QByteArray b(227 + 20, '\0');
    const auto put = [&](int at, auto value) { std::memcpy(b.data() + at, &value, sizeof value); };
    std::memcpy(b.data(), "LASF\0\0\0\0", 8);
    put(24, quint8(1));
    put(25, quint8(2));
    put(90, quint16(100));
    put(92, quint16(2020));
    put(94, quint16(227));
    put(96, quint32(227));
    put(105, quint16(20));
    put(107, quint32(1));
    put(111, quint32(1));
    for (int k = 0; k < 3; ++k) put(131 + 8 * k, 0.01);
    put(227 + 14, quint8(1 | 1 << 3));
    change(b);
    QFile file(path);
    QVERIFY(file.open(QIODevice::WriteOnly) && file.write(b) == b.size());
}

class InfoCliTest : public QObject
{
    Q_OBJECT

private slots:
    void tellsWhatLaszipReads_data()
    {
        QTest::addColumn<QString>("path");
        for (const QString& name : realFiles())
            if (!name.startsWith("broken_")) QTest::newRow(qPrintable(name)) << realFile(name);
        if (realFiles().isEmpty()) QTest::newRow("autzen_trim.laz and the others") << QString();
    }
    void tellsWhatLaszipReads()
    {
        QFETCH(QString, path);
        if (path.isEmpty()) QSKIP("There is no folder of real files here.");
        const LaszipFile file(path);
        QVERIFY(file.good());
        std::vector<std::string> names = namesOf(file.format());
        std::vector<Range> found(names.size());
        std::vector<double> values;
        std::map<QString, quint64> classes, returns, pulses, flags;
        const bool extended = file.format() >= 6;
        const std::uint64_t count = file.forEach([&](const laszip_point_struct& p) {
            ++classes[QString::number(extended ? p.extended_classification : p.classification)];
            ++returns[QString::number(extended ? p.extended_return_number : p.return_number)];
            ++pulses[QString::number(extended ? p.extended_number_of_returns : p.number_of_returns)];
            const unsigned bits = extended
                                      ? p.extended_classification_flags
                                      : unsigned(p.synthetic_flag | p.keypoint_flag << 1 | p.withheld_flag << 2);
            flags["Synthetic"] += bits & 1;
            flags["KeyPoint"] += bits >> 1 & 1;
            flags["Withheld"] += bits >> 2 & 1;
            flags["Overlap"] += bits >> 3 & 1;
            flags["ScanDirectionFlag"] += p.scan_direction_flag;
            flags["EdgeOfFlightLine"] += p.edge_of_flight_line;
            valuesOf(p, file, values);
            for (std::size_t k = 0; k < values.size(); ++k) found[k].include(values[k]);
        });
        std::map<std::string, Range> ranges;
        for (std::size_t k = 0; k < names.size(); ++k) ranges[names[k]] = found[k];
        QVERIFY(count > 0);

        const Outcome run = runPunctum({"info", "--json", path});
        PUNCTUM_EXIT(run, 0);
        const QJsonObject info = run.json().object();
        QCOMPARE(info["file"].toString(), path);
        QCOMPARE(quint64(info["points"].toDouble()), quint64(count));
        QCOMPARE(info["las_version"].toString(), "1." + QString::number(file.version()));
        QCOMPARE(info["point_format"].toInt(), file.format());
        QCOMPARE(info["record_length"].toInt(), file.recordLength());
        QCOMPARE(info["compressed"].toBool(), path.endsWith(".laz"));
        for (int axis = 0; axis < 3; ++axis) {
            QCOMPARE(info["scale"][axis].toDouble(), file.scale(axis));
            QCOMPARE(info["offset"][axis].toDouble(), file.offset(axis));
            const Range& range = ranges[std::string(1, "XYZ"[axis])];
            QVERIFY(near(info["min"][axis].toDouble(), range.min, 1e-12));
            QVERIFY(near(info["max"][axis].toDouble(), range.max, 1e-12));
        }
        const QJsonArray vlrs = info["vlrs"].toArray();
        const auto plain = std::count_if(vlrs.begin(), vlrs.end(),
                                         [](const auto& v) { return !v.toObject()["extended"].toBool(); });
        QCOMPARE(quint32(plain), file.records());
        QVERIFY(info["warnings"].isArray());
        const auto counted = [](const QJsonValue& json) {
            std::map<QString, quint64> counts;
            const QJsonObject object = json.toObject();
            for (auto it = object.begin(); it != object.end(); ++it) counts[it.key()] = quint64(it->toDouble());
            return counts;
        };
        QVERIFY(counted(info["classes"]) == classes);
        QVERIFY(counted(info["returns"]) == returns);
        QVERIFY(counted(info["number_of_returns"]) == pulses);
        QVERIFY(counted(info["flags"]) == flags);
        if (ranges.contains("GpsTime")) {
            QCOMPARE(info["gps_time"][0].toDouble(), ranges["GpsTime"].min);
            QCOMPARE(info["gps_time"][1].toDouble(), ranges["GpsTime"].max);
        } else {
            QVERIFY(info["gps_time"].isNull());
        }
        for (const char* key :
             {"density", "spacing", "guid", "software", "created", "doctor", "recovered", "losses"})
            QVERIFY2(info.contains(key), key);
        for (const auto& entry : info["doctor"].toArray())
            QVERIFY(entry.toObject()["fault"].toString().endsWith('.') &&
                    entry.toObject()["mend"].toString().endsWith('.'));

        std::vector<std::string> listed;
        for (const auto& entry : info["attributes"].toArray()) {
            const QJsonObject attribute = entry.toObject();
            const std::string name = attribute["name"].toString().toStdString();
            if (attribute["standard"].toBool() && name != "RGB") listed.push_back(name);
            if (!ranges.contains(name) || !attribute["standard"].toBool()) continue;
            const Range& range = ranges[name];
            QCOMPARE(attribute["components"].toInt(), 1);
            // Numbers of 32 bits are told by as many digits as tell them apart.
            const double digits = attribute["type"].toString() == "float32" ? 1e-7 : 1e-12;
            QVERIFY2(near(attribute["min"].toDouble(), range.min, digits), name.c_str());
            QVERIFY2(near(attribute["max"].toDouble(), range.max, digits), name.c_str());
            QVERIFY2(near(attribute["mean"].toDouble(), range.sum / double(count), 1e-9), name.c_str());
        }
        std::sort(names.begin(), names.end());
        std::sort(listed.begin(), listed.end());
        QCOMPARE(listed, names);
    }

    void namesDescribedExtraBytes_data()
    {
        QTest::addColumn<QString>("path");
        for (const char* name : {"extrabytes.las", "extra.laz", "lion_takanawa.copc.laz"})
            QTest::newRow(name) << realFile(name);
    }
    void namesDescribedExtraBytes()
    {
        QFETCH(QString, path);
        if (!QFile::exists(path)) QSKIP("The file is not here.");
        const auto described = extraBytes(path);
        QVERIFY(!described.empty());
        const Outcome run = runPunctum({"info", "--json", path});
        PUNCTUM_EXIT(run, 0);
        std::map<QString, QJsonObject> extra;
        for (const auto& entry : run.json()["attributes"].toArray())
            if (!entry.toObject()["standard"].toBool())
                extra[entry.toObject()["name"].toString()] = entry.toObject();
        const char* types[] = {"uint8", "int8",   "uint16", "int16",   "uint32",
                               "int32", "uint64", "int64",  "float32", "float64"};
        for (const Extra& e : described) {
            if (e.type < 1 || e.type > 10) continue;
            // a name the format has already gets a remark behind it
            const auto found = extra.contains(e.name) ? e.name : e.name + " (extra)";
            QVERIFY2(extra.contains(found), qPrintable(e.name));
            QCOMPARE(extra[found]["type"].toString(), QString(types[e.type - 1]));
            QVERIFY(!extra[found]["min"].isUndefined());
        }
    }

    void tellsTheOctreeOfCopc()
    {
        const QString path = realFile("lion_takanawa.copc.laz");
        if (!QFile::exists(path)) QSKIP("The file is not here.");
        const Outcome run = runPunctum({"info", "--json", path});
        PUNCTUM_EXIT(run, 0);
        const QJsonObject octree = run.json()["copc"].toObject();
        QCOMPARE(octree["nodes"].toInt(), 9);
        QCOMPARE(octree["levels"].toInt(), 2);
        QCOMPARE(octree["points_by_level"].toArray(), QJsonArray({35903, 306086}));
        QVERIFY(std::abs(octree["spacing"].toDouble() - 0.038673) < 1e-6);
        QCOMPARE(octree["half_size"].toDouble(), 2.8425);
        const Outcome text = runPunctum({"info", path});
        QVERIFY2(text.out.contains("9 nodes on 2 levels, spacing 0.03867 on the first"), text.out);
        QVERIFY(runPunctum({"info", "--json", realFile("extra.laz")}).json()["copc"].isNull());
    }

    void keepsIntegersOf64Bits()
    {
        // 2^53 + 1 and 2^64 - 1 have no double of their own: JSON must have their digits
        const QString path = realFile("extrabytes.las");
        if (!QFile::exists(path)) QSKIP("extrabytes.las is not here.");
        QTemporaryDir folder;
        QByteArray bytes = contentOf(path);
        std::uint32_t pointOffset = 0;
        std::memcpy(&pointOffset, bytes.constData() + 96, 4);
        int recordLength = 0;
        std::memcpy(&recordLength, bytes.constData() + 105, 2);
        constexpr int kStandard[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
        int place = kStandard[quint8(bytes[104]) & 0x3F];
        bool there = false;
        for (const Extra& e : extraBytes(path)) {
            there = e.type == 7;  // uint64
            if (there) break;
            place += e.bytes();
        }
        QVERIFY(there && place + 8 <= recordLength);
        const quint64 values[] = {(quint64(1) << 53) + 1, ~quint64(0)};
        const qsizetype points = (bytes.size() - pointOffset) / recordLength;
        for (qsizetype k = 0; k < points; ++k)
            std::memcpy(bytes.data() + pointOffset + k * recordLength + place, &values[k % 2], 8);
        QFile changed(folder.filePath("wide.las"));
        QVERIFY(changed.open(QIODevice::WriteOnly) && changed.write(bytes) == bytes.size());
        changed.close();
        const Outcome run = runPunctum({"info", "--json", changed.fileName()});
        PUNCTUM_EXIT(run, 0);
        QVERIFY2(run.out.contains("\"min\": 9007199254740993"), run.out);
        QVERIFY2(run.out.contains("\"max\": 18446744073709551615"), run.out);
    }

    void refusesBrokenFiles_data()
    {
        QTest::addColumn<QString>("path");
        for (const char* name : {"broken_type.laz", "broken_version.laz"}) QTest::newRow(name) << realFile(name);
    }
    void refusesBrokenFiles()
    {
        QFETCH(QString, path);
        if (!QFile::exists(path)) QSKIP("The file is not here.");
        for (const QStringList& arguments : {QStringList{"info", path}, QStringList{"info", "--json", path}}) {
            const Outcome run = runPunctum(arguments);
            PUNCTUM_EXIT(run, 1);
            QVERIFY2(run.oneSentence(), run.said());
            QVERIFY(run.err.contains(QFileInfo(path).fileName()));
            QVERIFY(run.out.isEmpty());
        }
    }

    void givesAnArrayForSeveralFiles()
    {
        QTemporaryDir folder;
        PUNCTUM_EXIT(runPunctum({"sample", folder.filePath("a.las"), "--points", "1000"}), 0);
        PUNCTUM_EXIT(runPunctum({"sample", folder.filePath("b.laz"), "--points", "2000"}), 0);
        Outcome run = runPunctum({"info", "--json", "a.las", "b.laz"}, folder.path());
        PUNCTUM_EXIT(run, 0);
        QVERIFY(run.json().isArray());
        QCOMPARE(run.json()[0]["points"].toInt(), 1000);
        QCOMPARE(run.json()[1]["file"].toString(), QString("b.laz"));

        // one that cannot be read does not hide the other
        run = runPunctum({"info", "--json", "a.las", "missing.las", "b.laz"}, folder.path());
        PUNCTUM_EXIT(run, 1);
        QVERIFY(run.oneSentence());
        QCOMPARE(run.json().array().size(), 2);
    }

    void valuesAreExact_data()
    {
        QTest::addColumn<double>("scale");
        QTest::addColumn<double>("offset");
        QTest::addColumn<int>("raw");
        QTest::addColumn<QByteArray>("text");
        QTest::addColumn<QByteArray>("json");
        QTest::newRow("a quarter") << 0.25 << 0.0 << 3 << QByteArray("0.75") << QByteArray("0.75");
        QTest::newRow("0.00025") << 0.00025 << 0.0 << 1234567 << QByteArray("308.64175") << QByteArray("308.64175");
        QTest::newRow("finer offset") << 1.0 << 0.125 << 7 << QByteArray("7.125") << QByteArray("7.125");
        QTest::newRow("no noise") << 0.01 << 0.0 << 84914820 << QByteArray("849148.20") << QByteArray("849148.2,");
    }
    void valuesAreExact()
    {
        QFETCH(double, scale);
        QFETCH(double, offset);
        QFETCH(int, raw);
        QFETCH(QByteArray, text);
        QFETCH(QByteArray, json);
        QTemporaryDir folder;
        const QString path = folder.filePath("a.las");
        writeOnePoint(path, [&](QByteArray& b) {
            std::memcpy(b.data() + 131, &scale, 8);
            std::memcpy(b.data() + 155, &offset, 8);
            std::memcpy(b.data() + 227, &raw, 4);
        });
        Outcome run = runPunctum({"info", path});
        PUNCTUM_EXIT(run, 0);
        QVERIFY2(run.out.contains(" " + text + " "), run.out);
        run = runPunctum({"info", "--json", path});
        PUNCTUM_EXIT(run, 0);
        QVERIFY2(run.out.contains(json), run.out);
        // what is listed finds the point
        PUNCTUM_EXIT(runPunctum({"extract", path, "-o", folder.filePath("b.las"), "--where", "X == " + text}), 0);
    }

    void emptyCloudsHaveNoFigures()
    {
        QTemporaryDir folder;
        const QString path = folder.filePath("a.las");
        writeOnePoint(path, [](QByteArray& b) {
            b.resize(227);
            std::memset(b.data() + 107, 0, 4);
        });
        const Outcome run = runPunctum({"info", path});
        PUNCTUM_EXIT(run, 0);
        for (const char* odd : {"inf", "nan", "-0"}) QVERIFY2(!run.out.contains(QByteArray(" ") + odd), run.out);
        QVERIFY2(run.out.contains("The file has no points."), run.out);
    }

    void nothingRawReachesTheTerminal()
    {
        QTemporaryDir folder;
        const QString path = folder.filePath("a.las");
        writeOnePoint(path, [](QByteArray& b) {
            QByteArray record(54, '\0');
            record.replace(2, 8, "\x1b[31mred");
            record.replace(18, 2, QByteArray("\x07\x00", 2));
            record.replace(22, 6, "\x1b]0;x\x07");
            std::memcpy(b.data() + 58, "\x1b[2Jsoft", 8);
            b.insert(227, record);
            const quint32 offset = 227 + 54, records = 1;
            std::memcpy(b.data() + 96, &offset, 4);
            std::memcpy(b.data() + 100, &records, 4);
        });
        for (const QStringList& arguments : {QStringList{"info", path}, QStringList{"info", "--json", path}}) {
            const Outcome run = runPunctum(arguments);
            PUNCTUM_EXIT(run, 0);
            for (const char c : run.out) QVERIFY2(quint8(c) >= 0x20 || c == '\n', run.out);
            QVERIFY2(run.out.contains("[31mred"), run.out);
        }
    }

    void repairsWhatCanBe()
    {
        QTemporaryDir folder;
        const QString path = folder.filePath("a.las"), mended = folder.filePath("b.las");
        PUNCTUM_EXIT(runPunctum({"sample", path, "--points", "5000"}), 0);
        // a sound file: nothing is written
        Outcome run = runPunctum({"repair", path, "-o", mended});
        PUNCTUM_EXIT(run, 0);
        QVERIFY2(run.out.contains("nothing to mend without guessing") && !QFile::exists(mended), run.out);
        const QByteArray sound = contentOf(path);
        QByteArray damaged = sound;
        std::memset(damaged.data() + 179, 0xFF, 48);  // the box
        std::memset(damaged.data() + 255, 0, 40);     // points by return
        QFile file(path);
        QVERIFY(file.open(QIODevice::WriteOnly) && file.write(damaged) == damaged.size());
        file.close();
        run = runPunctum({"repair", path, "-o", mended, "--json"});
        PUNCTUM_EXIT(run, 0);
        QCOMPARE(run.json()["mended"].toArray().size(), 2);
        QCOMPARE(run.json()["file"].toString(), mended);
        QVERIFY(contentOf(mended) == sound);
        QVERIFY(contentOf(path) == damaged);
        run = runPunctum({"repair", path, "-o", path});
        PUNCTUM_EXIT(run, 1);
        QVERIFY(run.oneSentence());
        PUNCTUM_EXIT(runPunctum({"repair", path}), 2);
    }

    void printsText()
    {
        QTemporaryDir folder;
        PUNCTUM_EXIT(runPunctum({"sample", folder.filePath("a.las"), "--points", "12345"}), 0);
        const Outcome run = runPunctum({"info", folder.filePath("a.las")});
        PUNCTUM_EXIT(run, 0);
        for (const char* part : {"12,345", "LAS 1.4, point format 7", "Classification", "GpsTime", "Reflectance"})
            QVERIFY2(run.out.contains(part), part);
    }
};

QTEST_GUILESS_MAIN(InfoCliTest)
#include "InfoCliTest.moc"
