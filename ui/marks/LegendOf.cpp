// SPDX-License-Identifier: MIT
#include "ui/marks/LegendOf.h"

#include "ui/basic/Text.h"
#include "ui/document/Document.h"

namespace punctum::ui
{

namespace
{

QColor toColor(render::Rgba8 c)
{
    return {c.r, c.g, c.b};
}

void addBar(Legend& legend, const render::DisplaySettings& display, std::pair<double, double> range)
{
    legend.bar = true;
    const render::ColorMap& map = render::chosenColorMap(display.colorMap, legend.title.toStdString());
    legend.table = render::banded(map.table, display.bands);
    const int steps = display.bands < 2 ? 1 : display.bands;
    for (int k = 0; k <= steps; ++k)
        legend.values << numberText(
            k == steps ? range.second : range.first + (range.second - range.first) * k / steps,
            range.second - range.first);
}

void addClasses(Legend& legend, const LegendFacts& facts, const render::DisplaySettings& display)
{
    if (facts.classCounts == nullptr) {
        legend.remark = QObject::tr("not counted yet");
        return;
    }
    const auto& counts = *facts.classCounts;
    for (unsigned code = 0; code < counts.size(); ++code)
        if (counts[code] > 0 && display.classVisible[code])
            legend.entries.push_back({toColor(display.palette[code]), classText(code), counts[code]});
    if (legend.entries.empty()) legend.remark = QObject::tr("no class is shown");
}

void addValues(Legend& legend, const DistinctValues* values)
{
    if (values == nullptr || values->tooMany) {
        legend.remark = QObject::tr("one color for each value");
        return;
    }
    for (const DistinctValue& v : values->values)
        legend.entries.push_back({toColor(render::categoryColor(v.bits)), valueText(v.value), v.points});
}

}  // namespace

Legend legendOf(const Document& document, const QString& name, std::pair<double, double> range,
                const render::DisplaySettings& display)
{
    const Attribute* const attribute = document.findAttribute(name);
    if (attribute == nullptr) return {};
    LegendFacts facts;
    const auto counts = document.classCountsShown();
    if (counts) facts.classCounts = &*counts;
    facts.values = document.values(name);
    return legendOf(*attribute, facts, range, display);
}

Legend legendOf(const Attribute& attribute, const LegendFacts& facts, std::pair<double, double> range,
                const render::DisplaySettings& display)
{
    Legend legend;
    if (attribute.kind == AttributeKind::Opaque) return legend;
    legend.title = toQString(attribute.name);
    legend.unit = toQString(attribute.unit);
    switch (attribute.kind) {
        case AttributeKind::Category:
            if (attribute.integral()) {
                addValues(legend, facts.values);
                break;
            }
            [[fallthrough]];
        case AttributeKind::Scalar:
            addBar(legend, display, range);
            break;
        case AttributeKind::Class:
            addClasses(legend, facts, display);
            break;
        case AttributeKind::Vector:
            legend.remark = display.normals == render::NormalLook::Lit ? QObject::tr("lit from the upper left")
                                                                       : QObject::tr("direction as color");
            break;
        case AttributeKind::Color:
            legend.remark = QObject::tr("colors of the file");
            break;
        case AttributeKind::Opaque:
            break;
    }
    return legend;
}

}  // namespace punctum::ui
