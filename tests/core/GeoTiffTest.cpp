// SPDX-License-Identifier: MIT
// GeoTIFF files of maps: the layout of a cloud-optimized file by a plain walk through its directories, values as
// libtiff decodes them, georeference and coordinate system as listgeo and gdalinfo tell them.
#include "MadeCloud.h"
#include "core/Error.h"
#include "core/las/Reader.h"
#include "core/las/SourceFile.h"
#include "core/raster/GeoTiff.h"
#include "core/task/Progress.h"

#include <QDir>
#include <QFile>
#include <QJsonArray>
#include <QJsonDocument>
#include <QJsonObject>
#include <QProcess>
#include <QRegularExpression>
#include <QStandardPaths>
#include <QTemporaryDir>
#include <QTest>

#include <tiffio.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <map>
#include <random>

using namespace punctum;

namespace
{

/// A directory of a TIFF file, read byte by byte.
struct Directory {
    std::uint64_t place = 0;
    std::map<int, std::vector<double>> numbers;
    std::map<int, QByteArray> texts;
    int at(int tag) const { return int(numbers.at(tag).at(0)); }
};

class TiffWalk
{
public:
    explicit TiffWalk(const QString& path)
    {
        QFile file(path);
        if (!file.open(QIODevice::ReadOnly)) return;
        m_bytes = file.readAll();
        big = number<std::uint16_t>(2) == 43;
        std::uint64_t at = big ? number<std::uint64_t>(8) : number<std::uint32_t>(4);
        while (at != 0) at = read(at);
    }

    const QByteArray& bytes() const { return m_bytes; }
    template <typename T>
    T number(std::uint64_t at) const
    {
        T value{};
        if (at + sizeof(T) <= std::uint64_t(m_bytes.size())) std::memcpy(&value, m_bytes.data() + at, sizeof(T));
        return value;
    }

    bool big = false;
    std::vector<Directory> directories;

private:
    std::uint64_t read(std::uint64_t at)
    {
        Directory d;
        d.place = at;
        const std::uint64_t n = big ? number<std::uint64_t>(at) : number<std::uint16_t>(at);
        const std::uint64_t step = big ? 20 : 12, first = at + (big ? 8 : 2);
        for (std::uint64_t e = first; e < first + n * step; e += step) {
            const int tag = number<std::uint16_t>(e), type = number<std::uint16_t>(e + 2);
            const std::uint64_t count = big ? number<std::uint64_t>(e + 4) : number<std::uint32_t>(e + 4);
            const std::map<int, int> sizes{{1, 1}, {2, 1}, {3, 2}, {4, 4}, {12, 8}, {16, 8}};
            const int size = sizes.contains(type) ? sizes.at(type) : 1;
            const std::uint64_t inside = e + (big ? 12 : 8);
            std::uint64_t place = inside;
            if (count * std::uint64_t(size) > (big ? 8u : 4u))
                place = big ? number<std::uint64_t>(inside) : number<std::uint32_t>(inside);
            if (type == 2) d.texts[tag] = m_bytes.mid(qsizetype(place), qsizetype(count));
            for (std::uint64_t k = 0; k < count; ++k, place += std::uint64_t(size))
                d.numbers[tag].push_back(type == 12   ? number<double>(place)
                                         : type == 16 ? double(number<std::uint64_t>(place))
                                         : size == 4  ? number<std::uint32_t>(place)
                                         : size == 2  ? number<std::uint16_t>(place)
                                                      : number<std::uint8_t>(place));
        }
        directories.push_back(d);
        const std::uint64_t next = first + n * step;
        return big ? number<std::uint64_t>(next) : number<std::uint32_t>(next);
    }

