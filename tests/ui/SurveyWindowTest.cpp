// SPDX-License-Identifier: MIT
// Several files as one document: how they are opened, listed, hidden, edited, saved, recovered and left out, by
// mouse and keys.
#include "SelectBench.h"

#include "core/edit/History.h"
#include "core/las/Diff.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/docks/FilesDock.h"
#include "ui/docks/FilesModel.h"
#include "ui/document/Recovery.h"
#include "ui/document/Workspace.h"
#include "ui/select/EditDock.h"
#include "ui/select/Selection.h"
#include "ui/view/MessageArea.h"
#include "ui/view/ShownCount.h"
#include "ui/view/ShownPill.h"
#include "ui/view/StartPage.h"
#include "ui/view/ViewFilter.h"
#include "ui/view/Viewport.h"
#include "ui/window/MainMenu.h"

#include <QDateTime>
#include <QDir>
#include <QFile>
#include <QFileInfo>
#include <QLineEdit>
#include <QMenu>
#include <QPushButton>
#include <QStyle>
#include <QStyleOptionViewItem>
#include <QTableView>

#include <algorithm>
#include <vector>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

constexpr std::uint32_t kPoints = 20'000;  // of each file
constexpr double kWidth = 1177.0;

QByteArray bytesOf(const QString& path)
{
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
}

/// Files side by side, from west to east.
struct SurveyBench : Bench {
    QTemporaryDir data;
    QStringList paths;

    explicit SurveyBench(int files, const QString& settings = {}) : Bench(settings)
    {
        for (int k = 0; k < files; ++k) {
            paths << data.filePath(QStringLiteral("tile%1.laz").arg(k));
            writeSurvey(paths.back(), kPoints, kWidth * k);
        }
    }
    bool openAll()
    {
        window->openFiles(paths);
        if (!settle()) return false;
        document = workspace().active();
        window->activateWindow();
        if (!document || !QTest::qWaitForWindowActive(window.get())) return false;
        window->viewport().setFocus();
        window->viewport().setStandardView(QStringLiteral("top"));
        return settle();
    }
    Workspace& workspace() { return window->workspace(); }
    FilesDock& files() { return window->filesDock(); }
    QTableView& list() { return files().view(); }
    QModelIndex row(int k) { return list().model()->index(k, 0); }
    QRect box(int k)
    {
        QStyleOptionViewItem option;
        option.initFrom(&list());
        option.features = QStyleOptionViewItem::HasCheckIndicator | QStyleOptionViewItem::HasDisplay;
        option.rect = list().visualRect(row(k));
        return list().style()->subElementRect(QStyle::SE_ItemViewItemCheckIndicator, &option, &list());
    }
    /// A click on the box of a row.
    void tick(int k) { QTest::mouseClick(list().viewport(), Qt::LeftButton, {}, box(k).center()); }
    void choose(int k, Qt::KeyboardModifiers modifiers = {})
    {
        const QRect cell = list().visualRect(list().model()->index(k, FilesModel::Points));
        QTest::mouseClick(list().viewport(), Qt::LeftButton, modifiers, cell.center());
    }
    void press(QPushButton& button) { QTest::mouseClick(&button, Qt::LeftButton); }
    bool changed(int k) { return row(k).data(FilesModel::ChangedRole).toBool(); }
    /// Points of the files that differ from what they were.
    static PointIndex differing(const QString& a, const QString& b)
    {
        Progress progress;
        return las::diffFiles(toPath(a), toPath(b), {}, progress).differing;
    }
};

}  // namespace

