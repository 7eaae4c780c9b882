// SPDX-License-Identifier: MIT
#include "core/edit/CloudKey.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/las/Reader.h"
#include "core/task/LockedLoop.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <shared_mutex>
#include <vector>

namespace punctum
{

namespace
{

std::uint64_t mixed(std::uint64_t v) noexcept  // the finalizer of MurmurHash3
{
    v = (v ^ (v >> 33)) * 0xFF51AFD7ED558CCDu;
    v = (v ^ (v >> 33)) * 0xC4CEB9FE1A85EC53u;
    return v ^ (v >> 33);
}

std::uint64_t digestOf(const std::byte* bytes, std::size_t n, std::uint64_t seed) noexcept
{
    // four lanes, so that multiplications overlap
    std::array<std::uint64_t, 4> lanes{seed, seed + 1, seed + 2, seed + 3};
    std::size_t at = 0;
    for (; at + 32 <= n; at += 32)
        for (std::size_t lane = 0; lane < 4; ++lane) {
            std::uint64_t v;
            std::memcpy(&v, bytes + at + 8 * lane, sizeof v);
            lanes[lane] = std::rotl((lanes[lane] ^ v) * 0x9E3779B97F4A7C15u, 29);
        }
    for (; at < n; ++at)
        lanes[0] = std::rotl((lanes[0] ^ std::to_integer<std::uint64_t>(bytes[at])) * 0x9E3779B97F4A7C15u, 29);
    std::uint64_t sum = n;
    for (const std::uint64_t lane : lanes) sum = mixed(sum ^ lane);
    return sum;
}

/// The name that a file has for it: that of the attribute that shows it, where it was renamed.
std::string nameOf(const Column& column, const PointCloud& cloud)
{
    for (const Attribute& a : cloud.attributes())
        if (!a.standard && a.components == 1 && a.columns[0].get() == &column) return a.name;
    return column.name();
}

void takeKept(const Column& column, const KeptPoints& kept, std::byte* out)
{
    const std::size_t bytes = column.elementBytes();
    for (const PointRange& run : kept.ranges()) {
        const auto n = std::size_t(run.size()) * bytes;
        std::memcpy(out, column.data() + run.first * bytes, n);
        out += n;
    }
}

/// Whether the fields of the file's records are the columns of the cloud, one after the other.
bool holdsColumns(const las::SourceFile& file, const PointCloud& cloud)
{
    const std::shared_lock lock(cloud.mutex());
    const auto isColumn = [&](const las::RecordField& field, const std::shared_ptr<Column>& column) {
        return field.column == nameOf(*column, cloud) && field.type == column->type() &&
               field.components == column->components();
    };
    const auto& fields = file.layout.fields;
    return file.coordinates.scale == cloud.coordinates().scale &&
           file.coordinates.offset == cloud.coordinates().offset &&
           std::equal(fields.begin(), fields.end(), cloud.columns().begin(), cloud.columns().end(), isColumn);
}

}  // namespace

std::string CloudKey::text() const
{
    return std::to_string(points) + "-" + digestText();
}

std::string CloudKey::digestText() const
{
    return hexText(digest, 16);
}

CloudKey keyOf(const PointCloud& cloud, Progress& progress, const KeptPoints* kept)
{
    const std::shared_lock lock(cloud.mutex());
    std::size_t total = 0;
    for (const auto& column : cloud.columns()) total += column->size() * column->elementBytes();
    progress.begin("Looking at the points", total);
    constexpr std::size_t kPiece = 1 << 20;  // bytes that one task digests
    CloudKey key;
    key.points = kept ? kept->count() : cloud.size();
    const CoordinateScale& grid = cloud.coordinates();
    for (int axis = 0; axis < 3; ++axis)
        key.digest = mixed(mixed(key.digest ^ std::bit_cast<std::uint64_t>(grid.scale[axis])) ^
                           std::bit_cast<std::uint64_t>(grid.offset[axis]));
    for (const auto& column : cloud.columns()) {
        const std::size_t bytes = std::size_t(key.points) * column->elementBytes();
        Buffer copy(kept ? bytes : 0);
        if (kept) takeKept(*column, *kept, copy.data());
        const std::byte* const data = kept ? copy.data() : column->data();
        std::vector<std::uint64_t> pieces((bytes + kPiece - 1) / kPiece);
        forPiecesLocked(lock, bytes, kPiece, [&](std::size_t first, std::size_t last) {
            if (progress.cancelled()) return;
            const std::size_t k = first / kPiece;
            pieces[k] = digestOf(data + first, last - first, k);
            progress.add(last - first);
        });
        progress.check();
        const std::string name = nameOf(*column, cloud);
        key.digest = mixed(key.digest ^ digestOf(reinterpret_cast<const std::byte*>(name.data()), name.size(),
                                                 std::uint64_t(column->type())));
        for (const std::uint64_t piece : pieces) key.digest = mixed(key.digest ^ piece);
    }
    return key;
}

bool hasColumnsOf(const PointCloud& cloud, const PointCloud& read)
{
    const std::shared_lock lock(cloud.mutex());
    return cloud.coordinates().scale == read.coordinates().scale &&
           cloud.coordinates().offset == read.coordinates().offset &&
           std::equal(cloud.columns().begin(), cloud.columns().end(), read.columns().begin(), read.columns().end(),
                      [&](const std::shared_ptr<Column>& a, const std::shared_ptr<Column>& b) {
                          return nameOf(*a, cloud) == nameOf(*b, read) && a->type() == b->type() &&
                                 a->components() == b->components();
                      });
}

CloudKey keyOfFile(const PointCloud& cloud, Progress& progress)
{
    if (!cloud.source()) return keyOf(cloud, progress);
    const las::CurrentFile current = cloud.source()->current->get();
    if (current.saved) {
        const auto reader = las::Reader::open(current.path, nullptr);
        if (!holdsColumns(*reader->source(), cloud)) {
            if (las::FileStamp::of(current.path) != current.stamp)
                throw Error(current.path, "another program changed the file since it was saved.");
            const auto file = reader->createCloud();
            reader->read(*file, progress);
            return keyOf(*file, progress);
        }
    }
    return keyOf(cloud, progress, current.kept.get());
}

}  // namespace punctum
