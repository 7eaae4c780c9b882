// SPDX-License-Identifier: MIT
#include "render/raster/gl/GlPicture.h"

#include "render/raster/gl/Shaders.h"
#include "render/resolve/EyeDome.h"
#include "render/resolve/HoleFill.h"
#include "uniforms.h"

#include <epoxy/gl.h>

#include <bit>
#include <limits>
#include <utility>

namespace punctum::render
{

namespace
{

// Texture units; those before are the visibility buffer's.
constexpr GLenum kFirstUnit = GL_TEXTURE3, kSecondUnit = GL_TEXTURE4;

/// A program that runs over whole pictures.
GlProgram whole(std::string_view name)
{
    return GlProgram::compute(name, {kShaderHead, shader(std::string(name) + ".glsl")});
}

void bind(GLenum unit, GLenum target, GlId texture)
{
    glActiveTexture(unit);
    glBindTexture(target, texture);
    glActiveTexture(GL_TEXTURE0);
}

void runOver(int width, int height)
{
    glDispatchCompute(GLuint(width + 15) / 16, GLuint(height + 15) / 16, 1);
}

}  // namespace

void GlPicture::reset()
{
    for (GlTexture* const t : {&m_picture, &m_other, &m_sums, &m_levels, &m_depths, &m_otherDepths, &m_ids})
        t->reset();
}

GlTexture GlPicture::texture(unsigned format, int width, int height, int layers) const
{
    checkGlErrors("drawing");
    GlTexture t = GlTexture::create();
    const GLenum target = layers > 0 ? GL_TEXTURE_2D_ARRAY : GL_TEXTURE_2D;
    glBindTexture(target, t.id());
    if (layers > 0)
        glTexStorage3D(target, 1, format, width, height, layers);
    else
        glTexStorage2D(target, 1, format, width, height);
    glTexParameteri(target, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glTexParameteri(target, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    glBindTexture(target, 0);
    checkGlErrors("making the picture");
    return t;
}

GlId GlPicture::picture(const GlVisibility& visibility)
{
    const TargetSize size = visibility.size();
    if (!m_picture) m_picture = texture(GL_R32UI, size.width, size.height);
    return m_picture.id();
}

GlId GlPicture::sums(const GlVisibility& visibility)
{
    const TargetSize size = visibility.size();
    if (!m_sums) m_sums = texture(GL_RGBA32UI, size.width, size.height);
    return m_sums.id();
}

void GlPicture::prepareLight(GlVisibility& visibility, const EyeDomeSettings& settings)
{
    const TargetSize size = visibility.size();
    if (!m_levels) m_levels = texture(GL_R32F, size.width, size.height, size.samples);
    if (!m_extent) m_extent = texture(GL_R32F, 2, 1);
    GlProgram& program = m_levelPrograms[sampleCountIndex(size.samples)];
    if (!program) program = visibility.reader("levels.comp", {shader("eyedome.glsl"), shader("levels.comp.glsl")});
    if (!m_extentProgram)
        m_extentProgram =
            GlProgram::compute("extent.comp", {kShaderHead, shader("eyedome.glsl"), shader("extent.comp.glsl")});
    program.use();
    glUniform1i(at::kLogarithmic, settings.perspective);
    glBindImageTexture(2, m_levels.id(), 0, GL_TRUE, 0, GL_WRITE_ONLY, GL_R32F);
    visibility.runOverAll();
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);

    m_extentProgram.use();
    glUniform1f(at::kStrength, settings.strength);
    glUniform1f(at::kFixedExtent, settings.extent);
    bind(kFirstUnit, GL_TEXTURE_2D_ARRAY, m_levels.id());
    glBindImageTexture(3, m_extent.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    glDispatchCompute(1, 1, 1);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    bind(kSecondUnit, GL_TEXTURE_2D, m_extent.id());
}

void GlPicture::makeDepths(GlVisibility& visibility)
{
    const TargetSize size = visibility.size();
    if (!m_depths) m_depths = texture(GL_R32F, size.width, size.height);
    GlProgram& program = m_nearest[sampleCountIndex(size.samples)];
    if (!program) program = visibility.reader("nearest.comp", {shader("nearest.comp.glsl")});
    program.use();
    glBindImageTexture(2, m_depths.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
    visibility.runOverAll();
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

void GlPicture::closeHoles(GlVisibility& visibility)
{
    const TargetSize size = visibility.size();
    makeDepths(visibility);
    if (!m_other) m_other = texture(GL_R32UI, size.width, size.height);
    if (!m_otherDepths) m_otherDepths = texture(GL_R32F, size.width, size.height);
    if (!m_holes) m_holes = whole("holes.comp");
    m_holes.use();
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    for (int pass = 0; pass < kHoleReach; ++pass) {
        bind(kFirstUnit, GL_TEXTURE_2D, m_depths.id());
        bind(kSecondUnit, GL_TEXTURE_2D, m_picture.id());
        glBindImageTexture(1, m_other.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
        glBindImageTexture(2, m_otherDepths.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
        runOver(size.width, size.height);
        glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
        std::swap(m_picture, m_other);
        std::swap(m_depths, m_otherDepths);
    }
}

void GlPicture::read(Image& out)
{
    if (!m_picture) return;
    glBindTexture(GL_TEXTURE_2D, m_picture.id());
    static_assert(std::endian::native == std::endian::little);  // the lowest byte of a word is red
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, out.pixels.data());
    glBindTexture(GL_TEXTURE_2D, 0);
    m_traffic.down += out.pixels.size() * sizeof(Rgba8);
}

void GlPicture::copyTo(GlId texture, const TargetSize& size)
{
    if (!m_picture) return;
    if (!m_show) m_show = whole("show.comp");
    m_show.use();
    bind(kSecondUnit, GL_TEXTURE_2D, m_picture.id());
    glBindImageTexture(1, texture, 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
    runOver(size.width, size.height);
    glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT);
}

void GlPicture::depths(GlVisibility& visibility, std::vector<float>& out)
{
    const TargetSize size = visibility.size();
    out.assign(std::size_t(size.width) * std::size_t(size.height), std::numeric_limits<float>::infinity());
    if (visibility.empty()) return;
    makeDepths(visibility);
    glBindTexture(GL_TEXTURE_2D, m_depths.id());
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RED, GL_FLOAT, out.data());
    glBindTexture(GL_TEXTURE_2D, 0);
    m_traffic.down += out.size() * sizeof(float);
    for (float& depth : out)
        if (depth >= kNoLevel) depth = std::numeric_limits<float>::infinity();
}

void GlPicture::nearestIds(GlVisibility& visibility, std::vector<PointId>& out)
{
    const TargetSize size = visibility.size();
    out.assign(std::size_t(size.width) * std::size_t(size.height), kNoPoint);
    if (visibility.empty()) return;
    if (!m_ids) m_ids = texture(GL_R32UI, size.width, size.height);
    GlProgram& program = m_nearestIds[sampleCountIndex(size.samples)];
    if (!program) program = visibility.reader("nearestid.comp", {shader("nearestid.comp.glsl")});
    program.use();
    glBindImageTexture(2, m_ids.id(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32UI);
    visibility.runOverAll();
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    glBindTexture(GL_TEXTURE_2D, m_ids.id());
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RED_INTEGER, GL_UNSIGNED_INT, out.data());
    glBindTexture(GL_TEXTURE_2D, 0);
    m_traffic.down += out.size() * sizeof(PointId);
}

}  // namespace punctum::render
