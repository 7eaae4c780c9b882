// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace punctum::las
{

static_assert(std::endian::native == std::endian::little, "LAS is little-endian, and so is this code");

/// The fields of the public header block: where each is, and of which type its values are (LAS 1.4 R15, table 3;
/// LAS 1.5, table 3). Nobody else says an offset; `headerFields()` has their names, groups and versions.
namespace at
{

/// A field of `Count` values of type T, `Step` bytes from one to the next; [k] is one of them.
template <typename T, std::size_t Count = 1, std::size_t Step = sizeof(T)>
struct Field {
    std::size_t offset;

    static constexpr std::size_t kCount = Count;
    constexpr Field<T> operator[](std::size_t k) const { return {offset + k * Step}; }
};

template <std::size_t N>
using Text = std::array<char, N>;
using Guid = std::array<std::byte, 16>;

constexpr Field<Text<4>> kSignature{0};
constexpr Field<std::uint16_t> kFileSourceId{4};    ///< since 1.1
constexpr Field<std::uint16_t> kGlobalEncoding{6};  ///< since 1.2; see Encoding
constexpr Field<Guid> kProjectId{8};
constexpr Field<std::uint8_t> kVersionMajor{24};
constexpr Field<std::uint8_t> kVersionMinor{25};
constexpr Field<Text<32>> kSystemId{26};
constexpr Field<Text<32>> kSoftware{58};
constexpr Field<std::uint16_t> kCreationDay{90};
constexpr Field<std::uint16_t> kCreationYear{92};
constexpr Field<std::uint16_t> kHeaderSize{94};
constexpr Field<std::uint32_t> kPointOffset{96};
constexpr Field<std::uint32_t> kVlrCount{100};
constexpr Field<std::uint8_t> kPointFormat{104};  ///< the two highest bits: compressed
constexpr Field<std::uint16_t> kRecordLength{105};
constexpr Field<std::uint32_t> kLegacyCount{107};
constexpr Field<std::uint32_t, 5> kLegacyByReturn{111};
constexpr Field<double, 3> kScale{131};
constexpr Field<double, 3> kOffset{155};
constexpr Field<double, 3, 16> kMax{179};  ///< max and min of an axis stand together
constexpr Field<double, 3, 16> kMin{187};
constexpr Field<std::uint64_t> kWaveformStart{227};  ///< since 1.3
constexpr Field<std::uint64_t> kEvlrStart{235};      ///< since 1.4, as the next three
constexpr Field<std::uint32_t> kEvlrCount{243};
constexpr Field<std::uint64_t> kPointCount{247};
constexpr Field<std::uint64_t, 15> kByReturn{255};
constexpr Field<double> kMaxGpsTime{375};  ///< since 1.5, as the next two
constexpr Field<double> kMinGpsTime{383};
constexpr Field<std::uint16_t> kTimeOffset{391};

}  // namespace at

/// Bits of the global encoding (LAS 1.4 R15, table 4).
namespace encoding
{
constexpr std::uint16_t kAdjustedGpsTime = 1, kInternalWaveform = 2, kExternalWaveform = 4, kSyntheticReturns = 8,
                        kWkt = 16, kTimeOffset = 64;  // kTimeOffset: since 1.5, there table 3
}

/// Size of the standard header of version 1.minor; user bytes may follow it.
std::uint16_t standardHeaderSize(std::uint8_t versionMinor) noexcept;

/// The public header block (LAS 1.4 R15, table 3): the file's own bytes, with typed access to fields.
/// Bytes beyond the standard's end (user bytes) are kept at the end of `bytes`.
struct Header {
    std::vector<std::byte> bytes;

    /// The one at the beginning of a file's bytes, as long as it says to be.
    static Header of(std::span<const std::byte> file);

    template <typename T, std::size_t Step>
    T get(at::Field<T, 1, Step> field) const  ///< 0 when the header is too short
    {
        T value{};
        if (holds<T>(field.offset)) std::memcpy(&value, bytes.data() + field.offset, sizeof(T));
        return value;
    }
    template <typename T, std::size_t Step>
    void set(at::Field<T, 1, Step> field, std::type_identity_t<T> value)  ///< nothing when the header is too short
    {
        if (holds<T>(field.offset)) std::memcpy(bytes.data() + field.offset, &value, sizeof(T));
    }
    /// Text is cut to the field, and filled up with NULs.
    template <std::size_t N>
    void setText(at::Field<at::Text<N>> field, std::string_view text)
    {
        at::Text<N> value{};
        std::copy_n(text.data(), std::min(N, text.size()), value.data());
        set(field, value);
    }

    std::uint8_t versionMajor() const { return get(at::kVersionMajor); }
    std::uint8_t versionMinor() const { return get(at::kVersionMinor); }
    std::uint16_t globalEncoding() const { return get(at::kGlobalEncoding); }
    /// Whether a bit of the namespace encoding is set.
    bool says(std::uint16_t bit) const { return (globalEncoding() & bit) != 0; }
    std::uint16_t headerSize() const { return get(at::kHeaderSize); }
    std::uint32_t pointOffset() const { return get(at::kPointOffset); }
    std::uint8_t pointFormat() const { return get(at::kPointFormat) & 0x3F; }
    bool compressed() const { return (get(at::kPointFormat) & 0xC0) != 0; }
    std::uint16_t recordLength() const { return get(at::kRecordLength); }
    /// Whether fields of 1.4 are there: by the version, and by the header's real size.
    bool extendedCounts() const { return versionMinor() >= 4 && bytes.size() >= standardHeaderSize(4); }
    /// First byte after the standard's part.
    std::size_t standardEnd() const
    {
        return std::min<std::size_t>(standardHeaderSize(versionMinor()), bytes.size());
    }
    std::string version() const;  ///< "1.4"

    /// Today as day of creation.
    void setCreation();

private:
    template <typename T>
    bool holds(std::size_t offset) const
    {
        return offset <= bytes.size() && sizeof(T) <= bytes.size() - offset;
    }
};

/// What people are told of a field of the header: one line for each value that has a name of its own.
struct HeaderField {
    enum class Type : std::uint8_t { U8, U16, U32, U64, F64, Text, Guid };
    /// Place: it says how the file is laid out, and differs where the content does not.
    enum class Kind : std::uint8_t { Content, Place };

    const char* name;   ///< as diff and JSON have it: "points_by_return"
    const char* group;  ///< what it belongs to, in words: "points by return"
    Type type;
    Kind kind;
    std::size_t offset;
    std::size_t bytes;         ///< of one value
    std::size_t count;         ///< of values; numbered from 1
    std::uint8_t since;        ///< minor version of LAS; before, the bytes are reserved or somebody's own
    std::uint8_t mask = 0xFF;  ///< of U8: the bits that are the field's

    /// The bytes of value k; none where the header's version or size has no such field.
    std::span<const std::byte> in(const Header& header, std::size_t k = 0) const;
};

/// Group of the fields that only say how many records there are: a list of the records themselves tells better.
constexpr const char* kRecordNumbers = "number of records";

/// All fields but the signature, in the order of the file.
std::span<const HeaderField> headerFields() noexcept;

}  // namespace punctum::las
