// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/LazInfo.h"

#include <cstddef>
#include <cstdint>
#include <iosfwd>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::las
{

class File;

class ChunkDecoder;

/// Decodes one run of compressed points, from memory or straight from the file: with our own
/// ChunkDecoder, or, for items of version 1, with LASzip. For one thread. After an error nothing more can be
/// decoded.
class PointDecoder
{
public:
    /// Which code decodes chunks in memory: tests hold one against the other.
    enum class Codec { Fastest, Laszip };
    /// A chunk in memory; `data` must stay. `count`: its points.
    PointDecoder(const LazInfo& info, std::span<const std::byte> data, std::uint64_t count,
                 Codec codec = Codec::Fastest);
    /// The bytes [offset, offset + bytes) of a file: a pointwise stream, or chunks of info.chunkSize one after
    /// another.
    PointDecoder(const LazInfo& info, const File& file, std::uint64_t offset, std::uint64_t bytes,
                 std::uint64_t count);
    ~PointDecoder();
    PointDecoder(const PointDecoder&) = delete;
    PointDecoder& operator=(const PointDecoder&) = delete;

    /// Whether it can take up another chunk in place of this one, which spares making the models anew.
    bool reusable() const noexcept { return m_own != nullptr; }
    /// Takes up another chunk; only when reusable().
    void restart(std::span<const std::byte> data);

    /// Decodes up to `count` points into records of info.recordLength bytes; fewer only on an error.
    std::size_t decode(std::size_t count, std::byte* records);
    /// Bytes of the data taken so far; more than there are when more were asked for.
    std::uint64_t position();
    /// Our own decoder, which knows of the chunk's end; null where LASzip decodes.
    const ChunkDecoder* own() const noexcept { return m_own.get(); }
    /// What went wrong; empty when all went well.
    const std::string& error() const noexcept { return m_error; }

private:
    struct Impl;
    std::unique_ptr<ChunkDecoder> m_own;
    std::unique_ptr<Impl> m_impl;  ///< LASzip; null when m_own decodes
    std::string m_error;
};

/// Compresses records one after the other with LASzip's own writer, in chunks of info.chunkSize: for one chunk of
/// the formats 6 to 10, and for what tests and benchmarks compare with. For one thread. Every member throws Error.
class LaszipEncoder
{
public:
    /// `out` must stay, and be able to go back: position of the table, chunks and table go there.
    LaszipEncoder(const LazInfo& info, std::ostream& out);
    ~LaszipEncoder();
    LaszipEncoder(const LaszipEncoder&) = delete;
    LaszipEncoder& operator=(const LaszipEncoder&) = delete;

    void add(std::span<const std::byte> records);
    void finish();

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

/// The bytes of one chunk with these records, the same that LASzip writes serially: by our own code for the formats
/// 0 to 5, by LASzip for the others. May be called from several threads. Throws Error or Cancelled.
std::vector<std::byte> encodeChunk(const LazInfo& info, std::span<const std::byte> records,
                                   const Progress& progress);

}  // namespace punctum::las
