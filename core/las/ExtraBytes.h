// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/ScalarType.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace punctum::las
{

struct Vlr;

constexpr std::uint16_t kExtraBytesRecordId = 4;  ///< of user LASF_Spec
// Places in a descriptor, in bytes (LAS 1.4 R15, table 24).
constexpr std::size_t kDescriptorNameAt = 4, kDescriptorNoDataAt = 40, kDescriptorMinAt = 64, kDescriptorMaxAt = 88,
                      kDescriptorScaleAt = 112, kDescriptorOffsetAt = 136, kDescriptorText = 32;

/// What is asked for when extra bytes are added to a record: one scalar a point.
struct ExtraBytesField {
    std::string name;  ///< at most 32 bytes of UTF-8 are stored
    ScalarType type = ScalarType::F32;
    std::string description;  ///< at most 32 bytes of UTF-8 are stored
    std::optional<double> scale;
    std::optional<double> offset;
};

/// One descriptor of an Extra Bytes record (LAS 1.4 R15, table 24): its 192 bytes, with typed access.
struct ExtraBytesDescriptor {
    static constexpr std::size_t kSize = 192;
    std::array<std::byte, kSize> bytes{};

    std::uint8_t type() const { return std::uint8_t(bytes[2]); }
    std::uint8_t options() const { return std::uint8_t(bytes[3]); }
    /// Bytes of a point record that it describes; 0 for reserved types.
    std::uint32_t recordBytes() const;
    std::string name() const;         ///< UTF-8; bytes that are not UTF-8 are taken as Latin-1
    std::string description() const;  ///< likewise
    bool hasNoData() const { return (options() & 1) != 0; }
    bool hasScale() const { return (options() & 8) != 0; }
    bool hasOffset() const { return (options() & 16) != 0; }
    /// The 8-byte value of component k at one of the places above.
    std::uint64_t bits(std::size_t at, std::size_t k) const;
    double number(std::size_t at, std::size_t k) const;
};

ExtraBytesDescriptor makeDescriptor(const ExtraBytesField& field);
/// Descriptor of 1 to 255 bytes that nobody described.
ExtraBytesDescriptor makeOpaqueDescriptor(std::uint8_t length, const std::string& name = {});

/// A descriptor and the bytes of the record that it describes.
struct ExtraBytesItem {
    ExtraBytesDescriptor descriptor;
    std::uint32_t offset = 0;  ///< from the record's start
    std::uint32_t bytes = 0;
    ScalarType type = ScalarType::U8;
    std::uint32_t values = 1;  ///< 2 or 3 for the old vector types, the number of bytes when opaque
    bool opaque = false;
    std::size_t record = 0;  ///< which of the records it is in
    std::size_t place = 0;   ///< of the descriptor in that record's bytes
};

/// Lays the descriptors of all records (in file order, one after another) over the bytes [first, last) of the
/// point record. Stops, with a sentence in `warnings`, at a descriptor that does not fit or has a reserved type;
/// the bytes after the last item are nobody's.
std::vector<ExtraBytesItem> parseExtraBytes(std::span<const Vlr* const> records, std::uint32_t first,
                                            std::uint32_t last, std::vector<std::string>& warnings);

/// Smallest and largest stored value of one component of an item whose descriptor states them, as the descriptor
/// does: 8 bytes of u64, i64 or f64.
struct ExtraBytesRange {
    std::size_t item = 0;  ///< of the list that parseExtraBytes gives
    std::size_t component = 0;
    bool any = false;  ///< false: no point has a value, and min and max mean nothing
    std::uint64_t min = 0, max = 0;
    friend bool operator==(const ExtraBytesRange&, const ExtraBytesRange&) = default;
};

/// Text of a fixed-size field up to the first NUL, as UTF-8, control characters replaced.
std::string fixedText(std::span<const std::byte> field);
/// `text` cut to whole UTF-8 characters that fit `bytes`.
std::string cutUtf8(const std::string& text, std::size_t bytes);

}  // namespace punctum::las
