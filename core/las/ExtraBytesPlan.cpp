// SPDX-License-Identifier: MIT
#include "core/las/ExtraBytesPlan.h"

#include "core/las/FormatNeeds.h"
#include "core/las/SourceFile.h"

#include <algorithm>

namespace punctum::las
{

namespace
{

constexpr std::size_t kLongestRun = 255;  ///< of bytes without a description, in one descriptor

class Planner
{
public:
    Planner(const PointCloud& cloud, const SourceFile& source,
            const std::vector<std::shared_ptr<const Column>>& standard)
        : m_cloud(cloud), m_from(source.layout), m_source(source), m_standard(standard)
    {
    }

    ExtraBytesPlan plan()
    {
        keepSource();
        addOthers();
        // A column of another type in the place of one that went is one that changed, not one that is gone.
        std::erase_if(m_plan.gone, [&](const std::string& name) {
            return std::find(m_plan.added.begin(), m_plan.added.end(), name) != m_plan.added.end();
        });
        return std::move(m_plan);
    }

private:
    void keepSource()
    {
        const std::uint16_t standard = standardRecordLength(m_from.format);
        std::vector<std::string> ignored;
        const auto records = m_source.extraBytesRecords();
        std::size_t field = 0;
        while (field < m_from.fields.size() && m_from.fields[field].offset < standard) ++field;
        for (const ExtraBytesItem& item : parseExtraBytes(records, standard, m_from.length, ignored)) {
            const std::size_t n = item.opaque ? 1 : item.values;
            bool whole = true;
            for (std::size_t k = 0; k < n; ++k) {
                const RecordField& f = m_from.fields[field + k];
                const auto c = matching(f);
                whole = whole && c != nullptr;
                const std::string name = c != nullptr ? nameOf(*c) : f.column;
                if (name == f.column) continue;
                m_plan.renamed.push_back(f.column + " to " + name);
                whole = false;  // described anew, under its name
            }
            m_plan.sourceItems.push_back({item.record, item.place, {}});
            if (whole) {
                m_plan.sourceItems.back().descriptor = m_plan.descriptors.size();
                m_plan.descriptors.push_back(item.descriptor);
            }
            for (std::size_t k = 0; k < n; ++k, ++field) {
                const auto c = take(m_from.fields[field]);
                if (c == nullptr || whole) continue;
                m_plan.descriptors.push_back(n == 1 ? named(item.descriptor, nameOf(*c)) : describe(*c));
            }
        }
        for (; field < m_from.fields.size(); ++field)  // bytes that nobody described
            if (const auto c = take(m_from.fields[field])) addOpaque(*c);
    }

    void addOthers()
    {
        const std::uint16_t standard = standardRecordLength(m_from.format);
        const auto isIn = [](const auto& list, const auto& c) {
            return std::find(list.begin(), list.end(), c) != list.end();
        };
        for (const std::shared_ptr<const Column> c : m_cloud.columns()) {
            const int f = m_from.find(c->name());
            if (f >= 0 && m_from.fields[std::size_t(f)].offset < standard) continue;
            if (m_from.isDerived(c->name())) continue;
            if (isIn(m_standard, c) || isIn(m_plan.columns, c)) continue;
            if (c->components() > 1)
                addOpaque(*c);
            else
                m_plan.descriptors.push_back(describe(*c));
            m_plan.columns.push_back(c);
            m_plan.added.push_back(nameOf(*c));
        }
    }

    std::shared_ptr<const Column> matching(const RecordField& f) const
    {
        auto c = findColumn(m_cloud, f.column);
        return c != nullptr && c->type() == f.type && c->components() == f.components ? c : nullptr;
    }

    std::shared_ptr<const Column> take(const RecordField& f)
    {
        auto c = matching(f);
        if (c == nullptr)
            m_plan.gone.push_back(f.column);
        else
            m_plan.columns.push_back(c);
        return c;
    }

    void addOpaque(const Column& c)
    {
        for (std::size_t left = c.elementBytes(); left > 0;) {
            const std::size_t run = std::min(left, kLongestRun);
            m_plan.descriptors.push_back(
                makeOpaqueDescriptor(std::uint8_t(run), c.name().starts_with("ExtraBytes") ? "" : c.name()));
            left -= run;
        }
    }

    const Attribute* attributeOf(const Column& c) const
    {
        for (const Attribute& a : m_cloud.attributes())
            if (a.components == 1 && a.bitWidth == 0 && a.columns[0].get() == &c) return &a;
        return nullptr;
    }

    /// Fields of the standard that are kept in extra bytes (compatibility mode) are called otherwise there.
    std::string nameOf(const Column& c) const
    {
        const Attribute* const shown = attributeOf(c);
        return shown != nullptr && !shown->standard ? shown->name : c.name();
    }

    static ExtraBytesDescriptor named(ExtraBytesDescriptor d, const std::string& name)
    {
        const std::string cut = cutUtf8(name, kDescriptorText);
        std::fill_n(d.bytes.begin() + kDescriptorNameAt, kDescriptorText, std::byte(0));
        std::memcpy(d.bytes.data() + kDescriptorNameAt, cut.data(), cut.size());
        return d;
    }

    ExtraBytesDescriptor describe(const Column& c) const
    {
        ExtraBytesField field{c.name(), c.type(), {}, {}, {}};
        const Attribute* const shown = attributeOf(c);
        if (shown == nullptr) return makeDescriptor(field);
        field.name = shown->name;
        field.description = shown->description;
        if (shown->scaled) {
            field.scale = shown->scale;
            field.offset = shown->offset;
        }
        ExtraBytesDescriptor d = makeDescriptor(field);
        if (shown->noData) {
            d.bytes[3] |= std::byte(1);
            std::visit([&](auto v) { std::memcpy(d.bytes.data() + kDescriptorNoDataAt, &v, 8); }, *shown->noData);
        }
        return d;
    }

    const PointCloud& m_cloud;
    const RecordLayout& m_from;
    const SourceFile& m_source;
    const std::vector<std::shared_ptr<const Column>>& m_standard;
    ExtraBytesPlan m_plan;
};

}  // namespace

ExtraBytesPlan planExtraBytes(const PointCloud& cloud, const SourceFile& source,
                              const std::vector<std::shared_ptr<const Column>>& standard)
{
    return Planner(cloud, source, standard).plan();
}

}  // namespace punctum::las
