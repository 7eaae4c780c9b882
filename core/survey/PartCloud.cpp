// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/cloud/NormalParts.h"
#include "core/survey/Member.h"
#include "core/survey/PackedFields.h"
#include "core/survey/Survey.h"
#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>

#include <algorithm>
#include <map>

namespace punctum
{

namespace
{

constexpr PointIndex kPiece = 1 << 16;  ///< points that one task takes

/// Whether an edit gave a point of the range a value, where the file has no such field.
bool hasValues(const Column& column, PointRange range)
{
    const std::size_t bytes = column.elementBytes();
    const std::byte* const from = column.data();
    return tbb::parallel_reduce(
        tbb::blocked_range<PointIndex>(range.first, range.last, kPiece), false,
        [&](const tbb::blocked_range<PointIndex>& r, bool any) {
            return any || std::any_of(from + r.begin() * bytes, from + r.end() * bytes,
                                      [](std::byte b) { return b != std::byte(0); });
        },
        [](bool a, bool b) { return a || b; });
}

bool isColor(std::string_view column)
{
    return column == "Red" || column == "Green" || column == "Blue";
}

/// The members of a set that lie in the range, as a set of those points alone; null where there are none.
std::shared_ptr<const PointSet> membersIn(const std::shared_ptr<const PointSet>& set, PointRange range)
{
    if (!set || range.empty()) return nullptr;
    auto part = std::make_shared<PointSet>(range.size());
    const std::span<const std::uint64_t> from = set->words();
    const std::span<std::uint64_t> to = part->words();
    const auto shift = unsigned(range.first % 64);
    const auto first = std::size_t(range.first / 64);
    std::uint64_t any = 0;
    for (std::size_t w = 0; w < to.size(); ++w) {
        std::uint64_t bits = from[first + w] >> shift;
        if (shift != 0 && first + w + 1 < from.size()) bits |= from[first + w + 1] << (64 - shift);
        if (w + 1 == to.size() && range.size() % 64 != 0) bits &= (std::uint64_t(1) << (range.size() % 64)) - 1;
        if (bits != 0) to[w] = bits;
        any |= bits;
    }
    return any == 0 ? nullptr : part;
}

/// The columns of a part, by those of the survey that they are a piece of.
using Pieces = std::map<const Column*, std::shared_ptr<Column>>;

/// Fields of formats 0 to 5 again, of a survey that shows those of 6 to 10.
class ClassicColumns
{
public:
    ClassicColumns(const std::vector<std::shared_ptr<Column>>& columns, PointRange points) : m_points(points)
    {
        const auto at = [&](std::string_view name) {
            const auto found = std::find_if(columns.begin(), columns.end(),
                                            [&](const auto& column) { return column->name() == name; });
            return (*found)->data() + points.first * (*found)->elementBytes();
        };
        m_from = {reinterpret_cast<std::uint8_t*>(at("Returns")), reinterpret_cast<std::uint8_t*>(at("Flags")),
                  reinterpret_cast<std::uint8_t*>(at("Classification")),
                  reinterpret_cast<std::int16_t*>(at("ScanAngle"))};
        returns = std::make_shared<Column>("Returns", ScalarType::U8, points.size());
        classes = std::make_shared<Column>("Classes", ScalarType::U8, points.size());
        angle = std::make_shared<Column>("ScanAngle", ScalarType::I8, points.size());
    }

    ClassicMisfits make()
    {
        return tbb::parallel_reduce(
            tbb::blocked_range<PointIndex>(0, m_points.size(), kPiece), ClassicMisfits{},
            [&](const tbb::blocked_range<PointIndex>& r, ClassicMisfits misfits) {
                const PointIndex i = r.begin();
                misfits.include(
                    toClassic({m_from.returns + i, m_from.flags + i, m_from.classification + i, m_from.angle + i},
                              {returns->values<std::uint8_t>().data() + i,
                               classes->values<std::uint8_t>().data() + i, angle->values<std::int8_t>().data() + i},
                              r.size()));
                return misfits;
            },
            [](ClassicMisfits a, const ClassicMisfits& b) {
                a.include(b);
                return a;
            });
    }

