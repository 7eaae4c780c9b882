// SPDX-License-Identifier: MIT
#pragma once

#include "render/gl/GlObjects.h"
#include "render/raster/VisibilityBuffer.h"

#include <array>
#include <span>
#include <vector>

namespace punctum::render
{

/// The visibility buffer on the device: point id and depth per sample, and what is read out of it. How they are
/// stored is the derived classes' business. Owned by the backend; the thread of its context. Changes bindings of
/// the context: callers hold a GlStateGuard. Members throw Error.
class GlVisibility
{
public:
    virtual ~GlVisibility() = default;
    GlVisibility(const GlVisibility&) = delete;
    GlVisibility& operator=(const GlVisibility&) = delete;

    /// An empty buffer. Width or height 0: none, and all else does nothing.
    void setSize(const TargetSize& size, const GlInfo& info);
    const TargetSize& size() const noexcept { return m_size; }
    bool empty() const noexcept { return m_bands.empty(); }
    void clear();

    /// As glDrawElementsIndirect and glDispatchComputeIndirect read it, and collect.comp and scan.comp write it.
    struct Command {
        std::uint32_t count, instances, firstIndex;
        std::int32_t baseVertex;
        std::uint32_t baseInstance;
        std::uint32_t groups[3];
        std::uint32_t written;            ///< used by collect.comp
        std::uint32_t offset, run, step;  ///< used by budget.comp: GlBudget::Piece ...
        std::uint32_t before;             ///< ... and slots of the runs before its own
    };
    static_assert(sizeof(Command) == 52 && offsetof(Command, groups) == 20);

    /// Rows of the picture that are stored together, and the visible points of them, sorted by chunk.
    struct Band {
        int firstRow = 0;
        int lastRow = 0;    ///< excluded
        GlBuffer commands;  ///< a Command a chunk
        GlBuffer list;      ///< uint32: id - first id of the chunk; empty: the slots of the commands as they lie
    };
    std::span<const Band> bands() const noexcept { return m_bands; }

    /// Lists what is visible on the device, each point once for each band that shows it. `firstIds`: of the chunks
    /// of ids, rising; an id belongs to the last chunk that begins at or before it. `groupPoints`: points that one
    /// work group draws, for Command::groups. Valid until the next call.
    std::span<const Band> collect(std::span<const PointId> firstIds, std::uint32_t groupPoints = 1);
    /// Reads a band back; returns the commands, ids relative to their chunk in `list`.
    std::vector<Command> readBack(const Band& band, std::size_t chunks, std::vector<std::uint32_t>& list);

    std::optional<VisibilityBuffer::Hit> pick(int x, int y, int radius);
    double coveredShare();

    /// Room for sums of colors, all 0, where there are none since clear() or clearSums().
    void requireSums();
    /// No color has been added.
    void clearSums() noexcept { m_summed = false; }
    bool hasSums() const noexcept { return m_summed; }
    /// Makes meanAt() of the sums.
    virtual void makeMeans() {}

    /// A compute shader that reads the buffer by idAt() and depthAt(), and the means of added colors by meanAt()
    /// where `means`; SAMPLES defined.
    GlProgram reader(std::string_view name, std::initializer_list<std::string_view> source,
                     bool means = false) const;
    /// Runs a reader, which is in use, over the pixels of a band, in groups of 16 x 16: uniform `band` gets first
    /// row, last row, width.
    void runOver(const Band& band);
    /// The same over all bands.
    void runOverAll();
    /// Lets shaders read a band: before each run of a reader.
    virtual void bindForReading(const Band& band) = 0;

protected:
    /// `bandSamples`: the most samples of a band. `traffic` outlives it and counts what goes to and fro.
    GlVisibility(std::size_t bandSamples, GlTraffic& traffic) : m_traffic(traffic), m_bandSamples(bandSamples) {}
    /// Makes room for bands(), or for nothing when there are none.
    virtual void makeStorage(const GlInfo& info) = 0;
    /// What defines idAt() and depthAt(), and where MEANS is defined meanAt().
    virtual std::string accessors() const = 0;
    virtual void emptyCells() = 0;
    /// Makes room for sums where there is none, and sets them to 0.
    virtual void emptySums() = 0;

private:
    /// As read.comp writes it.
    struct Sample {
        PointId id;
        float depth;  ///< along the view direction, view units
    };
    void read(int x, int y, int width, int height, std::vector<Sample>& out);

    struct Programs {
        GlProgram count, fill, read, covered;
    };
    Programs& programs();

    GlTraffic& m_traffic;
    std::size_t m_bandSamples;
    TargetSize m_size;
    std::array<Programs, kSampleCounts.size()> m_programs;  ///< made when first needed
    GlProgram m_scan;
    GlBuffer m_firstIds, m_scratch;
    std::vector<Band> m_bands;
    bool m_summed = false;
};

}  // namespace punctum::render
