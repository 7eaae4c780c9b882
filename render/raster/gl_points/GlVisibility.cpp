// SPDX-License-Identifier: MIT
#include "render/raster/gl_points/GlVisibility.h"

#include "core/Error.h"
#include "resources.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>

namespace punctum::render
{
namespace
{

constexpr GLuint kGroup = 16;  ///< of collect.comp and covered.comp, both ways

GLuint groups(int pixels, GLuint group)
{
    return (GLuint(pixels) + group - 1) / group;
}

/// A buffer that is large enough, made anew when it is not.
void reserve(GlBuffer& buffer, std::size_t bytes)
{
    if (buffer.size() < bytes) {
        buffer = GlBuffer();
        buffer = GlBuffer::allocate(bytes);
    }
}

std::string_view shader(std::string_view name)
{
    return resource("shaders/gl_points/" + std::string(name));
}

}  // namespace

std::string GlVisibility::shaderHead(int samples)
{
    return "#version 430 core\n#define SAMPLES " + std::to_string(samples) + "\n" +
           std::string(shader("visibility.glsl"));
}

GlVisibility::Programs& GlVisibility::programs()
{
    Programs& p = m_programs[sampleCountIndex(m_size.samples)];
    if (!p.covered) {
        const std::string head = shaderHead(m_size.samples);
        p.count = GlProgram::compute("collect.comp", {head, shader("collect.comp.glsl")});
        p.fill = GlProgram::compute("collect.comp", {head, "#define FILL\n", shader("collect.comp.glsl")});
        p.read = GlProgram::compute("read.comp", {head, shader("read.comp.glsl")});
        p.covered = GlProgram::compute("covered.comp", {head, shader("covered.comp.glsl")});
    }
    return p;
}

void GlVisibility::setSize(const TargetSize& size, const GlInfo& info)
{
    if (size.width > info.maxTextureSize || size.height > info.maxTextureSize)
        throw Error("The graphics card draws pictures of at most " + std::to_string(info.maxTextureSize) +
                    " px a side. Ask for a smaller one or choose the CPU backend.");
    checkSampleCount(size.samples);
    if (size.samples > info.maxIntegerSamples)
        throw Error("The graphics card offers at most " + std::to_string(info.maxIntegerSamples) +
                    " samples a pixel for point numbers. Choose fewer samples or the CPU backend.");
    m_framebuffer.reset();
    m_ids.reset();
    m_depths.reset();
    m_bands.clear();
    m_size = size;
    if (size.width <= 0 || size.height <= 0) return;

    checkGlErrors("drawing");
    const GLenum target = size.samples == 1 ? GL_TEXTURE_2D : GL_TEXTURE_2D_MULTISAMPLE;
    const auto storage = [&](GLenum format) {
        GlTexture texture = GlTexture::create();
        glActiveTexture(GL_TEXTURE0);
        glBindTexture(target, texture.id());
        if (size.samples == 1) {
            glTexStorage2D(target, 1, format, size.width, size.height);
            glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
            glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
        } else {
            glTexStorage2DMultisample(target, size.samples, format, size.width, size.height, GL_TRUE);
        }
        glBindTexture(target, 0);
        return texture;
    };
    m_ids = storage(GL_R32UI);
    m_depths = storage(GL_DEPTH_COMPONENT32F);
    GlFramebuffer framebuffer = GlFramebuffer::create();
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer.id());
    glFramebufferTexture(GL_FRAMEBUFFER, GL_COLOR_ATTACHMENT0, m_ids.id(), 0);
    glFramebufferTexture(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, m_depths.id(), 0);
    checkGlErrors("making the picture's buffers");
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        throw Error("The graphics card cannot draw point numbers of " + std::to_string(size.samples) +
                    " samples a pixel. Choose 1 sample or the CPU backend.");
    m_framebuffer = std::move(framebuffer);
    clear();
}

void GlVisibility::bindFramebuffer() const
{
    glBindFramebuffer(GL_FRAMEBUFFER, m_framebuffer.id());
}

void GlVisibility::bindTextures() const
{
    const GLenum target = m_size.samples == 1 ? GL_TEXTURE_2D : GL_TEXTURE_2D_MULTISAMPLE;
    glActiveTexture(GL_TEXTURE1);
    glBindTexture(target, m_depths.id());
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(target, m_ids.id());
}