    QByteArray m_bytes;
};

Raster wavy(std::size_t columns, std::size_t rows, double cell = 0.5, std::int64_t left = 987654,
            std::int64_t top = 9876543)
{
    Raster raster(RasterFrame{cell, left, top, columns, rows});
    std::mt19937 random(7);
    for (std::size_t r = 0; r < rows; ++r)
        for (std::size_t c = 0; c < columns; ++c)
            if (random() % 10 != 0)
                raster.at(c, r) = float(100 + 20 * std::sin(double(c) / 30) + 10 * std::cos(double(r) / 17));
    return raster;
}

MapCrs utm()
{
    MapCrs crs;
    crs.horizontal = 26910;
    crs.unit = 9001;
    crs.vertical = 5703;
    crs.verticalUnit = 9001;
    crs.name = "NAD83 / UTM zone 10N + NAVD88 height";
    return crs;
}

/// What a program says of the file; empty where it is not there.
QString saysOf(const QString& program, const QStringList& arguments)
{
    const QString path = QStandardPaths::findExecutable(program);
    if (path.isEmpty()) return {};
    QProcess process;
    process.start(path, arguments);
    process.waitForFinished();
    return QString::fromUtf8(process.readAllStandardOutput());
}

}  // namespace

class GeoTiffTest : public QObject
{
    Q_OBJECT

private slots:
    void isLaidOutForTheCloud_data()
    {
        QTest::addColumn<int>("columns");
        QTest::addColumn<int>("rows");
        QTest::addColumn<bool>("bytes");
        QTest::addColumn<bool>("big");
        QTest::addRow("one cell") << 1 << 1 << false << false;
        QTest::addRow("one tile") << 512 << 512 << false << false;
        QTest::addRow("a cell more") << 513 << 512 << false << false;
        QTest::addRow("many") << 2500 << 1300 << false << false;
        QTest::addRow("bytes") << 1500 << 900 << true << false;
        QTest::addRow("big") << 1100 << 1700 << false << true;
        QTest::addRow("big, one tile") << 100 << 17 << true << true;
    }
    void isLaidOutForTheCloud()
    {
        QFETCH(int, columns);
        QFETCH(int, rows);
        QFETCH(bool, bytes);
        QFETCH(bool, big);
        const QString path = m_folder.filePath(QString("%1.tif").arg(QTest::currentDataTag()));
        const Raster raster = wavy(std::size_t(columns), std::size_t(rows));
        GeoTiffOptions options;
        options.sample = bytes ? GeoTiffOptions::Sample::Byte : GeoTiffOptions::Sample::Float;
        if (big) options.big = GeoTiffOptions::Big::Yes;
        Progress progress;
        const std::uint64_t size = writeGeoTiff(path.toStdString(), raster, utm(), options, progress);
        const TiffWalk walk(path);
        QCOMPARE(std::uint64_t(walk.bytes().size()), size);
        QCOMPARE(walk.big, big);
        // the lines that readers look for behind the header
        const qsizetype ghost = big ? 16 : 8;
        QVERIFY(
            walk.bytes().mid(ghost).startsWith("GDAL_STRUCTURAL_METADATA_SIZE=000140 bytes\n"
                                               "LAYOUT=IFDS_BEFORE_DATA\nBLOCK_ORDER=ROW_MAJOR\n"
                                               "BLOCK_LEADER=SIZE_AS_UINT4\n"
                                               "BLOCK_TRAILER=LAST_4_BYTES_REPEATED\n"
                                               "KNOWN_INCOMPATIBLE_EDITION=NO\n "));
        int width = columns, height = rows;
        std::size_t levels = 1;
        for (; width > 512 || height > 512; ++levels) {
            width = (width + 1) / 2;
            height = (height + 1) / 2;
        }
        QCOMPARE(walk.directories.size(), levels);
        QCOMPARE(walk.directories[0].place, std::uint64_t(ghost + 43 + 140 + 1) / 2 * 2);
        width = columns, height = rows;
        double lastPlace = 0, before = 0;
        std::vector<std::pair<double, double>> tiles;  // of all, as they lie in the file
        for (std::size_t l = 0; l < levels; ++l) {
            const Directory& d = walk.directories[l];
            QVERIFY(double(d.place) > lastPlace);  // the whole picture first, then smaller and smaller ones
            lastPlace = double(d.place);
            QCOMPARE(d.at(254), l == 0 ? 0 : 1);
            QCOMPARE(d.at(256), width);
            QCOMPARE(d.at(257), height);
            QCOMPARE(d.at(258), bytes ? 8 : 32);
            QCOMPARE(d.at(259), 8);              // deflate
            QCOMPARE(d.at(317), bytes ? 2 : 3);  // predictor
            QCOMPARE(d.at(322), 512);
            QCOMPARE(d.at(323), 512);
            QCOMPARE(d.at(339), bytes ? 1 : 3);
            QCOMPARE(d.texts.at(42113), QByteArray(bytes ? "0" : "-9999") + '\0');
            QCOMPARE(d.numbers.contains(33922), l == 0);
            const std::size_t count = std::size_t((width + 511) / 512) * std::size_t((height + 511) / 512);
            QCOMPARE(d.numbers.at(324).size(), count);
            QCOMPARE(d.numbers.at(325).size(), count);
            for (std::size_t k = 0; k < count; ++k) {
                const auto at = std::uint64_t(d.numbers.at(324)[k]), n = std::uint64_t(d.numbers.at(325)[k]);
                QVERIFY(at > before || k == 0);
                before = double(at);
                tiles.emplace_back(at, n);
                QCOMPARE(walk.number<std::uint32_t>(at - 4), std::uint32_t(n));
                QCOMPARE(walk.number<std::uint32_t>(at + n), walk.number<std::uint32_t>(at + n - 4));
            }
            width = (width + 1) / 2;
            height = (height + 1) / 2;
        }
        // no gap between tiles, smallest pictures first, all after the directories
        std::sort(tiles.begin(), tiles.end());
        QVERIFY(tiles.front().first > lastPlace);
        QCOMPARE(walk.directories.back().numbers.at(324)[0], tiles.front().first);
        for (std::size_t k = 1; k < tiles.size(); ++k)
            QCOMPARE(tiles[k].first, tiles[k - 1].first + tiles[k - 1].second + 8);
        QCOMPARE(double(size), tiles.back().first + tiles.back().second + 4);
        // where it lies
        const auto& tie = walk.directories[0].numbers.at(33922);
        QCOMPARE(tie, (std::vector<double>{0, 0, 0, 987654 * 0.5, 9876543 * 0.5, 0}));
        QCOMPARE(walk.directories[0].numbers.at(33550), (std::vector<double>{0.5, 0.5, 0}));
        checkValues(path, raster, bytes);
    }

