// SPDX-License-Identifier: MIT
#include "render/raster/gl/GlBudget.h"

#include "resources.h"
#include "uniforms.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <utility>
#include <vector>

namespace punctum::render
{

namespace
{

/// As budget.comp has it.
struct Clock {
    std::uint64_t times[4];
    std::uint32_t total, unused;
};
static_assert(sizeof(Clock) == 40);

/// The shader counts nanoseconds in 32 bits.
constexpr double kMostSeconds = 4.0;

}  // namespace

GlBuffer& GlBudget::clock()
{
    if (!m_clock) {
        m_clock = GlBuffer::allocate(sizeof(Clock));
        m_clock.clear();
    }
    return m_clock;
}

void GlBudget::mark(Moment moment)
{
    const auto at = std::size_t(moment);
    GlQuery& query = m_queries[at];
    if (!query) query = GlQuery::create();
    glQueryCounter(query.id(), GL_TIMESTAMP);
    // Into the buffer when the device gets there: the pointer is an offset.
    glBindBuffer(GL_QUERY_BUFFER, clock().id());
    glGetQueryObjectui64v(query.id(), GL_QUERY_RESULT, reinterpret_cast<GLuint64*>(at * sizeof(std::uint64_t)));
    glBindBuffer(GL_QUERY_BUFFER, 0);
}

const GlVisibility::Band& GlBudget::decide(std::span<const Piece> pieces, Slot firstSlots,
                                           std::uint32_t groupPoints, double seconds)
{
    if (!m_program)
        m_program = GlProgram::compute("budget.comp", {kShaderHead, resource("shaders/gl/command.glsl"),
                                                       resource("shaders/gl/budget.comp.glsl")});
    std::vector<GlVisibility::Command> commands;
    Slot before = 0, run = 0;
    for (const Piece& p : pieces) {
        if (p.offset == 0) before += std::exchange(run, p.run);
        commands.push_back({p.count, 1, p.first, 0, 0, {0, 1, 1}, 0, p.offset, p.run, p.step, before});
    }
    const std::size_t bytes = commands.size() * sizeof(GlVisibility::Command);
    m_decided.commands.reserve(std::max(bytes, sizeof(GlVisibility::Command)));
    m_decided.commands.write(0, commands.data(), bytes, m_traffic);
    m_firstSlots = firstSlots;

    m_program.use();
    glUniform1ui(at::kCommandCount, GLuint(commands.size()));
    glUniform1ui(at::kGroupPoints, groupPoints);
    glUniform1ui(at::kFirstSlots, firstSlots);
    glUniform1ui(at::kBudget, GLuint(std::clamp(seconds, 0.0, kMostSeconds) * 1e9));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, clock().id());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, m_decided.commands.id());
    glMemoryBarrier(GL_QUERY_BUFFER_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
    glDispatchCompute(1, 1, 1);
    glMemoryBarrier(GL_COMMAND_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT |
                    GL_QUERY_BUFFER_BARRIER_BIT);
    return m_decided;
}

PointDrawing::Timed GlBudget::result() const
{
    Clock clock{};
    m_clock.read(0, &clock, sizeof clock, m_traffic);
    const auto seconds = [&](Moment from, Moment to) {
        const auto a = clock.times[std::size_t(from)], b = clock.times[std::size_t(to)];
        return b > a ? double(b - a) * 1e-9 : 0.0;
    };
    return {std::uint64_t(m_firstSlots) + clock.total, seconds(Moment::Start, Moment::FirstBegins),
            seconds(Moment::FirstBegins, Moment::Done), seconds(Moment::Start, Moment::Done)};
}

}  // namespace punctum::render
