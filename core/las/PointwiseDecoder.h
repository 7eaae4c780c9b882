// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkDecoder.h"

namespace punctum::las
{

/// Decodes the points of the formats 0 to 5 with extra bytes: items POINT10, GPSTIME11, RGB12 and BYTE of version
/// 2, WAVEPACKET13 of version 1, one point after the other from one range coder. For one thread.
class PointwiseDecoder final : public ChunkDecoder
{
public:
    static bool supports(const LazInfo& info);
    /// `info` must be supported.
    explicit PointwiseDecoder(const LazInfo& info);
    ~PointwiseDecoder() override;

    std::string start(std::span<const std::byte> chunk) override;
    std::size_t decode(std::size_t count, std::byte* records) override;
    std::uint64_t position() const override;
    unsigned zerosAtEnd() const override;
    bool endsAsWritten() const override;

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace punctum::las
