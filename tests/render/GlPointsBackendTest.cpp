// SPDX-License-Identifier: MIT
#include "render/raster/gl_points/GlPointsBackend.h"
#include "tests/render/GlBackendChecks.h"
#include "tests/render/GlPictures.h"

#include <QTest>

#include <epoxy/gl.h>

using namespace punctum;
using namespace punctum::test;

/// gl-points. Of two equally deep points the one drawn first stays, and reprojected points are drawn first.
class GlPointsBackendTest : public GlBackendChecks
{
    Q_OBJECT

public:
    GlPointsBackendTest() : GlBackendChecks(makeGlPointsBackend, {0.01, 0.001}, {1, 4}) {}

private Q_SLOTS:
    void outOfSightIsNotRead();
};

// The device counts what it is given: of a view from near a part, as the stretches in sight have it.
void GlPointsBackendTest::outOfSightIsNotRead()
{
    if (!epoxy_has_gl_extension("GL_ARB_pipeline_statistics_query")) QSKIP("This driver does not count vertices.");
    const auto cloud = makeCloud(400'000);
    const auto store = filledStore(cloud);
    GLuint query = 0;
    glGenQueries(1, &query);
    const auto verticesOf = [&](const std::function<void()>& draw) {
        glBeginQuery(GL_VERTICES_SUBMITTED_ARB, query);
        draw();
        glEndQuery(GL_VERTICES_SUBMITTED_ARB);
        GLuint64 count = 0;
        glGetQueryObjectui64v(query, GL_QUERY_RESULT, &count);
        return PointIndex(count);
    };
    Camera camera = cameraFor(*cloud);
    View whole(gl(), {store}, camera, {});
    QCOMPARE(verticesOf([&] { whole.converge(); }), PointIndex(store->slotCount()));
    camera.setView("top");
    camera.fit({{90, 90, -20}, {110, 110, 40}}, {kWidth, kHeight});
    for (const PointIndex points : {0, 50'000}) {  // the device decides how many; or they are said
        View near(gl(), {store}, camera, {});
        near.renderer.setPointsAFrame(points);
        const PointIndex read = verticesOf([&] { near.converge(); });
        QVERIFY2(read < cloud->size() / 2, qPrintable(QString::number(read)));
        QVERIFY2(read >= near.renderer.pointsInSight(), qPrintable(QString::number(read)));
    }
    glDeleteQueries(1, &query);
}

QTEST_APPLESS_MAIN(GlPointsBackendTest)
#include "GlPointsBackendTest.moc"