void GlVisibility::clear()
{
    if (empty()) return;
    bindFramebuffer();
    glDisable(GL_SCISSOR_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    const GLuint none[4] = {kNoPoint, kNoPoint, kNoPoint, kNoPoint};
    const GLfloat farthest = 0.0f;
    glClearBufferuiv(GL_COLOR, 0, none);
    glClearBufferfv(GL_DEPTH, 0, &farthest);
}

std::span<const GlVisibility::Band> GlVisibility::collect(std::span<const PointId> firstIds)
{
    if (empty() || firstIds.empty()) return {};
    Programs& p = programs();
    if (!m_scan) m_scan = GlProgram::compute("scan.comp", {"#version 430 core\n", shader("scan.comp.glsl")});

    const std::size_t rowSamples = std::size_t(m_size.width) * std::size_t(m_size.samples);
    const int bandRows = int(std::clamp<std::size_t>(m_bandSamples / rowSamples, 1, std::size_t(m_size.height)));
    const int bands = (m_size.height + bandRows - 1) / bandRows;
    const auto chunks = GLuint(firstIds.size());
    reserve(m_firstIds, firstIds.size_bytes());
    m_firstIds.write(0, firstIds.data(), firstIds.size_bytes());
    m_bands.resize(std::size_t(bands));

    bindTextures();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, m_firstIds.id());
    for (int i = 0; i < bands; ++i) {
        Band& band = m_bands[std::size_t(i)];
        reserve(band.commands, chunks * sizeof(Command));
        reserve(band.list, rowSamples * std::size_t(bandRows) * sizeof(std::uint32_t));
        band.commands.clear();
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, band.commands.id());
        glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 2, band.list.id());
        const int first = i * bandRows, last = std::min(m_size.height, first + bandRows);
        for (const GlProgram* program : {&p.count, &m_scan, &p.fill}) {
            program->use();
            glUniform1ui(1, chunks);
            if (program == &m_scan) {
                glDispatchCompute(1, 1, 1);
            } else {
                glUniform4i(0, first, last, m_size.width, 0);
                glDispatchCompute(groups(m_size.width, kGroup), groups(last - first, kGroup), 1);
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
    band.commands.read(0, commands.data(), chunks * sizeof(Command));
    const Command& last = commands.back();
    list.resize(std::size_t(last.firstIndex) + last.count);
    if (!list.empty()) band.list.read(0, list.data(), list.size() * sizeof(std::uint32_t));
    return commands;
}

float GlVisibility::Sample::metric() const noexcept
{
    constexpr std::uint32_t kSum = 0x3F800000u + 0x2B800000u;  // points.vert.glsl
    return std::bit_cast<float>(kSum - depth);
}

void GlVisibility::read(int x, int y, int width, int height, std::vector<Sample>& out)
{
    out.resize(std::size_t(width) * std::size_t(height) * std::size_t(m_size.samples));
    reserve(m_scratch, out.size() * sizeof(Sample));
    bindTextures();
    programs().read.use();
    glUniform4i(0, x, y, width, height);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, m_scratch.id());
    glDispatchCompute(groups(width, 8), groups(height, 8), 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    m_scratch.read(0, out.data(), out.size() * sizeof(Sample));
}

void GlVisibility::depths(std::vector<float>& out)
{
    const auto width = std::size_t(m_size.width), samples = std::size_t(m_size.samples);
    out.assign(width * std::size_t(m_size.height), std::numeric_limits<float>::infinity());
    if (empty()) return;
    const int rows = int(std::max<std::size_t>(1, m_bandSamples / (width * samples)));
    std::vector<Sample> band;
    for (int y = 0; y < m_size.height; y += rows) {
        read(0, y, m_size.width, std::min(rows, m_size.height - y), band);
        float* const nearest = out.data() + std::size_t(y) * width;
        for (std::size_t k = 0; k < band.size(); ++k)
            if (band[k].id != kNoPoint) nearest[k / samples] = std::min(nearest[k / samples], band[k].metric());
    }
}

std::optional<RasterBackend::Hit> GlVisibility::pick(int x, int y, int radius)
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
    std::optional<RasterBackend::Hit> best;
    int bestDistance = radius * radius;
    std::size_t at = 0;
    for (int py = y0; py < y1; ++py)
        for (int px = x0; px < x1; ++px)
            for (std::size_t s = 0; s < samples; ++s, ++at) {
                const int distance = (px - x) * (px - x) + (py - y) * (py - y);
                if (found[at].id == kNoPoint || distance > bestDistance) continue;
                const float depth = found[at].metric();
                if (best && distance == bestDistance && depth >= best->depth) continue;
                bestDistance = distance;
                best = RasterBackend::Hit{found[at].id, depth};
            }
    return best;
}

double GlVisibility::coveredShare()
{
    if (empty()) return 0.0;
    reserve(m_scratch, 4);
    const std::uint32_t zero = 0;
    m_scratch.write(0, &zero, 4);
    bindTextures();
    programs().covered.use();
    glUniform2i(0, m_size.width, m_size.height);
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, m_scratch.id());
    glDispatchCompute(groups(m_size.width, kGroup), groups(m_size.height, kGroup), 1);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    std::uint32_t covered = 0;
    m_scratch.read(0, &covered, 4);
    return double(covered) / (double(m_size.width) * double(m_size.height));
}

}  // namespace punctum::render
