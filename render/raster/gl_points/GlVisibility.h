// SPDX-License-Identifier: MIT
#pragma once

#include "render/gl/GlObjects.h"
#include "render/raster/Backend.h"

#include <array>
#include <span>
#include <vector>

namespace punctum::render
{

/// The visibility buffer on the device: point id (R32UI) and reversed depth (D32F) per sample, row 0 at the top
/// of the picture, and what is read out of it. Owned by the backend; the thread of its context. Changes bindings
/// of the context: callers hold a GlStateGuard. Members throw Error.
class GlVisibility
{
public:
    /// `bandSamples`: the most samples whose ids go into one list.
    explicit GlVisibility(std::size_t bandSamples) : m_bandSamples(bandSamples) {}

    /// Width or height 0: no buffer, and all else does nothing.
    void setSize(const TargetSize& size, const GlInfo& info);
    const TargetSize& size() const noexcept { return m_size; }
    bool empty() const noexcept { return !m_framebuffer; }
    void clear();
    /// For drawing into.
    void bindFramebuffer() const;
    /// For reading by shaders: ids as texture unit 0, depths as 1 (visibility.glsl).
    void bindTextures() const;

    /// Visible points of a band of rows, sorted by chunk.
    struct Band {
        GlBuffer commands;  ///< a Command a chunk
        GlBuffer list;      ///< uint32: id - first id of the chunk
    };
    /// As glDrawElementsIndirect reads it, and collect.comp writes it.
    struct Command {
        std::uint32_t count, instances, firstIndex;
        std::int32_t baseVertex;
        std::uint32_t baseInstance, written, unused[2];
    };
    static_assert(sizeof(Command) == 32);

    /// Lists what is visible on the device, each point once for each band that shows it. `firstIds`: of the chunks
    /// of ids, rising; an id belongs to the last chunk that begins at or before it. Valid until the next call.
    std::span<const Band> collect(std::span<const PointId> firstIds);
    /// Reads a band back; returns the commands, ids relative to their chunk in `list`.
    static std::vector<Command> readBack(const Band& band, std::size_t chunks, std::vector<std::uint32_t>& list);

    /// As RasterBackend has them.
    void depths(std::vector<float>& out);
    std::optional<RasterBackend::Hit> pick(int x, int y, int radius);
    double coveredShare();

    /// "#version ..." and what the shaders that read the buffer share.
    static std::string shaderHead(int samples);

private:
    /// As read.comp writes it.
    struct Sample {
        PointId id;
        std::uint32_t depth;            ///< reversed, see points.vert
        float metric() const noexcept;  ///< along the view direction, world units
    };
    void read(int x, int y, int width, int height, std::vector<Sample>& out);

    struct Programs {
        GlProgram count, fill, read, covered;
    };
    Programs& programs();

    std::size_t m_bandSamples;
    TargetSize m_size;
    GlTexture m_ids, m_depths;
    GlFramebuffer m_framebuffer;
    std::array<Programs, kSampleCounts.size()> m_programs;  ///< made when first needed
    GlProgram m_scan;
    GlBuffer m_firstIds, m_scratch;
    std::vector<Band> m_bands;
};

}  // namespace punctum::render