class SurveyWindowTest : public QObject
{
    Q_OBJECT
private slots:
    /// What the view looks at is told to those who read, while they do: the tile that it moved to, and nothing of
    /// the others; all again when it shows all.
    void readersKnowWhatIsLookedAt()
    {
        SurveyBench bench(4);
        Viewport& view = bench.window->viewport();
        const auto boxOf = [](int k) {
            const double low = kWidth * k;
            return WorldBounds{{low + 100, 100, 400}, {low + 1000, 400, 500}};
        };
        std::uint64_t before = 0, after = 0;
        std::vector<bool> seen;
        bool all = false;
        connect(&bench.workspace(), &Workspace::documentAdded, this, [&](Document* document) {
            ReadingOrder& order = *document->session()->readingOrder();
            before = order.looks();
            all = order.sight() == nullptr;
            QTest::qSleep(150);  // it is told some times a second at most
            const WorldBounds& bounds = document->bounds();
            const glm::dvec3 origin(bounds.min.x, bounds.min.y, 0);
            render::Camera camera = view.camera();
            camera.setView("top");
            camera.orthographic = true;
            const WorldBounds box = boxOf(2);
            camera.fit({box.min + origin, box.max + origin}, {800, 800});
            view.setCamera(camera);
            after = order.looks();
            const auto sight = order.sight();
            for (int k = 0; sight && k < 4; ++k) {
                const WorldBounds tile = boxOf(k);
                seen.push_back((*sight)({tile.min + origin, tile.max + origin}) > 0);
            }
        });
        QVERIFY(bench.openAll());
        QVERIFY(before > 0 && all);
        QVERIFY(after > before);
        QCOMPARE(seen.size(), std::size_t(4));
        QVERIFY(seen[2] && !seen[0]);
    }
    /// What is dropped together is one document, and what is dropped next is another beside it.
    void droppedTogetherTheyAreOne()
    {
        SurveyBench s(3);
        s.dropFiles(s.paths);
        QVERIFY(s.settle());
        QCOMPARE(s.workspace().documents().size(), std::size_t(1));
        Document* const first = s.workspace().active();
        QVERIFY(first->many());
        QCOMPARE(first->name(), QStringLiteral("3 files"));
        QCOMPARE(first->points(), PointIndex(3) * kPoints);
        QCOMPARE(s.window->windowTitle(), QStringLiteral("3 files[*] - Punctum"));
        QCOMPARE(s.list().model()->rowCount(), 3);
        QCOMPARE(s.row(1).data().toString(), QStringLiteral("tile1.laz"));
        QCOMPARE(s.row(1).siblingAtColumn(FilesModel::Points).data().toString(), QStringLiteral("20,000"));
        QVERIFY(s.row(1).siblingAtColumn(FilesModel::Size).data().toString().contains(QStringLiteral("×")));
        QVERIFY(s.list().isVisible());  // a survey brings the panel to the front

        QDir(s.data.path()).mkdir(QStringLiteral("north"));
        for (int k = 0; k < 2; ++k)
            writeSurvey(s.data.filePath(QStringLiteral("north/n%1.las").arg(k)), kPoints, kWidth * (k + 3));
        s.dropFiles({s.data.filePath(QStringLiteral("north"))});
        QVERIFY(s.settle());
        QCOMPARE(s.workspace().documents().size(), std::size_t(2));
        QCOMPARE(s.workspace().active()->name(), QStringLiteral("north"));
        QCOMPARE(s.list().model()->rowCount(), 2);

        // dropped once more, nothing is opened twice
        s.dropFiles({s.paths[1]});
        QVERIFY(s.settle());
        QCOMPARE(s.workspace().documents().size(), std::size_t(2));
        QCOMPARE(s.workspace().active(), first);
        QCOMPARE(s.window->viewport().messages().sentences(),
                 QStringList{QStringLiteral("tile1.laz is open already, as one of 3 files.")});
        const QString other = s.data.filePath(QStringLiteral("other.las"));
        writeSurvey(other, kPoints, kWidth * 6);
        s.dropFiles({s.paths[0], other});
        QVERIFY(s.settle());
        QCOMPARE(s.workspace().active()->name(), QStringLiteral("other.las"));
        QCOMPARE(s.window->viewport().messages().sentences().size(), 2);
        QVERIFY(s.window->viewport().messages().sentences().contains(
            QStringLiteral("One of these files is open already and is left as it is.")));
    }

    void aVirtualCloudIsOneDocument()
    {
        SurveyBench s(2);
        const QString vpc = s.data.filePath(QStringLiteral("all.vpc"));
        QFile file(vpc);
        QVERIFY(file.open(QIODevice::WriteOnly));
        file.write(
            "{\"type\": \"FeatureCollection\", \"features\": ["
            "{\"assets\": {\"data\": {\"href\": \"./tile0.laz\"}}},"
            "{\"assets\": {\"data\": {\"href\": \"./tile1.laz\"}}},"
            "{\"assets\": {\"data\": {\"href\": \"https://example.org/a.laz\"}}}]}");
        file.close();
        s.window->openFiles({vpc});
        QVERIFY(s.settle());
        QCOMPARE(s.workspace().documents().size(), std::size_t(1));
        QCOMPARE(s.workspace().active()->name(), QStringLiteral("all.vpc"));
        QCOMPARE(s.workspace().active()->parts().size(), std::size_t(2));
        QCOMPARE(s.window->viewport().messages().sentences(),
                 QStringList{
                     QStringLiteral("One file of all.vpc lies on a server and is left out; download it first.")});
    }

