// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Attribute.h"
#include "core/cloud/DecimalScale.h"
#include "core/cloud/PointSet.h"
#include "core/cloud/Units.h"

#include <glm/vec3.hpp>

#include <array>
#include <functional>
#include <memory>
#include <mutex>
#include <shared_mutex>
#include <string>
#include <string_view>
#include <vector>

namespace punctum
{

class BlockBoxes;
class KdOrder;
namespace las
{
struct SourceFile;
}

/// Says what changed in a cloud. The only way the rest of the program learns of a change.
struct ChangeNotice {
    enum class Kind {
        Values,      ///< values of `attributes` changed, for the points of `points` (null: all of them)
        Attributes,  ///< attributes were added or removed (`attributes` names them)
        Deleted,     ///< the points of `points` were deleted or restored
    };
    Kind kind = Kind::Values;
    std::vector<std::string> attributes;
    std::shared_ptr<const PointSet> points;

    /// Whether values of this attribute may have changed (RGB counts when Red does, and so on).
    bool concerns(const Attribute& attribute) const;
};

/// Smallest box of raw integer coordinates; empty when min > max.
struct RawBounds {
    glm::i64vec3 min{INT64_MAX};
    glm::i64vec3 max{INT64_MIN};

    bool empty() const noexcept { return min.x > max.x; }
    void include(std::int64_t x, std::int64_t y, std::int64_t z) noexcept;
    void include(const RawBounds& other) noexcept;
    /// Whether all of the other one lies within; of an empty one, yes.
    bool holds(const RawBounds& other) const noexcept;
    /// Whether they have any place in common.
    bool meets(const RawBounds& other) const noexcept;
    friend bool operator==(const RawBounds&, const RawBounds&) = default;
};

/// Box in `world` (double, CRS units); empty when min > max.
struct WorldBounds {
    glm::dvec3 min{1.0};
    glm::dvec3 max{0.0};

    bool empty() const noexcept { return min.x > max.x; }
    void include(const WorldBounds& other) noexcept;
};

/// raw integer coordinates <-> world: world = raw * scale + offset, axis by axis (LAS 1.4 R15, 2.4).
struct CoordinateScale {
    glm::dvec3 scale{0.001};
    glm::dvec3 offset{0.0};

    /// The decimals of an axis, by which values of points are told exactly.
    DecimalScale steps(int axis) const noexcept { return {scale[axis], offset[axis]}; }
    /// For drawing and computing, raw coordinates need not be whole; PointCloud::world() is exact.
    glm::dvec3 toWorld(const glm::dvec3& raw) const noexcept { return raw * scale + offset; }
    glm::dvec3 toRaw(const glm::dvec3& world) const noexcept { return (world - offset) / scale; }
    WorldBounds toWorld(const RawBounds& raw) const noexcept;  ///< exact
    /// Of stored coordinates as headers have it: with the last bits of raw * scale + offset as most programs
    /// compute it, so that for none of them a point is outside.
    WorldBounds headerBox(const RawBounds& raw) const noexcept;
};

/// One of the files that hold a cloud's points.
struct CloudPart {
    PointRange points;
    std::shared_ptr<const las::SourceFile> source;
};

/// Ends a subscription when destroyed.
class Subscription
{
public:
    Subscription() = default;
    explicit Subscription(std::function<void()> end) : m_end(std::move(end)) {}
    ~Subscription() { reset(); }
    Subscription(Subscription&& other) noexcept : m_end(std::exchange(other.m_end, {})) {}
    Subscription& operator=(Subscription&& other) noexcept
    {
        reset();
        m_end = std::exchange(other.m_end, {});
        return *this;
    }
    void reset()
    {
        if (m_end) std::exchange(m_end, {})();
    }

private:
    std::function<void()> m_end;
};

/// A point cloud in memory: what the file holds, one array per field of the record (struct of arrays), in the
/// file's own types. Loading is de-interleaving, saving is interleaving; nothing is rounded or dropped.
///
/// Threads: the list of columns and attributes, and values, are guarded by mutex(): readers that may meet an
/// edit hold it shared, whoever changes values or the list holds it alone, then calls notify() without it.
/// Loading writes only points that nobody was told of yet, and needs no lock.
class PointCloud
{
public:
    /// An empty frame for `size` points; columns and attributes are added next (las::Reader does it).
    explicit PointCloud(PointIndex size, CoordinateScale coordinates = {});

    PointIndex size() const noexcept { return m_size; }
    const CoordinateScale& coordinates() const noexcept { return m_coordinates; }
    /// Of the coordinates; set when the cloud is made, before other threads see it. See trueLengths().
    const CoordinateUnits& units() const noexcept { return m_units; }
    void setUnits(CoordinateUnits units) { m_units = std::move(units); }

