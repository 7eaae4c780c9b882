// SPDX-License-Identifier: MIT
#include "core/edit/ClassCommand.h"

#include "core/Error.h"
#include "core/cloud/Slabs.h"
#include "core/task/LockedLoop.h"

#include <algorithm>
#include <mutex>
#include <utility>

namespace punctum
{

namespace
{

constexpr std::uint32_t kLastClass = 255;
constexpr std::size_t kPiece = 1 << 18;  ///< points that one task takes

}  // namespace

Attribute classAttribute(const PointCloud& cloud, std::uint32_t code)
{
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const found = cloud.findAttribute("Classification");
    if (found == nullptr || found->components != 1 || found->columns[0]->components() != 1 ||
        found->type() != ScalarType::U8)
        throw Error("This cloud has no classes; nothing can be classified.");
    if (code > kLastClass) throw Error(std::to_string(code) + " is no class; classes are 0 to 255.");
    return *found;
}

namespace
{

/// Gives Classification a column of its own, of whole bytes, then sets the classes there.
class WideClassCommand final : public Command
{
public:
    WideClassCommand(std::string name, const Attribute& narrow, std::shared_ptr<const PointSet> points,
                     std::vector<std::byte> codes)
        : Command(name), m_narrow(narrow), m_wide(narrow)
    {
        m_wide.columns[0] = std::make_shared<Column>(narrow.name, ScalarType::U8, narrow.size());
        m_wide.bitShift = m_wide.bitWidth = 0;
        m_edit = std::make_unique<ValueCommand>(std::move(name), m_wide, std::move(points), std::move(codes));
        m_notice.kind = ChangeNotice::Kind::Attributes;
        m_notice.attributes.push_back(narrow.name);
    }

    PointIndex changedPoints() const noexcept override { return m_edit->changedPoints(); }
    std::shared_ptr<const PointSet> points() const override { return m_edit->points(); }

    void apply(PointCloud& cloud) noexcept override
    {
        if (m_done) m_edit->apply(cloud);
        {
            const std::unique_lock lock(cloud.mutex());
            if (!std::exchange(m_filled, true)) fill(lock);
            cloud.replaceAttribute(m_done ? m_narrow : m_wide);
            m_detached.clear();
            if (m_done) m_detached.add(m_wide.columns[0]);
        }
        cloud.notify(m_notice);
        if (!m_done) m_edit->apply(cloud);
        m_done = !m_done;
    }

    void prepare() override
    {
        m_edit->prepare();
        m_detached.fetch();
    }
    void stow() noexcept override { m_edit->stow(); }
    void spill(SpillFile& file) override
    {
        m_edit->spill(file);
        m_detached.spill(file);
    }
    std::size_t memory() const noexcept override { return m_edit->memory() + m_detached.memory(); }
    std::size_t spilled() const noexcept override { return m_edit->spilled() + m_detached.spilled(); }

    Effect effect() const override { return {{m_wide.columns[0]}, {m_wide}, {m_narrow}}; }
    void cross(const Column& column, std::span<std::byte> values) const override { m_edit->cross(column, values); }

private:
    void fill(const std::unique_lock<std::shared_mutex>& lock) const
    {
        const std::uint8_t* const from = m_narrow.columns[0]->values<std::uint8_t>().data();
        std::uint8_t* const to = m_wide.columns[0]->values<std::uint8_t>().data();
        const auto mask = std::uint8_t(m_narrow.maxBits());
        const unsigned shift = m_narrow.bitShift;
        forPiecesLocked(lock, m_narrow.size(), kPiece, [=](std::size_t first, std::size_t last) {
            for (std::size_t i = first; i < last; ++i) to[i] = std::uint8_t((from[i] >> shift) & mask);
        });
    }

    DetachedColumns m_detached;
    Attribute m_narrow, m_wide;
    std::unique_ptr<ValueCommand> m_edit;
    ChangeNotice m_notice;
    bool m_filled = false;
    bool m_done = false;
};

}  // namespace

std::unique_ptr<Command> makeClassCommand(std::string name, const Attribute& classes,
                                          std::shared_ptr<const PointSet> points, std::uint32_t code)
{
    const PointIndex count = points->count();
    if (count == 0) return nullptr;
    if (code > classes.maxBits())
        return std::make_unique<WideClassCommand>(std::move(name), classes, std::move(points),
                                                  std::vector<std::byte>(count, std::byte(code)));
    return std::make_unique<ValueCommand>(std::move(name), classes, std::move(points),
                                          std::vector<std::byte>(count, std::byte(code << classes.bitShift)));
}

std::unique_ptr<Command> makeClassCommand(std::string name, const Attribute& classes,
                                          std::shared_ptr<const PointSet> points, std::vector<std::byte> codes)
{
    if (codes.empty()) return nullptr;
    auto highest = std::byte(0);
    for (const std::byte code : codes) highest = std::max(highest, code);
    if (std::uint64_t(highest) > classes.maxBits())
        return std::make_unique<WideClassCommand>(std::move(name), classes, std::move(points), std::move(codes));
    // ValueCommand takes from these bytes the bits of the class field alone, so that flags beside it need no copy.
    if (classes.bitShift != 0)
        for (std::byte& code : codes) code <<= classes.bitShift;
    return std::make_unique<ValueCommand>(std::move(name), classes, std::move(points), std::move(codes));
}

void leaveOutValue(PointSet& points, const PointCloud& cloud, const Attribute& field, std::uint32_t value,
                   Progress& progress)
{
    if (value > field.maxBits()) return;  // the field cannot hold it: no point has it yet
    const std::uint8_t* const byte = field.columns[0]->values<std::uint8_t>().data();
    const auto mask = std::uint8_t(field.maxBits() << field.bitShift);
    const auto bits = std::uint8_t(value << field.bitShift);
    forEachSlab(cloud, progress, [&](std::size_t firstWord, std::size_t lastWord) {
        points.forEachInWords(firstWord, lastWord, [&](PointIndex i) {
            if ((byte[i] & mask) == bits) points.remove(i);
        });
    });
}

}  // namespace punctum
