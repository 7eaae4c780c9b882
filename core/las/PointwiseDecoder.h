// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkCodec.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

namespace punctum::las
{

/// Decodes the points of the formats 0 to 5 with extra bytes (items POINT10, GPSTIME11, RGB12 and BYTE of version 2,
/// WAVEPACKET13 of version 1), as LASzip does, only faster, since opening a compressed file is what people wait for,
/// and whatever the bytes are within its bounds, where LASzip can recurse without end. LASzip writes every chunk;
/// tests hold this decoder against it.
///
/// For one thread.
class PointwiseDecoder
{
public:
    static bool supports(const LazInfo& info);
    /// `info` must be supported.
    explicit PointwiseDecoder(const LazInfo& info);
    ~PointwiseDecoder();

    /// Begins a chunk; its bytes are copied. Says why it cannot be decoded; empty when it can.
    std::string start(std::span<const std::byte> chunk);
    /// Decodes `count` points into records; fewer when the bytes are at their end or damaged.
    std::size_t decode(std::size_t count, std::byte* records);
    /// Bytes of the chunk taken so far; one more than there are when more were asked for.
    std::uint64_t position() const;

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace punctum::las