    // -- columns and attributes; the first columns follow the file's record, added ones come after
    const std::vector<std::shared_ptr<Column>>& columns() const noexcept { return m_columns; }
    const std::vector<Attribute>& attributes() const noexcept { return m_attributes; }
    /// Null when there is none of that name. Valid until the list of attributes changes: copy it to keep it.
    const Attribute* findAttribute(std::string_view name) const noexcept;
    std::shared_ptr<Column> addColumn(std::shared_ptr<Column> column);
    void addAttribute(Attribute attribute);
    /// Takes the attribute, and its columns when no other attribute shows them, out of the cloud.
    void removeAttribute(std::string_view name);
    /// Trades the lists for others: the first columns and attributes stay those of the standard's fields.
    void exchangeLists(std::vector<std::shared_ptr<Column>>& columns, std::vector<Attribute>& attributes) noexcept
    {
        m_columns.swap(columns);
        m_attributes.swap(attributes);
    }
    /// Puts it in the place of the attribute of the same name. Its columns are added where they are not there yet;
    /// those that no attribute shows any longer go.
    void replaceAttribute(const Attribute& attribute);

    // -- coordinates; X, Y, Z are the first three columns, int32
    std::span<const std::int32_t> rawX() const noexcept { return m_columns[0]->values<std::int32_t>(); }
    std::span<const std::int32_t> rawY() const noexcept { return m_columns[1]->values<std::int32_t>(); }
    std::span<const std::int32_t> rawZ() const noexcept { return m_columns[2]->values<std::int32_t>(); }
    glm::dvec3 world(PointIndex i) const noexcept
    {
        return {m_steps[0](rawX()[i]), m_steps[1](rawY()[i]), m_steps[2](rawZ()[i])};
    }
    /// Bounds of the points, from their boxes: computed from the data, never from a header.
    RawBounds computeBounds() const;
    /// The box of each stretch of consecutive points, as they were read: coordinates do not change once all points
    /// are there. Points that could not be read are at 0. Of a cloud that nobody reads into, they are found when
    /// they are first asked for, in parallel, and kept; while points arrive, of what the columns hold now, and not
    /// kept. Any thread.
    std::shared_ptr<const BlockBoxes> boxes() const;
    /// Into which whoever reads points into the cloud includes them as they come; set when the cloud is made,
    /// before other threads see it. Null for a cloud that nobody reads into.
    void setArriving(std::shared_ptr<BlockBoxes> boxes);
    BlockBoxes* arriving() const noexcept { return m_arriving.get(); }

    // -- points that an edit deleted: views and tools leave them alone, and saving leaves them out; they keep
    //    their index and their values until they are restored
    /// Null: none. Guarded like the list of columns; a set itself never changes, so that a copy needs no lock.
    const std::shared_ptr<const PointSet>& deleted() const noexcept { return m_deleted; }
    void setDeleted(std::shared_ptr<const PointSet> points) { m_deleted = std::move(points); }

    // -- where it came from; null for a cloud made here. Of a cloud of many files: what one file of them all would
    //    be, which is nowhere (SourceFile::path is empty)
    const std::shared_ptr<const las::SourceFile>& source() const noexcept { return m_source; }
    void setSource(std::shared_ptr<const las::SourceFile> source) { m_source = std::move(source); }
    /// The files of a cloud of many, one after another; of any other cloud none. Set before other threads see it.
    const std::vector<CloudPart>& parts() const noexcept { return m_parts; }
    void setParts(std::vector<CloudPart> parts) { m_parts = std::move(parts); }

    /// The order of the points by place that was made last, so that it is made once for all who ask: KdOrder::of(),
    /// which alone looks here.
    struct PlaceOrder {
        std::mutex mutex;     ///< guards what follows
        bool making = false;  ///< somebody is at it
        std::shared_ptr<const KdOrder> order;
        std::shared_ptr<const PointSet> without;  ///< the deleted points of then
    };
    PlaceOrder& placeOrder() const noexcept { return *m_placeOrder; }

    // -- change
    std::shared_mutex& mutex() const noexcept { return m_mutex; }
    using Listener = std::function<void(const ChangeNotice&)>;
    /// `listener` is called in the thread that made the change, with mutex() free.
    [[nodiscard]] Subscription subscribe(Listener listener);
    void notify(const ChangeNotice& notice) const;

private:
    struct Listeners;

    void removeColumnsOf(const Attribute& gone);

    PointIndex m_size;
    CoordinateScale m_coordinates;
    std::array<DecimalScale, 3> m_steps;
    CoordinateUnits m_units;
    std::vector<std::shared_ptr<Column>> m_columns;
    std::vector<Attribute> m_attributes;
    std::shared_ptr<const PointSet> m_deleted;
    std::shared_ptr<const las::SourceFile> m_source;
    std::vector<CloudPart> m_parts;
    mutable std::shared_mutex m_mutex;
    std::shared_ptr<BlockBoxes> m_arriving;
    mutable std::mutex m_boxesMutex;
    mutable std::shared_ptr<const BlockBoxes> m_boxes;  ///< found here
    std::shared_ptr<Listeners> m_listeners;
    std::shared_ptr<PlaceOrder> m_placeOrder = std::make_shared<PlaceOrder>();
};

/// The deleted points at present; null: none. Takes cloud.mutex() shared.
std::shared_ptr<const PointSet> deletedPoints(const PointCloud& cloud);

/// Adds an attribute that shows three scalar ones together (RGB, Normal) when all three are there.
void addComposite(PointCloud& cloud, const std::string& name, AttributeKind kind,
                  const std::array<std::string, 3>& parts);

}  // namespace punctum
