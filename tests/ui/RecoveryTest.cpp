// SPDX-License-Identifier: MIT
// Edits that were not saved when the program was killed: offered, done again, kept for later, or set aside.
#include "SelectBench.h"

#include "core/edit/History.h"
#include "core/edit/Journal.h"
#include "core/las/Diff.h"
#include "core/steps/Replay.h"
#include "core/task/Progress.h"
#include "ui/document/Recovery.h"
#include "ui/document/Workspace.h"
#include "ui/select/EditDock.h"
#include "ui/select/Selection.h"
#include "ui/view/Viewport.h"
#include "ui/window/MainMenu.h"
#include "ui/window/RecoveryList.h"

#include <QDir>
#include <QFile>
#include <QPushButton>
#include <QTreeWidget>

#include <functional>
#include <vector>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

class RecoveryTest : public QObject
{
    Q_OBJECT
private slots:
    /// What a program that was killed leaves is offered when the file is opened again, and done again.
    void editsComeBackAfterACrash()
    {
        const QTemporaryDir folder;
        const QString file = folder.filePath(QStringLiteral("a.laz")),
                      settings = folder.filePath(QStringLiteral("s.ini"));
        const QDir journals(folder.filePath(QStringLiteral("journals")));
        QVERIFY(QFile::copy(surveyFile(), file));
        const auto found = [&] { return journals.entryList({QStringLiteral("*.journal")}, QDir::Files); };
        std::vector<double> expected;
        const QString kept = folder.filePath(QStringLiteral("kept"));
        QString name;
        {
            Bench b(settings);
            QVERIFY(b.begin(Tool::Rectangle, file));
            QVERIFY(found().isEmpty());  // nothing has been done yet
            b.drag(b.at(0.3, 0.3), b.at(0.6, 0.6));
            QVERIFY(b.done());
            QVERIFY(b.runEdit([&] { b.key(Qt::Key_6); }));
            QVERIFY(b.runEdit([&] { b.window->editDock().setClass(9, 6); }));
            QTest::keyClick(&b.view(), Qt::Key_Z, Qt::ControlModifier);
            QVERIFY(waitFor([&] { return b.document->history().position() == 1; }) && b.done());
            const Attribute classes = *b.document->findAttribute(QStringLiteral("Classification"));
            for (PointIndex i = 0; i < b.document->points(); ++i) expected.push_back(classes.number(i));
            QCOMPARE(found().size(), 1);
            name = found().front();
            QVERIFY(QFile::copy(journals.filePath(name), kept));  // the moment of the crash
        }
        QVERIFY(found().isEmpty());  // that end was in order
        QVERIFY(QFile::copy(kept, journals.filePath(name)));
        {
            Bench b(settings);
            QString told;
            b.window->workspace().recovery().ask = [&](const Question& question,
                                                       const std::function<void(RecoveryAnswer)>& answer) {
                told = question.reason;
                answer(RecoveryAnswer::Recover);
            };
            QVERIFY(b.begin(Tool::None, file));
            QVERIFY(waitFor([&] { return b.document->history().position() == 1; }) && b.done());
            QVERIFY2(told.contains(QLatin1String("this edit of a.laz")), qPrintable(told));
            QVERIFY2(told.contains(QLatin1String("Set Classification = 6")), qPrintable(told));
            const Attribute classes = *b.document->findAttribute(QStringLiteral("Classification"));
            for (PointIndex i = 0; i < b.document->points(); ++i) QCOMPARE(classes.number(i), expected[i]);
            QVERIFY(b.window->isWindowModified());
            QCOMPARE(found().size(), 1);
            b.window->save();  // then there is nothing to recover
            QVERIFY(waitFor([&] { return found().isEmpty(); }) && b.done());
            QVERIFY(!b.window->isWindowModified());
        }
        // the journal is of the file as it was: of the one that was saved it is not
        QVERIFY(QFile::copy(kept, journals.filePath(name)));
        Bench b(settings);
        b.window->workspace().recovery().ask = [](const Question&, const std::function<void(RecoveryAnswer)>&) {
            QFAIL("asked for another file");
        };
        QVERIFY(b.begin(Tool::None, file));
        QVERIFY(b.done());
        QCOMPARE(b.document->history().position(), std::size_t(0));
    }