    /// The list of recent files has them as they were opened.
    void theyAreOpenedAgainTogether()
    {
        SurveyBench s(2);
        QVERIFY(s.openAll());
        QVERIFY(waitFor([&] {
            return s.window->viewport().startPage().findChildren<QPushButton*>(QStringLiteral("recent")).size() ==
                   1;
        }));
        QVERIFY(s.settle());
        TestWindow again(ViewKind::Automatic, s.folder.filePath(QStringLiteral("settings.ini")));
        const auto recent =
            again.window->viewport().startPage().findChildren<QPushButton*>(QStringLiteral("recent"));
        QCOMPARE(recent.size(), 1);
        QVERIFY2(recent.front()->text().startsWith(QStringLiteral("tile0.laz and 1 more")),
                 qPrintable(recent.front()->text()));
        QTest::mouseClick(recent.front(), Qt::LeftButton);
        QVERIFY(waitFor([&] {
            const Document* const open = again.window->workspace().active();
            return open && open->parts().size() == 2 && !open->loading();
        }));
        QVERIFY(again.settle());
    }

    void hiddenFilesAreNeitherDrawnNorSelectedNorCounted()
    {
        SurveyBench s(2);
        QVERIFY(s.openAll());
        const auto before = s.frame();
        s.tick(1);
        QCOMPARE(s.document->hiddenParts(), 1);
        QVERIFY(s.done());
        QVERIFY(waitFor([&] { return difference(before->image, s.frame()->image) > 0.05; }));
        QVERIFY(waitFor([&] { return s.window->shownCount().state().known; }));
        QCOMPARE(s.window->shownPill().text(), QStringLiteral("20,000 of 40,000 shown: 1 file"));
        QCOMPARE(s.files().summary(), QStringLiteral("2 files, 1 hidden"));
        s.selection().selectAll();
        QVERIFY(s.done());
        QCOMPARE(s.selection().count(), PointIndex(kPoints));
        QVERIFY(!s.points()->contains(kPoints));
        s.selection().clear();

        // with a filter besides, and without it
        s.window->viewFilter().setText(QStringLiteral("Z > 450"));
        QVERIFY(s.done());
        s.selection().selectAll();
        QVERIFY(s.done());
        const PointIndex high = s.selection().count();
        QVERIFY(high > 0 && high < kPoints);
        QVERIFY(!s.points()->contains(kPoints) && s.points()->extent().last <= kPoints);
        s.selection().clear();
        s.window->viewFilter().setText({});
        QVERIFY(s.done());
        QVERIFY(waitFor([&] {
            const ShownState& state = s.window->shownCount().state();
            return state.known && state.shown == kPoints;
        }));

        QTest::mouseClick(&s.window->shownPill().showAllButton(), Qt::LeftButton);
        QCOMPARE(s.document->hiddenParts(), 0);
        QVERIFY(s.done());
        QVERIFY(waitFor([&] { return s.frame()->image == before->image; }));
        QCOMPARE(s.window->shownPill().text(), QString());
    }

    void theViewGoesToTheChosenFile()
    {
        SurveyBench s(3);
        QVERIFY(s.openAll());
        s.choose(2);
        s.press(s.files().zoomButton());
        QVERIFY(s.settle());
        const glm::dvec3& pivot = s.window->viewport().camera().pivot;
        const WorldBounds& bounds = s.document->parts()[2].bounds;
        QVERIFY(pivot.x > bounds.min.x && pivot.x < bounds.max.x);
        QVERIFY(bounds.max.x - bounds.min.x < kWidth + 1.0);
    }

