// SPDX-License-Identifier: MIT
#include "render/raster/gl_points/GlPointsBackend.h"
#include "tests/render/GlBackendChecks.h"

#include <QTest>

/// gl-points. Of two equally deep points the one drawn first stays, and reprojected points are drawn first.
class GlPointsBackendTest : public punctum::test::GlBackendChecks
{
    Q_OBJECT

public:
    GlPointsBackendTest() : GlBackendChecks(punctum::render::makeGlPointsBackend, {0.01, 0.001}, {1, 4}) {}
};

QTEST_APPLESS_MAIN(GlPointsBackendTest)
#include "GlPointsBackendTest.moc"
