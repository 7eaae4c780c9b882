// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/Buffer.h"
#include "core/sample/Random.h"

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

namespace punctum
{
class Progress;
}

namespace punctum::sample
{

struct Color {
    double r = 0, g = 0, b = 0;  ///< 0 to 1
    friend Color operator*(const Color& c, double f) { return {c.r * f, c.g * f, c.b * f}; }
    friend Color operator+(const Color& a, const Color& b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
};

/// Where the grids of a scene lie: square, a point each `step` metres.
struct Raster {
    double origin = 0, step = 1;
    std::int64_t side = 0;

    double coordinate(std::int64_t k) const { return origin + double(k) * step; }
    /// Of the grid point at or before v, kept inside so that there is a next one.
    std::int64_t index(double v) const
    {
        const std::int64_t k = floorOf((v - origin) / step);
        return k < 0 ? 0 : k > side - 2 ? side - 2 : k;
    }
    std::size_t at(std::int64_t ix, std::int64_t iy) const { return std::size_t(iy * side + ix); }
    std::size_t count() const { return std::size_t(side * side); }
};

/// Zeroes, made when they are first touched: a large grid costs no time before its rows are worked out.
template <typename T>
class LazyArray
{
public:
    LazyArray() = default;
    explicit LazyArray(std::size_t count) : m_buffer(count * sizeof(T)) {}
    T& operator[](std::size_t k) { return reinterpret_cast<T*>(m_buffer.data())[k]; }
    const T& operator[](std::size_t k) const { return reinterpret_cast<const T*>(m_buffer.data())[k]; }

private:
    Buffer m_buffer;
};

/// What changes slowly from place to place: kept on a grid of 1 m and read between its points.
struct Place {
    enum Layer { Z, Shadow, River, Road, Woods, Mottle, WarpX, WarpY, kLayers };
    std::array<double, kLayers> layers{};
    double dzdx = 0, dzdy = 0;  ///< slope of the terrain

    double z() const { return layers[Z]; }
    double shadow() const { return layers[Shadow]; }  ///< z below which this place is in shadow
    double river() const { return layers[River]; }    ///< metres to the river's edge; negative in the water
    double road() const { return layers[Road] < 0 ? -layers[Road] : layers[Road]; }  ///< metres to its middle
    double woods() const { return layers[Woods]; }    ///< a wood where it is above 0.1
    double mottle() const { return layers[Mottle]; }  ///< brightness of the ground, near 1
};

/// What the ground is made of at one place.
struct Ground {
    std::uint8_t code = 2;  ///< ASPRS class: 2 ground, 9 water, 11 road
    Color color;
    double reflectance = 0.3;  ///< at the laser's wavelength
    double cropHeight = 0;     ///< of what grows on a field; 0: nothing
};

/// Something hard that stands on the ground.
struct Solid {
    double top = 0;         ///< z
    std::uint8_t code = 6;  ///< ASPRS class
    Color color;
    Color sideColor;  ///< of walls
    double reflectance = 0.3;
    double slopeX = 0, slopeY = 0;  ///< of the top
};

/// A crown over one place.
struct Canopy {
    double top = 0, bottom = 0;  ///< z
    bool conifer = false;
    Color color;
    double towardsSun = 0;  ///< -1 to 1: which side of the crown
};

/// What a wire or a tower puts in the way.
struct Aerial {
    double z = 0;
    std::uint8_t code = 14;  ///< 14 wire, 15 tower
    bool opaque = false;
};

/// The country that the sample survey flies over: hills, a river with a bridge, a main road, towns of streets and
/// houses, fields, woods, a power line. Frame: metres from its south-west corner, `side` metres each way.
/// Immutable once made; every question may be asked from any thread.
class Scene
{
public:
    /// Works out terrain, trees and shadows on grids, in parallel. Throws Cancelled.
    Scene(double side, std::uint64_t seed, Progress& progress);
    ~Scene();
    Scene(const Scene&) = delete;
    Scene& operator=(const Scene&) = delete;

    double side() const { return m_side; }
    Place place(double x, double y) const;
    /// Heights above the terrain that no tree, and nothing solid, within 8 m of this place exceeds.
    double tallestTree(double x, double y) const
    {
        return m_tallestTree[m_coarse.at(m_coarse.index(x), m_coarse.index(y))];
    }
    double tallestSolid(double x, double y) const
    {
        return m_tallestSolid[m_coarse.at(m_coarse.index(x), m_coarse.index(y))];
    }

    Ground ground(double x, double y, const Place& place) const;
    std::optional<Solid> solid(double x, double y) const;
    std::optional<Canopy> canopy(double x, double y) const;
    /// A wire or tower met by a beam that reaches the ground at (x, y), `slope` metres to the east a metre up.
    std::optional<Aerial> aerial(double x, double y, double ground, double slope, Random& random) const;
    bool nearLine(double x, double y) const
    {
        const double offset = lineOffset(x, y);
        return offset > -20.0 && offset < 20.0;
    }
    double waterLevel(double y) const { return 6.0 - y * 0.0008; }

    static const std::array<double, 3> kSun;  ///< direction to the sun, length 1

private:
    struct Building;
    struct Town;
    struct Tree {
        float x, y, z, radius, height;  ///< of height 0 where there is none
        std::uint8_t tint;
        bool conifer;
    };

    double lowHeight(double x, double y) const;
    double terrainHeight(double x, double y, double river, double road) const;
    double roadLevel(double x, double roadY, double river) const;
    double riverDistance(double x, double y) const;
    double roadDistance(double x, double y) const;
    double lineOffset(double x, double y) const;
    const Town* townAt(double x, double y) const;
    double treeDensity(double x, double y) const;
    std::optional<Solid> parkedCar(const Town& town, double a, double b) const;
    Color fieldColor(double x, double y, const Place& place, Ground& ground) const;
    void placeTowns();
    void build(Town& town);
    void plantTrees(Progress& progress);
    void shapeLand(Progress& progress);
    void castShadows(Progress& progress);

    double m_side;
    std::uint64_t m_seed;
    double m_riverHalf, m_riverSwing, m_roadSwing;
    double m_lineX, m_span;
    std::int64_t m_townsAcross = 1;
    std::vector<Town> m_towns;
    Raster m_fine, m_coarse;
    LazyArray<std::array<float, Place::kLayers>> m_places;
    LazyArray<float> m_tallestTree, m_tallestSolid;
    std::int64_t m_treeSide = 0;
    LazyArray<Tree> m_trees;
    LazyArray<std::uint8_t> m_treeNear;
};

}  // namespace punctum::sample