    /// A shape over a seam, one undo; a save writes the files that changed, and in them those points alone.
    void onlyChangedFilesAreSaved()
    {
        SurveyBench s(3);
        QStringList originals;
        for (const QString& path : s.paths) {
            originals << path + QStringLiteral(".before.laz");
            QVERIFY(QFile::copy(path, originals.back()));
        }
        QVERIFY(s.openAll());
        s.window->selectTools().setTool(Tool::Rectangle);
        s.drag(s.at(0.30, 0.45), s.at(0.45, 0.55));  // of the first and the second file
        QVERIFY(s.done());
        const auto points = s.points();
        QVERIFY(points);
        PointIndex counts[3] = {};
        points->forEach([&](PointIndex i) { ++counts[i / kPoints]; });
        QVERIFY(counts[0] > 100 && counts[1] > 100 && counts[2] == 0);
        QVERIFY(s.runEdit([&] { s.key(Qt::Key_6); }));
        QVERIFY(waitFor([&] { return s.changed(0) && s.changed(1); }));
        QVERIFY(!s.changed(2));
        QVERIFY(s.row(0).data().toString().endsWith(QStringLiteral(" *")));
        QCOMPARE(s.files().summary(), QStringLiteral("3 files, 2 not saved"));
        QTest::keyClick(&s.view(), Qt::Key_Z, Qt::ControlModifier);
        QVERIFY(waitFor([&] { return s.document->history().position() == 0; }) && s.done());
        QVERIFY(waitFor([&] { return !s.changed(0) && !s.changed(1); }));
        QTest::keyClick(&s.view(), Qt::Key_Y, Qt::ControlModifier);
        QVERIFY(waitFor([&] { return s.changed(0) && s.changed(1); }) && s.done());

        const QByteArray third = bytesOf(s.paths[2]);
        const QDateTime written = QFileInfo(s.paths[2]).lastModified();
        s.window->menu().save->trigger();
        QVERIFY(waitFor([&] { return !s.window->isWindowModified(); }) && s.done());
        QVERIFY(!s.changed(0) && !s.changed(1));
        for (int k = 0; k < 2; ++k) QCOMPARE(SurveyBench::differing(originals[k], s.paths[k]), counts[k]);
        QCOMPARE(bytesOf(s.paths[2]), third);
        QCOMPARE(QFileInfo(s.paths[2]).lastModified(), written);
        const QString told = s.document->lastSave()->sentence;
        QVERIFY2(told.startsWith(QStringLiteral("Saved 2 of 3 files (tile0.laz, tile1.laz): ")), qPrintable(told));
        QCOMPARE(s.document->name(), QStringLiteral("3 files"));
    }

    /// A yes to a question that names one file is one to all that it is true of: the question says so.
    void aYesIsOneToAllFiles()
    {
        SurveyBench s(2);
        QVERIFY(s.openAll());
        s.selection().selectAll();
        QVERIFY(s.done());
        QVERIFY(s.runEdit([&] { s.key(Qt::Key_6); }));
        for (const QString& path : s.paths) QVERIFY(QFile::setPermissions(path, QFileDevice::ReadOwner));
        QStringList questions;
        s.workspace().askQuestion = [&](const Question& asked, std::function<void(bool)> answer) {
            questions << asked.text + asked.reason;
            answer(true);
        };
        s.workspace().save(*s.document, s.document->path());
        QVERIFY(waitFor([&] { return !s.window->isWindowModified(); }) && s.done());
        QCOMPARE(questions.size(), 1);
        QVERIFY2(questions[0].contains(QStringLiteral("Other files of this save")), qPrintable(questions[0]));
    }

    void oneFileIsSavedAlone()
    {
        SurveyBench s(2);
        const QByteArray second = bytesOf(s.paths[1]);
        QVERIFY(s.openAll());
        s.selection().selectAll();
        QVERIFY(s.done());
        QVERIFY(s.runEdit([&] { s.key(Qt::Key_6); }));
        QVERIFY(waitFor([&] { return s.changed(0) && s.changed(1); }));
        const QByteArray first = bytesOf(s.paths[0]);
        s.choose(0);
        const std::unique_ptr<QMenu> menu(s.files().makeMenu());
        QAction* action = nullptr;
        for (QAction* each : menu->actions())
            if (each->text().remove(QLatin1Char('&')) == QStringLiteral("Save Only This File")) action = each;
        QVERIFY(action && action->isEnabled());
        action->trigger();
        QVERIFY(waitFor([&] { return !s.changed(0); }) && s.done());
        QVERIFY(bytesOf(s.paths[0]) != first);
        QCOMPARE(bytesOf(s.paths[1]), second);
        QVERIFY(s.changed(1));
        QVERIFY(s.window->isWindowModified());
        QVERIFY(!s.files().saveButton().isEnabled());  // the chosen one is saved
        s.window->save();
        QVERIFY(waitFor([&] { return !s.window->isWindowModified(); }) && s.done());
        QVERIFY(bytesOf(s.paths[1]) != second);
    }

