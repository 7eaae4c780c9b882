// SPDX-License-Identifier: MIT
#pragma once

#include <laszip/laszip_api.h>

#include <QByteArray>
#include <QString>

#include <array>
#include <cstdint>
#include <cstring>
#include <functional>
#include <string>
#include <vector>

namespace punctum::test
{

/// A LAS/LAZ file as LASzip's own API and a plain look at its bytes show it: what the tests hold the program
/// against. It shares no code with the program. LASzip's header struct, which differs between its versions, is not
/// used.
class LaszipFile
{
public:
    explicit LaszipFile(const QString& path);

    bool good() const { return m_good; }
    std::uint64_t count() const { return m_count; }  ///< as the header says
    int version() const { return m_minor; }
    int format() const { return m_format; }
    int recordLength() const { return m_recordLength; }
    double scale(int axis) const { return m_scale[std::size_t(axis)]; }
    double offset(int axis) const { return m_offset[std::size_t(axis)]; }
    std::uint32_t records() const { return m_vlrs; }  ///< VLRs, without EVLRs

    /// Calls f for each point until the count is reached or LASzip cannot read on; returns how many there were.
    std::uint64_t forEach(const std::function<void(const laszip_point_struct&)>& f) const;

private:
    QByteArray m_name;
    bool m_good = false;
    std::uint64_t m_count = 0;
    int m_minor = 0;
    int m_format = 0;
    int m_recordLength = 0;
    std::uint32_t m_vlrs = 0;
    std::array<double, 3> m_scale{};
    std::array<double, 3> m_offset{};
};

/// Appends every field of a point that its format has, as bytes: two points are equal when these are. Points of one
/// file take the same number of bytes each.
void appendFields(const laszip_point_struct& point, int format, std::string& bytes);

/// Standard attributes of a point format, by the program's names, in the order of valuesOf().
std::vector<std::string> namesOf(int format);
/// Their values, as numbers, in place of what `values` held.
void valuesOf(const laszip_point_struct& point, const LaszipFile& file, std::vector<double>& values);

}  // namespace punctum::test