    void listgeoReadsIt()
    {
        const QString path = m_folder.filePath("listgeo.tif");
        Progress progress;
        writeGeoTiff(path.toStdString(), wavy(700, 300, 0.1, 4912345, 48123457), utm(), {}, progress);
        const QString said = saysOf("listgeo", {"-d", path});
        if (said.isEmpty()) QSKIP("There is no listgeo here (package geotiff-bin).");
        QVERIFY2(said.contains("GTRasterTypeGeoKey (Short,1): RasterPixelIsArea"), qPrintable(said));
        QVERIFY2(said.contains("26910") || said.contains("NAD83 / UTM zone 10N"), qPrintable(said));
        QVERIFY2(said.contains("NAVD88") || said.contains("5703"), qPrintable(said));
        QVERIFY2(said.contains("PCS = 26910 (NAD83 / UTM zone 10N)"), qPrintable(said));
        const auto corner = QRegularExpression("Upper Left\\s*\\(\\s*([0-9.]+),\\s*([0-9.]+)\\)").match(said);
        QVERIFY2(corner.hasMatch(), qPrintable(said));
        QVERIFY(std::abs(corner.captured(1).toDouble() - 491234.5) < 1e-4);
        QVERIFY(std::abs(corner.captured(2).toDouble() - 4812345.7) < 1e-4);
        const auto other = QRegularExpression("Lower Right\\s*\\(\\s*([0-9.]+),\\s*([0-9.]+)\\)").match(said);
        QVERIFY(std::abs(other.captured(1).toDouble() - 491304.5) < 1e-4);
        QVERIFY(std::abs(other.captured(2).toDouble() - 4812315.7) < 1e-4);
    }

