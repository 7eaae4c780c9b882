// SPDX-License-Identifier: MIT
#include "app/commands/BenchPcl.h"

#include <pcl/features/normal_3d_omp.h>
#include <pcl/filters/radius_outlier_removal.h>
#include <pcl/filters/statistical_outlier_removal.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/extract_clusters.h>
#include <pcl/segmentation/region_growing.h>

#include <functional>
#include <numbers>
#include <thread>
#include <utility>

namespace punctum::app
{

namespace
{

using PclCloud = pcl::PointCloud<pcl::PointXYZ>;
using PclTree = pcl::search::KdTree<pcl::PointXYZ>;

class PclWork final : public PclPeer
{
public:
    explicit PclWork(std::function<void()> work) : m_work(std::move(work)) {}
    void run() override { m_work(); }

private:
    std::function<void()> m_work;
};

std::function<void()> workOf(const std::string& step, const PclPeer::Values& values, const PclCloud::Ptr& cloud)
{
    const auto number = [values](const char* key) {
        const auto it = values.find(key);
        return it == values.end() ? 0.0 : std::stod(it->second);
    };
    if (step == "normals")
        return [=] {
            pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> normals(std::thread::hardware_concurrency());
            normals.setInputCloud(cloud);
            normals.setSearchMethod(std::make_shared<PclTree>());
            if (number("radius") > 0)
                normals.setRadiusSearch(number("radius"));
            else
                normals.setKSearch(int(number("k")));
            pcl::PointCloud<pcl::Normal> found;
            normals.compute(found);
        };
    if (step == "outliers")
        return [=] {
            pcl::StatisticalOutlierRemoval<pcl::PointXYZ> outliers;
            outliers.setInputCloud(cloud);
            outliers.setMeanK(int(number("k")));
            outliers.setStddevMulThresh(number("deviations"));
            pcl::Indices found;
            outliers.filter(found);
        };
    if (step == "radius-outliers")
        return [=] {
            pcl::RadiusOutlierRemoval<pcl::PointXYZ> outliers;
            outliers.setInputCloud(cloud);
            outliers.setRadiusSearch(number("radius"));
            outliers.setMinNeighborsInRadius(int(number("neighbors")));
            pcl::Indices found;
            outliers.filter(found);
        };
    if (step == "clusters")
        return [=] {
            const auto tree = std::make_shared<PclTree>();
            tree->setInputCloud(cloud);
            pcl::EuclideanClusterExtraction<pcl::PointXYZ> clusters;
            clusters.setInputCloud(cloud);
            clusters.setSearchMethod(tree);
            clusters.setClusterTolerance(number("tolerance"));
            clusters.setMinClusterSize(int(number("points")));
            std::vector<pcl::PointIndices> found;
            clusters.extract(found);
        };
    if (step == "planes")
        return [=] {
            const auto tree = std::make_shared<PclTree>();
            pcl::NormalEstimationOMP<pcl::PointXYZ, pcl::Normal> estimation(std::thread::hardware_concurrency());
            estimation.setInputCloud(cloud);
            estimation.setSearchMethod(tree);
            estimation.setKSearch(int(number("neighbors")));
            const auto normals = std::make_shared<pcl::PointCloud<pcl::Normal>>();
            estimation.compute(*normals);
            pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
            growing.setInputCloud(cloud);
            growing.setInputNormals(normals);
            growing.setSearchMethod(tree);
            growing.setNumberOfNeighbours(unsigned(number("neighbors")));
            growing.setSmoothnessThreshold(float(number("angle") * std::numbers::pi / 180));
            growing.setCurvatureThreshold(0.06F);  // what planes leaves out as not flat
            growing.setMinClusterSize(int(number("points")));
            std::vector<pcl::PointIndices> found;
            growing.extract(found);
        };
    return {};
}

}  // namespace

std::unique_ptr<PclPeer> PclPeer::make(const std::string& step, const Values& values, const Points& points)
{
    const PclCloud::Ptr cloud(new PclCloud);
    std::function<void()> work = workOf(step, values, cloud);
    if (!work) return nullptr;
    cloud->reserve(points.size());
    for (const auto& p : points) cloud->push_back({p[0], p[1], p[2]});
    return std::make_unique<PclWork>(std::move(work));
}

}  // namespace punctum::app
