// SPDX-License-Identifier: MIT
// Our steps against PCL's own filters with one kd-tree over the whole cloud, on real files.
#include "core/las/Reader.h"
#include "core/neighbors/KdOrder.h"
#include "core/sample/Sample.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <pcl/features/normal_3d.h>
#include <pcl/filters/radius_outlier_removal.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/filters/voxel_grid.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>

#include <Eigen/Eigenvalues>

#include <QTest>

#include <chrono>
#include <cmath>
#include <filesystem>

using namespace punctum;

namespace
{

using Points = pcl::PointCloud<pcl::PointXYZ>;

constexpr double kOneDegree = 0.99984769515639127;  ///< its cosine

/// Coordinates from the middle of the cloud, as anyone would have to give them to PCL.
Points::Ptr pointsOf(const PointCloud& cloud)
{
    Points::Ptr points(new Points);
    points->reserve(cloud.size());
    const RawBounds bounds = cloud.computeBounds();
    const glm::dvec3 middle = glm::dvec3(bounds.min + bounds.max) / 2.0;
    const glm::dvec3 scale = cloud.coordinates().scale;
    for (PointIndex i = 0; i < cloud.size(); ++i) {
        const glm::dvec3 p = (glm::dvec3(cloud.rawX()[i], cloud.rawY()[i], cloud.rawZ()[i]) - middle) * scale;
        points->push_back({float(p.x), float(p.y), float(p.z)});
    }
    return points;
}

std::unique_ptr<Command> run(const PointCloud& cloud, const std::string& text)
{
    const ParsedStep parsed = parseStep(text);
    Progress progress;
    return parsed.step->run(cloud, parsed.values, progress);
}

double secondsSince(std::chrono::steady_clock::time_point start)
{
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

}  // namespace

class PclTest : public QObject
{
    Q_OBJECT

private slots:
    void outliersAreThoseOfPcl_data() { files(); }
    void outliersAreThoseOfPcl();
    void cellsAreThoseOfPcl_data() { files(); }
    void cellsAreThoseOfPcl();
    void radiusOutliersAreThoseOfPcl_data() { files(); }
    void radiusOutliersAreThoseOfPcl();
    void clustersAreThoseOfPcl_data()
    {
        QTest::addColumn<QString>("file");  // PCL takes minutes for those that are denser
        for (const char* file : {"autzen_trim_7.las", "megaplot.las"}) QTest::newRow(file) << QString(file);
    }
    void clustersAreThoseOfPcl();
    void featuresAreThoseOfEigen_data() { files(); }
    void featuresAreThoseOfEigen();
    void normalsAreThoseOfPcl_data() { files(); }
    void normalsAreThoseOfPcl();
    void normalsOfTheSample();

private:
    static void files()
    {
        QTest::addColumn<QString>("file");
        for (const char* file : {"autzen_trim_7.las", "megaplot.las", "tls_clip.laz", "lone-star.laz"})
            QTest::newRow(file) << QString(file);
    }
    static std::shared_ptr<PointCloud> load(const QString& file)
    {
        const auto path = std::filesystem::path(PUNCTUM_TEST_DATA) / file.toStdString();
        if (!std::filesystem::exists(path)) return nullptr;
        Progress progress;
        return las::load(path, progress);
    }
};

void PclTest::outliersAreThoseOfPcl()
{
    QFETCH(QString, file);
    const auto cloud = load(file);
    if (!cloud) QSKIP(qPrintable(file + " is not there"));
    pcl::StatisticalOutlierRemoval<pcl::PointXYZ> filter;
    filter.setInputCloud(pointsOf(*cloud));
    filter.setMeanK(8);
    filter.setStddevMulThresh(1.0);
    filter.setNegative(true);
    pcl::Indices outliers;
    filter.filter(outliers);
    PointSet expected(cloud->size());
    for (const auto i : outliers) expected.insert(PointIndex(i));

    const Attribute classes = *cloud->findAttribute("Classification");
    PointSet before(cloud->size()), after(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (classes.number(i) == 7.0) before.insert(i);
    const auto command = run(*cloud, "outliers k=8 deviations=1.0 class=7");
    QVERIFY(command != nullptr);
    command->apply(*cloud);
    PointIndex differ = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i)
        differ += (classes.number(i) == 7.0) != (expected.contains(i) || before.contains(i));
    qInfo("%llu outliers of %llu points", qulonglong(expected.count()), qulonglong(cloud->size()));
    QVERIFY(expected.count() > 100);
    QCOMPARE(differ, PointIndex(0));
}

// PCL counts cells from the zero of its coordinates, as thin does from that of the world's: it is given coordinates
// from a place that is a whole number of cells away. Cells of 0.7 m are no whole number of steps of any file; its
// floats may still take a point for one beyond a face.
void PclTest::cellsAreThoseOfPcl()
{
    QFETCH(QString, file);
    const auto cloud = load(file);
    if (!cloud) QSKIP(qPrintable(file + " is not there"));
    const double cell = file.startsWith("lone") ? 0.05 : 0.7;
    glm::dvec3 origin = cloud->world(0) / cell;
    for (int axis = 0; axis < 3; ++axis) origin[axis] = std::floor(origin[axis]) * cell;
    Points::Ptr points(new Points);
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const glm::dvec3 p = cloud->world(i) - origin;
        points->push_back({float(p.x), float(p.y), float(p.z)});
    }
    pcl::VoxelGrid<pcl::PointXYZ> filter;
    filter.setLeafSize(float(cell), float(cell), float(cell));
    filter.setInputCloud(points);
    filter.setSaveLeafLayout(true);
    Points theirs;
    const auto start = std::chrono::steady_clock::now();
    filter.filter(theirs);
    const double pclSeconds = secondsSince(start);
    const auto ourStart = std::chrono::steady_clock::now();
    const auto command = run(*cloud, "thin method=grid cell=" + std::to_string(cell));
    const double seconds = secondsSince(ourStart);
    QVERIFY(command != nullptr);
    const auto ours = double(cloud->size() - command->changedPoints()), other = double(theirs.size());
    qInfo("%.0f cells, PCL %.0f; %.1f M points/s, PCL %.1f", ours, other, double(cloud->size()) / seconds * 1e-6,
          double(cloud->size()) / pclSeconds * 1e-6);
    QVERIFY(std::abs(ours - other) <= 0.0005 * other);
    // One point in each of PCL's cells.
    std::vector<int> kept(theirs.size());
    std::size_t extra = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (!command->points()->contains(i)) {
            const int at = filter.getCentroidIndex((*points)[i]);
            extra += at < 0 || kept[std::size_t(at)]++ > 0;
        }
    QVERIFY(double(extra) <= 0.0005 * other);
}

