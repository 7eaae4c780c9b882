// SPDX-License-Identifier: MIT
#include "render/progressive/SharedLegend.h"

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

bool SharedLegend::show(ViewCloud& shownCloud, const std::string& name)
{
    const PointCloud& cloud = shownCloud.store->cloud();
    const std::shared_lock lock(cloud.mutex());
    const Attribute* const wanted = cloud.findAttribute(name);
    if (wanted == nullptr || wanted->kind == AttributeKind::Opaque) return false;
    if (shownCloud.store->encoder()) {
        const Attribute shown = shownCloud.store->shown();
        if (shown.name == wanted->name && shown.columns == wanted->columns) return false;
    }
    shownCloud.store->show(*wanted);
    return true;
}

std::string SharedLegend::shownAttribute(const ViewClouds& clouds, const DisplaySettings& display)
{
    std::string first = display.attribute;
    bool any = false;
    for (const auto& entry : clouds) {
        const auto encoder = entry->store->encoder();
        if (!encoder) continue;
        const std::string& name = encoder->attribute().name;
        if (name == display.attribute) return name;
        if (!std::exchange(any, true)) first = name;
    }
    return first;
}

std::string SharedLegend::scalarOf(const ViewClouds& clouds, const DisplaySettings& display)
{
    std::string first, shown = shownAttribute(clouds, display);
    for (const auto& entry : clouds) {
        const auto encoder = entry->store->encoder();
        if (!encoder || encoder->kind() != WordKind::Scalar) continue;
        if (encoder->attribute().name == shown) return shown;
        if (first.empty()) first = encoder->attribute().name;
    }
    return first;
}

bool SharedLegend::agree(ViewClouds& clouds, const DisplaySettings& display)
{
    if (!std::exchange(m_agreementNeeded, false)) return false;
    bool changed = false;
    const std::string name = scalarOf(clouds, display);
    for (const auto& entry : clouds) {
        const auto encoder = entry->store->encoder();
        if (!encoder)
            m_agreementNeeded = true;  // its first points have not come yet
        else if (encoder->kind() == WordKind::Scalar && encoder->attribute().name != name && show(*entry, name))
            m_rangeNeeded = changed = true;
    }
    return changed;
}

void SharedLegend::updateRange(ViewClouds& clouds, const DisplaySettings& display)
{
    m_rangeNeeded = false;
    const std::string name = scalarOf(clouds, display);
    // A cloud that lacks the attribute of the legend shows another one, whose values are not to be mixed with
    // those.
    std::map<std::string, std::vector<double>> values;
    for (const auto& entry : clouds) {
        PointStore& store = *entry->store;
        const auto encoder = store.encoder();
        entry->filledAtRange = store.filled();
        if (!encoder || encoder->kind() != WordKind::Scalar) continue;
        if (display.range && encoder->attribute().name == name) continue;
        const std::shared_lock lock(store.cloud().mutex());
        addShownValues(store, encoder->attribute(), display, kRangeSamples / clouds.size() + 1,
                       values[encoder->attribute().name]);
    }
    std::map<std::string, std::pair<double, double>> ranges;
    for (auto& [attribute, numbers] : values)
        if (!numbers.empty()) ranges[attribute] = rangeOf(numbers);
    if (const auto found = ranges.find(name); found != ranges.end()) m_range = found->second;
    if (display.range) m_range = *display.range;
    for (const auto& entry : clouds) {
        entry->range = m_range;
        const auto encoder = entry->store->encoder();
        if (!encoder || encoder->attribute().name == name) continue;
        if (const auto found = ranges.find(encoder->attribute().name); found != ranges.end())
            entry->range = found->second;
    }
}

}  // namespace punctum::render
