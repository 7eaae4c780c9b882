// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace punctum::las
{

struct LazInfo;

/// Said of bytes that begin with 0xFFFFFFFF, which no range coder writes.
constexpr const char* kImpossibleStart = "its compressed bytes begin as none can";

/// Decodes the points of compressed chunks by our own code: faster than LASzip, since opening a compressed file is
/// what people wait for, and within its bounds whatever the bytes are, where LASzip can recurse without end. Tests
/// hold these decoders against it. For one thread.
class ChunkDecoder
{
public:
    /// Null when only LASzip can decode these chunks (items of version 1).
    static std::unique_ptr<ChunkDecoder> make(const LazInfo& info);
    virtual ~ChunkDecoder() = default;

    /// Begins a chunk; its bytes are copied. Says why it cannot be decoded; empty when it can.
    virtual std::string start(std::span<const std::byte> chunk) = 0;
    /// Decodes `count` points into records; fewer when the bytes are at their end or damaged.
    virtual std::size_t decode(std::size_t count, std::byte* records) = 0;
    /// Bytes of the chunk taken so far; one more than there are when more were asked for.
    virtual std::uint64_t position() const = 0;
    /// If the last point decoded was the last one: whether a coder can have written the chunk's last bytes. Of
    /// chunks in layers, which have a coder each: those of all layers.
    virtual bool endsAsWritten() const = 0;
    /// How many zeros a coder ends with then; 0 for chunks in layers.
    virtual unsigned zerosAtEnd() const { return 0; }
};

}  // namespace punctum::las
