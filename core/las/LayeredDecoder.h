// SPDX-License-Identifier: MIT
#pragma once

#include "core/las/ChunkDecoder.h"

namespace punctum::las
{

/// Decodes the points of the formats 6 to 10 with extra bytes: items POINT14, RGB14, RGBNIR14, WAVEPACKET14 and
/// BYTE14 of the versions 2 to 4. Each chunk holds its points in layers, each with a range coder of its own. All
/// layers of a point are decoded before the next point, so that the processor works on several at once.
///
/// A layer ends with the last byte that its decoder takes, and position() is the chunk's end only when all do. So
/// most damage is noticed that LASzip lets pass. For one thread.
class LayeredDecoder final : public ChunkDecoder
{
public:
    static bool supports(const LazInfo& info);
    /// `info` must be supported.
    explicit LayeredDecoder(const LazInfo& info);
    ~LayeredDecoder() override;

    std::string start(std::span<const std::byte> chunk) override;
    std::size_t decode(std::size_t count, std::byte* records) override;
    std::uint64_t position() const override;
    bool endsAsWritten() const override;

private:
    struct Impl;
    std::unique_ptr<Impl> m_impl;
};

}  // namespace punctum::las