    /// Asked later, nothing is lost; set aside, the window gives it back.
    void unsavedEditsWaitOrAreHadBack()
    {
        const QTemporaryDir folder;
        const QString file = folder.filePath(QStringLiteral("a.laz")),
                      other = folder.filePath(QStringLiteral("b.laz")),
                      settings = folder.filePath(QStringLiteral("s.ini"));
        const QDir journals(folder.filePath(QStringLiteral("journals")));
        QVERIFY(QFile::copy(surveyFile(), file));
        writeSurvey(other, 1000);
        const auto found = [&](const QString& ending) {
            return journals.entryList({QStringLiteral("*.") + ending}, QDir::Files);
        };
        const QString kept = folder.filePath(QStringLiteral("kept"));
        QString name;
        {
            Bench b(settings);
            QVERIFY(b.begin(Tool::Rectangle, file));
            b.drag(b.at(0.3, 0.3), b.at(0.6, 0.6));
            QVERIFY(b.done());
            QVERIFY(b.runEdit([&] { b.key(Qt::Key_6); }));
            name = found(QStringLiteral("journal")).front();
            QVERIFY(QFile::copy(journals.filePath(name), kept));  // the moment of the crash
        }
        QVERIFY(QFile::copy(kept, journals.filePath(name)));
        {
            Bench b(settings);
            const auto box = [] {
                for (QWidget* widget : QApplication::topLevelWidgets())
                    if (widget->isVisible() && widget->objectName() == QStringLiteral("recoveryQuestion"))
                        return widget;
                return static_cast<QWidget*>(nullptr);
            };
            b.document = b.open(file);
            QVERIFY(b.document && waitFor([&] { return box() != nullptr; }));
            QTest::keyClick(box(), Qt::Key_Escape);
            QVERIFY(waitFor([&] { return box() == nullptr; }) && b.done());
            QCOMPARE(b.document->history().position(), std::size_t(0));
            QCOMPARE(found(QStringLiteral("journal")), QStringList{name});
            b.window->workspace().close(*b.document);
            QVERIFY(b.done());
            QCOMPARE(found(QStringLiteral("journal")), QStringList{name});  // it waits still

            // asked again, and set aside
            b.window->workspace().recovery().ask = [](const Question&,
                                                      const std::function<void(RecoveryAnswer)>& answer) {
                answer(RecoveryAnswer::SetAside);
            };
            QVERIFY(b.open(file));
            QVERIFY(waitFor([&] { return found(QStringLiteral("declined")).size() == 1; }) && b.done());
            QVERIFY(found(QStringLiteral("journal")).isEmpty());
        }
        Bench b(settings);
        b.window->workspace().recovery().ask = [](const Question&, const std::function<void(RecoveryAnswer)>&) {
            QFAIL("asked for what was set aside");
        };
        QVERIFY(b.begin(Tool::None, other));
        auto* action = b.window->findChild<QAction*>(QStringLiteral("recoverEdits"));
        QVERIFY(action && action->isEnabled());
        action->trigger();
        auto* list = b.window->findChild<RecoveryList*>();
        QVERIFY(list && waitFor([&] { return list->list().topLevelItemCount() == 1; }));
        QCOMPARE(list->list().topLevelItem(0)->text(0), QStringLiteral("a.laz"));
        QVERIFY(list->list().topLevelItem(0)->text(1).contains(QStringLiteral("Classification = 6")));
        QTest::mouseClick(&list->recoverButton(), Qt::LeftButton);
        QVERIFY(waitFor([&] { return b.window->workspace().documents().size() == 2; }));
        b.document = b.window->workspace().documents()[1];
        QVERIFY(waitFor([&] { return b.document->history().position() == 1; }) && b.done());
        QCOMPARE(b.document->path(), file);
        QVERIFY(b.document->modified());
        // it is noted on from there, as the journal of what is not saved
        QVERIFY(found(QStringLiteral("declined")).isEmpty());
        QCOMPARE(found(QStringLiteral("journal")), QStringList{name});
    }

    /// Saved, undone beyond that, and crashed: the journal is of the file that was saved, and leads to what was
    /// seen.
    void undoneSavesComeBackAfterACrash()
    {
        const QTemporaryDir folder;
        const QString file = folder.filePath(QStringLiteral("a.laz"));
        QVERIFY(QFile::copy(surveyFile(), file));
        Bench b(folder.filePath(QStringLiteral("s.ini")));
        QVERIFY(b.begin(Tool::Rectangle, file));
        b.drag(b.at(0.3, 0.3), b.at(0.6, 0.6));
        QVERIFY(b.done());
        QVERIFY(b.runEdit([&] { b.key(Qt::Key_6); }));
        b.window->save();
        QVERIFY(waitFor([&] { return !b.window->isWindowModified(); }) && b.done());
        QTest::keyClick(&b.view(), Qt::Key_Z, Qt::ControlModifier);
        QVERIFY(waitFor([&] { return b.document->history().position() == 0; }) && b.done());
        const QDir journals(folder.filePath(QStringLiteral("journals")));
        const QStringList found = journals.entryList({QStringLiteral("*.journal")}, QDir::Files);
        QCOMPARE(found.size(), 1);
        Progress progress;
        const auto reopened = las::load(file.toStdString(), progress);
        History history(reopened);
        const JournalContents journal = readJournal(journals.filePath(found.front()).toStdString());
        QCOMPARE(journal.inForce(), std::vector<std::string>{"Undo Set Classification = 6"});
        QCOMPARE(replay(journal, *reopened, history, progress).stopped, std::string());
        const Attribute& is = *reopened->findAttribute("Classification");
        const Attribute expected = *b.document->findAttribute(QStringLiteral("Classification"));
        for (PointIndex i = 0; i < reopened->size(); ++i) QCOMPARE(is.number(i), expected.number(i));
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<RecoveryTest>(); });
}
#include "RecoveryTest.moc"