void PclTest::radiusOutliersAreThoseOfPcl()
{
    QFETCH(QString, file);
    const auto cloud = load(file);
    if (!cloud) QSKIP(qPrintable(file + " is not there"));
    // No length between two points of a grid of millimeters or feet, so that floats do not decide.
    const std::string radius = file.startsWith("tls")    ? "0.0314159"
                               : file.startsWith("lone") ? "0.0514159"
                                                         : "1.5123457";
    pcl::RadiusOutlierRemoval<pcl::PointXYZ> filter;
    filter.setInputCloud(pointsOf(*cloud));
    filter.setRadiusSearch(std::stod(radius));
    filter.setMinNeighborsInRadius(4);
    filter.setNegative(true);
    pcl::Indices outliers;
    filter.filter(outliers);
    PointSet expected(cloud->size());
    for (const auto i : outliers) expected.insert(PointIndex(i));
    const Attribute classes = *cloud->findAttribute("Classification");
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (classes.number(i) == 7.0) expected.insert(i);
    const auto command = run(*cloud, "radius-outliers neighbors=4 class=7 radius=" + radius);
    if (command) command->apply(*cloud);
    PointIndex differ = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i) differ += (classes.number(i) == 7.0) != expected.contains(i);
    qInfo("%llu outliers of %llu points", qulonglong(expected.count()), qulonglong(cloud->size()));
    QVERIFY(expected.count() > 10 && expected.count() < cloud->size());
    QCOMPARE(differ, PointIndex(0));
}