    void filesGoIntoAnotherFolderOrIntoOne()
    {
        SurveyBench s(2);
        QVERIFY(s.openAll());
        const QByteArray before = bytesOf(s.paths[0]);
        s.selection().selectByRule(QStringLiteral("Z > 450"));
        QVERIFY(s.done());
        const PointIndex high = s.selection().count();
        QVERIFY(s.runEdit([&] { s.key(Qt::Key_6); }));
        const QString one = s.data.filePath(QStringLiteral("one.las"));
        s.workspace().merge(*s.document, one);
        QVERIFY(s.done());
        Progress progress;
        QCOMPARE(las::load(toPath(one), progress)->size(), PointIndex(2) * kPoints);
        QVERIFY(s.window->isWindowModified());  // the files themselves are as they were

        QDir(s.data.path()).mkdir(QStringLiteral("out"));
        const QString out = s.data.filePath(QStringLiteral("out"));
        QVERIFY(QFile::copy(s.paths[1], out + QStringLiteral("/tile1.laz")));
        int asked = 0;
        bool answer = false;
        s.workspace().askQuestion = [&](const Question& question, std::function<void(bool)> reply) {
            ++asked;
            QCOMPARE(question.text, QStringLiteral("Replace tile1.laz in out?"));
            reply(answer);
        };
        s.workspace().save(*s.document, out);
        QVERIFY(s.done());
        QCOMPARE(asked, 1);
        QVERIFY(!QFile::exists(out + QStringLiteral("/tile0.laz")));
        answer = true;
        s.workspace().save(*s.document, out);
        QVERIFY(waitFor([&] { return !s.window->isWindowModified(); }) && s.done());
        QCOMPARE(asked, 2);
        QCOMPARE(bytesOf(s.paths[0]), before);
        PointIndex differing = 0;
        for (int k = 0; k < 2; ++k)
            differing += SurveyBench::differing(s.paths[k], out + QStringLiteral("/tile%1.laz").arg(k));
        QCOMPARE(differing, high);
        QCOMPARE(s.document->name(), QStringLiteral("out"));
        QCOMPARE(s.document->parts()[0].path, out + QStringLiteral("/tile0.laz"));
    }

    void aFileIsLeftOut()
    {
        SurveyBench s(3);
        QVERIFY(s.openAll());
        s.selection().selectAll();
        QVERIFY(s.done());
        QVERIFY(s.runEdit([&] { s.key(Qt::Key_6); }));
        QVERIFY(waitFor([&] { return s.changed(1); }));
        s.choose(1);
        int asked = 0;
        s.window->askUnsaved = [&](const QString&, const QString&) {
            ++asked;
            return UnsavedAnswer::Cancel;
        };
        s.press(s.files().removeButton());
        QCOMPARE(asked, 1);
        QCOMPARE(s.document->parts().size(), std::size_t(3));  // nothing is lost
        s.window->save();
        QVERIFY(waitFor([&] { return !s.window->isWindowModified(); }) && s.done());

        s.wheel(s.at(0.5, 0.5), 2);
        QVERIFY(s.settle());
        const render::Camera camera = s.view().camera();
        s.press(s.files().removeButton());
        QVERIFY(waitFor([&] {
            s.document = s.workspace().active();
            return s.workspace().documents().size() == 1 && s.document && s.document->parts().size() == 2 &&
                   !s.document->loading();
        }));
        QVERIFY(s.settle());
        QCOMPARE(asked, 1);
        QCOMPARE(s.document->parts()[1].name, QStringLiteral("tile2.laz"));
        QVERIFY(s.view().camera() == camera);
        QVERIFY(QFile::exists(s.paths[1]));
        s.choose(0);
        s.choose(1, Qt::ControlModifier);
        QVERIFY(!s.files().removeButton().isEnabled());  // something must be left
    }

