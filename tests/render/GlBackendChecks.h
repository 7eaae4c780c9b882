// SPDX-License-Identifier: MIT
#pragma once

#include "core/cloud/PointCloud.h"
#include "render/gl/EglContext.h"
#include "render/raster/gl/GlBackend.h"

#include <QObject>
#include <QString>

#include <functional>
#include <map>
#include <memory>
#include <vector>

namespace punctum::test
{

/// What every backend that draws with OpenGL must do; each has a test class derived from this one.
class GlBackendChecks : public QObject
{
    Q_OBJECT

protected:
    using Make = std::function<std::unique_ptr<render::RasterBackend>(const render::GlLimits&)>;
    /// Shares of the covered pixels that may differ.
    struct Tolerance {
        double cpu = 0;        ///< from the CPU backend's picture
        double converged = 0;  ///< between converged and brute force
    };
    GlBackendChecks(Make make, Tolerance tolerance, std::vector<int> samples)
        : m_make(std::move(make)), m_tolerance(tolerance), m_samples(std::move(samples))
    {
    }
    std::unique_ptr<render::RasterBackend> gl(const render::GlLimits& limits = {}) const { return m_make(limits); }
    bool hasContext() const noexcept { return bool(m_egl); }

private slots:
    void initTestCase();
    void agreesWithTheCpuBackend_data();
    void agreesWithTheCpuBackend();
    void stylesAgreeWithTheCpuBackend_data();
    void stylesAgreeWithTheCpuBackend();
    void averagesFollowColors();
    void averagesFollowChanges();
    void lightAndHolesAreThoseOfTheCpuBackend_data();
    void lightAndHolesAreThoseOfTheCpuBackend();
    void picturesStayOnTheDevice_data();
    void picturesStayOnTheDevice();
    void surfaceIsThatOfTheCpuBackend_data();
    void surfaceIsThatOfTheCpuBackend();
    void edgesOfThePictureAreComplete();
    void depthsKeepTheirDigits();
    void convergedEqualsBruteForce_data();
    void convergedEqualsBruteForce();
    void outOfSightMakesNoDifference();
    void deviceKeepsTheBudget();
    void movingKeepsThePicture();
    void chunksMakeNoDifference();
    void severalCloudsComeAndGo();
    void hiddenClassesVanishAndComeBack();
    void attributeSwitchShowsAtOnce();
    void wordsOfAllPointsFollow();
    void editsShowInTheNextFrame();
    void colorsAreThoseOfTheCpuBackend();
    void convergesWhileLoading();
    void colorsAreRightWhileLoading();
    void loadingSendsEachPointOnce_data();
    void loadingSendsEachPointOnce();
    void rebuiltStoresAreSeen();
    void pointsOfAListAreSeen();
    void otherStoresAtTheSameAddressAreSeen();
    void picksWhatIsOnScreen();
    void listsEachVisiblePoint();
    void impossibleSizesAreErrors();

private:
    std::shared_ptr<PointCloud> cloudNamed(const QString& name);

    Make m_make;
    Tolerance m_tolerance;
    std::vector<int> m_samples;
    render::EglContext m_egl;
    std::map<QString, std::shared_ptr<PointCloud>> m_clouds;
};

}  // namespace punctum::test
