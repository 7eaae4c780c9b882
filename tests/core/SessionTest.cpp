// SPDX-License-Identifier: MIT
// What is open, edited, saved and recovered through a session: who may lose what, and when.
#include "core/edit/Journal.h"
#include "core/session/KeptJournals.h"
#include "core/session/Session.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <atomic>
#include <thread>

using namespace punctum;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kPoints = 5000;

Recipe setClass(int value, std::shared_ptr<const PointSet> within = nullptr)
{
    return {"set", {{"rule", "Classification = " + std::to_string(value)}}, std::move(within)};
}

}  // namespace

class SessionTest : public QObject
{
    Q_OBJECT
private slots:
    void init()
    {
        m_folder = std::make_unique<QTemporaryDir>();
        m_path = place("a.las");
        const std::uint16_t length = lasfiles::recordLength(1);
        lasfiles::writeFile(m_path, lasfiles::file(lasfiles::header(lasfiles::minorFor(1), 1, length, kPoints), {},
                                                   lasfiles::randomRecords(1, length, kPoints, 4)));
    }

    /// What a save makes goes by what was seen before, as long as nobody edited since.
    void aSaveGoesByItsForecast()
    {
        const auto session = opened();
        session->edit(setClass(5), m_progress);
        const Forecast forecast = session->foresee(m_path, m_progress);
        QVERIFY(forecast.preview.plan);
        session->unsavedChanges(m_progress);
        QVERIFY(session->foresee(m_path, m_progress).preview.plan == forecast.preview.plan);
        session->edit({"delete", {{"where", "UserData > 100"}}, nullptr}, m_progress);
        QVERIFY(session->foresee(m_path, m_progress).preview.plan != forecast.preview.plan);
        session->undo(m_progress);
        SaveRequest request{.target = m_path};
        request.forecast = forecast;
        const SaveOutcome outcome = session->save(std::move(request), m_progress);
        QCOMPARE(outcome.report.points, PointIndex(kPoints));
        QVERIFY(outcome.compared);
    }

    void editsAreUndoneAndSaved()
    {
        const auto session = opened();
        const lasfiles::Bytes before = lasfiles::readFile(m_path);
        QCOMPARE(session->path(), m_path);
        const EditOutcome edit = session->edit(setClass(5), m_progress);
        QVERIFY(edit.changed > kPoints / 2);
        QVERIFY(session->edit(setClass(5), m_progress).changed == 0);  // nothing to do is no step
        QCOMPARE(session->history().position(), std::size_t(1));
        QVERIFY(session->unsavedChanges(m_progress).find("Classification") != std::string::npos);
        const EditOutcome added =
            session->edit({"set", {{"rule", "Twice = Intensity * 2"}, {"new", "uint32"}}, nullptr}, m_progress);
        QCOMPARE(added.changed, PointIndex(kPoints));
        QCOMPARE(added.newAttributes, std::vector<std::string>{"Twice"});
        session->undo(m_progress);
        session->undo(m_progress);
        session->undo(m_progress);  // no more
        QVERIFY(!session->history().modified());
        QCOMPARE(session->unsavedChanges(m_progress), std::string());
        session->walk(2, m_progress);
        QVERIFY(session->cloud()->findAttribute("Twice") != nullptr);
        session->walk(1, m_progress);
        session->redo(m_progress);
        session->undo(m_progress);

        const SaveOutcome saved = session->save({place("b.las"), {}, true, {}}, m_progress);
        QVERIFY(saved.compared && !saved.disturbed);
        QCOMPARE(saved.preview.difference.attributes.size(), std::size_t(1));
        QCOMPARE(session->path(), place("b.las"));
        QCOMPARE(session->openedPath(), m_path);
        QVERIFY(!session->history().modified());
        QVERIFY(lasfiles::readFile(m_path) == before);
        // a forecast of before an edit is not believed
        Forecast old = session->foresee(place("c.las"), m_progress);
        QVERIFY(old.preview.difference.attributes.empty());
        session->edit({"set", {{"rule", "UserData = 9"}}, nullptr}, m_progress);
        const SaveOutcome again = session->save({place("c.las"), {}, true, std::move(old)}, m_progress);
        QVERIFY(again.compared);
        QCOMPARE(again.preview.difference.attributes[0].name, std::string("UserData"));
    }

