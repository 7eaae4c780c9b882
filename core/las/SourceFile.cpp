// SPDX-License-Identifier: MIT
#include "core/las/SourceFile.h"

#include "core/Error.h"
#include "core/las/Crs.h"
#include "core/las/GeoKeys.h"

#include <algorithm>

namespace punctum::las
{

namespace
{

template <std::size_t N>
void copyText(std::array<char, N>& field, std::string_view text)
{
    std::copy_n(text.data(), std::min(N, text.size()), field.data());
}

}  // namespace

std::string Vlr::user() const
{
    return {userId.data(), std::size_t(std::find(userId.begin(), userId.end(), '\0') - userId.begin())};
}

Vlr makeVlr(std::string_view user, std::uint16_t id, std::string_view description, std::vector<std::byte> data,
            bool extended)
{
    Vlr vlr;
    copyText(vlr.userId, user);
    vlr.recordId = id;
    copyText(vlr.description, description);
    vlr.data = std::move(data);
    vlr.extended = extended;
    return vlr;
}

std::vector<PointRange> readable(PointIndex points, const std::vector<PointRange>& missing)
{
    std::vector<PointRange> ranges;
    PointIndex next = 0;
    for (const PointRange& gone : missing) {
        if (gone.first > next) ranges.push_back({next, gone.first});
        next = std::max(next, gone.last);
    }
    if (next < points) ranges.push_back({next, points});
    return ranges;
}

const Vlr* SourceFile::findVlr(std::string_view user, std::uint16_t id) const
{
    for (const auto* list : {&vlrs, &evlrs})
        for (const Vlr& vlr : *list)
            if (vlr.is(user, id)) return &vlr;
    return nullptr;
}

void SourceFile::setUnits(const CoordinateUnits& coordinateUnits)
{
    units = coordinateUnits;
    layout.attributes[0].unit = layout.attributes[1].unit = units.horizontal;
    layout.attributes[2].unit = units.vertical;
}

std::vector<const Vlr*> SourceFile::extraBytesRecords() const
{
    std::vector<const Vlr*> records;
    for (const auto* list : {&vlrs, &evlrs})
        for (const Vlr& vlr : *list)
            if (vlr.is("LASF_Spec", kExtraBytesRecordId)) records.push_back(&vlr);
    return records;
}

std::shared_ptr<SourceFile> makeSource(std::uint8_t format, std::span<const ExtraBytesField> extraBytes,
                                       const CoordinateScale& coordinates, std::string_view wkt, PointIndex points)
{
    std::vector<std::byte> descriptors;
    for (const ExtraBytesField& field : extraBytes) {
        const ExtraBytesDescriptor d = makeDescriptor(field);
        descriptors.insert(descriptors.end(), d.bytes.begin(), d.bytes.end());
    }
    std::vector<Vlr> records;
    if (!wkt.empty()) {
        std::vector<std::byte> text(wkt.size() + 1);  // with the NUL that the standard asks for
        std::memcpy(text.data(), wkt.data(), wkt.size());
        records.push_back(makeVlr(geo::kUser, geo::kWktId, geo::kWktDescription, std::move(text)));
    }
    if (!descriptors.empty())
        records.push_back(makeVlr("LASF_Spec", kExtraBytesRecordId, "Extra Bytes Record", std::move(descriptors)));
    const bool wktSaid = !wkt.empty() || isExtendedFormat(format);  // the formats 6-10 ask for WKT
    return makeSource(format, std::move(records), coordinates,
                      std::uint16_t(encoding::kAdjustedGpsTime | (wktSaid ? encoding::kWkt : 0)), points);
}

std::shared_ptr<SourceFile> makeSource(std::uint8_t format, std::vector<Vlr> records,
                                       const CoordinateScale& coordinates, std::uint16_t bits, PointIndex points)
{
    auto source = std::make_shared<SourceFile>();
    std::size_t length = standardRecordLength(format);
    if (length == 0) throw Error("Point format " + std::to_string(format) + " is not supported.");
    std::size_t described = 0;
    for (Vlr& vlr : records) {
        vlr.extended = vlr.data.size() > UINT16_MAX;
        if (vlr.is("LASF_Spec", kExtraBytesRecordId)) {
            described += vlr.data.size();
            for (std::size_t at = 0; at + ExtraBytesDescriptor::kSize <= vlr.data.size();
                 at += ExtraBytesDescriptor::kSize) {
                ExtraBytesDescriptor d;
                std::memcpy(d.bytes.data(), vlr.data.data() + at, d.bytes.size());
                length += d.recordBytes();
            }
        }
        (vlr.extended ? source->evlrs : source->vlrs).push_back(std::move(vlr));
    }
    if (length > UINT16_MAX || described > UINT16_MAX) throw Error("A point cannot hold that many extra bytes.");

    Header& h = source->header;
    h.bytes.resize(standardHeaderSize(4));
    h.setText(at::kSignature, "LASF");
    h.set(at::kVersionMajor, 1);
    h.set(at::kVersionMinor, 4);
    h.set(at::kGlobalEncoding, bits);
    h.setText(at::kSystemId, "OTHER");
    h.setText(at::kSoftware, "Punctum");
    h.setCreation();
    h.set(at::kHeaderSize, std::uint16_t(h.bytes.size()));
    std::uint64_t offset = h.bytes.size();
    for (const Vlr& vlr : source->vlrs) offset += vlr.bytesInFile();
    h.set(at::kPointOffset, std::uint32_t(offset));
    h.set(at::kVlrCount, std::uint32_t(source->vlrs.size()));
    h.set(at::kEvlrCount, std::uint32_t(source->evlrs.size()));
    h.set(at::kPointFormat, format);
    h.set(at::kRecordLength, std::uint16_t(length));
    h.set(at::kPointCount, points);
    for (std::size_t k = 0; k < 3; ++k) {
        h.set(at::kScale[k], coordinates.scale[int(k)]);
        h.set(at::kOffset[k], coordinates.offset[int(k)]);
    }

    source->pointCount = points;
    source->coordinates = coordinates;
    const auto extra = source->extraBytesRecords();
    source->layout = makeLayout(format, std::uint16_t(length), extra, coordinates, source->warnings);
    CrsInfo crs = readCrs(*source);
    source->crs = std::move(crs.text);
    for (std::string& sentence : crs.warnings) source->warnings.push_back(std::move(sentence));
    source->setUnits(crs.units);
    return source;
}

}  // namespace punctum::las
