// SPDX-License-Identifier: MIT
#include "render/raster/gl_compute/GlComputeBackend.h"
#include "tests/render/GlBackendChecks.h"

#include <QTest>

/// gl-compute. Nearest depth and least id win, as on the CPU: a converged picture is the brute-force picture. As
/// graphics cards draw, reading several points at once; PrecisionTest draws as the device would have it.
class GlComputeBackendTest : public punctum::test::GlBackendChecks
{
    Q_OBJECT

public:
    GlComputeBackendTest()
        : GlBackendChecks(
              [](const auto& limits) {
                  return punctum::render::makeGlComputeBackend({.limits = limits, .allLoads = true});
              },
              {0.001, 0.0}, {1, 4, 8, 16})
    {
    }
};

QTEST_APPLESS_MAIN(GlComputeBackendTest)
#include "GlComputeBackendTest.moc"
