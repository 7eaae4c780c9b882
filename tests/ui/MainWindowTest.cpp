// SPDX-License-Identifier: MIT
// The main job by real events: drop a file, drag an attribute, compute, reclassify, undo, save, reopen; and what
// happens when something goes wrong.
#include "UiTest.h"

#include "core/edit/History.h"
#include "core/las/Writer.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/docks/AttributesDock.h"
#include "ui/docks/AttributesModel.h"
#include "ui/docks/ClassesDock.h"
#include "ui/docks/ClassesModel.h"
#include "ui/document/Workspace.h"
#include "ui/process/ProcessingDock.h"
#include "ui/view/Framing.h"
#include "ui/view/MessageArea.h"
#include "ui/view/Overlays.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"
#include "ui/window/MainMenu.h"

#include <QElapsedTimer>
#include <QMimeData>
#include <QSignalSpy>
#include <QTimer>
#include <QWheelEvent>
#include <QWindow>

#include <glm/geometric.hpp>
#include <glm/vector_relational.hpp>

#include <mutex>

#include <sys/resource.h>
#include <unistd.h>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

/// The median z of the file's points lies in between; what matters is that both sides have many.
constexpr double kLowZ = 406.0, kHighZ = 425.0;

}  // namespace

class MainWindowTest : public QObject
{
    Q_OBJECT
private slots:
    void emptyWindowIdles()
    {
        TestWindow test;
        QVERIFY(test.window->workspace().documents().empty());
        QVERIFY(test.settle());
        const auto before = test.frame()->number;
        QTest::qWait(100);
        QCOMPARE(test.frame()->number, before);
        QVERIFY(!test.window->menu().save->isEnabled());
        QVERIFY(!test.window->menu().undo->isEnabled());
    }

    /// L shades and shades no more; steps of color come from the panel's settings. Nothing else changes.
    void lightingAndSteps()
    {
        TestWindow test;
        QVERIFY(test.settle());
        test.dropFiles({surveyFile()});
        QVERIFY(test.settle());
        const auto plain = test.frame();
        test.window->activateWindow();  // shortcuts want it, and there may be no window manager to see to it
        QVERIFY(QTest::qWaitForWindowActive(test.window.get()));
        const auto differs = [&](const std::shared_ptr<const Frame>& from) {
            return waitFor([&] { return difference(from->image, test.frame()->image) > 0.01; }) && test.settle();
        };
        QTest::keyClick(&test.window->viewport(), Qt::Key_L);
        QVERIFY(differs(plain));
        QTest::keyClick(&test.window->viewport(), Qt::Key_L);
        QVERIFY(waitFor([&] { return test.frame()->image == plain->image; }));
        test.window->showAttribute(QStringLiteral("Z"));
        QVERIFY(test.settle(QStringLiteral("Z")));
        const auto smooth = test.frame();
        test.window->viewSettings().setBands(5);
        QVERIFY(differs(smooth));
    }

    void opensDroppedFile()
    {
        TestWindow test;
        QVERIFY(test.settle());
        const auto empty = test.frame();
        test.dropFiles({surveyFile()});
        QVERIFY(test.settle());
        Document* document = test.window->workspace().active();
        QVERIFY(document);
        QCOMPARE(document->points(), PointIndex(110000));
        QVERIFY(!document->loading());
        QVERIFY(difference(empty->image, test.frame()->image) > 0.05);
        QVERIFY(test.window->windowTitle().startsWith(kSurvey));
        QVERIFY(!test.window->isWindowModified());
        QVERIFY(test.window->viewport().messages().sentences().isEmpty());

        // Idle again: nothing is drawn while nothing changes.
        const auto number = test.frame()->number;
        QTest::qWait(100);
        QCOMPARE(test.frame()->number, number);

        // What is known of the attributes and classes has come, too.
        QVERIFY(waitFor([&] { return document->figures(QStringLiteral("Z")) && document->classCounts(); }));
        QVERIFY(document->figures(QStringLiteral("Intensity")));
        const ClassesModel& classes = test.window->classesDock().model();
        QCOMPARE(classes.countOf(1) + classes.countOf(2), quint64(110000));
        QCOMPARE(classes.rowCount(), 2);
    }