void PclTest::clustersAreThoseOfPcl()
{
    QFETCH(QString, file);
    const auto cloud = load(file);
    if (!cloud) QSKIP(qPrintable(file + " is not there"));
    const std::string tolerance = file.startsWith("tls") ? "0.0314159" : "1.5123457";
    pcl::EuclideanClusterExtraction<pcl::PointXYZ> filter;
    const auto points = pointsOf(*cloud);
    const pcl::search::KdTree<pcl::PointXYZ>::Ptr tree(new pcl::search::KdTree<pcl::PointXYZ>);
    tree->setInputCloud(points);
    filter.setInputCloud(points);
    filter.setSearchMethod(tree);
    filter.setClusterTolerance(std::stod(tolerance));
    filter.setMinClusterSize(10);
    std::vector<pcl::PointIndices> expected;
    filter.extract(expected);
    run(*cloud, "clusters points=10 tolerance=" + tolerance)->apply(*cloud);
    const auto ids = cloud->findAttribute("ClusterId")->columns[0]->values<std::uint32_t>();
    std::vector<PointIndex> sizes(expected.size() + 1);
    PointIndex in = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        QVERIFY(ids[i] <= expected.size());
        ++sizes[ids[i]];
    }
    for (const auto& cluster : expected) {
        in += cluster.indices.size();
        const std::uint32_t id = ids[std::size_t(cluster.indices[0])];
        QVERIFY(id != 0);
        QCOMPARE(sizes[id], PointIndex(cluster.indices.size()));
        for (const auto i : cluster.indices) QCOMPARE(ids[std::size_t(i)], id);
    }
    QCOMPARE(sizes[0], cloud->size() - in);
    for (std::size_t k = 2; k < sizes.size(); ++k) QVERIFY(sizes[k] <= sizes[k - 1]);
    qInfo("%zu clusters", expected.size());
}

void PclTest::featuresAreThoseOfEigen()
{
    QFETCH(QString, file);
    const auto cloud = load(file);
    if (!cloud) QSKIP(qPrintable(file + " is not there"));
    run(*cloud, "features k=16")->apply(*cloud);
    run(*cloud, "normals k=16")->apply(*cloud);
    Progress progress;
    const KdOrder order(*cloud, progress);
    std::vector<KdOrder::Found> found;
    double worst = 0;
    for (PointIndex i = 0; i < cloud->size(); i += 37) {
        order.nearest(std::uint32_t(i), 16, found);
        Eigen::Matrix<double, 3, 16> offsets;
        for (int j = 0; j < 16; ++j)
            for (int a = 0; a < 3; ++a)
                offsets(a, j) = (double(order.raw(found[std::size_t(j)].point)[std::size_t(a)]) -
                                 double(order.raw(std::uint32_t(i))[std::size_t(a)])) *
                                order.scale()[std::size_t(a)];
        const Eigen::Vector3d mean = offsets.rowwise().mean();
        const Eigen::Matrix<double, 3, 16> centered = offsets.colwise() - mean;
        const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(centered * centered.transpose() / 16);
        const Eigen::Vector3d l = solver.eigenvalues().cwiseMax(0.0);
        if (l[2] <= 0) continue;
        const auto check = [&](const char* name, double expected, double room) {
            const double off = std::abs(cloud->findAttribute(name)->number(i) - expected);
            worst = std::max(worst, off / room);
        };
        check("Linearity", (l[2] - l[1]) / l[2], 1e-6);
        check("Planarity", (l[1] - l[0]) / l[2], 1e-6);
        check("Sphericity", l[0] / l[2], 1e-6);
        check("Anisotropy", (l[2] - l[0]) / l[2], 1e-6);
        check("Curvature", l[0] / l.sum(), 1e-6);
        check("Omnivariance", std::cbrt(l[0] * l[1] * l[2]) / l.sum(), 1e-4);
        check("Density", 16 / (M_PI * found[15].squared), 1e-5 * 16 / (M_PI * found[15].squared));
        if (l[1] - l[0] < 1e-4 * l[2]) continue;  // no normal is singled out
        const Eigen::Vector3d normal = solver.eigenvectors().col(0);
        check("Verticality", 1 - std::abs(normal[2]), 1e-5);
        check("Roughness", std::abs(normal.dot(mean)), 1e-5 * std::sqrt(l[2]));
    }
    QVERIFY2(worst < 1, qPrintable(QString::number(worst)));
}