    /// Deleted points get no values that anybody sees.
    void newAttributesCountNoDeletedPoints()
    {
        const auto session = opened();
        const Recipe twice{"set", {{"rule", "Twice = Intensity * 2"}, {"new", "uint32"}}, nullptr};
        const PointIndex gone =
            session->edit({"delete", {{"where", "UserData > 100"}}, nullptr}, m_progress).changed;
        QVERIFY(gone > 0 && gone < kPoints);
        QCOMPARE(session->edit(twice, m_progress).changed, kPoints - gone);
        QCOMPARE(session->history().changedPoints().back(), kPoints - gone);
        // the same after it was undone and done again
        session->walk(0, m_progress);
        session->walk(2, m_progress);
        QCOMPARE(session->history().changedPoints().back(), kPoints - gone);
        QCOMPARE(session->edit({"normals", {}, nullptr}, m_progress).changed, kPoints - gone);
        session->walk(0, m_progress);
        QCOMPARE(session->edit(twice, m_progress).changed, PointIndex(kPoints));
    }

    void aHistoryThatKeepsNothingStillKnowsThatPointsChanged()
    {
        HistoryRoom room;
        room.undo = false;
        const auto session = Session::open(m_path, room);
        session->read(m_progress);
        session->edit(setClass(5), m_progress);
        QVERIFY(session->history().modified());
        QVERIFY(!session->history().canUndo());
        QCOMPARE(session->history().kept().memory, std::size_t(0));
        session->save({place("b.las"), {}, false, {}}, m_progress);
        QVERIFY(!session->history().modified());
        session->edit(setClass(6), m_progress);
        QVERIFY(session->history().modified());
    }

    void damagedFilesAreNotReplaced()
    {
        lasfiles::Bytes bytes = lasfiles::readFile(m_path);
        bytes.resize(bytes.size() / 2);
        lasfiles::writeFile(m_path, bytes);
        fs::create_hard_link(m_path, place("same.las"));
        const auto session = opened();
        QVERIFY(session->damaged());
        for (const fs::path& target : {m_path, place("same.las")}) {
            QVERIFY(complaint([&] {
                        session->save({target, {}}, m_progress);
                    }).find("under another name") != std::string::npos);
            QVERIFY(lasfiles::readFile(target) == bytes);
        }
        session->save({place("b.las"), {}}, m_progress);
        QVERIFY(fs::exists(place("b.las")));
    }

    void partsAreNotWrittenOverTheWhole()
    {
        const auto session = opened();
        PointSet some(kPoints);
        for (PointIndex i = 10; i < 30; ++i) some.insert(i);
        for (const fs::path& target : {m_path, m_path.parent_path() / "." / "a.las"})
            QVERIFY(complaint([&] { session->extract(some, target, {}, m_progress); }).find("would be lost") !=
                    std::string::npos);
        QCOMPARE(session->extract(some, place("part.laz"), {}, m_progress).points, PointIndex(20));
        QCOMPARE(session->path(), m_path);
        session->save({place("b.las"), {}}, m_progress);
        QVERIFY(complaint([&] { session->extract(some, place("b.las"), {}, m_progress); }).find("would be lost") !=
                std::string::npos);
    }

    /// Edits that come while the file is written: it is not called saved unless it has them all.
    void savesBesideEditsMissNone()
    {
        const auto session = opened();
        std::atomic<bool> ended{false};
        std::thread editor([&] {
            Progress progress;
            for (int k = 0; !ended; ++k) session->edit(setClass(k % 30), progress);
        });
        int disturbed = 0;
        for (int k = 0; k < 20; ++k) {
            const SaveOutcome saved = session->save({place("b.laz"), {}, k % 2 == 0, {}}, m_progress);
            disturbed += saved.disturbed ? 1 : 0;
        }
        ended = true;
        editor.join();
        QVERIFY2(disturbed > 0, "no edit came in between: nothing was tried");
        session->save({place("b.laz"), {}, false, {}}, m_progress);
        QVERIFY(!session->history().modified());
        Progress progress;
        const auto file = las::load(place("b.laz"), progress);
        for (PointIndex i = 0; i < kPoints; ++i)
            QCOMPARE(file->findAttribute("Classification")->number(i),
                     session->cloud()->findAttribute("Classification")->number(i));
    }

