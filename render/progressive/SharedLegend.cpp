// SPDX-License-Identifier: MIT
// Which attribute, and which range, one legend tells for all clouds of a view; the rest of ProgressiveRenderer is
// in ProgressiveRenderer.cpp.
#include "render/progressive/Entry.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "render/progressive/ShownValues.h"

#include <algorithm>
#include <map>
#include <shared_mutex>
#include <string>
#include <utility>
#include <vector>

namespace punctum::render
{

namespace
{

/// Points looked at for the range of a scalar attribute, over all clouds.
constexpr std::size_t kRangeSamples = 20'000;
constexpr double kLowPercentile = 0.02;
constexpr double kHighPercentile = 0.98;

std::pair<double, double> rangeOf(std::vector<double>& values)
{
    const auto percentile = [&](double share) {
        const auto at = values.begin() + std::ptrdiff_t(share * double(values.size() - 1));
        std::nth_element(values.begin(), at, values.end());
        return *at;
    };
    const double low = percentile(kLowPercentile);
    return {low, percentile(kHighPercentile)};
}

}  // namespace

void ProgressiveRenderer::applyDisplay(Entry& entry)
{
    if (m_display.attribute.empty()) return;
    show(entry, m_display.attribute);
}

bool ProgressiveRenderer::show(Entry& entry, const std::string& name)
{
    const PointCloud& cloud = entry.store->cloud();
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const wanted = cloud.findAttribute(name);
    if (wanted == nullptr || wanted->kind == AttributeKind::Opaque) return false;
    if (entry.store->encoder()) {
        const Attribute shown = entry.store->shown();
        if (shown.name == wanted->name && shown.columns == wanted->columns) return false;
    }
    entry.store->show(*wanted);
    return true;
}

std::string ProgressiveRenderer::shownAttribute() const
{
    std::string first = m_display.attribute;
    bool any = false;
    for (const auto& entry : m_entries) {
        const auto encoder = entry->store->encoder();
        if (!encoder) continue;
        const std::string& name = encoder->attribute().name;
        if (name == m_display.attribute) return name;
        if (!std::exchange(any, true)) first = name;
    }
    return first;
}

std::string ProgressiveRenderer::scalarInLegend() const
{
    std::string first, shown = shownAttribute();
    for (const auto& entry : m_entries) {
        const auto encoder = entry->store->encoder();
        if (!encoder || encoder->kind() != WordKind::Scalar) continue;
        if (encoder->attribute().name == shown) return shown;
        if (first.empty()) first = encoder->attribute().name;
    }
    return first;
}

void ProgressiveRenderer::agreeOnAttribute()
{
    if (!std::exchange(m_agreementNeeded, false)) return;
    const std::string name = scalarInLegend();
    for (const auto& entry : m_entries) {
        const auto encoder = entry->store->encoder();
        if (!encoder)
            m_agreementNeeded = true;  // its first points have not come yet
        else if (encoder->kind() == WordKind::Scalar && encoder->attribute().name != name && show(*entry, name))
            m_rangeNeeded = m_resolveNeeded = m_visibleOutdated = true;
    }
}

void ProgressiveRenderer::updateRange()
{
    m_rangeNeeded = false;
    const std::string name = scalarInLegend();
    // A cloud that lacks the attribute of the legend shows another one, whose values are not to be mixed with
    // those.
    std::map<std::string, std::vector<double>> values;
    for (const auto& entry : m_entries) {
        PointStore& store = *entry->store;
        const auto encoder = store.encoder();
        entry->filledAtRange = store.filled();
        if (!encoder || encoder->kind() != WordKind::Scalar) continue;
        if (m_display.range && encoder->attribute().name == name) continue;
        const std::shared_lock lock(store.cloud().mutex());
        addShownValues(store, encoder->attribute(), m_display, kRangeSamples / m_entries.size() + 1,
                       values[encoder->attribute().name]);
    }
    std::map<std::string, std::pair<double, double>> ranges;
    for (auto& [attribute, numbers] : values)
        if (!numbers.empty()) ranges[attribute] = rangeOf(numbers);
    if (const auto found = ranges.find(name); found != ranges.end()) m_range = found->second;
    if (m_display.range) m_range = *m_display.range;
    for (const auto& entry : m_entries) {
        entry->range = m_range;
        const auto encoder = entry->store->encoder();
        if (!encoder || encoder->attribute().name == name) continue;
        if (const auto found = ranges.find(encoder->attribute().name); found != ranges.end())
            entry->range = found->second;
    }
}

}  // namespace punctum::render
