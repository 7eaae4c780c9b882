// SPDX-License-Identifier: MIT
#include "render/raster/gl/GlVisibility.h"

#include "render/raster/gl/Shaders.h"
#include "uniforms.h"

#include <epoxy/gl.h>

#include <algorithm>

namespace punctum::render
{
namespace
{

constexpr GLuint kGroup = 16;  ///< of the shaders that run over pixels, both ways

GLuint groups(int pixels, GLuint group)
{
    return (GLuint(pixels) + group - 1) / group;
}

}  // namespace

GlProgram GlVisibility::reader(std::string_view name, std::initializer_list<std::string_view> source,
                               bool means) const
{
    std::string text = std::string(kShaderHead) + "#define SAMPLES " + std::to_string(m_size.samples) + "\n" +
                       (means ? "#define MEANS\n" : "") + accessors();
    for (const std::string_view piece : source) text += piece;
    return GlProgram::compute(name, {text});
}

GlVisibility::Programs& GlVisibility::programs()
{
    Programs& p = m_programs[sampleCountIndex(m_size.samples)];
    if (!p.covered) {
        p.count = reader("collect.comp", {shader("command.glsl"), shader("collect.comp.glsl")});
        p.fill = reader("collect.comp", {"#define FILL\n", shader("command.glsl"), shader("collect.comp.glsl")});
        p.read = reader("read.comp", {shader("read.comp.glsl")});
        p.covered = reader("covered.comp", {shader("covered.comp.glsl")});
    }
    return p;
}

void GlVisibility::setSize(const TargetSize& size, const GlInfo& info)
{
    checkSampleCount(size.samples);
    m_bands.clear();
    m_size = size;
    if (size.width > 0 && size.height > 0) {
        const std::size_t rowSamples = std::size_t(size.width) * std::size_t(size.samples);
        const int rows = int(std::clamp<std::size_t>(m_bandSamples / rowSamples, 1, std::size_t(size.height)));
        for (int first = 0; first < size.height; first += rows) {
            Band band;
            band.firstRow = first;
            band.lastRow = std::min(size.height, first + rows);
            m_bands.push_back(std::move(band));
        }
    }
    try {
        makeStorage(info);
        clear();
    } catch (...) {
        m_bands.clear();
        throw;
    }
}

void GlVisibility::clear()
{
    m_summed = false;
    if (!empty()) emptyCells();
}

void GlVisibility::requireSums()
{
    if (!m_summed && !empty()) emptySums();
    m_summed = true;
}

void GlVisibility::runOver(const Band& band)
{
    glUniform4i(at::kBand, band.firstRow, band.lastRow, m_size.width, 0);
    glDispatchCompute(groups(m_size.width, kGroup), groups(band.lastRow - band.firstRow, kGroup), 1);
}

void GlVisibility::runOverAll()
{
    for (const Band& band : m_bands) {
        bindForReading(band);
        runOver(band);
    }
}

std::span<const GlVisibility::Band> GlVisibility::collect(std::span<const PointId> firstIds,
                                                          std::uint32_t groupPoints)
{
    if (empty() || firstIds.empty()) return {};
    Programs& p = programs();
    if (!m_scan)
        m_scan = GlProgram::compute("scan.comp", {kShaderHead, shader("command.glsl"), shader("scan.comp.glsl")});
    const std::size_t rowSamples = std::size_t(m_size.width) * std::size_t(m_size.samples);
    const auto chunks = GLuint(firstIds.size());
    m_firstIds.reserve(firstIds.size_bytes());
    m_firstIds.write(0, firstIds.data(), firstIds.size_bytes(), m_traffic);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, m_firstIds.id());
    for (Band& band : m_bands) {
        band.commands.reserve(chunks * sizeof(Command));
        band.list.reserve(rowSamples * std::size_t(band.lastRow - band.firstRow) * sizeof(std::uint32_t));
        band.commands.clear();
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, band.commands.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, band.list.id());
        for (const GlProgram* program : {&p.count, &m_scan, &p.fill}) {
            program->use();
            glUniform1ui(at::kChunkCount, chunks);
            if (program == &m_scan) {
                glUniform1ui(at::kGroupPoints, groupPoints);
                glDispatchCompute(1, 1, 1);
            } else {
                bindForReading(band);
                runOver(band);
            }
            glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
        }
    }
    glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_ELEMENT_ARRAY_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
    return m_bands;
}

std::vector<GlVisibility::Command> GlVisibility::readBack(const Band& band, std::size_t chunks,
                                                          std::vector<std::uint32_t>& list)
{
    std::vector<Command> commands(chunks);
    band.commands.read(0, commands.data(), chunks * sizeof(Command), m_traffic);
    const Command& last = commands.back();
    list.resize(std::size_t(last.firstIndex) + last.count);
    if (!list.empty()) band.list.read(0, list.data(), list.size() * sizeof(std::uint32_t), m_traffic);
    return commands;
}

void GlVisibility::read(int x, int y, int width, int height, std::vector<Sample>& out)
{
    out.resize(std::size_t(width) * std::size_t(height) * std::size_t(m_size.samples));
    m_scratch.reserve(out.size() * sizeof(Sample));
    programs().read.use();
    glUniform4i(at::kRectangle, x, y, width, height);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, m_scratch.id());
    for (const Band& band : m_bands) {
        if (band.firstRow >= y + height || band.lastRow <= y) continue;
        bindForReading(band);
        glUniform2i(at::kRows, band.firstRow, band.lastRow);
        glDispatchCompute(groups(width, 8), groups(height, 8), 1);
    }
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    m_scratch.read(0, out.data(), out.size() * sizeof(Sample), m_traffic);
}

std::optional<VisibilityBuffer::Hit> GlVisibility::pick(int x, int y, int radius)
{
    if (empty() || radius < 0) return std::nullopt;
    radius = std::min(radius, 1024);
    const int x0 = std::max(0, x - radius), x1 = std::min(m_size.width, x + radius + 1);
    const int y0 = std::max(0, y - radius), y1 = std::min(m_size.height, y + radius + 1);
    if (x0 >= x1 || y0 >= y1) return std::nullopt;

    const std::size_t samples = std::size_t(m_size.samples);
    std::vector<Sample> found;
    read(x0, y0, x1 - x0, y1 - y0, found);

    // The nearest pixel wins, in it the nearest point: as the CPU backend has it.
    std::optional<VisibilityBuffer::Hit> best;
    int bestDistance = radius * radius;
    std::size_t at = 0;
    for (int py = y0; py < y1; ++py)
        for (int px = x0; px < x1; ++px)
            for (std::size_t s = 0; s < samples; ++s, ++at) {
                const int distance = (px - x) * (px - x) + (py - y) * (py - y);
                if (found[at].id == kNoPoint || distance > bestDistance) continue;
                if (best && distance == bestDistance && found[at].depth >= best->depth) continue;
                bestDistance = distance;
                best = VisibilityBuffer::Hit{found[at].id, found[at].depth};
            }
    return best;
}

double GlVisibility::coveredShare()
{
    if (empty()) return 0.0;
    m_scratch.reserve(4);
    const std::uint32_t zero = 0;
    m_scratch.write(0, &zero, 4, m_traffic);
    programs().covered.use();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, m_scratch.id());
    runOverAll();
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    std::uint32_t covered = 0;
    m_scratch.read(0, &covered, 4, m_traffic);
    return double(covered) / (double(m_size.width) * double(m_size.height));
}

}  // namespace punctum::render
