// SPDX-License-Identifier: MIT
#include "MadeSurvey.h"

#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"

#include <QDir>
#include <QFile>
#include <QTemporaryDir>
#include <QtEndian>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <filesystem>

namespace punctum::ui::test
{

namespace
{

constexpr double kScale = 0.01;
constexpr double kWest = 636001.76, kEast = 637179.22, kSouth = 848935.20, kNorth = 849497.90;
constexpr double kLow = 406.26, kHigh = 520.51;
constexpr int kHeader = 227, kRecord = 34;

/// The file's bytes, written down by the specification (LAS 1.2, point format 3), so that nothing of what is tested
/// has made them.
class Bytes
{
public:
    explicit Bytes(qsizetype size) : m_bytes(size, '\0') {}
    template <typename T>
    void put(qsizetype at, T value)
    {
        qToLittleEndian(value, m_bytes.data() + at);
    }
    void put(qsizetype at, double value) { put(at, std::bit_cast<std::uint64_t>(value)); }
    void text(qsizetype at, const char* value)
    {
        std::copy_n(value, std::char_traits<char>::length(value), m_bytes.data() + at);
    }
    const QByteArray& all() const { return m_bytes; }

private:
    QByteArray m_bytes;
};

std::uint32_t mixed(std::uint32_t x)
{
    x ^= x >> 16;
    x *= 0x7feb352du;
    x ^= x >> 15;
    x *= 0x846ca68bu;
    return x ^ (x >> 16);
}

/// 0 to 1, another one for each kind of use.
double chance(std::uint32_t point, std::uint32_t use)
{
    return mixed(point * 31u + use * 0x9e3779b9u) / 4294967296.0;
}

struct Place {
    double x, y, z;
    bool ground;
};

/// Rows from south to north; hills, and trees and houses on them.
Place placeOf(std::uint32_t i, std::uint32_t points)
{
    const double rows = std::max(1.0, std::floor(std::sqrt(points * (kNorth - kSouth) / (kEast - kWest))));
    const double inRow = std::max(2.0, std::ceil(points / rows));
    const double u = (std::fmod(i, inRow) + chance(i, 1) * 0.8) / inRow;
    const double v = (std::floor(i / inRow) + chance(i, 2) * 0.8) / rows;
    const double land = 410.0 + 13.0 * (0.5 + 0.5 * std::sin(u * 7.0 + 1.0) * std::cos(v * 4.0));
    const double kind = chance(i, 3);
    const double above = kind < 0.24 ? 0.0 : kind < 0.7 ? 3.0 * chance(i, 4) : 60.0 * std::pow(chance(i, 5), 2.0);
    return {kWest + u * (kEast - kWest), kSouth + v * (kNorth - kSouth), std::clamp(land + above, kLow, kHigh),
            kind < 0.24};
}

QByteArray surveyBytes(std::uint32_t points, double east)
{
    Bytes las(kHeader + qsizetype(points) * kRecord);
    std::array<double, 3> least{1e9, 1e9, 1e9}, most{-1e9, -1e9, -1e9};
    std::array<std::uint32_t, 5> byReturn{};
    for (std::uint32_t i = 0; i < points; ++i) {
        Place place = placeOf(i, points);
        // the corners, so that the box is always the same
        if (i == 0) place = {kWest, kSouth, kLow, true};
        if (i + 1 == points) place = {kEast, kNorth, kHigh, false};
        const std::array<double, 3> world{place.x + east, place.y, place.z};
        const qsizetype at = kHeader + qsizetype(i) * kRecord;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto raw = std::int32_t(std::lround(world[axis] / kScale));
            las.put(at + 4 * qsizetype(axis), raw);
            least[axis] = std::min(least[axis], raw * kScale);
            most[axis] = std::max(most[axis], raw * kScale);
        }
        const bool second = !place.ground && chance(i, 6) < 0.14;
        ++byReturn[second ? 1 : 0];
        las.put(at + 12, std::uint16_t(chance(i, 7) * 255));
        las.put(at + 14, std::uint8_t((second ? 2 : 1) | (second ? 2 : 1) << 3 | (i / 500 % 2) << 6));
        las.put(at + 15, std::uint8_t(place.ground ? 2 : 1));
        las.put(at + 16, std::int8_t(-1 - int(chance(i, 8) * 17)));
        las.put(at + 17, std::uint8_t(117 + chance(i, 9) * 18));
        las.put(at + 18, std::uint16_t(7326));
        las.put(at + 20, 245379.4 + i * 6e-5);
        for (int c = 0; c < 3; ++c)
            las.put(at + 28 + 2 * c, std::uint16_t(std::clamp(
                                         60 + 20 * c + (place.z - kLow) * 1.2 + 40 * chance(i, 10), 40.0, 236.0)));
    }
    las.text(0, "LASF");
    las.put(24, std::uint8_t(1));
    las.put(25, std::uint8_t(2));
    las.text(26, "MADE FOR TESTS");
    las.text(58, "punctum tests");
    las.put(90, std::uint16_t(1));
    las.put(92, std::uint16_t(2010));
    las.put(94, std::uint16_t(kHeader));
    las.put(96, std::uint32_t(kHeader));
    las.put(104, std::uint8_t(3));
    las.put(105, std::uint16_t(kRecord));
    las.put(107, points);
    for (std::size_t k = 0; k < byReturn.size(); ++k) las.put(111 + 4 * qsizetype(k), byReturn[k]);
    for (std::size_t axis = 0; axis < 3; ++axis) {
        las.put(131 + 8 * qsizetype(axis), kScale);
        las.put(179 + 16 * qsizetype(axis), most[axis]);
        las.put(187 + 16 * qsizetype(axis), least[axis]);
    }
    return las.all();
}

}  // namespace

void writeSurvey(const QString& path, std::uint32_t points, double east)
{
    const bool compressed = las::isCompressedName(toPath(path));
    QFile file(compressed ? path + QStringLiteral(".las") : path);
    if (!file.open(QIODevice::WriteOnly)) return;
    file.write(surveyBytes(points, east));
    file.close();
    if (!compressed) return;
    Progress progress;
    las::WriteOptions options;
    options.compressed = true;
    options.verify = false;
    las::write(*las::load(toPath(file.fileName()), progress), toPath(path), options, progress);
    file.remove();
}

QString surveyFile()
{
    static const QTemporaryDir folder;
    const QString path = folder.filePath(kSurvey);
    if (!QFile::exists(path)) writeSurvey(path, 110'000);
    return path;
}

}  // namespace punctum::ui::test