    void journalsAreFoundFollowedAndSetAside()
    {
        const auto crash = [&] {  // one that does not close
            const auto session = opened(true);
            session->edit(setClass(7), m_progress);
            session->edit({"set", {{"rule", "UserData = 1"}}, nullptr}, m_progress);
            session->undo(m_progress);
            QVERIFY(session->takeWarnings().empty());
        };
        crash();
        QCOMPARE(keptJournals(place("journals"), m_progress).size(), std::size_t(1));
        {
            const auto session = opened(true);
            auto journal = session->findJournal(m_progress);
            QVERIFY(journal.has_value());
            QCOMPARE(journal->contents.inForce(), std::vector<std::string>{"Set Classification = 7"});
            QCOMPARE(session->recover(*journal, m_progress).stopped, std::string());
            QCOMPARE(session->cloud()->findAttribute("Classification")->number(17), 7.0);
            QVERIFY(session->history().canRedo());
            QVERIFY(keptJournals(place("journals"), m_progress).empty());  // in use
            // it is gone on with
            session->edit({"set", {{"rule", "UserData = 2"}}, nullptr}, m_progress);
        }
        auto kept = keptJournals(place("journals"), m_progress);
        QCOMPARE(kept.size(), std::size_t(1));
        QCOMPARE(kept[0].edits.size(), std::size_t(2));
        QCOMPARE(kept[0].files, std::vector{m_path});
        {
            const auto session = opened(true);
            const auto journal = session->findJournal(m_progress);
            session->setAside(journal->path);
            QVERIFY(!session->findJournal(m_progress));
            kept = keptJournals(place("journals"), m_progress);
            QVERIFY(kept.size() == 1 && kept[0].setAside);
            // edited first: it cannot be followed, and says so
            session->edit(setClass(9), m_progress);
            const FoundJournal late{kept[0].path, readJournal(kept[0].path)};
            QVERIFY(complaint([&] { session->recover(late, m_progress); }).find("edited first") !=
                    std::string::npos);
            session->close();
        }
        QCOMPARE(keptJournals(place("journals"), m_progress).size(), std::size_t(1));  // the one set aside
        {
            const auto session = opened(true);
            const FoundJournal late{kept[0].path, readJournal(kept[0].path)};
            QCOMPARE(session->recover(late, m_progress).entries, late.contents.entries.size());
            session->close();
        }
        QVERIFY(keptJournals(place("journals"), m_progress).empty());
    }

    void whatKeepsAJournalFromBeingKeptIsToldOnce()
    {
        lasfiles::writeFile(place("journals"), {});  // no folder
        const auto session = opened(true);
        session->edit(setClass(3), m_progress);
        const auto warnings = session->takeWarnings();
        QCOMPARE(warnings.size(), std::size_t(1));
        QVERIFY(warnings[0].starts_with("A crash would lose the edits"));
        session->edit(setClass(4), m_progress);
        QVERIFY(session->takeWarnings().empty());
    }

    void whatIsCancelledChangesNothing()
    {
        const auto session = opened(true);
        Progress cancelled;
        cancelled.cancel();
        QVERIFY_THROWS_EXCEPTION(Cancelled, session->edit(setClass(5), cancelled));
        QVERIFY_THROWS_EXCEPTION(Cancelled, session->save({place("b.las"), {}}, cancelled));
        QVERIFY(!session->history().modified());
        QVERIFY(!fs::exists(place("b.las")));
        session->edit(setClass(5), m_progress);
        QVERIFY_THROWS_EXCEPTION(Cancelled, session->walk(0, cancelled));
        QCOMPARE(session->history().position(), std::size_t(1));
    }

private:
    fs::path place(const char* name) const { return fs::path(m_folder->path().toStdString()) / name; }
    std::shared_ptr<Session> opened(bool journal = false)
    {
        HistoryRoom room;
        if (journal) room.folder = place("journals");
        auto session = Session::open(m_path, room);
        session->read(m_progress);
        return session;
    }

    std::unique_ptr<QTemporaryDir> m_folder;
    fs::path m_path;
    Progress m_progress;
};

QTEST_GUILESS_MAIN(SessionTest)
#include "SessionTest.moc"
