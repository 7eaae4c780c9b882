// SPDX-License-Identifier: MIT
#pragma once

#include "render/raster/Backend.h"
#include "render/raster/gl/GlBudget.h"
#include "render/raster/gl/GlPicture.h"
#include "render/raster/gl/GlPointCopy.h"
#include "render/raster/gl/GlVisibility.h"

#include <array>
#include <memory>
#include <unordered_map>
#include <vector>

namespace punctum::render
{

/// How much is done at once. The defaults suit every device; tests ask for less, to have many pieces of little.
struct GlLimits {
    Slot chunkSlots = 0;                             ///< slots of one piece of device memory, a multiple of
                                                     ///< PointStore::kBlockSlots; 0: what the driver allows
    std::size_t blocksAFrame = 64;                   ///< changed blocks of words (256 KiB) sent in one frame
    std::size_t bandSamples = std::size_t(1) << 24;  ///< samples in one buffer (64 or 128 MiB)
};

/// What the backends that draw with OpenGL share: copies of the stores on the device, lists of what is visible, the
/// picture, picking. How points get into the visibility buffer is the derived classes' business. Needs a current
/// OpenGL 4.3 core context, which must be current whenever a member is called and when the backend is destroyed;
/// leaves the context's drawing state as it found it, but for texture units 0 to 4 and the numbered storage and
/// image bindings.
class GlBackend : public RasterBackend
{
public:
    ~GlBackend() override;
    std::string description() const override;
    void setTarget(const TargetSize& size) final;
    TargetSize target() const noexcept final { return m_visibility->size(); }
    void clear() final;
    void visibleIds(std::vector<PointId>& out) final;
    void reproject(const FrameScene& scene) final;
    void redraw(const FrameScene& scene, std::span<const PointId> ids) final;
    void draw(const FrameScene& scene, std::size_t layer, SlotRange slots) final;
    void finish() final { GlSync::insert().wait(); }
    bool keepsTime() const noexcept final { return m_info.timesToBuffers; }
    void startClock() final;
    void drawTimed(const FrameScene& scene, std::span<const Run> runs, double seconds) final;
    Timed timed() final;
    void clearColors() final { m_visibility->clearSums(); }
    void addColors(const FrameScene& scene, const ResolveSettings& settings, std::size_t layer,
                   SlotRange slots) final;
    void resolve(const FrameScene& scene, const ResolveSettings& settings, Image& out) final;
    bool keepsPicture() const noexcept final { return true; }
    void resolveOnDevice(const FrameScene& scene, const ResolveSettings& settings) final;
    void readPicture(Image& out) final;
    void copyPicture(unsigned texture) final;
    Traffic traffic() const noexcept final { return {m_traffic.up, m_traffic.down}; }
    void depths(std::vector<float>& out) final;
    void nearestIds(std::vector<PointId>& out) final;
    std::optional<Hit> pick(int x, int y, int radius) final;
    double coveredShare() final;

protected:
    /// A chunk of the scene, in the numbering of the view.
    struct ChunkPlace {
        PointId firstId;
        std::size_t layer;
        std::size_t chunk;
    };

    /// Points of a work group, where there are work groups.
    struct GroupPoints {
        std::uint32_t list = 1;  ///< that draws a list (GlVisibility::collect)
        std::uint32_t run = 1;   ///< that draws slots
    };
    GlBackend(const GlLimits& limits, const GroupPoints& groupPoints);
    /// To be called by the derived constructor.
    void setVisibility(std::unique_ptr<GlVisibility> visibility) { m_visibility = std::move(visibility); }
    const GlInfo& info() const noexcept { return m_info; }
    const GlLimits& limits() const noexcept { return m_limits; }
    /// Counts what goes to the device and back.
    GlTraffic& counted() noexcept { return m_traffic; }
    GlPointCopy& copyOf(const Layer& layer) { return m_copies.at(layer.store); }

    /// The visibility buffer is new.
    virtual void targetChanged() {}
    /// Draws a run of slots, whose positions (and classes, when points are filtered) have come over.
    virtual void drawSlots(const FrameScene& scene, const Layer& layer, SlotRange slots) = 0;
    /// Appends what drawCommands() is to be asked for of a run of slots, in rising order and at most `most` pieces:
    /// all of it, or what of it is in sight where a backend does not look for that itself.
    virtual void pieces(const Layer&, SlotRange slots, std::size_t /*most*/, std::vector<SlotRange>& out) const
    {
        out.push_back(slots);
    }
    /// Draws by the commands of each band, one for each of these places: points that collect() listed; without a
    /// list, slots from Command::firstIndex on. Places of one chunk stand together.
    virtual void drawCommands(const FrameScene& scene, std::span<const ChunkPlace> places,
                              std::span<const GlVisibility::Band> bands) = 0;
    /// addColors() of a run of slots that has come over, into sums that there is room for.
    virtual void addSlots(const FrameScene& scene, const Layer& layer, const LayerColors& colors,
                          SlotRange slots) = 0;
    /// Sets what color.glsl reads in the program that is in use.
    void useColors() const;

private:
    /// Copies of the scene's stores, and of no others; makes them anew where a store is not what it was.
    void updateCopies(const FrameScene& scene);
    /// All chunks of the scene, by rising first id.
    std::vector<ChunkPlace> places(const FrameScene& scene) const;
    /// Brings words (or groups) of visible points up to date, and some of the others.
    void updateVisible(const FrameScene& scene, GlPointCopy::Part part);
    /// The slots that the layer's store has, with all that drawing them needs brought over.
    SlotRange ready(const FrameScene& scene, std::size_t layer, SlotRange slots);
    /// Brings over what drawing these slots needs.
    void updateFor(const FrameScene& scene, const Layer& layer, SlotRange slots);
    void scatter(const FrameScene& scene, const std::vector<bool>& layers);
    /// Brings the tables of colors over.
    void updateTables(const ResolveSettings& settings);
    void runResolve(const FrameScene& scene, const ResolveSettings& settings);

    GlInfo m_info;
    GlLimits m_limits;
    GroupPoints m_groupPoints;
    GlTraffic m_traffic;
    GlBudget m_budget{m_traffic};
    GlPicture m_picture{m_traffic};
    std::unique_ptr<GlVisibility> m_visibility;
    std::unordered_map<const PointStore*, GlPointCopy> m_copies;
    std::array<GlProgram, 2> m_scatter;                                    ///< words; words and groups
    std::array<std::array<GlProgram, 4>, kSampleCounts.size()> m_resolve;  ///< 1: of means; 2: with light
    bool m_lit = false;                                                    ///< as in the tables
    glm::vec3 m_light{0.0f}, m_eye{0.0f};
    GlBuffer m_entries, m_tables;
    std::vector<SlotRange> m_pieces;  ///< of a run; kept, so that memory is not asked for each frame
};

/// Sets the uniforms of projection.glsl in the program that is in use.
void useProjection(const LayerProjection& projection);

/// Sets what colorOf() of color.glsl takes of a layer: its kind and its range.
void useLayerColors(const LayerColors& colors);

/// Sets the uniforms of size.glsl; `least` and `most`: steps that the device can draw.
void usePointSize(const LayerProjection& projection, int least, int most);

/// Sets the uniforms of clip.glsl.
void useClip(const LayerClip& clip);

/// Bits of the classes that a scene shows, as shaders take them: two uvec4.
std::array<std::uint32_t, 8> shownClasses(const FrameScene& scene) noexcept;

}  // namespace punctum::render