    void gdalReadsIt()
    {
        const QString path = m_folder.filePath("gdal.tif");
        Progress progress;
        const Raster raster = wavy(1300, 800, 0.25);
        writeGeoTiff(path.toStdString(), raster, utm(), {}, progress);
        const QString said = saysOf("gdalinfo", {"-json", "-stats", "--config", "GDAL_PAM_ENABLED", "NO", path});
        if (said.isEmpty()) QSKIP("There is no gdalinfo here (package gdal-bin).");
        const QJsonObject info = QJsonDocument::fromJson(said.toUtf8()).object();
        const QJsonArray place = info["geoTransform"].toArray();
        QCOMPARE(place[0].toDouble(), 987654 * 0.25);
        QCOMPARE(place[1].toDouble(), 0.25);
        QCOMPARE(place[3].toDouble(), 9876543 * 0.25);
        QCOMPARE(place[5].toDouble(), -0.25);
        const QJsonObject band = info["bands"].toArray()[0].toObject();
        QCOMPARE(band["noDataValue"].toDouble(), -9999.0);
        QCOMPARE(band["overviews"].toArray().size(), 2);
        QVERIFY(said.contains("LAYOUT") && said.contains("COG"));
        QVERIFY(said.contains("26910") && said.contains("5703"));
        float least = INFINITY, most = -INFINITY;
        for (const float v : raster.values())
            if (!std::isnan(v)) least = std::min(least, v), most = std::max(most, v);
        QVERIFY(std::abs(band["minimum"].toDouble() - double(least)) < 1e-3);
        QVERIFY(std::abs(band["maximum"].toDouble() - double(most)) < 1e-3);
    }

    void realFilesKeepTheirSystem_data()
    {
        QTest::addColumn<QString>("file");
        QTest::addColumn<int>("code");
        QTest::addColumn<int>("vertical");
        QTest::addRow("keys of its own") << "autzen_trim.las" << 0 << 0;
        QTest::addRow("keys, degrees") << "epsg_4326.las" << 4326 << 0;
        QTest::addRow("a foot") << "cases/epsg2926-no-unit-key.las" << 2926 << 0;
        QTest::addRow("WKT") << "autzen_trim_7.las" << 0 << 0;
    }
    void realFilesKeepTheirSystem()
    {
        QFETCH(QString, file);
        const QString path = QStringLiteral(PUNCTUM_TEST_DATA "/") + file;
        if (!QFile::exists(path)) QSKIP(qPrintable(path + " is not there."));
        Progress progress;
        const auto cloud = las::load(path.toStdString(), progress);
        const MapCrs crs = mapCrs(*cloud);
        QTEST(int(crs.horizontal), "code");
        QTEST(int(crs.vertical), "vertical");
        const QString tif = m_folder.filePath("real.tif");
        writeGeoTiff(tif.toStdString(), wavy(20, 20, 1.0, 10, 10), crs, {}, progress);
        TiffWalk walk(tif);
        const auto& keys = walk.directories[0].numbers.at(34735);
        QFETCH(int, code);
        bool found = false;
        for (std::size_t k = 4; k + 3 < keys.size(); k += 4)
            found |=
                (int(keys[k]) == 3072 || int(keys[k]) == 2048) && int(keys[k + 3]) == (code != 0 ? code : 32767);
        QVERIFY(found);
        const QByteArray text = walk.directories[0].texts[34737];
        if (code == 0) QVERIFY2(text.contains("NAD_1983_HARN_Lambert_Conformal_Conic"), text);
    }

    void noSystemAndOwnSystems()
    {
        Progress progress;
        const QString path = m_folder.filePath("none.tif");
        writeGeoTiff(path.toStdString(), wavy(5, 5), {}, {}, progress);
        QVERIFY(TiffWalk(path).directories[0].numbers.contains(34735));  // PixelIsArea
        MapCrs own;
        own.name = "Site grid | of 2026";
        own.wkt =
            "PROJCS[\"Site\",GEOGCS[\"GCS_WGS_1984\",DATUM[\"D_WGS_1984\",SPHEROID[\"WGS_1984\",6378137.0,"
            "298.257223563]],PRIMEM[\"Greenwich\",0.0],UNIT[\"Degree\",0.0174532925199433]],"
            "PROJECTION[\"Transverse_Mercator\"],UNIT[\"Meter\",1.0]]";
        own.unit = 9001;
        writeGeoTiff(path.toStdString(), wavy(5, 5), own, {}, progress);
        const QByteArray text = TiffWalk(path).directories[0].texts.at(34737);
        QVERIFY2(text.contains("Site grid   of 2026|") && text.contains("ESRI PE String = PROJCS[\"Site\""), text);
    }

