// SPDX-License-Identifier: MIT
#include "tests/cli/LaszipPoints.h"

#include <QFile>

namespace punctum::test
{

namespace
{

template <typename T>
T at(const QByteArray& bytes, int offset)
{
    T value{};
    if (offset + int(sizeof(T)) <= bytes.size()) std::memcpy(&value, bytes.constData() + offset, sizeof value);
    return value;
}

bool hasTime(int format)
{
    return format == 1 || format >= 3;
}
bool hasColor(int format)
{
    return format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
}
bool hasNir(int format)
{
    return format == 8 || format == 10;
}
bool hasWave(int format)
{
    return format == 4 || format == 5 || format == 9 || format == 10;
}

template <typename T>
void append(std::string& bytes, const T& value)
{
    bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

LaszipFile::LaszipFile(const QString& path) : m_name(QFile::encodeName(path))
{
    QFile file(path);
    if (!file.open(QIODevice::ReadOnly)) return;
    const QByteArray header = file.read(375);
    if (!header.startsWith("LASF")) return;
    m_minor = at<std::uint8_t>(header, 25);
    m_format = at<std::uint8_t>(header, 104) & 0x3F;
    m_recordLength = at<std::uint16_t>(header, 105);
    m_vlrs = at<std::uint32_t>(header, 100);
    m_count = at<std::uint32_t>(header, 107);
    if (m_minor >= 4 && at<std::uint64_t>(header, 247) != 0) m_count = at<std::uint64_t>(header, 247);
    for (int axis = 0; axis < 3; ++axis) {
        m_scale[std::size_t(axis)] = at<double>(header, 131 + 8 * axis);
        m_offset[std::size_t(axis)] = at<double>(header, 155 + 8 * axis);
    }
    m_good = true;
}

std::uint64_t LaszipFile::forEach(const std::function<void(const laszip_point_struct&)>& f) const
{
    laszip_POINTER reader = nullptr;
    laszip_BOOL compressed = 0;
    laszip_point_struct* point = nullptr;
    std::uint64_t count = 0;
    if (laszip_create(&reader) != 0) return 0;
    if (laszip_open_reader(reader, m_name.constData(), &compressed) == 0 &&
        laszip_get_point_pointer(reader, &point) == 0)
        while (count < m_count && laszip_read_point(reader) == 0) {
            f(*point);
            ++count;
        }
    laszip_close_reader(reader);
    laszip_destroy(reader);
    return count;
}

void appendFields(const laszip_point_struct& p, int format, std::string& bytes)
{
    append(bytes, p.X);
    append(bytes, p.Y);
    append(bytes, p.Z);
    append(bytes, p.intensity);
    append(bytes, p.user_data);
    append(bytes, p.point_source_ID);
    const bool extended = format >= 6;
    const std::array<int, 13> small = {p.scan_direction_flag,
                                       p.edge_of_flight_line,
                                       extended ? p.extended_return_number : p.return_number,
                                       extended ? p.extended_number_of_returns : p.number_of_returns,
                                       extended ? p.extended_classification : p.classification,
                                       extended ? p.extended_classification_flags : 0,
                                       extended ? p.extended_scanner_channel : 0,
                                       extended ? p.extended_scan_angle : p.scan_angle_rank,
                                       p.synthetic_flag,
                                       p.keypoint_flag,
                                       p.withheld_flag,
                                       p.num_extra_bytes,
                                       format};
    append(bytes, small);
    if (hasTime(format)) append(bytes, p.gps_time);
    if (hasColor(format)) bytes.append(reinterpret_cast<const char*>(p.rgb), 6);
    if (hasNir(format)) append(bytes, p.rgb[3]);
    if (hasWave(format)) bytes.append(reinterpret_cast<const char*>(p.wave_packet), 29);
    if (p.num_extra_bytes > 0)
        bytes.append(reinterpret_cast<const char*>(p.extra_bytes), std::size_t(p.num_extra_bytes));
}

std::vector<std::string> namesOf(int format)
{
    std::vector<std::string> names{"X",
                                   "Y",
                                   "Z",
                                   "Intensity",
                                   "ReturnNumber",
                                   "NumberOfReturns",
                                   "ScanDirectionFlag",
                                   "EdgeOfFlightLine",
                                   "Classification",
                                   "Synthetic",
                                   "KeyPoint",
                                   "Withheld"};
    const auto add = [&names](std::initializer_list<const char*> more) {
        names.insert(names.end(), more.begin(), more.end());
    };
    if (format >= 6) add({"Overlap", "ScannerChannel"});
    add({"ScanAngle", "UserData", "PointSourceId"});
    if (hasTime(format)) add({"GpsTime"});
    if (hasColor(format)) add({"Red", "Green", "Blue"});
    if (hasNir(format)) add({"NIR"});
    if (hasWave(format))
        add({"WaveformDescriptorIndex", "WaveformOffset", "WaveformSize", "WaveformReturnLocation", "WaveformX",
             "WaveformY", "WaveformZ"});
    return names;
}

void valuesOf(const laszip_point_struct& p, const LaszipFile& file, std::vector<double>& values)
{
    const int format = file.format();
    const bool extended = format >= 6;
    const unsigned flags = p.extended_classification_flags;
    values.clear();
    const auto add = [&values](auto... more) { (values.push_back(double(more)), ...); };
    add(p.X * file.scale(0) + file.offset(0), p.Y * file.scale(1) + file.offset(1),
        p.Z * file.scale(2) + file.offset(2), p.intensity, extended ? p.extended_return_number : p.return_number,
        extended ? p.extended_number_of_returns : p.number_of_returns, p.scan_direction_flag, p.edge_of_flight_line,
        extended ? p.extended_classification : p.classification, extended ? flags & 1u : p.synthetic_flag,
        extended ? flags >> 1 & 1u : p.keypoint_flag, extended ? flags >> 2 & 1u : p.withheld_flag);
    if (extended) add(flags >> 3 & 1u, p.extended_scanner_channel);
    add(extended ? p.extended_scan_angle * 0.006 : double(p.scan_angle_rank), p.user_data, p.point_source_ID);
    if (hasTime(format)) add(p.gps_time);
    if (hasColor(format)) add(p.rgb[0], p.rgb[1], p.rgb[2]);
    if (hasNir(format)) add(p.rgb[3]);
    if (hasWave(format)) {
        std::uint64_t offset = 0;
        std::uint32_t size = 0;
        std::array<float, 4> reals{};
        std::memcpy(&offset, p.wave_packet + 1, 8);
        std::memcpy(&size, p.wave_packet + 9, 4);
        std::memcpy(reals.data(), p.wave_packet + 13, 16);
        add(p.wave_packet[0], offset, size, reals[0], reals[1], reals[2], reals[3]);
    }
}

}  // namespace punctum::test
