// SPDX-License-Identifier: MIT
#include "render/backends/BackendChoice.h"

#include <QTest>

#include <algorithm>

using namespace punctum::render;

/// Which backend is the fastest is found by measuring.
class BackendChoiceTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void namesAreOneToOne();
    void measuresWhatIsThere();
};

void BackendChoiceTest::namesAreOneToOne()
{
    for (const BackendKind kind : kBackendKinds) QVERIFY(backendFromName(nameOf(kind)) == kind);
    QVERIFY(!backendFromName("auto"));
    QVERIFY(!backendFromName(""));
}

void BackendChoiceTest::measuresWhatIsThere()
{
    MeasuredLook look;
    look.display.fillHoles = true;
    look.display.eyeDome = 1;
    look.display.samples = 4;
    const BackendMeasurement m = measureBackends(look);
    const auto rateOf = [&](BackendKind kind) {
        for (const auto& rate : m.rates)
            if (rate.kind == kind) return rate.pointsPerSecond;
        return 0.0;
    };
    qInfo("%s", m.device.empty() ? "no OpenGL" : m.device.c_str());
    for (const auto& rate : m.rates)
        qInfo("%s: %.1f million points/s", std::string(nameOf(rate.kind)).c_str(), rate.pointsPerSecond * 1e-6);
    QVERIFY(rateOf(BackendKind::Cpu) > 0);
    QVERIFY(rateOf(m.fastest) >= rateOf(BackendKind::Cpu));
    if (m.device.empty()) {
        QCOMPARE(m.rates.size(), std::size_t(1));
        QCOMPARE(m.fastest, BackendKind::Cpu);
    } else {
        QVERIFY(rateOf(BackendKind::GlCompute) > 0);
        QVERIFY(rateOf(BackendKind::GlPoints) > 0);
        // A software renderer is no graphics card.
        if (m.device.find("llvmpipe") != std::string::npos) QCOMPARE(m.fastest, BackendKind::Cpu);
    }
    // The same device again: nothing is drawn.
    const BackendMeasurement again = measureBackends(look, m.device);
    QCOMPARE(again.device, m.device);
    QVERIFY(again.rates.empty());
}

QTEST_APPLESS_MAIN(BackendChoiceTest)
#include "BackendChoiceTest.moc"