    std::shared_ptr<Column> returns, classes, angle;

private:
    PointRange m_points;
    ExtendedFields m_from;
};

/// Adds the attributes of the file's record, under the names that they have now, then those that edits brought.
void addAttributes(const PointCloud& survey, const las::RecordLayout& layout, const std::vector<FieldLink>& links,
                   const std::vector<std::shared_ptr<Column>>& unionColumns,
                   const std::vector<std::shared_ptr<Column>>& ofField, const Pieces& pieces, PointCloud& part)
{
    const auto attributeOn = [&](const Column* column, const Attribute& like) -> const Attribute* {
        for (const Attribute& a : survey.attributes())
            if (a.components == 1 && a.columns[0].get() == column && a.bitShift == like.bitShift &&
                a.bitWidth == like.bitWidth)
                return &a;
        return nullptr;
    };
    std::vector<const Column*> told;
    for (std::size_t k = 0; k < layout.attributes.size(); ++k) {
        Attribute a = layout.attributes[k];
        const std::int32_t field = layout.attributeFields[k][0];
        if (a.components != 1 || field < 0 || !ofField[std::size_t(field)]) continue;
        a.columns[0] = ofField[std::size_t(field)];
        if (const FieldLink& link = links[std::size_t(field)]; link.column >= 0) {
            const Column* const shared = unionColumns[std::size_t(link.column)].get();
            told.push_back(shared);
            const Attribute* const now = attributeOn(shared, a);
            if (now != nullptr && !now->standard && now->name != link.sharedName) a.name = now->name;
        }
        // classes that no longer fit beside their flags have got a column of their own
        if (a.standard)
            if (const Attribute* const now = survey.findAttribute(a.name); now != nullptr && now->components == 1)
                if (const auto wide = pieces.find(now->columns[0].get());
                    wide != pieces.end() && now->bitWidth == 0 && a.bitWidth != 0)
                    a = [&] {
                        Attribute widened = *now;
                        widened.columns[0] = wide->second;
                        return widened;
                    }();
        part.addAttribute(std::move(a));
    }
    for (const Attribute& now : survey.attributes()) {
        if (now.components != 1 || part.findAttribute(now.name) != nullptr) continue;
        const Column* const column = now.columns[0].get();
        const auto piece = pieces.find(column);
        if (piece == pieces.end() || std::find(told.begin(), told.end(), column) != told.end()) continue;
        Attribute a = now;
        a.columns[0] = piece->second;
        part.addAttribute(std::move(a));
    }
    addComposite(part, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    addNormalVector(part);
}

}  // namespace

std::shared_ptr<PointCloud> Survey::partCloud(std::size_t part, Progress& progress) const
{
    if (!many()) return m_cloud;
    const Part& p = m_parts[part];
    const Member& member = *m_members[part];
    const las::RecordLayout& layout = p.source->layout;
    auto cloud = std::make_shared<PointCloud>(p.points.size(), p.source->coordinates);
    cloud->setUnits(p.source->units);
    cloud->setSource(p.source);
    const auto isThere = [&](const std::shared_ptr<Column>& column) {
        return std::find(m_cloud->columns().begin(), m_cloud->columns().end(), column) != m_cloud->columns().end();
    };
    std::unique_ptr<ClassicColumns> classic;
    ClassicMisfits misfits;
    if (member.links.converted) {
        classic = std::make_unique<ClassicColumns>(m_columns, p.points);
        misfits = classic->make();
        progress.check();
        if (const std::string text = misfits.text(); !text.empty())
            throw Error(p.path, "Point format " + std::to_string(layout.format) +
                                    " has no place for what was edited: " + text +
                                    ". Convert the file to point format 6 or higher first.");
    }

    std::vector<std::shared_ptr<Column>> ofField(member.links.fields.size());
    Pieces pieces;
    for (std::size_t k = 0; k < ofField.size(); ++k) {
        const las::RecordField& field = layout.field(std::int32_t(k));
        const std::int32_t shared = member.links.fields[k].column;
        if (isOwn(part, k)) {
            ofField[k] = k < member.own.size() ? member.own[k] : nullptr;
            if (shared >= 0) pieces[m_columns[std::size_t(shared)].get()] = ofField[k];
        } else if (shared >= 0) {
            const std::shared_ptr<Column>& whole = m_columns[std::size_t(shared)];
            if (!isThere(whole)) continue;  // removed
            ofField[k] = std::make_shared<Column>(field.column, whole, p.points);
            pieces[whole.get()] = ofField[k];
        } else if (classic) {
            ofField[k] = field.column == "Returns"   ? classic->returns
                         : field.column == "Classes" ? classic->classes
                                                     : classic->angle;
        }
        if (ofField[k]) cloud->addColumn(ofField[k]);
    }
    // of red, green and blue a point format has all or none
    const bool colored = std::any_of(m_columns.begin(), m_columns.end(), [&](const auto& column) {
        return isColor(column->name()) && !pieces.contains(column.get()) && isThere(column) &&
               hasValues(*column, p.points);
    });
    for (const std::shared_ptr<Column>& column : m_cloud->columns()) {
        progress.check();
        if (pieces.contains(column.get())) continue;
        const auto known = std::find(m_columns.begin(), m_columns.end(), column);
        if (known != m_columns.end()) {  // another file's, unless edits gave it values here
            if (member.links.converted && isExtendedField(column->name())) continue;
            if (isColor(column->name()) ? !colored : !hasValues(*column, p.points)) continue;
        }
        auto piece = std::make_shared<Column>(column->name(), column, p.points);
        pieces[column.get()] = piece;
        cloud->addColumn(std::move(piece));
    }
    if (classic && misfits.classes != 0) {
        const auto& codes = *std::find_if(m_columns.begin(), m_columns.end(),
                                          [](const auto& column) { return column->name() == "Classification"; });
        auto wide = std::make_shared<Column>("Classification", codes, p.points);
        pieces[codes.get()] = wide;
        cloud->addColumn(std::move(wide));
    }
    addAttributes(*m_cloud, layout, member.links.fields, m_columns, ofField, pieces, *cloud);
    cloud->setDeleted(membersIn(m_cloud->deleted(), p.points));
    return cloud;
}

}  // namespace punctum