    void allOrNothing()
    {
        const QString path = m_folder.filePath("kept.tif");
        QFile file(path);
        QVERIFY(file.open(QIODevice::WriteOnly));
        file.write("what was there");
        file.close();
        Progress progress;
        progress.cancel();
        bool cancelled = false;
        try {
            writeGeoTiff(path.toStdString(), wavy(900, 900), utm(), {}, progress);
        } catch (const Cancelled&) {
            cancelled = true;
        }
        QVERIFY(cancelled);
        QVERIFY(file.open(QIODevice::ReadOnly));
        QCOMPARE(file.readAll(), QByteArray("what was there"));
        QCOMPARE(QDir(m_folder.path()).entryList({"*kept*"}, QDir::Files | QDir::Hidden).size(), 1);
        Progress fresh;
        QVERIFY_THROWS_EXCEPTION(Error, writeGeoTiff("/nowhere/at/all.tif", wavy(9, 9), utm(), {}, fresh));
    }

private:
    /// All cells, and those of the smaller pictures, as libtiff decodes them.
    void checkValues(const QString& path, const Raster& raster, bool bytes)
    {
        TIFF* const tiff = TIFFOpen(qPrintable(path), "r");
        QVERIFY(tiff != nullptr);
        Raster level = raster;
        do {
            std::uint32_t columns = 0, rows = 0;
            TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &columns);
            TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &rows);
            QCOMPARE(std::size_t(columns), level.columns());
            QCOMPARE(std::size_t(rows), level.rows());
            std::vector<std::byte> tile(std::size_t(TIFFTileSize(tiff)));
            for (std::uint32_t y = 0; y < rows; y += 512)
                for (std::uint32_t x = 0; x < columns; x += 512) {
                    QVERIFY(TIFFReadTile(tiff, tile.data(), x, y, 0, 0) > 0);
                    for (std::uint32_t r = y; r < std::min(rows, y + 512); ++r)
                        for (std::uint32_t c = x; c < std::min(columns, x + 512); ++c) {
                            const std::size_t k = (r - y) * 512 + (c - x);
                            const float wanted = level.at(c, r);
                            float value = 0;
                            if (bytes)
                                value = float(std::to_integer<int>(tile[k]));
                            else
                                std::memcpy(&value, &tile[k * 4], 4);
                            const float none = bytes ? 0.0f : -9999.0f;
                            if (std::isnan(wanted)) {
                                QCOMPARE(value, none);
                            } else {
                                QVERIFY(value == (bytes ? std::round(wanted) : wanted));
                            }
                        }
                }
            // the next one: means of four
            RasterFrame frame = level.frame();
            frame.columns = (frame.columns + 1) / 2;
            frame.rows = (frame.rows + 1) / 2;
            Raster half(frame);
            for (std::size_t r = 0; r < half.rows(); ++r)
                for (std::size_t c = 0; c < half.columns(); ++c) {
                    double sum = 0;
                    int n = 0;
                    for (std::size_t k = 0; k < 4; ++k)
                        if (2 * r + k / 2 < level.rows() && 2 * c + k % 2 < level.columns() &&
                            !std::isnan(level.at(2 * c + k % 2, 2 * r + k / 2))) {
                            sum += double(level.at(2 * c + k % 2, 2 * r + k / 2));
                            ++n;
                        }
                    if (n > 0) half.at(c, r) = float(sum / n);
                }
            level = half;
        } while (TIFFReadDirectory(tiff) != 0);
        TIFFClose(tiff);
    }

    QTemporaryDir m_folder;
};

QTEST_APPLESS_MAIN(GeoTiffTest)
#include "GeoTiffTest.moc"
