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
    GlBufferVisibility(std::size_t bandSamples, GlTraffic& traffic, bool wide)
        : GlVisibility(bandSamples, traffic), m_wide(wide)
    {
    }

    void bindForReading(const Band& band) override;
    void makeMeans() override;
    /// Bindings 5 and 6, or 5 alone when wide, for shaders that draw.
    void bindForDrawing(const Band& band) const;
    /// These, and bindings 3 and 7, for shaders that add colors.
    void bindForAdding(const Band& band) const;

protected:
    void makeStorage(const GlInfo& info) override;
    std::string accessors() const override;
    void emptyCells() override;
    void emptySums() override;

private:
    struct Storage {
        GlBuffer ids;                  ///< wide: everything
        GlBuffer depths;               ///< wide: empty
        GlBuffer redGreen, blueCount;  ///< sums of colors, 2 x uint32 a cell; empty until there are any
        GlBuffer means;                ///< of these, as resolve.comp reads them
    };
    std::size_t cellsOf(const Band& band) const noexcept
    {
        return std::size_t(size().width) * std::size_t(size().samples) * std::size_t(band.lastRow - band.firstRow);
    }
    std::size_t indexOf(const Band& band) const noexcept { return std::size_t(&band - bands().data()); }

    bool m_wide;
    GlProgram m_means;
    std::vector<Storage> m_storage;  ///< one for each of bands()
};

}  // namespace punctum::render
