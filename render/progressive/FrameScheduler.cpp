// SPDX-License-Identifier: MIT
#include "render/progressive/FrameScheduler.h"

#include "render/progressive/Clock.h"

#include <algorithm>
#include <cmath>

namespace punctum::render
{

namespace
{

/// What a device that keeps time is offered, as a multiple of what the last frames let expect: so that it decides,
/// and not much more is brought to it than it draws.
constexpr std::uint64_t kOffer = 4;
/// The first of it, by which it judges the rest: a share, and at most so many slots.
constexpr std::uint64_t kFirstShare = 32;
constexpr std::uint64_t kMostFirst = 1'000'000;

}  // namespace

void FrameScheduler::beginPass(ViewClouds& clouds) noexcept
{
    for (const auto& cloud : clouds) {
        cloud->begin();
        cloud->colored = 0;
    }
}

bool FrameScheduler::partial(const ViewClouds& clouds) noexcept
{
    return std::any_of(clouds.begin(), clouds.end(),
                       [](const auto& cloud) { return cloud->drawn < cloud->store->slotCount(); });
}

bool FrameScheduler::beginGrown(ViewClouds& clouds, bool partly) noexcept
{
    bool any = false;
    for (const auto& cloud : clouds) {
        if (cloud->partly != partly || !cloud->grown()) continue;
        cloud->begin();
        any = true;
    }
    return any;
}

void FrameScheduler::beginFrame(PointDrawing& drawing)
{
    m_filled = 0;
    m_timedRuns.clear();
    m_frameBegan = now();
    if (drawing.keepsTime()) drawing.startClock();
}

bool FrameScheduler::fill(ViewClouds& clouds, const FrameScene& scene, PointDrawing& drawing, double deadline)
{
    bool grown = beginGrown(clouds, false);
    if (deviceDecides(drawing)) {
        offerRuns(clouds, scene, drawing, deadline);
        return grown;
    }
    for (bool first = true;; first = false) {
        if (!first) grown = beginGrown(clouds, false) || grown;
        // The cloud that is furthest behind goes next, so that all converge together.
        std::size_t next = clouds.size();
        double least = 1.0;
        for (std::size_t k = 0; k < clouds.size(); ++k) {
            const ViewCloud& cloud = *clouds[k];
            if (cloud.passDone()) continue;
            if (next == clouds.size() || cloud.share() < least) {
                next = k;
                least = cloud.share();
            }
        }
        const double started = now();
        const bool spent = m_pointsAFrame > 0 ? m_filled >= m_pointsAFrame : started >= deadline;
        if (next == clouds.size() || (!first && spent)) return grown;

        ViewCloud& cloud = *clouds[next];
        const Slot slots = cloud.store->slotCount(), window = cloud.store->order().windowSize();
        const VisibleStretches* const partly = cloud.partly ? scene.layers[next].visible.get() : nullptr;
        const std::uint64_t affordable = m_cost.affordable(std::max(0.0, deadline - started));
        std::uint64_t run = 0;
        if (m_pointsAFrame > 0) {
            run = m_pointsAFrame - m_filled;
        } else if (partly != nullptr) {
            // later windows have less of the cloud
            run =
                partly->runOf(cloud.cursor, std::max(affordable, FrameCostModel::kLeastRun), slots) - cloud.cursor;
        } else {
            const auto those = std::uint64_t(std::min(double(affordable) / cloud.weight, double(slots)));
            run = std::max<std::uint64_t>(those, FrameCostModel::kLeastRun);
            // A picture that is nearly full is made full: one more frame for the rest would cost more.
            if (run + run / 4 >= slots - cloud.drawn) run = slots;
        }
        run = (run + window - 1) / window * window;
        const Slot count = Slot(std::min<std::uint64_t>({run, slots - cloud.drawn, slots - cloud.cursor}));
        const SlotRange slotsNow{cloud.cursor, cloud.cursor + count};
        drawing.draw(scene, next, slotsNow);
        drawing.finish();
        m_cost.observe(partly != nullptr ? partly->drawn(slotsNow) : std::uint64_t(std::ceil(count * cloud.weight)),
                       now() - started);
        cloud.cursor = cloud.cursor + count == slots ? 0 : cloud.cursor + count;
        cloud.drawn += count;
        m_filled += count;
    }
}

void FrameScheduler::offerRuns(ViewClouds& clouds, const FrameScene& scene, PointDrawing& drawing, double deadline)
{
    std::vector<std::size_t> open;
    for (std::size_t k = 0; k < clouds.size(); ++k)
        if (!clouds[k]->passDone()) open.push_back(k);
    std::stable_sort(open.begin(), open.end(),
                     [&](std::size_t a, std::size_t b) { return clouds[a]->share() < clouds[b]->share(); });
    const double seconds = std::max(0.0, deadline - m_frameBegan);
    const std::uint64_t offer = kOffer * std::min<std::uint64_t>(m_cost.affordable(seconds), 0xFFFFFFFFu);
    std::uint64_t left = offer;
    for (const std::size_t k : open) {
        const ViewCloud& cloud = *clouds[k];
        const Slot slots = cloud.store->slotCount(), window = cloud.store->order().windowSize();
        Slot at = cloud.cursor;
        std::uint64_t undrawn = slots - cloud.drawn;
        const auto take = [&](std::uint64_t wish) {
            wish = (wish + window - 1) / window * window;
            const auto count = Slot(std::min<std::uint64_t>({wish, undrawn, slots - at}));
            m_timedRuns.push_back({k, {at, at + count}, window});
            at = at + count == slots ? 0 : at + count;
            undrawn -= count;
            left -= std::min<std::uint64_t>(left, std::uint64_t(std::ceil(count * cloud.weight)));
        };
        const auto slotsFor = [&](std::uint64_t drawn) {
            return std::uint64_t(std::min(double(drawn) / cloud.weight, double(slots)));
        };
        if (m_timedRuns.empty())
            take(std::clamp<std::uint64_t>(slotsFor(offer / kFirstShare), FrameCostModel::kLeastRun, kMostFirst));
        while (left > 0 && undrawn > 0) take(slotsFor(left));
    }
    if (!m_timedRuns.empty()) drawing.drawTimed(scene, m_timedRuns, seconds);
}

double FrameScheduler::countTimed(ViewClouds& clouds, PointDrawing& drawing, FrameReport::Passes& passes)
{
    const PointDrawing::Timed timed = drawing.timed();
    passes.reproject = timed.before;
    passes.fill = timed.seconds;
    std::uint64_t left = timed.drawn;
    double weighted = 0;
    for (const PointDrawing::Run& run : m_timedRuns) {
        ViewCloud& cloud = *clouds[run.layer];
        const auto count = Slot(std::min<std::uint64_t>(run.range.size(), left));
        if (count == 0) break;
        cloud.cursor = run.range.first + count == cloud.store->slotCount() ? 0 : run.range.first + count;
        cloud.drawn += count;
        m_filled += count;
        weighted += count * cloud.weight;
        left -= count;
    }
    m_cost.observe(std::uint64_t(std::ceil(weighted)), timed.seconds);
    m_timedRuns.clear();
    return m_frameBegan + timed.done;
}

}  // namespace punctum::render
