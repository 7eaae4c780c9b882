// SPDX-License-Identifier: MIT
#include "core/sample/Survey.h"

#include <algorithm>
#include <cmath>

namespace punctum::sample
{

namespace
{

constexpr double kRangeNoise = 0.015;     ///< metres, one deviation
constexpr double kPulseSeparation = 0.6;  ///< metres between two returns that a scanner can tell apart

/// The aerial photograph: color under sun and sky. `direct`: how much the surface faces the sun, 1 for flat
/// ground.
Color lit(const Color& color, double direct, double inSun, Random& random)
{
    const double sun = 0.78 * inSun * std::clamp(direct, 0.0, 1.6);
    const double grain = 1.0 + 0.03 * random.bell();
    return {color.r * (0.24 + sun) * grain, color.g * (0.26 + sun) * grain, color.b * (0.31 + 0.95 * sun) * grain};
}

/// How much a surface of this slope faces the sun, relative to flat ground.
double facing(double dzdx, double dzdy)
{
    const auto& sun = Scene::kSun;
    const double n = std::sqrt(1.0 + dzdx * dzdx + dzdy * dzdy);
    return (sun[2] - dzdx * sun[0] - dzdy * sun[1]) / (n * sun[2]);
}

/// 0 in shadow, 1 in the sun. The shadow is read where the beam meets the ground: a leaning beam is not far off.
double inSun(const Place& place, double z)
{
    return 1.0 - smooth((place.shadow() - z + 0.1) / 0.9);
}

/// Where the beam meets something hard, from the top down.
struct Hit {
    double z = 0;
    Solid solid;
    bool side = false;  ///< a wall rather than the top
    bool found = false;
};

Hit marchSolids(const Scene& scene, double x, double y, double slope, double ground, double most, Random& random)
{
    Hit hit;
    if (std::fabs(slope) < 0.015) {
        if (const auto s = scene.solid(x, y); s && s->top > ground) hit = {s->top, *s, false, true};
        return hit;
    }
    // Steps no longer than 0.25 m on the map: a wall is met where it stands.
    const double step = std::min(0.8, 0.25 / std::fabs(slope));
    for (double z = ground + most + step * random.unit(); z > ground; z -= step) {
        const auto s = scene.solid(x - slope * (z - ground), y);
        if (!s || s->top < z) continue;
        // from above onto the top, or level with what was beside it: then it is the wall
        hit.side = s->top > z + step + 0.3;
        hit.z = hit.side ? z : s->top;
        hit.solid = *s;
        hit.found = true;
        return hit;
    }
    return hit;
}

}  // namespace

Echo sendPulse(const Scene& scene, double x, double y, double slope, Random& random)
{
    Echo echo;
    const Place place = scene.place(x, y);
    const double ground = place.z();
    const auto put = [&](Return& r, double z) {
        r.x = x - slope * (z - ground);
        r.y = y;
        r.z = z + kRangeNoise * random.bell();
    };

    const double luck = random.unit();
    if (luck < 8e-5) {  // a bird, a cloud's wisp, or an echo of an echo
        Return r;
        const bool high = luck < 5e-5;
        put(r, ground + (high ? random.between(35.0, 110.0) : -random.between(2.0, 14.0)));
        r.code = high ? 18 : 7;
        r.color = {0.55, 0.56, 0.58};
        r.reflectance = 0.02 + 0.05 * random.unit();
        r.spread = random.unit();
        echo.add(r);
        return echo;
    }

    double share = 1.0;  // of the pulse that is still on its way
    if (scene.nearLine(x, y))
        if (const auto met = scene.aerial(x, y, ground, slope, random)) {
            Return r;
            put(r, met->z);
            r.code = met->code;
            r.color = lit(met->code == 14 ? Color{0.24, 0.24, 0.26} : Color{0.56, 0.58, 0.60}, 1.0, 1.0, random);
            r.reflectance = met->code == 14 ? 0.10 : 0.22;
            r.spread = 0.15;
            echo.add(r);
            if (met->opaque) return echo;
            share = 0.6;
        }

    Hit hit;
    if (const double most = scene.tallestSolid(x, y); most > 0.4)
        hit = marchSolids(scene, x, y, slope, ground, most, random);
    const double floor = hit.found ? hit.z : ground;

    // Leaves and twigs, from the crown's top down: the deeper, the fewer.
    double lowest = 1e9;
    if (const double most = scene.tallestTree(x, y); most > 0.5) {
        const auto crown = scene.canopy(x - slope * most * 0.7, y);
        if (crown && crown->top > floor + 1.0) {
            const double depth = std::max(0.5, crown->top - std::max(crown->bottom, floor));
            double z = crown->top - 0.9 * random.unit() * random.unit() * std::min(depth, 2.5);
            const int wanted = 1 + int(random.chance(0.58)) + int(random.chance(0.30));
            for (int k = 0; k < wanted && z > floor + 0.4; ++k) {
                Return r;
                put(r, z);
                const double height = z - ground;
                r.code = height < 0.5 ? 3 : height < 2.0 ? 4 : 5;
                const double above = std::clamp((z - crown->bottom) / (crown->top - crown->bottom), 0.0, 1.0);
                const double direct = (0.62 + 0.38 * crown->towardsSun) * (0.45 + 0.65 * above);
                r.color = lit(crown->color * 1.15, direct * 1.25, 0.35 + 0.65 * inSun(place, z + 0.4), random);
                r.reflectance = share * (crown->conifer ? 0.30 : 0.48);
                r.spread = 0.5 + 0.5 * random.unit();
                echo.add(r);
                share *= random.between(0.35, 0.65);
                lowest = z;
                z -= kPulseSeparation + (0.15 + random.unit()) * depth * 0.45;
            }
            if (echo.count == 0) return echo;
            // dense crowns let little through; the underwood stops some of that
            const bool through = random.chance(crown->conifer ? 0.34 : 0.50);
            if (through && !hit.found && random.chance(0.28)) {
                Return r;
                const double h = 0.25 + 2.3 * random.unit() * random.unit();
                put(r, ground + h);
                r.code = h < 0.5 ? 3 : h < 2.0 ? 4 : 5;
                r.color = lit({0.24, 0.33, 0.14}, 0.7, 0.3, random);
                r.reflectance = share * 0.4;
                r.spread = 0.6;
                if (ground + h < lowest - kPulseSeparation) echo.add(r);
                return echo;
            }
            if (!through || floor > lowest - kPulseSeparation) return echo;
        }
    }
    if (echo.count == Echo::kMost) return echo;

    Return r;
    if (hit.found) {
        put(r, hit.z);
        r.code = hit.solid.code;
        const double direct = hit.side ? std::clamp(0.55 + (slope > 0 ? 0.4 : -0.25), 0.0, 1.0)
                                       : facing(hit.solid.slopeX, hit.solid.slopeY);
        r.color = lit(hit.side ? hit.solid.sideColor : hit.solid.color, direct,
                      hit.side ? 0.7 : inSun(place, hit.z + 0.35), random);
        r.reflectance = share * hit.solid.reflectance * (0.85 + 0.3 * random.unit());
        r.spread = hit.side ? 0.2 : 0.04;
        echo.add(r);
        return echo;
    }
    const Ground cover = scene.ground(x, y, place);
    if (cover.code == 9) {
        // Water sends little back, and that near the nadir only.
        const double glint = 0.5 / (1.0 + 60.0 * slope * slope);
        if (!random.chance(0.04 + glint)) return echo;
        put(r, scene.waterLevel(y));
        r.code = 9;
        r.color = lit(cover.color, 1.0, 0.5 + 0.5 * inSun(place, r.z), random);
        r.reflectance = share * (0.02 + 0.2 * glint * random.unit());
        r.spread = 0.05;
        echo.add(r);
        return echo;
    }
    const double direct = facing(place.dzdx, place.dzdy);
    double z = ground;
    r.code = cover.code;
    r.spread = 0.03;
    if (cover.cropHeight > 0 && random.chance(0.45)) {
        const double h = cover.cropHeight * random.between(0.35, 1.0);
        z += h;
        r.code = h < 0.5 ? 3 : 4;
        r.spread = 0.4;
    } else if (cover.code == 2 && cover.color.g > cover.color.r && random.chance(0.06)) {
        z += 0.12 + 0.3 * random.unit();  // grass
        r.code = 3;
        r.spread = 0.3;
    }
    put(r, z);
    r.color = lit(cover.color, direct, inSun(place, z), random);
    r.reflectance = share * cover.reflectance * (0.8 + 0.4 * random.unit());
    echo.add(r);
    return echo;
}

}  // namespace punctum::sample
