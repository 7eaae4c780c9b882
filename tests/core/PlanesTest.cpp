// SPDX-License-Identifier: MIT
// Planes: made scenes whose planes are known, any number of threads, any order of points, some points alone,
// cancel.
#include "core/sample/Sample.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/CancelAfter.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <tbb/global_control.h>
#include <glm/geometric.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <numeric>
#include <set>

using namespace punctum;

namespace
{

using Cloud = std::shared_ptr<PointCloud>;
using Vector = glm::dvec3;

/// A rectangle: a corner, two sides.
struct Face {
    Vector corner, a, b;
    Vector normal() const { return glm::normalize(glm::cross(a, b)); }
    /// From the whole plane.
    double distance(const Vector& place) const { return std::fabs(glm::dot(place - corner, normal())); }
    double distanceOfFace(const Vector& place) const
    {
        const Vector from = place - corner;
        const double u = std::clamp(glm::dot(from, a) / glm::dot(a, a), 0.0, 1.0);
        const double v = std::clamp(glm::dot(from, b) / glm::dot(b, b), 0.0, 1.0);
        return glm::length(from - u * a - v * b);
    }
};

/// Points of faces, with which face each is of; -1: none.
struct Scene {
    std::vector<Vector> places;
    std::vector<int> faceOf;
    std::vector<Face> faces;
    std::mt19937_64 random{7};

