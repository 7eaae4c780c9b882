// SPDX-License-Identifier: MIT
// Leave-one-out over the samples of the ISPRS filter test: for each sample the parameters of the ground are fitted
// to the seven others alone, from values that know none of them, and judged on the one that was left out. No test,
// since it takes minutes: docs/dev/ground.md says how to run it and what it said.
#include "core/ground/GroundSurface.h"
#include "core/las/Reader.h"
#include "core/task/Progress.h"
#include "tests/core/GroundScore.h"

#include <cstdio>
#include <filesystem>
#include <map>

using namespace punctum;

namespace
{

struct Sample {
    std::string name;
    std::shared_ptr<PointCloud> cloud;
    std::vector<std::uint8_t> truth;
};

/// What is fitted, with values to begin from: those that the paper has (SMRF), else round numbers.
struct Fitted {
    const char* name;
    float BareSurfaceSettings::*value;
    float first;
};
constexpr Fitted kFitted[] = {{"slope", &BareSurfaceSettings::slope, 0.15f},
                              {"window", &BareSurfaceSettings::window, 18},
                              {"threshold", &BareSurfaceSettings::threshold, 0.5f},
                              {"steepness", &BareSurfaceSettings::steepness, 1.25f},
                              {"trendReach", &BareSurfaceSettings::trendReach, 10},
                              {"trendShare", &BareSurfaceSettings::trendShare, 0.7f},
                              {"trendSlope", &BareSurfaceSettings::trendSlope, 0.5f},
                              {"edgeShare", &BareSurfaceSettings::edgeShare, 0.3f},
                              {"bumpHeight", &BareSurfaceSettings::bumpHeight, 0.1f},
                              {"bumpRoughness", &BareSurfaceSettings::bumpRoughness, 3}};
using Values = std::array<float, std::size(kFitted)>;

GroundScore judged(const Sample& sample, const Values& values)
{
    BareSurfaceSettings settings;
    for (std::size_t k = 0; k < values.size(); ++k) settings.*kFitted[k].value = values[k];
    Progress progress;
    const PointIndex size = sample.cloud->size();
    const LowestPoints lowest(*sample.cloud, PointSet::all(size), trueLengths(*sample.cloud), double(settings.cell),
                              progress);
    const GroundSurface surface(lowest, settings, progress);
    GroundSurface::Asker asker(surface);
    std::vector<char> ground(size);
    for (PointIndex i = 0; i < size; ++i) ground[i] = char(asker.isGround(i));
    return groundScore(sample.truth, ground, std::vector<char>(size, 1));
}

class Folds
{
public:
    explicit Folds(std::vector<Sample> samples) : m_samples(std::move(samples)) {}

    /// Descends along one parameter after the other, by larger and then by smaller steps.
    Values fittedWithout(std::size_t left)
    {
        Values best{};
        for (std::size_t k = 0; k < best.size(); ++k) best[k] = kFitted[k].first;
        double least = cost(best, left);
        for (const float step : {1.4f, 1.4f, 1.2f, 1.1f})
            for (std::size_t k = 0; k < best.size(); ++k)
                for (const float factor : {step, 1 / step}) {
                    Values tried = best;
                    tried[k] *= factor;
                    const double now = cost(tried, left);
                    if (now > least - 0.005) continue;
                    least = now;
                    best = tried;
                    break;
                }
        return best;
    }
    const std::vector<GroundScore>& scores(const Values& values)
    {
        std::vector<GroundScore>& known = m_scores[values];
        for (std::size_t k = known.size(); k < m_samples.size(); ++k) known.push_back(judged(m_samples[k], values));
        return known;
    }

private:
    /// Of the other samples: both aims, of which 10 % of kappa weigh as much as 1 % of points.
    double cost(const Values& values, std::size_t left)
    {
        double sum = 0;
        const std::vector<GroundScore>& all = scores(values);
        for (std::size_t k = 0; k < all.size(); ++k)
            if (k != left) sum += all[k].total - 0.1 * all[k].kappa;
        return sum / double(all.size() - 1);
    }

    std::vector<Sample> m_samples;
    std::map<Values, std::vector<GroundScore>> m_scores;
};

int run(const std::filesystem::path& folder)
{
    std::vector<Sample> samples;
    for (const char* name : {"11", "21", "22", "31", "42", "51", "53", "61"}) {
        Progress progress;
        Sample sample{name, las::load(folder / ("samp" + std::string(name) + ".laz"), progress), {}};
        sample.truth.resize(sample.cloud->size());
        sample.cloud->findAttribute("Classification")->gatherBits({0, sample.cloud->size()}, sample.truth.data());
        samples.push_back(std::move(sample));
    }
    const std::vector<Sample> names = samples;
    Folds folds(std::move(samples));
    GroundScore mean;
    for (std::size_t left = 0; left < names.size(); ++left) {
        const Values values = folds.fittedWithout(left);
        const GroundScore s = folds.scores(values)[left];
        std::printf("%s left out: total %.2f  type I %.2f  type II %.2f  kappa %.1f  with",
                    names[left].name.c_str(), s.total, s.lost, s.taken, s.kappa);
        for (std::size_t k = 0; k < values.size(); ++k) std::printf(" %s=%.3g", kFitted[k].name, double(values[k]));
        std::printf("\n");
        std::fflush(stdout);
        mean.total += s.total / double(names.size());
        mean.lost += s.lost / double(names.size());
        mean.taken += s.taken / double(names.size());
        mean.kappa += s.kappa / double(names.size());
    }
    std::printf("mean: total %.2f  type I %.2f  type II %.2f  kappa %.1f\n", mean.total, mean.lost, mean.taken,
                mean.kappa);
    return 0;
}

}  // namespace

/// GroundFolds [FOLDER]: the folder that holds samp11.laz and the others.
int main(int count, char** arguments)
{
    try {
        return run(count > 1 ? std::filesystem::path(arguments[1])
                             : std::filesystem::path(PUNCTUM_TEST_DATA) / "isprs");
    } catch (const std::exception& error) {
        std::fprintf(stderr, "%s\n", error.what());
        return 1;
    }
}
