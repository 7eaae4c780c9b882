// SPDX-License-Identifier: MIT
// The docks' models, held to the rules of Qt's models while documents come and go.
#include "UiTest.h"

#include "ui/basic/Text.h"
#include "ui/docks/AttributesDock.h"
#include "ui/docks/AttributesModel.h"
#include "ui/docks/ClassesDock.h"
#include "ui/docks/ClassesModel.h"
#include "ui/docks/JobsDock.h"
#include "ui/docks/JobsModel.h"
#include "ui/docks/PropertiesDock.h"
#include "ui/document/Workspace.h"
#include "ui/process/ProcessingDock.h"
#include "ui/style/NumberField.h"
#include "ui/view/MessageArea.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"

#include "core/Error.h"
#include "core/task/Progress.h"

#include <QAbstractItemModelTester>
#include <QMenu>
#include <QMimeData>
#include <QPushButton>
#include <QScopeGuard>
#include <QSet>
#include <QSignalSpy>
#include <QWindow>

#include <atomic>
#include <filesystem>
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
        TestWindow test;
        const QString file = test.folder.filePath(QStringLiteral("simple.laz"));
        writeSurvey(file, 1065);
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

        jobs.setStay(1, 1'000'000);
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
        bool cancelled = false;
        connect(&jobs, &QAbstractItemModel::dataChanged, this, [&] {
            cancelled = cancelled || jobs.index(0).data(JobsModel::StateRole).toInt() == int(JobState::Cancelled);
        });
        QVERIFY(waitFor([&] { return jobs.rowCount() == 0; }, 10000) && cancelled);

        // What failed stands below what runs, for a while; why is said once, over the view.
        const JobId failing =
            workspace.startJob(QStringLiteral("Fail"), [](Progress&) { throw Error("It broke."); });
        QVERIFY(waitFor(
            [&] { return jobs.index(0).data(JobsModel::ErrorRole).toString() == QLatin1String("It broke."); }));
        QCOMPARE(jobs.index(0).data(JobsModel::StageRole).toString(), QStringLiteral("Failed"));
        QCOMPARE(test.window->viewport().messages().sentences(), QStringList{QStringLiteral("It broke.")});
        std::atomic<bool> go = false;
        workspace.startJob(QStringLiteral("Next"), [&](Progress&) {
            while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(2));
        });
        QCOMPARE(jobs.rowCount(), 2);
        QCOMPARE(jobs.index(0).data().toString(), QStringLiteral("Next"));
        QCOMPARE(jobs.index(1).data().toString(), QStringLiteral("Fail"));
        jobs.closeOrCancel(failing);
        QCOMPARE(jobs.rowCount(), 1);
        jobs.setStay(1, 1);
        workspace.startJob(QStringLiteral("Fail again"), [](Progress&) { throw Error("It broke again."); });
        QVERIFY(waitFor([&] { return jobs.rowCount() == 2; }) && waitFor([&] { return jobs.rowCount() == 1; }));
        go = true;
        QVERIFY(waitFor([&] { return jobs.rowCount() == 0; }, 10000));

        // A quiet job that is soon done is never listed, one that takes long is.
        QSignalSpy listed(&jobs, &QAbstractItemModel::rowsInserted);
        std::atomic<bool> done = false;
        workspace.startJob(
            QStringLiteral("Quiet"), [&](Progress&) { done = true; }, {}, true);
        QVERIFY(waitFor([&] { return done.load() && !workspace.busy(); }));
        QCOMPARE(listed.size(), 0);
        go = false;
        workspace.startJob(
            QStringLiteral("Quiet and long"),
            [&](Progress&) {
                while (!go) std::this_thread::sleep_for(std::chrono::milliseconds(2));
            },
            {}, true);
        QVERIFY(waitFor([&] { return listed.size() == 1; }));
        go = true;
        QVERIFY(waitFor([&] { return jobs.rowCount() == 0; }));
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

    /// Owner destroyed in mid-job: no result arrives, no thread stays.
    void windowClosedWhileJobsRun()
    {
        for (int round = 0; round < 3; ++round) {
            std::atomic<bool> running = false, stopped = false;
            bool ended = false;
            {
                TestWindow test;
                test.window->workspace().startJob(
                    QStringLiteral("Wait"),
                    [&](Progress& progress) {
                        running = true;
                        try {
                            for (;;) {
                                progress.check();
                                std::this_thread::sleep_for(std::chrono::milliseconds(2));
                            }
                        } catch (...) {
                            stopped = true;
                            throw;
                        }
                    },
                    [&](const JobInfo&) { ended = true; });
                QVERIFY(waitFor([&] { return running.load(); }));
                if (round != 0) test.window->openFiles({surveyFile()});
                if (round == 2) QVERIFY(waitFor([&] { return !test.window->workspace().documents().empty(); }));
            }
            QVERIFY(stopped);  // the window has waited for it
            QCoreApplication::processEvents();
            QVERIFY(!ended);
        }
    }

    /// What is typed is read by the user's language, or refused where it stands; nothing runs then.
    void numbersAreTheUsers()
    {
        const QLocale before;
        QLocale::setDefault(QLocale(QLocale::German, QLocale::Germany));
        const auto back = qScopeGuard([&] { QLocale::setDefault(before); });
        TestWindow test;
        Document* const document = test.open(surveyFile());
        QVERIFY(document);
        ProcessingDock& dock = test.window->processingDock();
        dock.chooseStep(QStringLiteral("reclassify"));
        QVERIFY(dock.setValue(QStringLiteral("attribute"), QStringLiteral("Z")));
        QVERIFY(dock.setValue(QStringLiteral("class"), QStringLiteral("9")));
        const auto fields = dock.findChildren<NumberField*>();
        QVERIFY(fields.size() >= 2);
        const auto type = [](NumberField* field, const QString& text) {
            field->setFocus();
            field->selectAll();
            QTest::keyClicks(field, text);
        };
        type(fields[0], QStringLiteral("412.5"));  // no group of three, and no decimal sign here
        type(fields[1], QStringLiteral("1.000,5"));
        dock.run();
        QVERIFY(!dock.running());
        QVERIFY2(dock.resultText().contains(QStringLiteral("1.234,5")), qPrintable(dock.resultText()));
        QCOMPARE(fields[0]->property("wrong").toBool(), true);
        QCOMPARE(fields[1]->property("wrong").toBool(), false);
        type(fields[0], QStringLiteral("412,5"));
        QCOMPARE(fields[0]->property("wrong").toBool(), false);  // as soon as it is well again
        dock.run();
        QVERIFY(dock.running());
        QVERIFY(waitFor([&] { return !dock.running(); }));
        PointIndex expected = 0;
        const Attribute& z = *document->findAttribute(QStringLiteral("Z"));
        for (PointIndex i = 0; i < document->points(); ++i)
            expected += z.number(i) >= 412.5 && z.number(i) <= 1000.5;
        QCOMPARE(dock.resultText(), QStringLiteral("Reclassify: %1 changed.").arg(pointsText(expected)));
        QVERIFY(pointsText(expected).contains(QLatin1Char('.')) && expected > 1000);

        // only what can be renamed is offered: nothing here
        dock.chooseStep(QStringLiteral("rename"));
        QVERIFY(!dock.setValue(QStringLiteral("attribute"), QStringLiteral("Z")));

        // the range of colors, and spin boxes
        test.window->showAttribute(QStringLiteral("Z"));
        QVERIFY(test.settle(QStringLiteral("Z")));
        const auto range = test.window->attributesDock().findChildren<NumberField*>();
        QCOMPARE(range.size(), 2);
        // the picture is there a little before the panel has heard of it; no field takes keys until then
        QVERIFY(waitFor([&] { return range[0]->isEnabled() && range[0]->number() && range[1]->number(); }));
        type(range[0], QStringLiteral("410.5"));
        QTest::keyClick(range[0], Qt::Key_Return);
        QVERIFY(range[0]->property("wrong").toBool() && !test.window->viewSettings().display().range);
        type(range[0], QStringLiteral("410,5"));
        QTest::keyClick(range[0], Qt::Key_Return);
        QVERIFY(test.window->viewSettings().display().range);
        QCOMPARE(test.window->viewSettings().display().range->first, 410.5);
        // Auto takes back what is wrong as well as what was chosen
        type(range[1], QStringLiteral("x"));
        QTest::keyClick(range[1], Qt::Key_Return);
        QVERIFY(range[1]->property("wrong").toBool());
        for (QPushButton* button : test.window->attributesDock().findChildren<QPushButton*>())
            if (button->text() == QStringLiteral("Auto")) button->click();
        QVERIFY(!range[1]->property("wrong").toBool() && !test.window->viewSettings().display().range);
        QVERIFY(test.settle());
        QVERIFY(range[1]->number() && *range[1]->number() > 410);

        NumberSpin spin;
        spin.setRange(0.0, 5000.0);
        spin.setDecimals(2);
        spin.setValue(1.0);
        const auto spun = [&](const QString& text) {
            spin.selectAll();
            QTest::keyClicks(&spin, text);
            QTest::keyClick(&spin, Qt::Key_Return);
            return spin.value();
        };
        QCOMPARE(spun(QStringLiteral("42,5")), 42.5);
        QCOMPARE(spun(QStringLiteral("42.5")), 42.5);  // refused: as it was
        QCOMPARE(spun(QStringLiteral("7.5")), 42.5);
        QCOMPARE(spun(QStringLiteral("1.234,5")), 1234.5);
        QCOMPARE(spin.text(), QStringLiteral("1.234,50"));
    }

    /// Names may have signs that menus and titles take for theirs.
    void namesAreShownAsTheyAre()
    {
        TestWindow test;
        const QString file = test.folder.filePath(QStringLiteral("a&b[*].las"));
        writeSurvey(file, 2000);
        QVERIFY(test.open(file));
        QVERIFY2(test.window->windowHandle()->title().startsWith(QStringLiteral("a&b[*].las - ")),
                 qPrintable(test.window->windowHandle()->title()));
        QVERIFY(waitFor([&] {
            for (const QMenu* menu : test.window->findChildren<QMenu*>())
                for (const QAction* action : menu->actions())
                    if (action->text() == QStringLiteral("a&&b[*].las")) return true;
            return false;
        }));
    }

    /// A name that is no UTF-8 opens from a drop, whose address has lost it, and is saved under that very name.
    void namesOfOtherEncodings()
    {
        TestWindow test;
        const QByteArray name = test.folder.path().toUtf8() + "/caf\xe9.las";
        const QString made = test.folder.filePath(QStringLiteral("made.las"));
        writeSurvey(made, 2000);
        std::filesystem::rename(toPath(made), std::filesystem::path(name.toStdString()));
        test.dropFiles({QString::fromUtf8(name)});
        QVERIFY(waitFor([&] { return test.window->workspace().active() != nullptr; }) && test.settle());
        Document* const document = test.window->workspace().active();
        QCOMPARE(document->points(), PointIndex(2000));
        QCOMPARE(toPath(document->path()).string(), name.toStdString());
        bool saved = false;
        test.window->workspace().save(*document, document->path(), [&](bool done) { saved = done; });
        QVERIFY(waitFor([&] { return saved; }));
        int files = 0;
        for (const auto& entry : std::filesystem::directory_iterator(toPath(test.folder.path())))
            files += entry.path().extension() == ".las" ? 1 : 0;
        QCOMPARE(files, 1);
        std::filesystem::remove(name.toStdString());  // QTemporaryDir does not see it
    }

    /// What is said of a file goes with it.
    void messagesGoWithTheirFile()
    {
        TestWindow test;
        Document* const document = test.open(surveyFile());
        QVERIFY(document);
        MessageArea& messages = test.window->viewport().messages();
        test.window->workspace().say(MessageKind::Error, QStringLiteral("About the file."), {}, document);
        test.window->workspace().say(MessageKind::Error, QStringLiteral("About something else."));
        QCOMPARE(messages.sentences().size(), 2);
        test.window->workspace().close(*document);
        QVERIFY(
            waitFor([&] { return messages.sentences() == QStringList{QStringLiteral("About something else.")}; }));
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<DocksTest>(); });
}
#include "DocksTest.moc"
