// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/SourceFile.h"

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace punctum::las
{

constexpr std::uint32_t kVariableChunks = 0xFFFFFFFFu;  ///< chunk size in the laszip record: see the chunk table
constexpr std::uint32_t kDefaultChunkSize = 50000;      ///< what LASzip writes

/// The laszip record: how the points are compressed. Only what a file of this format can mean gets through.
struct LazInfo {
    static constexpr std::size_t kChunkSizeAt = 12;  ///< in the payload
    enum Compressor : std::uint16_t { Pointwise = 1, Chunked = 2, Layered = 3 };
    struct Item {
        std::uint16_t type = 0, size = 0, version = 0;
        friend bool operator==(const Item&, const Item&) = default;
    };

    std::uint16_t compressor = Chunked;
    std::uint32_t chunkSize = kDefaultChunkSize;  ///< kVariableChunks when chunks differ
    std::vector<Item> items;
    std::vector<std::byte> payload;  ///< of the record, 34 + 6 bytes an item
    std::uint8_t format = 0;
    std::uint16_t recordLength = 0;

    bool variable() const { return chunkSize == kVariableChunks; }
    /// Layers of a chunk of the layered compressor.
    std::uint32_t layers() const;
    /// Changes chunkSize, and the payload with it.
    void setChunkSize(std::uint32_t size);
    /// Parses and checks the record against point format and record length. Throws Error.
    static LazInfo parse(const Vlr& record, std::uint8_t format, std::uint16_t recordLength);
    /// What LASzip itself writes for this format, with chunks of kDefaultChunkSize.
    static LazInfo standard(std::uint8_t format, std::uint16_t recordLength);
};

constexpr const char* kLaszipUser = "laszip encoded";
constexpr std::uint16_t kLaszipRecordId = 22204;
inline bool isLaszip(const Vlr& vlr)
{
    return vlr.is(kLaszipUser, kLaszipRecordId);
}

/// Why a layered chunk cannot be decoded: its own count and layer sizes are checked against `count` and its bytes,
/// which LASzip does not do. Empty when it can.
std::string checkLayeredChunk(std::span<const std::byte> chunk, const LazInfo& info,
                              std::optional<std::uint32_t> count);
/// Count and size that a layered chunk states in its first bytes (recordLength + 4 + 4 * layers() of them);
/// false when there are too few bytes or the sizes cannot be.
bool layeredChunkSize(std::span<const std::byte> start, const LazInfo& info, std::uint32_t& count,
                      std::uint64_t& bytes);

/// A little-endian value at any address.
template <typename T>
T loadAs(const std::byte* p)
{
    T v;
    std::memcpy(&v, p, sizeof v);
    return v;
}

}  // namespace punctum::las