    void showsAttributeDraggedOntoTheView()
    {
        TestWindow test;
        QVERIFY(test.open(surveyFile()));
        const auto before = test.frame();
        QVERIFY(before->attribute != QLatin1String("Classification"));

        AttributesView& list = test.window->attributesDock().view();
        const QModelIndex index = test.window->attributesDock().model().indexOf(QStringLiteral("Classification"));
        QVERIFY(index.isValid());
        list.scrollTo(index);
        QTest::qWait(50);
        Viewport& view = test.window->viewport();
        const QPoint start = list.viewport()->mapTo(&list, list.visualRect(index).center());
        QString hint;
        QTimer watch;
        connect(&watch, &QTimer::timeout, this, [&] {
            if (view.dropHint().isVisible()) hint = view.dropHint().text();
        });
        watch.start(5);
        if (QGuiApplication::platformName() == QLatin1String("offscreen")) {
            // No window system, no drag: the same events by hand.
            const std::unique_ptr<QMimeData> mime(test.window->attributesDock().model().mimeData({index}));
            test.drop(*mime, [&] { hint = view.dropHint().text(); });
        } else {
            dragWithMouse(list, start, view, view.rect().center());
        }
        QVERIFY(test.settle(QStringLiteral("Classification"), 20000));
        QCOMPARE(hint, QStringLiteral("Color by Classification"));
        QVERIFY(!view.dropHint().isVisible());
        const auto after = test.frame();
        QCOMPARE(after->camera == before->camera, true);
        QVERIFY(difference(before->image, after->image) > 0.05);

        // And by a double click on another.
        const QModelIndex z = test.window->attributesDock().model().indexOf(QStringLiteral("Z"));
        list.scrollTo(z);
        QTest::mouseClick(list.viewport(), Qt::LeftButton, {}, list.visualRect(z).center());
        QTest::mouseDClick(list.viewport(), Qt::LeftButton, {}, list.visualRect(z).center());
        QVERIFY(test.settle(QStringLiteral("Z")));
        QVERIFY(waitFor([&] { return view.legend().content().bar; }));
        QCOMPARE(view.legend().content().title, QStringLiteral("Z"));
    }

