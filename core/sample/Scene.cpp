// SPDX-License-Identifier: MIT
#include "core/sample/Scene.h"

#include "core/task/Progress.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace punctum::sample
{

namespace
{

constexpr double kMargin = 30.0;   ///< of the grids around the survey, so that its edge has neighbors
constexpr double kTreeCell = 7.0;  ///< at most one tree in each
constexpr double kTallestCell = 4.0;
constexpr double kRoadHalf = 4.0;  ///< main road, half its width
constexpr double kStreetA = 58.0;  ///< from street to street, in a town's own frame
constexpr double kStreetB = 96.0;
constexpr double kStreet = 6.0;
constexpr double kLotA = 26.0;
constexpr double kLotB = 22.5;
/// The power line runs along (7, 24) / 25: a direction of length 1 without a rounding.
constexpr double kLineX = 0.28, kLineY = 0.96;

/// Which noise is meant: added to the seed.
enum Channel : std::uint64_t {
    kHills = 1,
    kRiver = 40,
    kRoad = 410,

    kTownPlace = 420,
    kLot = 430,
    kWoods = 440,
    kTree = 450,
    kField = 460,
    kGrass = 470,
    kCar = 480,
    kConifers = 490,
};

template <typename F>
void forRows(std::int64_t rows, Progress& progress, F&& f)
{
    tbb::parallel_for(tbb::blocked_range<std::int64_t>(0, rows, 8), [&](const auto& r) {
        for (std::int64_t y = r.begin(); y != r.end(); ++y) {
            if (progress.cancelled()) return;
            f(y);
        }
    });
    progress.check();
    progress.add(1);
}

constexpr Color gray(double v)
{
    return {v, v, v};
}

}  // namespace

const std::array<double, 3> Scene::kSun = {-6.0 / 11.0, -6.0 / 11.0, 7.0 / 11.0};

Place Scene::place(double x, double y) const
{
    const std::int64_t ix = m_fine.index(x), iy = m_fine.index(y);
    const double u = std::clamp(x - m_fine.coordinate(ix), 0.0, 1.0);
    const double v = std::clamp(y - m_fine.coordinate(iy), 0.0, 1.0);
    const auto& a = m_places[m_fine.at(ix, iy)];
    const auto& b = m_places[m_fine.at(ix + 1, iy)];
    const auto& c = m_places[m_fine.at(ix, iy + 1)];
    const auto& d = m_places[m_fine.at(ix + 1, iy + 1)];
    const double wa = (1 - u) * (1 - v), wb = u * (1 - v), wc = (1 - u) * v, wd = u * v;
    Place p;
    for (std::size_t k = 0; k < Place::kLayers; ++k)
        p.layers[k] = double(a[k]) * wa + double(b[k]) * wb + double(c[k]) * wc + double(d[k]) * wd;
    p.dzdx = lerp(double(b[0]) - double(a[0]), double(d[0]) - double(c[0]), v);
    p.dzdy = lerp(double(c[0]) - double(a[0]), double(d[0]) - double(b[0]), u);
    return p;
}

/// One house of a town, in the town's frame.
struct Scene::Building {
    double a = 0, b = 0;          ///< center
    double halfA = 0, halfB = 0;  ///< half its size
    double z = 0;                 ///< of the ground it stands on
    double wall = 0, rise = 0;    ///< height of the walls, and of the ridge above them
    enum class Roof { Flat, GableA, GableB, Hip } roof = Roof::Flat;
    Color roofColor, wallColor;
    double reflectance = 0.3;
    bool built = false;

    bool holds(double pa, double pb) const { return std::fabs(pa - a) <= halfA && std::fabs(pb - b) <= halfB; }
    /// z of the roof, and its slope in the town's frame.
    double roofAt(double pa, double pb, double& slopeA, double& slopeB) const
    {
        const double da = pa - a, db = pb - b;
        slopeA = slopeB = 0;
        switch (roof) {
            case Roof::Flat:
                return z + wall + (halfA - std::fabs(da) < 0.35 || halfB - std::fabs(db) < 0.35 ? 0.5 : 0.0);
            case Roof::GableA:
                slopeB = (db < 0 ? rise : -rise) / halfB;
                return z + wall + rise * (1 - std::fabs(db) / halfB) + chimney(da, db);
            case Roof::GableB:
                slopeA = (da < 0 ? rise : -rise) / halfA;
                return z + wall + rise * (1 - std::fabs(da) / halfA) + chimney(da, db);
            case Roof::Hip:
                break;
        }
        const double least = std::min(halfA, halfB);
        const double inA = halfA - std::fabs(da), inB = halfB - std::fabs(db);
        (inA < inB ? slopeA : slopeB) = (inA < inB ? (da < 0 ? rise : -rise) : (db < 0 ? rise : -rise)) / least;
        return z + wall + rise * std::min(inA, inB) / least + chimney(da, db);
    }

private:
    double chimney(double da, double db) const
    {
        return std::fabs(da - halfA * 0.3) < 0.45 && std::fabs(db - halfB * 0.4) < 0.45 ? 1.4 : 0.0;
    }
};

/// Streets and lots in a square with round corners, in a frame of its own that is turned against the map's.
struct Scene::Town {
    double x = 0, y = 0, radius = 0;
    double c = 1, s = 0;  ///< of the turn
    std::uint64_t key = 0;
    std::int64_t lotsA = 0, lotsB = 0;  ///< on each side of the middle
    std::vector<Building> houses, garages;

    double a(double px, double py) const { return (px - x) * c + (py - y) * s; }
    double b(double px, double py) const { return (py - y) * c - (px - x) * s; }
    /// Metres to the town's edge, from inside.
    double edge(double px, double py) const
    {
        const double a2 = a(px, py) * a(px, py), b2 = b(px, py) * b(px, py);
        return radius - std::sqrt(std::sqrt(a2 * a2 + b2 * b2));
    }
    double inside(double px, double py) const { return edge(px, py) / radius; }
    std::size_t lot(std::int64_t la, std::int64_t lb) const
    {
        return std::size_t((la + lotsA) * 2 * lotsB + lb + lotsB);
    }
    const Building* building(double pa, double pb) const
    {
        const std::int64_t ia = floorOf(pa / kStreetA), ib = floorOf(pb / kStreetB);
        const double fa = pa - double(ia) * kStreetA - kStreet, fb = pb - double(ib) * kStreetB - kStreet;
        if (fa < 0.0 || fb < 0.0) return nullptr;
        const std::int64_t la = ia * 2 + std::min<std::int64_t>(1, std::int64_t(fa / kLotA));
        const std::int64_t lb = ib * 4 + std::min<std::int64_t>(3, std::int64_t(fb / kLotB));
        if (la < -lotsA || la >= lotsA || lb < -lotsB || lb >= lotsB) return nullptr;
        const std::size_t k = lot(la, lb);
        if (houses[k].built && houses[k].holds(pa, pb)) return &houses[k];
        if (garages[k].built && garages[k].holds(pa, pb)) return &garages[k];
        return nullptr;
    }
};

Scene::Scene(double side, std::uint64_t seed, Progress& progress)
    : m_side(side),
      m_seed(seed),
      m_riverHalf(std::clamp(side * 0.016, 2.0, 14.0)),
      m_riverSwing(std::min(75.0, side * 0.11)),
      m_roadSwing(std::min(45.0, side * 0.07)),
      m_lineX(side * 0.83),
      m_span(std::clamp(side * 0.28, 50.0, 240.0))
{
    progress.begin("Making the landscape", 6);
    placeTowns();
    shapeLand(progress);
    tbb::parallel_for(std::size_t(0), m_towns.size(), [&](std::size_t k) {
        if (!progress.cancelled()) build(m_towns[k]);
    });
    progress.check();
    plantTrees(progress);
    castShadows(progress);
}

Scene::~Scene() = default;

void Scene::shapeLand(Progress& progress)
{
    m_fine = {-kMargin, 1.0, std::int64_t(std::ceil(m_side + 2 * kMargin)) + 1};
    m_places = LazyArray<std::array<float, Place::kLayers>>(m_fine.count());
    forRows(m_fine.side, progress, [&](std::int64_t iy) {
        const double y = m_fine.coordinate(iy);
        for (std::int64_t ix = 0; ix < m_fine.side; ++ix) {
            const double x = m_fine.coordinate(ix);
            auto& layers = m_places[m_fine.at(ix, iy)];
            const double river = riverDistance(x, y), road = roadDistance(x, y);
            layers[Place::Z] = float(terrainHeight(x, y, river, road));
            layers[Place::River] = float(river);
            layers[Place::Road] = float(road);
            layers[Place::Woods] = float(noise(m_seed + kWoods, x / 230.0, y / 230.0) +
                                         0.35 * noise(m_seed + kWoods + 1, x / 70.0, y / 70.0));
            layers[Place::Mottle] = float(1.0 + 0.07 * noise(m_seed + kGrass, x / 19.0, y / 19.0) +
                                          0.06 * noise(m_seed + kGrass + 1, x / 2.7, y / 2.7));
            layers[Place::WarpX] = float(9.0 * noise(m_seed + kField, x / 170.0, y / 170.0));
            layers[Place::WarpY] = float(9.0 * noise(m_seed + kField + 1, x / 170.0, y / 170.0));
        }
    });
}

void Scene::castShadows(Progress& progress)
{
    LazyArray<float> trees(m_fine.count()), solids(m_fine.count());  // heights above the terrain
    forRows(m_fine.side, progress, [&](std::int64_t iy) {
        const double y = m_fine.coordinate(iy);
        for (std::int64_t ix = 0; ix < m_fine.side; ++ix) {
            const double x = m_fine.coordinate(ix);
            const std::size_t k = m_fine.at(ix, iy);
            const float z = m_places[k][Place::Z];
            if (const auto s = solid(x, y)) solids[k] = std::max(0.0f, float(s->top) - z);
            if (const auto c = canopy(x, y)) trees[k] = std::max(0.0f, float(c->top) - z);
        }
    });

    m_coarse = {-kMargin, kTallestCell, std::int64_t(std::ceil((m_side + 2 * kMargin) / kTallestCell)) + 1};
    m_tallestTree = LazyArray<float>(m_coarse.count());
    m_tallestSolid = LazyArray<float>(m_coarse.count());
    forRows(m_coarse.side, progress, [&](std::int64_t cy) {
        constexpr std::int64_t kReach = 9;  // metres: no beam leans over further
        constexpr auto kStep = std::int64_t(kTallestCell);
        for (std::int64_t cx = 0; cx < m_coarse.side; ++cx) {
            float tree = 0, solid = 0;
            const std::int64_t lastX = std::min(m_fine.side, (cx + 1) * kStep + kReach);
            for (std::int64_t y = std::max<std::int64_t>(0, cy * kStep - kReach);
                 y < std::min(m_fine.side, (cy + 1) * kStep + kReach); ++y)
                for (std::int64_t x = std::max<std::int64_t>(0, cx * kStep - kReach); x < lastX; ++x) {
                    tree = std::max(tree, trees[m_fine.at(x, y)]);
                    solid = std::max(solid, solids[m_fine.at(x, y)]);
                }
            m_tallestTree[m_coarse.at(cx, cy)] = tree;
            m_tallestSolid[m_coarse.at(cx, cy)] = solid;
        }
    });

    forRows(m_fine.side, progress, [&](std::int64_t iy) {
        // The sun stands over a diagonal of the grid: its ray rises so much with each step along it.
        const double kRise = kSun[2] / -kSun[0];
        for (std::int64_t ix = 0; ix < m_fine.side; ++ix) {
            double ceiling = -1e9;
            for (std::int64_t d = 1; d <= std::min<std::int64_t>(20, std::min(ix, iy)); ++d) {
                const std::size_t k = m_fine.at(ix - d, iy - d);
                const float top = m_places[k][Place::Z] + std::max(trees[k], solids[k]);
                ceiling = std::max(ceiling, double(top) - double(d) * kRise);
            }
            m_places[m_fine.at(ix, iy)][Place::Shadow] = float(ceiling);
        }
    });
}

// -- terrain, water, roads -------------------------------------------------------------------------------------

double Scene::lowHeight(double x, double y) const
{
    return 26.0 + 24.0 * noise(m_seed + kHills, x / 820.0, y / 820.0) +
           9.0 * noise(m_seed + kHills + 1, x / 350.0, y / 350.0);
}

double Scene::riverDistance(double x, double y) const
{
    const double middle = m_side * 0.27 + m_riverSwing * noise(m_seed + kRiver, y / 290.0) +
                          m_riverSwing * 0.3 * noise(m_seed + kRiver + 100, y / 97.0);
    const double half = m_riverHalf * (1.0 + 0.2 * noise(m_seed + kRiver + 200, y / 60.0));
    return std::fabs(x - middle) - half;
}

double Scene::roadDistance(double x, double y) const
{
    return y - m_side * 0.66 - m_roadSwing * noise(m_seed + kRoad, x / 360.0);
}

double Scene::roadLevel(double x, double roadY, double river) const
{
    return lerp(waterLevel(roadY) + 5.5, lowHeight(x, roadY), smooth(river / 130.0));
}

double Scene::terrainHeight(double x, double y, double river, double road) const
{
    const double low = lowHeight(x, y);
    double z = low + 4.5 * noise(m_seed + kHills + 2, x / 150.0, y / 150.0) +
               1.5 * noise(m_seed + kHills + 3, x / 64.0, y / 64.0);
    if (const Town* town = townAt(x, y)) z = lerp(z, low, 0.8 * smooth(town->inside(x, y) * 4.0));
    const double level = waterLevel(y);
    const double plain = level + 1.6 + 0.5 * noise(m_seed + kHills + 6, x / 40.0, y / 40.0);
    z = lerp(plain, z, smooth((river - 4.0) / 115.0));
    if (river < 4.0) z = river < 0.0 ? level - 1.2 * smooth(-river / 4.0) : lerp(level, plain, smooth(river / 4.0));
    const double away = std::fabs(road);
    if (away < 20.0) {
        const double embankment = (1.0 - smooth((away - 5.5) / 14.0)) * smooth((river - 3.0) / 9.0);
        z = lerp(z, roadLevel(x, y - road, river), embankment);
    }
    return z + (river > 4.0 && away > 6.0 ? 1.0 : 0.15) * (0.28 * noise(m_seed + kHills + 4, x / 21.0, y / 21.0) +
                                                           0.07 * noise(m_seed + kHills + 5, x / 4.3, y / 4.3));
}

double Scene::lineOffset(double x, double y) const
{
    return (x - m_lineX) * kLineY - (y - m_side * 0.5) * kLineX;
}

// -- towns -----------------------------------------------------------------------------------------------------

void Scene::placeTowns()
{
    m_townsAcross = std::max<std::int64_t>(1, floorOf(m_side / 620.0 + 0.5));
    const double cell = m_side / double(m_townsAcross);
    constexpr double kTurns[4][2] = {
        {0.8, 0.6}, {12.0 / 13.0, 5.0 / 13.0}, {15.0 / 17.0, 8.0 / 17.0}, {0.96, 0.28}};
    for (std::int64_t iy = 0; iy < m_townsAcross; ++iy)
        for (std::int64_t ix = 0; ix < m_townsAcross; ++ix) {
            const std::uint64_t h = hash(m_seed + kTownPlace, ix, iy);
            Town town;
            town.x = (double(ix) + 0.55 + 0.06 * unit(mix(h + 1))) * cell;
            town.y = (double(iy) + 0.38 + 0.06 * unit(mix(h + 2))) * cell;
            town.radius = std::min(230.0, cell * 0.32) * (0.82 + 0.18 * unit(mix(h + 3)));
            if (m_townsAcross > 2 && unit(mix(h + 4)) < 0.3) town.radius = 0.0;
            town.c = kTurns[h & 3][0];
            town.s = (h & 4) != 0 ? kTurns[h & 3][1] : -kTurns[h & 3][1];
            town.key = mix(h + 5);
            m_towns.push_back(std::move(town));
        }
}

const Scene::Town* Scene::townAt(double x, double y) const
{
    const double scale = double(m_townsAcross) / m_side;
    const auto ix = std::clamp<std::int64_t>(floorOf(x * scale), 0, m_townsAcross - 1);
    const auto iy = std::clamp<std::int64_t>(floorOf(y * scale), 0, m_townsAcross - 1);
    const Town& town = m_towns[std::size_t(iy * m_townsAcross + ix)];
    const double dx = x - town.x, dy = y - town.y, r2 = town.radius * town.radius;
    if (dx * dx + dy * dy > 1.5 * r2) return nullptr;
    const double a = town.a(x, y), b = town.b(x, y);
    return a * a * (a * a) + b * b * (b * b) < r2 * r2 ? &town : nullptr;
}

void Scene::build(Town& town)
{
    static constexpr Color kRoofs[6] = {{0.56, 0.27, 0.19}, {0.60, 0.33, 0.23}, {0.47, 0.23, 0.18},
                                        {0.30, 0.30, 0.33}, {0.36, 0.28, 0.23}, {0.62, 0.40, 0.29}};
    static constexpr Color kWalls[4] = {
        {0.90, 0.87, 0.78}, {0.82, 0.74, 0.60}, {0.93, 0.92, 0.90}, {0.76, 0.62, 0.52}};
    town.lotsA = 2 * (floorOf(town.radius / kStreetA) + 1);
    town.lotsB = 4 * (floorOf(town.radius / kStreetB) + 1);
    town.houses.resize(std::size_t(4 * town.lotsA * town.lotsB));
    town.garages.resize(town.houses.size());
    for (std::int64_t la = -town.lotsA; la < town.lotsA; ++la)
        for (std::int64_t lb = -town.lotsB; lb < town.lotsB; ++lb) {
            Random random(hash(town.key, la, lb));
            const std::int64_t row = la & 1;
            const double lotA = double(la >> 1) * kStreetA + kStreet + (double(row) + 0.5) * kLotA;
            const double lotB = double(lb >> 2) * kStreetB + kStreet + (double(lb & 3) + 0.5) * kLotB;
            const double outwards = row == 0 ? -1.0 : 1.0;  // to the street
            const bool built = random.chance(0.9);
            const bool large = std::sqrt(lotA * lotA + lotB * lotB) < 0.32 * town.radius && random.chance(0.75);
            Building house;
            house.halfA = large ? random.between(8.0, 11.0) : random.between(4.0, 6.0);
            house.halfB = large ? random.between(8.0, 10.2) : random.between(4.6, 6.6);
            house.a = lotA + outwards * (large ? 0.0 : random.between(2.0, 5.0));
            house.b = lotB + (large ? 0.0 : random.between(0.3, 1.6));
            house.wall = large ? 3.1 * double(floorOf(random.between(3.0, 6.0))) : random.between(3.2, 6.4);
            const double kind = random.unit();
            house.roof = large || kind < 0.07 ? Building::Roof::Flat
                         : kind < 0.4         ? Building::Roof::Hip
                         : kind < 0.75        ? Building::Roof::GableB
                                              : Building::Roof::GableA;
            house.rise = (house.roof == Building::Roof::GableA ? house.halfB : std::min(house.halfA, house.halfB)) *
                         random.between(0.62, 0.95);
            const bool flat = house.roof == Building::Roof::Flat;
            const double bright = random.between(0.42, 0.66);
            const std::uint64_t paint = random.next();
            house.roofColor = flat ? gray(bright) : kRoofs[paint % 6];
            house.wallColor = kWalls[(paint >> 8) % 4];
            house.reflectance = flat ? 0.22 : 0.30;

            Building garage = house;
            garage.halfA = 3.0;
            garage.halfB = 1.7;
            garage.a = lotA + outwards * 6.5;
            garage.b = lotB - kLotB / 2 + 2.4;
            garage.wall = 2.6;
            garage.roof = Building::Roof::Flat;
            garage.roofColor = gray(bright * 0.9);

            const double x = town.x + house.a * town.c - house.b * town.s;
            const double y = town.y + house.a * town.s + house.b * town.c;
            const Place p = place(x, y);
            if (!built || town.edge(x, y) < 14.0 || p.river() < 22.0 || p.road() < 18.0 ||
                std::fabs(lineOffset(x, y)) < 17.0)
                continue;
            house.z = garage.z = p.z();
            house.built = true;
            garage.built = !large && random.chance(0.45);
            const std::size_t lot = town.lot(la, lb);
            town.houses[lot] = house;
            town.garages[lot] = garage;
        }
}

std::optional<Solid> Scene::parkedCar(const Town& town, double a, double b) const
{
    const std::int64_t ia = floorOf(a / kStreetA), slot = floorOf(b / 6.4);
    const double fa = a - double(ia) * kStreetA;
    if (fa > kStreet) return {};
    const bool left = fa < kStreet / 2;
    const std::uint64_t h = hash(town.key + kCar, ia * 2 + left, slot);
    if (unit(h) > 0.33) return {};
    const double across = std::fabs(fa - (left ? 1.05 : kStreet - 1.05));
    const double along = b - (double(slot) + 0.5) * 6.4;
    if (across > 0.9 || std::fabs(along) > 2.15) return {};
    static constexpr Color kPaint[7] = {{0.85, 0.85, 0.87}, {0.12, 0.12, 0.14}, {0.55, 0.57, 0.60},
                                        {0.60, 0.08, 0.08}, {0.10, 0.18, 0.42}, {0.92, 0.92, 0.92},
                                        {0.25, 0.27, 0.30}};
    Solid car;
    car.top = along > -1.4 && along < 1.1 ? 1.48 : 0.95;  // above the street
    car.code = 1;
    car.color = car.sideColor = kPaint[(h >> 5) % 7];
    car.reflectance = 0.4;
    return car;
}

std::optional<Solid> Scene::solid(double x, double y) const
{
    const Town* const town = townAt(x, y);
    const double a = town != nullptr ? town->a(x, y) : 0, b = town != nullptr ? town->b(x, y) : 0;
    if (town != nullptr)
        if (const Building* house = town->building(a, b)) {
            Solid s;
            double slopeA, slopeB;
            s.top = house->roofAt(a, b, slopeA, slopeB);
            s.slopeX = slopeA * town->c - slopeB * town->s;
            s.slopeY = slopeA * town->s + slopeB * town->c;
            s.color = house->roofColor;
            s.sideColor = house->wallColor;
            s.reflectance = house->reflectance;
            return s;
        }
    if (town != nullptr)
        if (auto car = parkedCar(*town, a, b)) {
            const Place p = place(x, y);
            car->top += p.z();
            if (p.river() > 10.0 && p.road() > 9.0 && town->edge(x, y) > 6.0) return car;
        }
    if (std::fabs(y - m_side * 0.66) > m_roadSwing + 6.0) return {};
    const Place p = place(x, y);
    if (p.road() < kRoadHalf + 1.0 && p.river() < 12.0) {
        const bool parapet = p.road() > kRoadHalf + 0.7;
        Solid bridge;
        bridge.top = roadLevel(x, y - p.layers[Place::Road], p.river()) + (parapet ? 1.0 : 0.0);
        bridge.code = 17;
        bridge.color = gray(parapet ? 0.62 : 0.38);
        bridge.sideColor = gray(0.6);
        bridge.reflectance = 0.15;
        return bridge;
    }
    return {};
}

// -- what grows ------------------------------------------------------------------------------------------------

double Scene::treeDensity(double x, double y) const
{
    const Place p = place(x, y);
    if (p.river() < 2.5 || p.road() < 7.5 || std::fabs(lineOffset(x, y)) < 15.0) return 0.0;
    if (const Town* town = townAt(x, y)) {
        const double a = town->a(x, y), b = town->b(x, y);
        if (fractionOf(a / kStreetA) * kStreetA < kStreet + 2.0) return 0.0;
        if (fractionOf(b / kStreetB) * kStreetB < kStreet + 2.0) return 0.0;
        for (int k = 0; k < 9; ++k)
            if (const int across = k % 3 - 1, along = k / 3 - 1;
                town->building(a + across * 2.5, b + along * 2.5) != nullptr)
                return 0.0;
        return 0.34;
    }
    if (p.river() < 13.0) return 0.62;
    if (p.road() < 11.0) return 0.30;
    return p.woods() > 0.16 ? 0.95 : p.woods() > 0.08 ? 0.4 : 0.012;
}

void Scene::plantTrees(Progress& progress)
{
    m_treeSide = std::int64_t((m_side + 2 * kMargin) / kTreeCell) + 2;
    m_trees = LazyArray<Tree>(std::size_t(m_treeSide * m_treeSide));
    m_treeNear = LazyArray<std::uint8_t>(std::size_t(m_treeSide * m_treeSide));
    forRows(m_treeSide, progress, [&](std::int64_t iy) {
        for (std::int64_t ix = 0; ix < m_treeSide; ++ix) {
            Random random(hash(m_seed + kTree, ix, iy));
            const double x = -kMargin + (double(ix) + 0.5) * kTreeCell + random.between(-3.4, 3.4);
            const double y = -kMargin + (double(iy) + 0.5) * kTreeCell + random.between(-3.4, 3.4);
            if (!random.chance(treeDensity(x, y))) continue;
            Tree& tree = m_trees[std::size_t(iy * m_treeSide + ix)];
            const bool garden = townAt(x, y) != nullptr;
            const double stand = noise(m_seed + kConifers, x / 120.0, y / 120.0);
            tree.x = float(x);
            tree.y = float(y);
            tree.z = float(place(x, y).z());
            tree.conifer = random.chance(garden ? 0.2 : stand > 0.1 ? 0.88 : 0.12);
            tree.height =
                float(garden ? random.between(3.5, 9.5)
                             : 15.0 + 4.0 * stand + random.between(-4.5, 5.5) - (tree.conifer ? 0.0 : 1.5));
            tree.radius =
                float(tree.conifer ? random.between(1.9, 3.0) : random.between(2.4, 4.6) * (garden ? 0.72 : 1.0));
            tree.tint = std::uint8_t(random.next() >> 56);
        }
    });
    forRows(m_treeSide, progress, [&](std::int64_t iy) {
        for (std::int64_t ix = 0; ix < m_treeSide; ++ix) {
            std::uint8_t near = 0;
            for (std::int64_t y = std::max<std::int64_t>(0, iy - 1); y <= std::min(m_treeSide - 1, iy + 1); ++y)
                for (std::int64_t x = std::max<std::int64_t>(0, ix - 1); x <= std::min(m_treeSide - 1, ix + 1); ++x)
                    near |= std::uint8_t(m_trees[std::size_t(y * m_treeSide + x)].height > 0);
            m_treeNear[std::size_t(iy * m_treeSide + ix)] = near;
        }
    });
}

std::optional<Canopy> Scene::canopy(double x, double y) const
{
    const std::int64_t ix = floorOf((x + kMargin) / kTreeCell), iy = floorOf((y + kMargin) / kTreeCell);
    if (ix < 0 || iy < 0 || ix >= m_treeSide || iy >= m_treeSide) return {};
    if (m_treeNear[std::size_t(iy * m_treeSide + ix)] == 0) return {};
    Canopy best;
    best.top = -1e9;
    double lumps = 0;  // of foliage: the outline of a crown is not a circle
    bool lumpsKnown = false;
    for (std::int64_t cy = std::max<std::int64_t>(0, iy - 1); cy <= std::min(m_treeSide - 1, iy + 1); ++cy)
        for (std::int64_t cx = std::max<std::int64_t>(0, ix - 1); cx <= std::min(m_treeSide - 1, ix + 1); ++cx) {
            const Tree& t = m_trees[std::size_t(cy * m_treeSide + cx)];
            if (t.height <= 0) continue;
            const double dx = x - double(t.x), dy = y - double(t.y);
            const double r = t.radius, h = t.height;
            const double d2 = dx * dx + dy * dy;
            if (d2 >= r * r) continue;
            const double out = std::sqrt(d2) / r;
            if (!std::exchange(lumpsKnown, true)) lumps = 0.5 * noise(m_seed + kGrass + 9, x / 1.3, y / 1.3);
            const double top =
                double(t.z) +
                (t.conifer ? h * (0.14 + 0.86 * (1.0 - out)) : h * (0.55 + 0.45 * std::sqrt(1.0 - out * out))) +
                lumps;
            if (top <= best.top) continue;
            best.top = top;
            best.bottom = double(t.z) + (t.conifer ? h * 0.12 : h * (0.34 + 0.12 * out));
            best.conifer = t.conifer;
            best.towardsSun = -(dx + dy) * 0.7071 / r;
            const double tint = double(t.tint) / 255.0;
            best.color = t.conifer ? Color{0.10 + 0.05 * tint, 0.22 + 0.07 * tint, 0.11 + 0.03 * tint}
                                   : Color{0.22 + 0.16 * tint * tint, 0.37 + 0.10 * tint, 0.12 + 0.06 * tint};
        }
    if (best.top < -1e8) return {};
    best.bottom = std::min(best.bottom, best.top - 0.4);
    return best;
}

// -- ground cover ----------------------------------------------------------------------------------------------

Color Scene::fieldColor(double x, double y, const Place& place, Ground& ground) const
{
    // parcels in a frame of their own, their borders a little crooked
    const double wx = x + place.layers[Place::WarpX], wy = y + place.layers[Place::WarpY];
    const double a = (wx * 0.96 + wy * 0.28) / 118.0, b = (wy * 0.96 - wx * 0.28) / 64.0;
    const double fa = fractionOf(a), fb = fractionOf(b);
    const std::uint64_t h = hash(m_seed + kField, floorOf(a), floorOf(b));
    const Color meadow{0.36, 0.47, 0.21};
    if (std::min(fa, 1.0 - fa) * 118.0 < 1.0 || std::min(fb, 1.0 - fb) * 64.0 < 1.0) return meadow * 0.9;
    const double across = (fb * 64.0) / 15.0;  // a tractor's working width
    const double tram = std::fabs(fractionOf(across) - 0.5) * 15.0;
    const bool track = tram < 1.3 && tram > 0.7;
    const double furrow = fb * 64.0 / 1.5;
    const double ripple = std::fabs(fractionOf(furrow) - 0.5) * 2.0;
    switch (h % 7) {
        case 0:
            ground.cropHeight = 0.7;
            return Color{0.76, 0.67, 0.38} * (track ? 0.72 : 0.96 + 0.06 * ripple);
        case 1:
            ground.cropHeight = 1.1;
            return Color{0.80, 0.75, 0.17} * (track ? 0.66 : 0.97 + 0.05 * ripple);
        case 2:
            ground.cropHeight = 1.7;
            return Color{0.27, 0.42, 0.14} * (track ? 0.8 : 0.85 + 0.2 * ripple);
        case 3:
            ground.reflectance = 0.24;
            return Color{0.47, 0.36, 0.26} * (0.82 + 0.24 * ripple);
        case 4:
            ground.reflectance = 0.34;
            return Color{0.68, 0.60, 0.41} * (track ? 0.85 : 0.92 + 0.12 * ripple);
        default:
            return meadow;
    }
}

Ground Scene::ground(double x, double y, const Place& place) const
{
    Ground g;
    const double river = place.river(), road = place.road(), mottle = place.mottle();
    if (river < 0.0) {
        g.code = 9;
        const double depth = smooth(-river / 9.0);
        g.color = Color{lerp(0.33, 0.11, depth), lerp(0.37, 0.20, depth), lerp(0.30, 0.22, depth)};
        g.reflectance = 0.05;
        return g;
    }
    if (road < kRoadHalf + 1.2) {
        g.code = road < kRoadHalf ? 11 : 2;
        const bool paint = (road < 0.14 && fractionOf(x / 9.0) < 0.55) || std::fabs(road - kRoadHalf + 0.35) < 0.12;
        g.color = road >= kRoadHalf ? Color{0.55, 0.51, 0.44} * mottle : paint ? gray(0.88) : gray(0.34) * mottle;
        g.reflectance = paint ? 0.55 : road < kRoadHalf ? 0.10 : 0.25;
        return g;
    }
    g.reflectance = 0.42;
    if (river < 3.5) {
        g.color = Color{0.62, 0.56, 0.43} * mottle;
        g.reflectance = 0.33;
        return g;
    }
    if (const Town* town = townAt(x, y)) {
        const double a = town->a(x, y), b = town->b(x, y);
        const double fa = fractionOf(a / kStreetA) * kStreetA, fb = fractionOf(b / kStreetB) * kStreetB;
        const bool paved = town->edge(x, y) > 6.0;
        if (paved && (fa < kStreet || fb < kStreet)) {
            g.code = 11;
            g.color = gray(0.40) * mottle;
            g.reflectance = 0.12;
            return g;
        }
        constexpr double kWalk = 1.4;
        if (paved &&
            (fa < kStreet + kWalk || fb < kStreet + kWalk || fa > kStreetA - kWalk || fb > kStreetB - kWalk)) {
            g.color = gray(0.58) * mottle;
            g.reflectance = 0.28;
            return g;
        }
        const std::uint64_t lot = hash(town->key + kLot, floorOf(a / kLotA), floorOf(b / kLotB));
        g.color = Color{0.34 + 0.09 * unit(lot), 0.44, 0.23} * mottle;
        return g;
    }
    if (place.woods() > 0.06) {
        const double deep = smooth((place.woods() - 0.06) / 0.1);
        g.color = Color{lerp(0.37, 0.28, deep), lerp(0.44, 0.26, deep), lerp(0.24, 0.17, deep)} * mottle;
        g.reflectance = 0.36;
        return g;
    }
    g.color = (river < 16.0 || road < 14.0 ? Color{0.36, 0.45, 0.23} : fieldColor(x, y, place, g)) * mottle;
    return g;
}

// -- the power line --------------------------------------------------------------------------------------------

std::optional<Aerial> Scene::aerial(double x, double y, double ground, double slope, Random& random) const
{
    struct Conductor {
        double offset, height;
    };
    static constexpr Conductor kWires[7] = {{-5.6, 19.0}, {5.6, 19.0}, {-7.0, 23.0}, {7.0, 23.0},
                                            {-4.8, 27.0}, {4.8, 27.0}, {0.0, 31.0}};
    const auto along = [&](double px, double py) { return (px - m_lineX) * kLineX + (py - m_side * 0.5) * kLineY; };
    const auto towerBase = [&](double number) {
        const double s = number * m_span;
        return place(m_lineX + s * kLineX, m_side * 0.5 + s * kLineY).z();
    };
    const double s = along(x, y) / m_span;
    const auto before = double(floorOf(s));
    const double za = towerBase(before), zb = towerBase(before + 1);

    // towers: a tapering lattice with three arms, met now and then
    const auto number = double(floorOf(s + 0.5));
    const double base = number > s ? zb : za;
    if (std::fabs(s - number) * m_span < 9.0) {
        for (double h = 33.0 - random.unit(); h > 0.5; h -= 0.5) {
            const double px = x - slope * (base + h - ground);
            const double u = std::fabs(along(px, y) - number * m_span), v = std::fabs(lineOffset(px, y));
            const double half = 0.4 + 2.8 * (1.0 - h / 33.0);
            const bool mast = std::max(u, v) < half && std::max(u, v) > half - 0.45;
            const bool arm =
                u < 0.45 && ((std::fabs(h - 21.0) < 0.3 && v < 5.8) || (std::fabs(h - 25.0) < 0.3 && v < 7.2) ||
                             (std::fabs(h - 29.0) < 0.3 && v < 5.0));
            if ((mast && random.chance(0.35)) || (arm && random.chance(0.8)))
                return Aerial{base + h, 15, random.chance(0.5)};
        }
    }
    for (const Conductor& wire : kWires) {
        const double f = s - before;
        const double z = lerp(za, zb, f) + wire.height - m_span * 0.032 * 4.0 * f * (1.0 - f);
        const double off = lineOffset(x - slope * (z - ground), y) - wire.offset;
        if (std::fabs(off) < 0.13 && random.chance(0.85)) return Aerial{z, 14, false};
    }
    return {};
}

}  // namespace punctum::sample