void PclTest::normalsAreThoseOfPcl()
{
    QFETCH(QString, file);
    const auto cloud = load(file);
    if (!cloud) QSKIP(qPrintable(file + " is not there"));
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> filter;
    filter.setInputCloud(pointsOf(*cloud));
    filter.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    filter.setKSearch(16);
    filter.setViewPoint(0, 0, 1e9f);
    pcl::PointCloud<pcl::Normal> expected;
    filter.compute(expected);
    run(*cloud, "normals k=16")->apply(*cloud);
    const Attribute* normal = cloud->findAttribute("Normal");
    PointIndex differ = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const auto& e = expected[i];
        const double cosine = normal->number(i, 0) * double(e.normal_x) +
                              normal->number(i, 1) * double(e.normal_y) + normal->number(i, 2) * double(e.normal_z);
        differ += !(std::abs(cosine) > kOneDegree);
    }
    // Files hold coordinates in steps of centimetres, so that several points tie for the 16th place and either may
    // be taken; PCL's choice changes with the order of its tree, too. Planes of such points differ.
    qInfo("%llu of %llu normals differ", qulonglong(differ), qulonglong(cloud->size()));
    QVERIFY(double(differ) < 0.01 * double(cloud->size()));
}

void PclTest::normalsOfTheSample()
{
    // Millimetres and noise: hardly any ties. And the speed, side by side.
    Progress progress;
    const auto cloud = makeSample(300'000, 1, progress);
    auto start = std::chrono::steady_clock::now();
    const auto command = run(*cloud, "normals k=16");
    const double ours = secondsSince(start);
    command->apply(*cloud);
    start = std::chrono::steady_clock::now();
    pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> filter;
    filter.setInputCloud(pointsOf(*cloud));
    filter.setSearchMethod(pcl::search::KdTree<pcl::PointXYZ>::Ptr(new pcl::search::KdTree<pcl::PointXYZ>));
    filter.setKSearch(16);
    filter.setViewPoint(0, 0, 1e9f);
    pcl::PointCloud<pcl::Normal> expected;
    filter.compute(expected);
    qInfo("normals k=16: %.2f M points/s; pcl::NormalEstimation on one thread %.2f", 0.3 / ours,
          0.3 / secondsSince(start));
    const Attribute* normal = cloud->findAttribute("Normal");
    PointIndex differ = 0;
    for (PointIndex i = 0; i < cloud->size(); ++i) {
        const auto& e = expected[i];
        const double cosine = normal->number(i, 0) * double(e.normal_x) +
                              normal->number(i, 1) * double(e.normal_y) + normal->number(i, 2) * double(e.normal_z);
        differ += !(std::abs(cosine) > 0.999);
    }
    QVERIFY2(differ < 100, qPrintable(QString::number(differ)));
}

QTEST_APPLESS_MAIN(PclTest)
#include "PclTest.moc"