    double unit() { return double(random() >> 11) * 0x1p-53; }
    /// `noise`: standard deviation across the face.
    void addFace(const Face& face, std::size_t count, double noise)
    {
        std::normal_distribution<double> across;
        for (std::size_t k = 0; k < count; ++k)
            add(face.corner + unit() * face.a + unit() * face.b + noise * across(random) * face.normal(),
                int(faces.size()));
        faces.push_back(face);
    }
    void add(const Vector& place, int face)
    {
        places.push_back(place);
        faceOf.push_back(face);
    }
    /// Whether a point is further from all faces but its own.
    bool isOfOneFace(std::size_t point, double distance) const
    {
        for (std::size_t f = 0; f < faces.size(); ++f)
            if (int(f) != faceOf[point] && faces[f].distanceOfFace(places[point]) <= distance) return false;
        return true;
    }
    /// In millimeters; point k of it is point order[k] of the scene.
    Cloud cloud(const std::vector<std::size_t>& order) const
    {
        const auto made = makeFrame(places.size(), {glm::dvec3(0.001), glm::dvec3(457000.0, 5552000.0, 100.0)});
        for (std::size_t k = 0; k < order.size(); ++k)
            for (int a = 0; a < 3; ++a)
                rawAxis(*made, std::size_t(a))[k] = std::int32_t(std::lround(places[order[k]][a] * 1000));
        return made;
    }
    Cloud cloud() const
    {
        std::vector<std::size_t> order(places.size());
        std::iota(order.begin(), order.end(), std::size_t(0));
        return cloud(order);
    }
};

/// 100 points a square unit.
Scene makeCube(double noise)
{
    Scene scene;
    for (int axis = 0; axis < 3; ++axis)
        for (const double at : {0.0, 5.0}) {
            Face face{Vector(0), Vector(0), Vector(0)};
            face.corner[axis] = at;
            face.a[(axis + 1) % 3] = 5;
            face.b[(axis + 2) % 3] = 5;
            scene.addFace(face, 2500, noise);
        }
    for (int k = 0; k < 500; ++k) scene.add(Vector(1) + 3.0 * Vector(scene.unit(), scene.unit(), scene.unit()), -1);
    return scene;
}

/// A house of 8 by 6 with a roof of 30 degrees, on level ground, a car park's worth of ground about it.
Scene makeHouse(double noise)
{
    Scene scene;
    const double rise = 3 * std::tan(0.5235987755982988);
    scene.addFace({Vector(-10, -10, 0), Vector(28, 0, 0), Vector(0, 8, 0)}, 12'000, noise);
    scene.addFace({Vector(0, 0, 3), Vector(8, 0, 0), Vector(0, 3, rise)}, 2'000, noise);
    scene.addFace({Vector(0, 6, 3), Vector(8, 0, 0), Vector(0, -3, rise)}, 2'000, noise);
    scene.addFace({Vector(0, 0, 0), Vector(8, 0, 0), Vector(0, 0, 3)}, 1'500, noise);
    scene.addFace({Vector(8, 0, 0), Vector(0, 6, 0), Vector(0, 0, 3)}, 1'200, noise);
    return scene;
}

std::unique_ptr<Command> run(const PointCloud& cloud, const std::string& text, const PointSet* within = nullptr)
{
    const ParsedStep parsed = parseStep(text);
    Progress progress;
    return parsed.step->run(cloud, parsed.values, progress, within);
}

std::vector<int> planesOf(const PointCloud& cloud)
{
    const Attribute* const ids = cloud.findAttribute("PlaneId");
    std::vector<int> planes(cloud.size());
    for (PointIndex i = 0; i < cloud.size(); ++i) planes[i] = int(ids->number(i));
    return planes;
}

std::vector<int> planesFound(const PointCloud& cloud, const std::string& text)
{
    const auto command = run(cloud, text);
    auto& changed = const_cast<PointCloud&>(cloud);
    command->apply(changed);
    std::vector<int> planes = planesOf(cloud);
    command->apply(changed);
    return planes;
}

/// Every face is one plane, which has nearly all of its points, but for those near where others meet it, and no
/// point that is not in its plane.
void checkFaces(const Scene& scene, const std::vector<int>& planes, double tolerance, double leastShare)
{
    std::set<int> ids(planes.begin(), planes.end());
    ids.erase(0);
    QCOMPARE(ids.size(), scene.faces.size());
    std::vector<int> idOf;
    for (std::size_t f = 0; f < scene.faces.size(); ++f) {
        std::map<int, std::size_t> counts;
        std::size_t all = 0;
        for (std::size_t i = 0; i < planes.size(); ++i)
            if (scene.faceOf[i] == int(f) && scene.isOfOneFace(i, 1.1 * tolerance)) {
                ++counts[planes[i]];
                ++all;
            }
        const auto most = std::max_element(counts.begin(), counts.end(),
                                           [](const auto& a, const auto& b) { return a.second < b.second; });
        QVERIFY2(most->first != 0 && double(most->second) >= leastShare * double(all),
                 qPrintable(QString("face %1: %2 of %3").arg(f).arg(most->second).arg(all)));
        idOf.push_back(most->first);
    }
    QCOMPARE(std::set<int>(idOf.begin(), idOf.end()).size(), scene.faces.size());
    std::size_t wrong = 0;
    for (std::size_t i = 0; i < planes.size(); ++i) {
        if (planes[i] == 0) continue;
        const auto face = std::size_t(std::find(idOf.begin(), idOf.end(), planes[i]) - idOf.begin());
        // The plane that was found may be off by what noise does to it: a tenth of the tolerance.
        if (scene.faces[face].distance(scene.places[i]) > 1.1 * tolerance) ++wrong;
        if (scene.faceOf[i] == -1) ++wrong;
    }
    QCOMPARE(wrong, std::size_t(0));
}

/// Hills with houses and trees, in millimeters or whatever makeSample() has.
Cloud permuted(const PointCloud& from, const std::vector<PointIndex>& order)
{
    const auto to = makeFrame(from.size(), from.coordinates());
    for (std::size_t a = 0; a < 3; ++a) {
        const auto source = from.columns()[a]->values<std::int32_t>();
        for (PointIndex i = 0; i < from.size(); ++i) rawAxis(*to, a)[i] = source[order[i]];
    }
    return to;
}

}  // namespace

class PlanesTest : public QObject
{
    Q_OBJECT

private slots:
    void facesOfACube()
    {
        const Scene scene = makeCube(0.01);
        const Cloud cloud = scene.cloud();
        const auto command = run(*cloud, "planes tolerance=0.05");
        QVERIFY(QString::fromStdString(command->finding()).startsWith("6 planes of "));
        command->apply(*cloud);
        QVERIFY(cloud->findAttribute("PlaneId")->kind == AttributeKind::Category);
        checkFaces(scene, planesOf(*cloud), 0.05, 0.98);  // corners look like none of their faces
        command->apply(*cloud);
        QVERIFY(cloud->findAttribute("PlaneId") == nullptr);
    }
    void sidesOfAHouse()
    {
        const Scene scene = makeHouse(0.02);
        checkFaces(scene, planesFound(*scene.cloud(), "planes tolerance=0.1"), 0.1, 0.995);
        // The most points have the first number.
        const auto planes = planesFound(*scene.cloud(), "planes tolerance=0.1");
        std::map<int, std::size_t> counts;
        for (const int id : planes)
            if (id > 0) ++counts[id];
        for (std::size_t id = 2; id <= counts.size(); ++id) QVERIFY(counts[int(id)] <= counts[int(id) - 1]);
    }
    void stepsAreTwoPlanes()
    {
        // Of two levels, a hand above each other; and beside, with a gap, at the height of the first.
        Scene scene;
        scene.addFace({Vector(0, 0, 0), Vector(5, 0, 0), Vector(0, 5, 0)}, 2500, 0.005);
        scene.addFace({Vector(5, 0, 0.3), Vector(5, 0, 0), Vector(0, 5, 0)}, 2400, 0.005);
        scene.addFace({Vector(0, 9, 0), Vector(5, 0, 0), Vector(0, 5, 0)}, 2300, 0.005);
        checkFaces(scene, planesFound(*scene.cloud(), "planes tolerance=0.05"), 0.05, 0.99);
    }
    void whatBendsIsNoPlane()
    {
        Scene scene;
        for (int k = 0; k < 20'000; ++k) {  // 8 points a square unit
            const Vector d(scene.unit() - 0.5, scene.unit() - 0.5, scene.unit() - 0.5);
            scene.add(14.0 * glm::normalize(d), -1);
        }
        const auto command = run(*scene.cloud(), "planes tolerance=0.02");
        QCOMPARE(QString::fromStdString(command->finding()), QString("No planes."));
    }
    void onePlaneOfAnySlope()
    {
        for (const Vector& normal : {Vector(0, 0, 1), Vector(1, 0, 0), Vector(0, 1, 0), Vector(1, 1, 1),
                                     Vector(-1, 2, 0.1), Vector(3, -1, -2)}) {
            const Vector a =
                glm::normalize(glm::cross(normal, std::fabs(normal.z) < 1 ? Vector(0, 0, 1) : Vector(1, 0, 0)));
            const Vector b = glm::normalize(glm::cross(normal, a));
            Scene scene;
            scene.addFace({Vector(3, 2, 1), 10.0 * a, 10.0 * b}, 5000, 0);
            checkFaces(scene, planesFound(*scene.cloud(), "planes tolerance=0.01"), 0.01, 1.0);
        }
    }
    void degenerateOnes()
    {
        for (const std::size_t count : {0, 1, 2, 3, 100, 5000}) {
            Scene same, line;
            for (std::size_t k = 0; k < count; ++k) {
                same.add(Vector(1, 2, 3), -1);
                line.add(Vector(double(k) * 0.01, double(k) * 0.02, 5), -1);
            }
            for (const Scene* scene : {&same, &line}) {
                const Cloud cloud = scene->cloud();
                const auto command = run(*cloud, "planes tolerance=0.1 cell=0.5 points=3");
                QCOMPARE(command == nullptr, count == 0);
                if (command) QCOMPARE(QString::fromStdString(command->finding()), QString("No planes."));
            }
        }
    }
    void sameInAnyOrderOnAnyNumberOfThreads()
    {
        Progress progress;
        const Scene house = makeHouse(0.03);
        for (const Cloud& cloud : {house.cloud(), makeSample(120'000, 3, progress)}) {
            std::vector<PointIndex> order(cloud->size());
            std::iota(order.begin(), order.end(), PointIndex(0));
            std::vector<int> first;
            {
                const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
                first = planesFound(*cloud, "planes tolerance=0.1 cell=1.5 points=30");
            }
            const int most = *std::max_element(first.begin(), first.end());
            QVERIFY2(most >= 5, qPrintable(QString::number(most)));
            for (const std::size_t threads : {2, 4}) {
                const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, threads);
                QVERIFY(planesFound(*cloud, "planes tolerance=0.1 cell=1.5 points=30") == first);
            }
            // As tiles of a survey, the last first; then in no order at all.
            const auto x = cloud->rawX();
            const auto [least, last] = std::minmax_element(x.begin(), x.end());
            const std::int64_t from = *least, wide = std::int64_t(*last) - from + 1;
            std::stable_sort(order.begin(), order.end(), [&](PointIndex a, PointIndex b) {
                return (x[a] - from) * 4 / wide > (x[b] - from) * 4 / wide;
            });
            for (int round = 0; round < 2; ++round) {
                const auto other = planesFound(*permuted(*cloud, order), "planes tolerance=0.1 cell=1.5 points=30");
                std::size_t differ = 0;
                for (PointIndex i = 0; i < cloud->size(); ++i) differ += other[i] != first[order[i]];
                QCOMPARE(differ, std::size_t(0));
                std::shuffle(order.begin(), order.end(), std::mt19937_64(5));
            }
        }
    }
    void someAloneGoOnCounting()
    {
        const Scene scene = makeCube(0.01);
        const Cloud cloud = scene.cloud();
        PointSet three(cloud->size()), others(cloud->size());
        for (PointIndex i = 0; i < cloud->size(); ++i) (scene.faceOf[i] < 3 ? three : others).insert(i);
        run(*cloud, "planes tolerance=0.05", &three)->apply(*cloud);
        const auto before = planesOf(*cloud);
        for (PointIndex i = 0; i < cloud->size(); ++i)
            if (!three.contains(i)) QCOMPARE(before[i], 0);
        QCOMPARE(*std::max_element(before.begin(), before.end()), 3);
        run(*cloud, "planes tolerance=0.05", &others)->apply(*cloud);
        const auto after = planesOf(*cloud);
        for (PointIndex i = 0; i < cloud->size(); ++i) {
            if (three.contains(i)) QCOMPARE(after[i], before[i]);
            if (others.contains(i)) QVERIFY(after[i] == 0 || (after[i] > 3 && after[i] <= 6));
        }
        // Deleted points are none.
        const auto gone = std::make_shared<const PointSet>(three);
        const Cloud less = scene.cloud();
        less->setDeleted(gone);
        QVERIFY(QString::fromStdString(run(*less, "planes tolerance=0.05")->finding()).startsWith("3 planes of "));
    }
    void cancelsAnywhere()
    {
        Progress made;
        const Cloud cloud = makeSample(1'000'000, 2, made);
        const ParsedStep parsed = parseStep("planes tolerance=0.1 cell=1.5 points=30");
        int cancelled = 0;
        for (int wait = 0; wait < 1'500; wait += 150) {
            const CancelOutcome outcome = cancelAfter(
                wait, [&](Progress& progress) { (void)parsed.step->run(*cloud, parsed.values, progress); });
            cancelled += outcome.cancelled;
            // 100 ms, and room for a machine that does other things, too
            QVERIFY2(!outcome.cancelled || outcome.ms < 300, qPrintable(QString::number(outcome.ms)));
        }
        QVERIFY(cancelled > 0);
    }
};

QTEST_APPLESS_MAIN(PlanesTest)
#include "PlanesTest.moc"
