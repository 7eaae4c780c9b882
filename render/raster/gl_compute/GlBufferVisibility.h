// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/gl/GlVisibility.h"

namespace punctum::render
{

/// The visibility buffer in storage buffers, which compute shaders change by atomic operations: a band of rows in
/// each buffer, since one may hold no more than 128 MiB. Depths are float bits; where no point is, depth and id
/// have all bits set.
class GlBufferVisibility final : public GlVisibility
{
public:
    /// `wide`: depth (high) and id (low) of a sample in one 64-bit word; otherwise in two buffers of 32-bit words.
    GlBufferVisibility(std::size_t bandSamples, bool wide) : GlVisibility(bandSamples), m_wide(wide) {}

    void clear() override;
    void bindForReading(const Band& band) override;
    /// Bindings 5 and 6, or 5 alone when wide, for shaders that draw.
    void bindForDrawing(const Band& band) const;

protected:
    void makeStorage(const GlInfo& info) override;
    std::string accessors() const override;

private:
    struct Storage {
        GlBuffer ids;     ///< wide: everything
        GlBuffer depths;  ///< wide: empty
    };
    std::size_t indexOf(const Band& band) const noexcept { return std::size_t(&band - bands().data()); }

    bool m_wide;
    std::vector<Storage> m_storage;  ///< one for each of bands()
};

}  // namespace punctum::render
