// SPDX-License-Identifier: MIT
#include "core/edit/Extract.h"

#include "core/cloud/KeptPoints.h"
#include "core/cloud/Slabs.h"
#include "core/las/SourceFile.h"
#include "core/task/LockedLoop.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <cstring>
#include <mutex>

namespace punctum
{

namespace
{

/// The source of a cloud of other points: what is noted there on saving is not the whole's.
std::shared_ptr<const las::SourceFile> forPart(const las::SourceFile& whole, const PointSet& points)
{
    auto source = std::make_shared<las::SourceFile>(whole);
    source->asRead = std::make_shared<las::Guarded<las::PointsAsRead>>();
    source->current = std::make_shared<las::Guarded<las::CurrentFile>>();
    source->current->set(whole.current->get());
    las::PointsAsRead read = whole.asRead->get();
    read.missing.clear();  // places in the whole
    source->asRead->set(std::move(read));
    if (whole.copc) {
        PointSet others = points;
        others.invert();
        source->copc = whole.copc->of(KeptPoints::all(points.size()).without(others));
    }
    return source;
}

}  // namespace

std::shared_ptr<PointCloud> extracted(const PointCloud& cloud, const PointSet& wanted, Progress& progress)
{
    const std::shared_lock lock(cloud.mutex());
    PointSet points = wanted;
    if (cloud.deleted()) points.remove(*cloud.deleted());
    const std::size_t words = points.words().size();
    const std::vector<PointIndex> ranks = points.ranks(kTaskWords);
    const PointIndex count = ranks.back();
    progress.begin("Taking points", cloud.columns().size() * (ranks.size() - 1));
    auto part = std::make_shared<PointCloud>(count, cloud.coordinates());
    for (const auto& from : cloud.columns()) {
        const auto to =
            part->addColumn(std::make_shared<Column>(from->name(), from->type(), count, from->components()));
        const std::size_t bytes = from->elementBytes();
        forPiecesLocked(lock, words, kTaskWords, [&](std::size_t first, std::size_t last) {
            if (progress.cancelled()) return;
            std::byte* out = to->data() + ranks[first / kTaskWords] * bytes;
            points.forEachInWords(first, last, [&](PointIndex i) {
                std::memcpy(out, from->data() + i * bytes, bytes);
                out += bytes;
            });
            progress.add(1);
        });
        progress.check();
    }
    for (Attribute attribute : cloud.attributes()) {
        for (std::uint32_t c = 0; c < attribute.components; ++c) {
            const auto& all = cloud.columns();
            const auto at = std::find(all.begin(), all.end(), attribute.columns[c]) - all.begin();
            attribute.columns[c] = part->columns()[std::size_t(at)];
        }
        part->addAttribute(std::move(attribute));
    }
    part->setUnits(cloud.units());
    if (cloud.source()) part->setSource(forPart(*cloud.source(), points));
    return part;
}

}  // namespace punctum
