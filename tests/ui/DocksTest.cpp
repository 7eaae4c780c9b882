// SPDX-License-Identifier: MIT
// The docks' models, held to the rules of Qt's models while documents come and go.
#include "UiTest.h"

#include "ui/Text.h"
#include "ui/ViewSettings.h"
#include "ui/Workspace.h"
#include "ui/docks/AttributesDock.h"
#include "ui/docks/AttributesModel.h"
#include "ui/docks/ClassesDock.h"
#include "ui/docks/ClassesModel.h"
#include "ui/docks/JobsDock.h"
#include "ui/docks/JobsModel.h"
#include "ui/docks/PropertiesDock.h"

#include "core/Error.h"
#include "core/task/Progress.h"

#include <QAbstractItemModelTester>
#include <QMimeData>
#include <QSet>

#include <atomic>
#include <thread>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

class DocksTest : public QObject
{
    Q_OBJECT
private slots:
    void modelsKeepTheRules()
    {
        const QString file = dataFile(QStringLiteral("simple.laz"));
        if (file.isEmpty()) QSKIP("simple.laz is not here.");
        TestWindow test;
        MainWindow& window = *test.window;
        const auto mode = QAbstractItemModelTester::FailureReportingMode::QtTest;
        const QAbstractItemModelTester attributes(&window.attributesDock().model(), mode);
        const QAbstractItemModelTester classes(&window.classesDock().model(), mode);
        const QAbstractItemModelTester jobs(&window.jobsDock().model(), mode);
        Document* document = test.open(file);
        QVERIFY(document);
        QVERIFY(waitFor(
            [&] { return document->classCounts().has_value() && document->figures(QStringLiteral("Blue")); }));

        AttributesModel& list = window.attributesDock().model();
        QCOMPARE(list.rowCount(), int(document->attributes().size()));
        const QModelIndex intensity = list.indexOf(QStringLiteral("Intensity"));
        QVERIFY(intensity.data(AttributesModel::DetailRole).toString().startsWith(QStringLiteral("uint16  ·  ")));
        const std::unique_ptr<QMimeData> mime(list.mimeData({intensity}));
        QCOMPARE(mime->data(QStringLiteral("application/x-punctum-attribute")), QByteArray("Intensity"));
        // Once round the list and back.
        QSet<QString> seen;
        for (int i = 0; i < list.rowCount(); ++i) {
            list.setShown(list.neighbor(1));
            seen.insert(list.shown());
        }
        QCOMPARE(seen.size(), list.rowCount());

        quint64 sum = 0;
        const ClassesModel& counted = window.classesDock().model();
        for (int row = 0; row < counted.rowCount(); ++row)
            sum += counted.index(row, 0).data(ClassesModel::CountRole).toULongLong();
        QCOMPARE(sum, quint64(document->points()));

        const QString properties = window.propertiesDock().text();
        for (const char* text : {"simple.laz", "1,065", "1.2", "34 bytes", "yes, LAZ"})
            QVERIFY2(properties.contains(QLatin1String(text)), text);

        window.workspace().close(*document);
        QCOMPARE(list.rowCount(), 0);
        QCOMPARE(counted.rowCount(), 0);
    }

    void jobsComeAndGo()
    {
        TestWindow test;
        Workspace& workspace = test.window->workspace();
        JobsModel& jobs = test.window->jobsDock().model();
        const auto mode = QAbstractItemModelTester::FailureReportingMode::QtTest;
        const QAbstractItemModelTester tester(&jobs, mode);

        const JobId endless = workspace.startJob(QStringLiteral("Wait"), [](Progress& progress) {
            progress.begin("Waiting", 4);
            progress.add(1);
            for (;;) {
                progress.check();
                std::this_thread::sleep_for(std::chrono::milliseconds(5));
            }
        });
        QCOMPARE(jobs.rowCount(), 1);
        QVERIFY(waitFor(
            [&] { return jobs.index(0).data(JobsModel::StageRole).toString() == QLatin1String("Waiting"); }));
        QCOMPARE(jobs.index(0).data(JobsModel::FractionRole).toDouble(), 0.25);
        jobs.closeOrCancel(endless);
        QVERIFY(waitFor(
            [&] { return jobs.index(0).data(JobsModel::StateRole).toInt() == int(JobState::Cancelled); }, 1000));
        QVERIFY(waitFor([&] { return jobs.rowCount() == 0; }, 10000));

        // What failed stays until it is closed.
        const JobId failing =
            workspace.startJob(QStringLiteral("Fail"), [](Progress&) { throw Error("It broke."); });
        QVERIFY(waitFor(
            [&] { return jobs.index(0).data(JobsModel::ErrorRole).toString() == QLatin1String("It broke."); }));
        QTest::qWait(3000);
        QCOMPARE(jobs.rowCount(), 1);
        jobs.closeOrCancel(failing);
        QCOMPARE(jobs.rowCount(), 0);

        // A quiet job that is soon done is never listed.
        std::atomic<bool> done = false;
        workspace.startJob(
            QStringLiteral("Quiet"), [&](Progress&) { done = true; }, {}, true);
        QVERIFY(waitFor([&] { return done.load() && !workspace.busy(); }));
        QTest::qWait(200);
        QCOMPARE(jobs.rowCount(), 0);
    }

    void settingsAreKept()
    {
        const QTemporaryDir folder;
        WindowOptions options;
        options.settingsFile = folder.filePath(QStringLiteral("kept.ini"));
        {
            MainWindow window(options);
            window.show();
            window.viewSettings().setPointSize(3.5);
            window.viewSettings().setSamples(4);
            window.viewSettings().setColorMap(QStringLiteral("turbo"));
            QVERIFY(window.close());
        }
        MainWindow again(options);
        const render::DisplaySettings& display = again.viewSettings().display();
        QCOMPARE(display.pointSize, 3.5);
        QCOMPARE(display.samples, 4);
        QCOMPARE(display.colorMap, std::string("turbo"));
    }

    void windowClosedWhileJobsRun()
    {
        // Owner destroyed in mid-job: no result may arrive, no thread may stay.
        for (int round = 0; round < 3; ++round) {
            TestWindow test;
            test.window->workspace().startJob(QStringLiteral("Wait"), [](Progress& progress) {
                for (;;) {
                    progress.check();
                    std::this_thread::sleep_for(std::chrono::milliseconds(2));
                }
            });
            const QString file = dataFile(QStringLiteral("autzen_trim.laz"));
            if (!file.isEmpty()) test.window->openFiles({file});
            QTest::qWait(15 * round);
        }
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<DocksTest>(); });
}
#include "DocksTest.moc"