    /// A program that was killed: asked once for all files, and all is done again.
    void editsOfASurveyComeBack()
    {
        const QTemporaryDir folder;
        const QString settings = folder.filePath(QStringLiteral("s.ini"));
        const QDir journals(folder.filePath(QStringLiteral("journals")));
        const QString kept = folder.filePath(QStringLiteral("kept"));
        QTemporaryDir data;
        QStringList paths;
        for (int k = 0; k < 2; ++k) {
            paths << data.filePath(QStringLiteral("t%1.laz").arg(k));
            writeSurvey(paths.back(), kPoints, kWidth * k);
        }
        QString name;
        {
            SurveyBench s(0, settings);
            s.paths = paths;
            QVERIFY(s.openAll());
            s.selection().selectAll();
            QVERIFY(s.done());
            QVERIFY(s.runEdit([&] { s.key(Qt::Key_6); }));
            const QStringList found = journals.entryList({QStringLiteral("*.journal")}, QDir::Files);
            QCOMPARE(found.size(), 1);
            name = found.front();
            QVERIFY(QFile::copy(journals.filePath(name), kept));
        }
        QVERIFY(QFile::copy(kept, journals.filePath(name)));
        SurveyBench s(0, settings);
        s.paths = paths;
        int asked = 0;
        s.workspace().recovery().ask = [&](const Question& question,
                                           const std::function<void(RecoveryAnswer)>& answer) {
            ++asked;
            QVERIFY(question.reason.contains(QStringLiteral("this edit of 2 files")));
            answer(RecoveryAnswer::Recover);
        };
        QVERIFY(s.openAll());
        QVERIFY(waitFor([&] { return s.document->history().position() == 1; }) && s.done());
        QCOMPARE(asked, 1);
        const Attribute classes = *s.document->findAttribute(QStringLiteral("Classification"));
        for (PointIndex i = 0; i < s.document->points(); ++i) QCOMPARE(classes.number(i), 6.0);
        QVERIFY(waitFor([&] { return s.changed(0) && s.changed(1); }));
    }

    /// A file that is none is told of by its name, and the others are there.
    void oneBadFileKeepsTheOthers()
    {
        SurveyBench s(2);
        const QString bad = s.data.filePath(QStringLiteral("bad.laz"));
        QFile file(bad);
        QVERIFY(file.open(QIODevice::WriteOnly) && file.write("no cloud") > 0);
        file.close();
        s.window->openFiles(s.paths + QStringList(bad));
        QVERIFY(s.settle());
        QCOMPARE(s.workspace().documents().size(), std::size_t(1));
        QCOMPARE(s.workspace().active()->parts().size(), std::size_t(2));
        const QStringList said = s.window->viewport().messages().sentences();
        QCOMPARE(said.size(), 1);
        QVERIFY2(said.front().contains(QStringLiteral("bad.laz")), qPrintable(said.front()));
    }

    /// A long list is searched, and sorted by its columns.
    void aLongListIsSearched()
    {
        SurveyBench s(0);
        for (int k = 0; k < 30; ++k) {
            s.paths << s.data.filePath(QStringLiteral("p%1.las").arg(k, 2, 10, QLatin1Char('0')));
            writeSurvey(s.paths.back(), std::uint32_t(200 + 10 * ((7 * k) % 30)), 0.0);
        }
        QVERIFY(s.openAll());
        QVERIFY(s.files().search().isVisible());
        QTest::keyClicks(&s.files().search(), QStringLiteral("p1"));
        QCOMPARE(s.list().model()->rowCount(), 10);
        s.files().search().clear();
        s.list().sortByColumn(FilesModel::Points, Qt::DescendingOrder);
        for (int k = 0; k + 1 < 30; ++k) {
            const auto count = [&](int row) {
                return s.row(row).siblingAtColumn(FilesModel::Points).data(FilesModel::SortRole).toULongLong();
            };
            QVERIFY(count(k) >= count(k + 1));
        }
        s.tick(0);
        QCOMPARE(s.document->hiddenParts(), 1);
        for (const Document::Part& part : s.document->parts())
            QCOMPARE(part.shown, part.name != s.row(0).data().toString());
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<SurveyWindowTest>(); });
}
#include "SurveyWindowTest.moc"