    /// The legend names the classes that are shown, and the values that have a color of their own.
    void legendTellsClassesAndValues()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("sample.las"));
        writeSample(path, 20'000);
        Document* const document = test.open(path);
        QVERIFY(document);
        const Viewport& view = test.window->viewport();
        test.window->showAttribute(QStringLiteral("Classification"));
        QVERIFY(test.settle(QStringLiteral("Classification")));
        const auto names = [&] {
            QStringList list;
            for (const Legend::Entry& entry : view.legend().content().entries) list << entry.name;
            return list;
        };
        QVERIFY(waitFor([&] { return names().contains(QStringLiteral("2 Ground")); }));
        QCOMPARE(names().size(), test.window->classesDock().model().rowCount());
        test.window->viewSettings().setClassVisible(2, false);
        QVERIFY(!names().contains(QStringLiteral("2 Ground")));
        QVERIFY(!names().isEmpty());

        test.window->showAttribute(QStringLiteral("ReturnNumber"));
        QVERIFY(test.settle(QStringLiteral("ReturnNumber")));
        QVERIFY(waitFor([&] { return document->figures(QStringLiteral("ReturnNumber")) != nullptr; }));
        QVERIFY(names().size() > 1);
        for (int k = 0; k < names().size(); ++k) QCOMPARE(names()[k], QString::number(k + 1));
        QVERIFY(view.legend().isVisible());
        // In a narrow view it keeps clear of the edges.
        QVERIFY(view.rect().contains(view.legend().geometry()));
    }

    void navigatesByMouse()
    {
        TestWindow test;
        QVERIFY(test.open(surveyFile()));
        Viewport& view = test.window->viewport();
        const QPoint middle = view.rect().center();
        const render::Camera fitted = view.camera();

        dragWithMouse(view, middle, view, middle + QPoint(90, 20));
        QVERIFY(view.camera().yaw != fitted.yaw);
        const render::Camera turned = view.camera();
        QTest::mousePress(&view, Qt::RightButton, {}, middle);
        QTest::mouseMove(&view, middle + QPoint(30, 0));
        QMouseEvent move(QEvent::MouseMove, middle + QPointF(60, 0), view.mapToGlobal(middle + QPointF(60, 0)),
                         Qt::NoButton, Qt::RightButton, Qt::NoModifier);
        QApplication::sendEvent(&view, &move);
        QTest::mouseRelease(&view, Qt::RightButton, {}, middle + QPoint(60, 0));
        QCOMPARE(view.camera().yaw, turned.yaw);
        QVERIFY(glm::length(view.camera().pivot - turned.pivot) > 1.0);
        view.setCamera(fitted);
        QVERIFY(test.settle());

        // The wheel zooms to the point under the cursor: that keeps its place.
        const QSize size = view.pictureSize();
        const auto pickMiddle = [&] {
            std::optional<PickedPoint> point;
            bool replied = false;
            test.window->renderer().pick(int(middle.x() * view.devicePixelRatioF()),
                                         int(middle.y() * view.devicePixelRatioF()), this, [&](const auto& p) {
                                             point = p;
                                             replied = true;
                                         });
            return waitFor([&] { return replied; }) ? point : std::nullopt;
        };
        std::optional<PickedPoint> picked = pickMiddle();
        QVERIFY(picked.has_value());
        const glm::dvec2 px(size.width(), size.height());
        const glm::dvec3 at = view.camera().project(picked->world, px);
        QWheelEvent wheel(middle, view.mapToGlobal(middle), {}, {0, 240}, Qt::NoButton, Qt::NoModifier,
                          Qt::NoScrollPhase, false);
        QApplication::sendEvent(&view, &wheel);
        QVERIFY(waitFor([&] { return !(view.camera() == fitted); }));
        const glm::dvec3 after = view.camera().project(picked->world, px);
        QVERIFY(after.z < at.z * 0.7);
        QVERIFY(std::abs(after.x - at.x) < 1.0 && std::abs(after.y - at.y) < 1.0);

        // A double click makes it the pivot, in the middle of the picture; F shows everything again.
        QVERIFY(test.settle());
        picked = pickMiddle();  // seen from nearer, another point may be in front
        QVERIFY(picked.has_value());
        QTest::mouseDClick(&view, Qt::LeftButton, {}, middle);
        QVERIFY(waitFor([&] { return glm::length(view.camera().pivot - picked->world) < 1e-6; }));
        QTest::qWait(350);
        test.window->activateWindow();  // shortcuts want it, and there may be no window manager to see to it
        QVERIFY(QTest::qWaitForWindowActive(test.window.get()));
        QTest::keyClick(&view, Qt::Key_F);
        QVERIFY(waitFor([&] { return glm::length(view.camera().eye - fitted.eye) < 1e-6; }));
    }

    void fileFarAwayIsShownAlone()
    {
        TestWindow test;
        const QString far = test.folder.filePath(QStringLiteral("far.las"));
        writeSurvey(far, 20'000, 1e6);
        Document* first = test.open(surveyFile());
        QVERIFY(first);
        Document* second = test.open(far);
        QVERIFY(second && second != first);
        QCOMPARE(test.window->workspace().documents().size(), std::size_t(2));
        const auto holds = [&](const Document& document) {
            const glm::dvec3& pivot = test.window->viewport().camera().pivot;
            const WorldBounds& b = document.bounds();
            return glm::all(glm::lessThanEqual(b.min, pivot)) && glm::all(glm::lessThanEqual(pivot, b.max));
        };
        QVERIFY(holds(*second));
        test.window->workspace().setActive(first);
        test.window->framing().fitActive();
        QVERIFY(waitFor([&] { return holds(*first); }, 5000));
        test.window->workspace().close(*second);
        QCOMPARE(test.window->workspace().documents().size(), std::size_t(1));
        QVERIFY(test.settle());
        // closing the one that is looked at shows the one that is left; the view stays where something is seen
        second = test.open(far);
        QVERIFY(second && holds(*second));
        test.window->workspace().close(*second);
        QVERIFY(holds(*first));
        QVERIFY(test.settle());
        second = test.open(far);
        QVERIFY(second);
        test.window->workspace().setActive(first);
        test.window->framing().fitActive();
        QVERIFY(waitFor([&] { return holds(*first); }, 5000) && test.settle());
        const render::Camera before = test.window->viewport().camera();
        test.window->workspace().close(*second);
        QVERIFY(test.window->viewport().camera() == before);
    }

    void ofFilesFarApartTheActiveOneIsShown()
    {
        TestWindow test;
        QStringList paths;
        for (int k = 0; k < 3; ++k) {
            paths << test.folder.filePath(QStringLiteral("far%1.las").arg(k));
            writeSurvey(paths.back(), 20'000, 1e6 * k);
        }
        for (const QString& path : paths) test.window->openFiles({path});
        const auto& documents = test.window->workspace().documents();
        QVERIFY(waitFor([&] {
            return documents.size() == 3 &&
                   std::all_of(documents.begin(), documents.end(), [](const Document* d) { return !d->loading(); });
        }));
        QVERIFY(test.settle());
        const Document* const active = test.window->workspace().active();
        QVERIFY(active);
        const glm::dvec3& pivot = test.window->viewport().camera().pivot;
        QVERIFY(glm::all(glm::lessThanEqual(active->bounds().min, pivot)) &&
                glm::all(glm::lessThanEqual(pivot, active->bounds().max)));
    }

    void readsOutThePointUnderTheCursor()
    {
        TestWindow test;
        Document* document = test.open(surveyFile());
        QVERIFY(document);
        Viewport& view = test.window->viewport();
        QSignalSpy spy(&view, &Viewport::hovered);
        const QPointF at = view.rect().center();
        QMouseEvent move(QEvent::MouseMove, at, view.mapToGlobal(at), Qt::NoButton, Qt::NoButton, Qt::NoModifier);
        QApplication::sendEvent(&view, &move);
        QVERIFY(waitFor(
            [&] { return !spy.isEmpty() && spy.last().front().value<std::optional<PickedPoint>>().has_value(); }));
        const auto point = *spy.last().front().value<std::optional<PickedPoint>>();
        const glm::dvec3 exact = document->cloud()->world(point.index);
        QVERIFY(glm::length(exact - point.world) < 0.02);
        QVERIFY(point.classCode.has_value());
    }

    void normalsAppearWhileTurning()
    {
        if (!findStep("normals")) QSKIP("The normals step is not built.");
        TestWindow test;
        Document* document = test.open(surveyFile());
        QVERIFY(document);
        ProcessingDock& dock = test.window->processingDock();
        dock.chooseStep(QStringLiteral("normals"));
        QVERIFY(dock.setValue(QStringLiteral("k"), QStringLiteral("16")));
        // Whoever changes points holds this lock, and here the test does: the step waits, and the view must not.
        std::unique_lock held(document->cloud()->mutex());
        dock.run();
        QVERIFY(dock.running());

        Viewport& view = test.window->viewport();
        const QPoint middle = view.rect().center();
        const auto firstFrame = test.frame()->number;
        const double firstYaw = view.camera().yaw;
        QTest::mousePress(&view, Qt::LeftButton, {}, middle);
        int frames = 0, moves = 0;
        connect(&view, &Viewport::frameShown, &view, [&] { frames += dock.running() ? 1 : 0; });
        while (frames < 5 && moves < 3000) {
            ++moves;
            const QPointF at = middle + QPointF(moves % 200, (moves / 3) % 40);
            QMouseEvent move(QEvent::MouseMove, at, view.mapToGlobal(at), Qt::NoButton, Qt::LeftButton,
                             Qt::NoModifier);
            QApplication::sendEvent(&view, &move);
            QTest::qWait(10);
        }
        QTest::mouseRelease(&view, Qt::LeftButton, {}, middle);
        QVERIFY2(frames >= 5, qPrintable(QStringLiteral("%1 frames for %2 moves").arg(frames).arg(moves)));
        QVERIFY(dock.running());
        held.unlock();
        QVERIFY(waitFor([&] { return !dock.running(); }));
        QVERIFY(test.frame()->number > firstFrame);
        QVERIFY(view.camera().yaw != firstYaw);
        QVERIFY(test.settle(QStringLiteral("Normal")));
        QCOMPARE(dock.resultText(), QStringLiteral("Normals: 110,000 points changed."));
        for (const char* name : {"NormalX", "NormalY", "NormalZ", "Normal"})
            QVERIFY2(document->findAttribute(QLatin1String(name)), name);

        // Undone, they are gone, and the view shows something that is there.
        test.window->menu().undo->trigger();
        QVERIFY(waitFor([&] { return !document->findAttribute(QStringLiteral("Normal")); }));
        QVERIFY(waitFor([&] { return test.settle() && test.frame()->attribute != QLatin1String("Normal"); }));
    }

    void reclassifyUndoSaveReopen()
    {
        TestWindow test;
        Document* document = test.open(surveyFile());
        QVERIFY(document);
        test.window->showAttribute(QStringLiteral("Classification"));
        QVERIFY(test.settle(QStringLiteral("Classification")));
        QVERIFY(waitFor([&] { return document->classCounts().has_value(); }));
        const auto original = test.frame();
        const auto originalCounts = *document->classCounts();

        ProcessingDock& dock = test.window->processingDock();
        dock.chooseStep(QStringLiteral("reclassify"));
        QVERIFY(dock.setValue(QStringLiteral("attribute"), QStringLiteral("Z")));
        QVERIFY(dock.setValue(QStringLiteral("min"), QString::number(kLowZ)));
        QVERIFY(dock.setValue(QStringLiteral("max"), QString::number(kHighZ)));
        QVERIFY(dock.setValue(QStringLiteral("class"), QStringLiteral("9")));
        const auto reclassify = [&] {
            dock.run();
            return waitFor([&] { return !dock.running(); }) && test.settle() &&
                   waitFor([&] { return (*document->classCounts())[9] > 0; });
        };
        QVERIFY(reclassify());
        const PointIndex water = (*document->classCounts())[9];
        QCOMPARE(dock.resultText(), QStringLiteral("Reclassify: %1 changed.").arg(pointsText(water)));
        QVERIFY(difference(original->image, test.frame()->image) > 0.01);
        QCOMPARE(test.frame()->camera == original->camera, true);
        QVERIFY(test.window->isWindowModified());
        QVERIFY(test.window->menu().undo->isEnabled());

        test.window->menu().undo->trigger();
        QVERIFY(waitFor([&] { return !document->modified(); }));
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return *document->classCounts() == originalCounts; }));
        QCOMPARE(difference(original->image, test.frame()->image), 0.0);
        QVERIFY(!test.window->isWindowModified());
        QVERIFY(test.window->menu().redo->isEnabled());
        test.window->menu().redo->trigger();
        QVERIFY(waitFor([&] { return document->modified(); }));
        QVERIFY(test.settle());

        const bool normals = findStep("normals") != nullptr;
        if (normals) {
            dock.chooseStep(QStringLiteral("normals"));
            dock.run();
            QVERIFY(waitFor([&] { return !dock.running(); }));
        }

        const QString path = test.folder.filePath(QStringLiteral("saved.laz"));
        test.window->saveTo(*document, path);
        QVERIFY(test.settle());
        QVERIFY(QFile::exists(path));
        QCOMPARE(document->path(), path);
        QVERIFY(!test.window->isWindowModified());

        TestWindow again;
        Document* reopened = again.open(path);
        QVERIFY(reopened);
        QCOMPARE(reopened->points(), PointIndex(110000));
        QVERIFY(waitFor([&] { return reopened->classCounts().has_value(); }));
        QCOMPARE((*reopened->classCounts())[9], water);
        for (const char* name : {"X", "Intensity", "GpsTime", "Red"})
            QVERIFY2(reopened->findAttribute(QLatin1String(name)), name);
        if (normals) {
            for (const char* name : {"NormalX", "NormalY", "NormalZ", "Normal"})
                QVERIFY2(reopened->findAttribute(QLatin1String(name)), name);
            const Attribute* a = document->findAttribute(QStringLiteral("NormalZ"));
            const Attribute* b = reopened->findAttribute(QStringLiteral("NormalZ"));
            for (PointIndex i = 0; i < 110000; i += 977) QCOMPARE(b->number(i), a->number(i));
        }
    }

    void hidesClasses()
    {
        TestWindow test;
        Document* document = test.open(surveyFile());
        QVERIFY(document);
        QVERIFY(waitFor([&] { return document->classCounts().has_value(); }));
        const auto all = test.frame();
        ClassesModel& model = test.window->classesDock().model();
        QVERIFY(model.setData(model.index(0, ClassesModel::Visible), Qt::Unchecked, Qt::CheckStateRole));
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return difference(all->image, test.frame()->image) > 0.01; }));
        test.window->viewSettings().setAllClassesVisible(true);
        QVERIFY(waitFor(
            [&] { return test.frame()->report.converged && difference(all->image, test.frame()->image) == 0.0; }));
    }

    void badFilesChangeNothing_data()
    {
        QTest::addColumn<QByteArray>("content");
        QTest::newRow("missing") << QByteArray();
        QTest::newRow("empty") << QByteArray("");
        QTest::newRow("foreign")
            << QByteArray("GIF89a, or some other file that is no point cloud at all").repeated(20);
        QTest::newRow("header only") << QByteArray("LASF").leftJustified(100, '\0');
    }
    void badFilesChangeNothing()
    {
        QFETCH(QByteArray, content);
        TestWindow test;
        Document* document = test.open(surveyFile());
        QVERIFY(document);
        const auto before = test.frame();
        const QString path = test.folder.filePath(QStringLiteral("bad.las"));
        if (!content.isNull()) {
            QFile file(path);
            QVERIFY(file.open(QIODevice::WriteOnly));
            file.write(content);
        }
        test.dropFiles({path});
        QVERIFY(waitFor([&] { return !test.window->viewport().messages().sentences().isEmpty(); }));
        QVERIFY(test.settle());
        const QStringList said = test.window->viewport().messages().sentences();
        QCOMPARE(said.size(), 1);
        QVERIFY(said.front().contains(QStringLiteral("bad.las")));
        QVERIFY2(said.front().endsWith(QLatin1Char('.')), qPrintable(said.front()));
        QCOMPARE(test.window->workspace().active(), document);
        QCOMPARE(test.window->workspace().documents().size(), std::size_t(1));
        QCOMPARE(difference(before->image, test.frame()->image), 0.0);
        QCOMPARE(test.window->viewport().camera() == before->camera, true);
    }

    void cancelledLoadChangesNothing()
    {
        TestWindow test;
        Document* document = test.open(surveyFile());
        QVERIFY(document);
        const auto before = test.frame();
        const QString path = test.folder.filePath(QStringLiteral("large.laz"));
        writeSample(path, 1'500'000);
        test.window->openFiles({path});
        // As soon as its first points show.
        QVERIFY(waitFor([&] { return test.window->workspace().documents().size() == 2; }));
        test.window->workspace().jobs().cancelAll();
        QElapsedTimer clock;
        clock.start();
        QVERIFY(waitFor([&] { return test.window->workspace().documents().size() == 1; }));
        qInfo("the cancelled load was gone after %lld ms", clock.elapsed());
        QVERIFY(test.settle());
        QCOMPARE(test.window->workspace().active(), document);
        QVERIFY(test.window->viewport().messages().sentences().isEmpty());
        QVERIFY(waitFor([&] { return difference(before->image, test.frame()->image) == 0.0; }, 5000));
    }

    void fullDiskOnSaving()
    {
        TestWindow test;
        Document* document = test.open(surveyFile());
        QVERIFY(document);
        const QString path = test.folder.filePath(QStringLiteral("full.las"));
        QFile old(path);
        QVERIFY(old.open(QIODevice::WriteOnly));
        old.write("what was there before");
        old.close();
        rlimit limit{};
        getrlimit(RLIMIT_FSIZE, &limit);
        rlimit small = limit;
        small.rlim_cur = 100'000;
        setrlimit(RLIMIT_FSIZE, &small);
        test.window->saveTo(*document, path);
        const bool ended = waitFor([&] { return !test.window->workspace().busy(); });
        setrlimit(RLIMIT_FSIZE, &limit);
        QVERIFY(ended);
        QVERIFY(waitFor([&] { return !test.window->viewport().messages().sentences().isEmpty(); }));
        const QString said = test.window->viewport().messages().sentences().front();
        QVERIFY2(said.contains(QStringLiteral("full.las")), qPrintable(said));
        QVERIFY(old.open(QIODevice::ReadOnly));
        QCOMPARE(old.readAll(), QByteArray("what was there before"));
        QCOMPARE(QDir(test.folder.path()).entryList({QStringLiteral("full*")}, QDir::Files | QDir::Hidden).size(),
                 1);
        QCOMPARE(document->path(), surveyFile());
    }

    void changedFileIsAskedForBeforeSaving()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("shared.las"));
        writeSample(path, 5000);
        Document* document = test.open(path);
        QVERIFY(document);
        QStringList asked;
        bool answer = false;
        test.window->workspace().askQuestion = [&](const Question& question,
                                                   const std::function<void(bool)>& answered) {
            asked << question.text << question.reason << question.yes;
            answered(answer);
        };
        const auto save = [&] {
            bool ended = false, saved = false;
            test.window->workspace().save(*document, path, [&](bool done) {
                ended = true;
                saved = done;
            });
            return waitFor([&] { return ended; }) && saved;
        };
        QVERIFY(save());
        QVERIFY(asked.isEmpty());
        // as another program would
        QFile file(path);
        QVERIFY(file.open(QIODevice::Append));
        file.write("theirs");
        file.close();
        const qint64 size = file.size();
        QVERIFY(!save());
        QCOMPARE(asked.size(), 3);
        QVERIFY2(asked[1].contains(QStringLiteral("Another program changed this file")), qPrintable(asked[1]));
        QCOMPARE(QFileInfo(path).size(), size);
        answer = true;
        QVERIFY(save());
        QCOMPARE(asked.size(), 6);
        QCOMPARE(QFileInfo(path).size(), size - 6);
        QVERIFY(save());
        QCOMPARE(asked.size(), 6);
        // one that its owner made read-only
        QVERIFY(QFile::setPermissions(path, QFile::ReadOwner));
        answer = false;
        QVERIFY(!save());
        QCOMPARE(asked.size(), 9);
        QVERIFY2(asked[7].contains(QStringLiteral("write-protected")), qPrintable(asked[7]));
        answer = true;
        QVERIFY(save());
        QCOMPARE(asked.size(), 12);
    }

    void closingAsksOnce()
    {
        TestWindow test;
        Document* document = test.open(surveyFile());
        QVERIFY(document);
        int asked = 0;
        QString told;
        UnsavedAnswer answer = UnsavedAnswer::Cancel;
        test.window->askUnsaved = [&](const QString&, const QString& changes) {
            ++asked;
            told = changes;
            return answer;
        };
        const Step* step = findStep("reclassify");
        QVERIFY(step);
        test.window->workspace().run(*document, *step,
                                     {{"attribute", "Z"}, {"min", "400"}, {"max", "430"}, {"class", "6"}});
        QVERIFY(waitFor([&] { return test.window->isWindowModified(); }));
        QVERIFY(waitFor([&] { return document->unsavedChanges().contains(QStringLiteral("Classification")); }));
        test.window->closeActive();
        QCOMPARE(asked, 1);
        QCOMPARE(told, document->unsavedChanges());
        QCOMPARE(test.window->workspace().documents().size(), std::size_t(1));
        answer = UnsavedAnswer::Discard;
        QVERIFY(test.window->close());
        QCOMPARE(asked, 2);
    }

    void worksWithoutOpenGl()
    {
        TestWindow test(ViewKind::Raster);
        QVERIFY(!test.window->viewport().usesOpenGl());
        QVERIFY(test.open(surveyFile()));
        const QImage seen = test.window->viewport().grab().toImage();
        QVERIFY(seen.size() == test.window->viewport().pictureSize());
        // The middle of the view is the picture itself: no overlay lies there.
        const auto frame = test.frame();
        int unlike = 0;
        for (int x = 300; x < 400; ++x) {
            const render::Rgba8 c = frame->image.at(x, frame->image.height / 2);
            unlike += seen.pixel(x, frame->image.height / 2) == qRgb(c.r, c.g, c.b) ? 0 : 1;
        }
        QCOMPARE(unlike, 0);
    }

    void orderOfDrawingIsRemembered()
    {
        const QTemporaryDir folder;
        const QString settings = folder.filePath(QStringLiteral("order.ini"));
        const auto prime = [](TestWindow& test) -> QAction* {
            for (QAction* action :
                 test.window->menu().findChildren<QAction*>() + test.window->findChildren<QAction*>())
                if (action->text() == QStringLiteral("P&rime")) return action;
            return nullptr;
        };
        {
            TestWindow test(ViewKind::Raster, settings);
            QAction* const action = prime(test);
            QVERIFY(action && !action->isChecked());
            QCOMPARE(test.window->workspace().order(), render::OrderKind::Stratified);
            action->trigger();
            QCOMPARE(test.window->workspace().order(), render::OrderKind::Prime);
        }
        TestWindow test(ViewKind::Raster, settings);
        QVERIFY(prime(test)->isChecked());
        QCOMPARE(test.window->workspace().order(), render::OrderKind::Prime);
        QVERIFY(test.open(surveyFile()));
        QVERIFY(test.frame()->report.converged);
    }

    void openGlViewShowsTheSamePixels()
    {
        TestWindow test(ViewKind::OpenGl);
        if (!test.window->viewport().usesOpenGl()) QSKIP("There is no OpenGL for widgets on this platform.");
        QVERIFY(test.open(surveyFile()));
        QTest::qWait(100);
        const QImage seen = test.window->viewport().grab().toImage();
        const auto frame = test.frame();
        int unlike = 0;
        for (int x = 300; x < 400; ++x) {
            const render::Rgba8 c = frame->image.at(x, frame->image.height / 2);
            unlike +=
                (seen.pixel(x, frame->image.height / 2) & RGB_MASK) == (qRgb(c.r, c.g, c.b) & RGB_MASK) ? 0 : 1;
        }
        QCOMPARE(unlike, 0);
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<MainWindowTest>(); });
}
#include "MainWindowTest.moc"
