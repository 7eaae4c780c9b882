// SPDX-License-Identifier: MIT
// The journal beside a file that is saved again and again: undoing goes beyond what was saved, the point format
// changes, and a program that is killed at any moment loses nothing. Called with --edit, the test is that program.
#include "core/Error.h"
#include "core/edit/History.h"
#include "core/edit/Journal.h"
#include "core/session/Session.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"

#include <QProcess>
#include <QTemporaryDir>
#include <QTest>

#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <random>

using namespace punctum;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kPoints = 3001;
constexpr std::uint8_t kFormat = 1;

void makeFile(const fs::path& path)
{
    const std::uint16_t length = lasfiles::recordLength(kFormat);
    lasfiles::writeFile(path,
                        lasfiles::file(lasfiles::header(lasfiles::minorFor(kFormat), kFormat, length, kPoints), {},
                                       lasfiles::randomRecords(kFormat, length, kPoints, 8)));
}

/// A file that is edited and saved in its place, with a journal of what is not saved, or without.
struct Work {
    fs::path path;
    fs::path journals;  ///< empty: none are kept
    Progress progress{};
    std::shared_ptr<Session> session = opened();

    std::shared_ptr<Session> opened()
    {
        HistoryRoom room;
        room.folder = journals;
        auto result = Session::open(path, room);
        result->read(progress);
        return result;
    }
    const PointCloud& cloud() const { return *session->cloud(); }
    void run(const Recipe& recipe) { session->edit(recipe, progress); }
    void undo() { session->undo(progress); }
    void redo() { session->redo(progress); }
    void save()
    {
        las::WriteOptions options;
        options.upgrade = true;
        session->save({path, options, false, {}}, progress);
    }
    /// Why a crash would lose edits; empty: it would not.
    std::string failure() const
    {
        const auto warnings = session->takeWarnings();
        if (!warnings.empty()) return warnings.front();
        const auto journal = session->history().journal();
        return journal ? journal->failure() : std::string();
    }
};

/// What a program finds that opens the file after a crash.
std::shared_ptr<PointCloud> recovered(const Work& work, std::string& trouble)
{
    // the journal stays for the one that is killed: this one looks at a copy
    const QTemporaryDir copies;
    const fs::path folder = copies.path().toStdString();
    if (fs::exists(work.journals)) fs::copy(work.journals, folder, fs::copy_options::recursive);
    Work again{work.path, folder};
    const auto journal = again.session->findJournal(again.progress);
    if (journal) trouble = again.session->recover(*journal, again.progress).stopped;
    return again.session->cloud();
}

/// Where they differ but for what the point format alone decides; empty: nowhere.
std::string difference(const PointCloud& expected, const PointCloud& got)
{
    if (expected.size() != got.size()) return "size";
    const auto deletedOf = [](const PointCloud& cloud) {
        return cloud.deleted() ? *cloud.deleted() : PointSet(cloud.size());
    };
    if (deletedOf(expected) != deletedOf(got)) return "deleted points";
    const auto onlyExtended = [](const std::string& name) { return name == "Overlap" || name == "ScannerChannel"; };
    for (const Attribute& a : got.attributes())
        if (expected.findAttribute(a.name) == nullptr && !onlyExtended(a.name)) return a.name + " too much";
    for (const Attribute& a : expected.attributes()) {
        const Attribute* const b = got.findAttribute(a.name);
        if (b == nullptr && onlyExtended(a.name)) continue;
        if (b == nullptr || b->components != a.components) return a.name + " missing";
        if (a.scaled != b->scaled) continue;  // the scan angle, in degrees or finer
        if (a.kind != b->kind || a.type() != b->type() || a.scale != b->scale) return a.name + " of another kind";
        const std::size_t bytes = a.columns[0]->elementBytes();
        const auto same = [&](PointIndex i, std::uint32_t c) {  // to the bit, where it is no field of bits
            if (a.bitWidth != 0 || b->bitWidth != 0) return a.value(i) == b->value(i);
            return std::memcmp(a.columns[c]->data() + i * bytes, b->columns[c]->data() + i * bytes, bytes) == 0;
        };
        for (PointIndex i = 0; i < expected.size(); ++i)
            for (std::uint32_t c = 0; c < a.components; ++c)
                if (!same(i, c)) return a.name + " of point " + std::to_string(i);
    }
    return {};
}

std::shared_ptr<PointSet> randomPoints(std::mt19937_64& random)
{
    auto points = std::make_shared<PointSet>(kPoints);
    const bool runs = random() % 2 == 0;
    for (PointIndex i = random() % 50; i < kPoints; i += 1 + random() % (runs ? 3 : 400)) points->insert(i);
    return points;
}

Recipe randomRecipe(std::mt19937_64& random)
{
    const char* const names[] = {"Extra", "Other"};
    const std::size_t one = random() % 2;
    switch (random() % 10) {
        case 0:
        case 1:
            return {"set", {{"rule", "Classification = " + std::to_string(random() % 32)}}, randomPoints(random)};
        case 2:
            return {"reclassify",
                    {{"attribute", "Intensity"},
                     {"min", "0"},
                     {"max", std::to_string(random() % 65000)},
                     {"class", std::to_string(random() % 60)}},
                    nullptr};
        case 3:
            return {"set", {{"rule", "Intensity = Intensity / 2 + " + std::to_string(random() % 9)}}, nullptr};
        case 4:
            return {"set", {{"rule", "Withheld = 1 - Withheld"}}, randomPoints(random)};
        case 5:
        case 6:
            return {"set",
                    {{"rule", names[one] + (" = Intensity % 97 * " + std::to_string(random() % 600))},
                     {"new", one == 0 ? "uint16" : "float64"}},
                    nullptr};
        case 7:
            return {"rename", {{"attribute", names[one]}, {"to", names[1 - one]}}, nullptr};
        case 8:
            return {"remove", {{"attribute", names[one]}}, nullptr};
        default:
            if (random() % 2 == 0) return {"restore", {}, nullptr};
            return {"delete", {}, randomPoints(random)};
    }
}

/// The k-th of a row of random edits and saves.
void act(Work& session, std::uint64_t seed, int k)
{
    std::mt19937_64 random(seed * 10'000 + std::uint64_t(k));
    const auto kind = random() % 100;
    try {
        if (kind < 32)
            session.undo();
        else if (kind < 44)
            session.redo();
        else if (kind < 56) {
            // what a file lacks cannot be noted when it is restored
            if (!session.cloud().deleted()) session.save();
        } else
            session.run(randomRecipe(random));
    } catch (const Error& e) {
        const std::string_view text = e.what();
        const bool expected = text.find("no attribute") != std::string_view::npos ||
                              text.find("already") != std::string_view::npos ||
                              text.find("choose another") != std::string_view::npos;
        if (!expected) throw;  // names that are not there, or there already, are no edits
    }
}

/// Edits until it is killed, and says after each edit that it is there.
int editForever(const char* path, const char* journals, std::uint64_t seed)
{
    Work session{path, journals};
    for (int k = 0;; ++k) {
        act(session, seed, k);
        if (const std::string failure = session.failure(); !failure.empty()) {
            qWarning("%d: %s", k, failure.c_str());
            return 2;
        }
        if (::write(STDOUT_FILENO, ".", 1) != 1) return 1;
    }
}

}  // namespace

class JournalSaveTest : public QObject
{
    Q_OBJECT
private slots:
    void init()
    {
        m_folder = std::make_unique<QTemporaryDir>();
        m_path = fs::path(m_folder->path().toStdString()) / "a.las";
        makeFile(m_path);
    }

    /// Without a crash: after each edit, another program that opens the file would find the same.
    void eachStateComesBack()
    {
        for (std::uint64_t seed = 1; seed <= 4; ++seed) {
            makeFile(m_path);
            Work session{m_path, journals(seed)};
            for (int k = 0; k < 150; ++k) {
                act(session, seed, k);
                QCOMPARE(session.failure(), std::string());
                std::string trouble;
                const auto got = recovered(session, trouble);
                QCOMPARE(trouble, std::string());
                const std::string where = difference(session.cloud(), *got);
                QVERIFY2(where.empty(), qPrintable(QStringLiteral("%1: seed %2, edit %3")
                                                       .arg(QString::fromStdString(where))
                                                       .arg(seed)
                                                       .arg(k)));
            }
        }
    }

    void theKeyIsOfTheFileThatWasWritten()
    {
        Work session{m_path, journals(0)};
        session.run({"set", {{"rule", "Classification = 40"}}, nullptr});
        session.save();
        QCOMPARE(int(lasfiles::load(m_path)->source()->layout.format), 6);
        const CloudKey key = keyOfFile(session.cloud(), session.progress);
        QVERIFY(key == keyOf(*lasfiles::load(m_path), session.progress));
        QVERIFY(!(key == keyOf(session.cloud(), session.progress)));
        // and where points were left out as well
        auto some = std::make_shared<PointSet>(kPoints);
        for (PointIndex i = 100; i < 200; ++i) some->insert(i);
        session.run({"delete", {}, some});
        session.save();
        QVERIFY(keyOfFile(session.cloud(), session.progress) == keyOf(*lasfiles::load(m_path), session.progress));
        session.run({"set", {{"rule", "Classification = 50 if Intensity > 30000"}}, nullptr});
        std::string trouble;
        const auto got = recovered(session, trouble);
        QCOMPARE(trouble, std::string());
        QCOMPARE(got->size(), PointIndex(kPoints - 100));
        for (PointIndex i = 0; i < got->size(); ++i)
            QCOMPARE(got->findAttribute("Classification")->number(i),
                     session.cloud().findAttribute("Classification")->number(i < 100 ? i : i + 100));
        // a file that somebody else has changed is not the one that was saved
        session.save();
        makeFile(m_path);
        QVERIFY_THROWS_EXCEPTION(Error, keyOfFile(session.cloud(), session.progress));
    }

    /// Points that the file lacks: what restores them has no entry, and nothing while they are restored.
    void aGapEndsWithWhatMadeIt()
    {
        Work session{m_path, journals(0)};
        auto some = std::make_shared<PointSet>(kPoints);
        for (PointIndex i = 100; i < 200; ++i) some->insert(i);
        session.run({"set", {{"rule", "UserData = 3"}}, nullptr});
        session.run({"delete", {}, some});
        session.save();
        const auto entries = [&] {
            return readJournal(session.session->history().journal()->path()).entries.size();
        };
        session.undo();
        QVERIFY(session.failure().find("were deleted when the file was saved") != std::string::npos);
        QCOMPARE(entries(), std::size_t(0));
        session.undo();
        session.redo();
        QVERIFY(!session.failure().empty());
        session.redo();
        QCOMPARE(session.failure(), std::string());
        session.run({"set", {{"rule", "UserData = 4"}}, nullptr});
        QCOMPARE(entries(), std::size_t(1));
        std::string trouble;
        QCOMPARE(recovered(session, trouble)->findAttribute("UserData")->number(150), 4.0);
        QCOMPARE(trouble, std::string());
    }

    void killedAtRandomMomentsNothingIsLost()
    {
        std::mt19937_64 random(std::random_device{}());
        std::size_t most = 0;
        for (std::uint64_t round = 0; round < 40; ++round) {
            makeFile(m_path);
            const Work found{m_path, journals(round)};
            QProcess child;
            child.setProcessChannelMode(QProcess::ForwardedErrorChannel);
            child.start(QCoreApplication::applicationFilePath(),
                        {QStringLiteral("--edit"), QString::fromStdString(found.path.string()),
                         QString::fromStdString(found.journals.string()), QString::number(round)});
            QVERIFY(child.waitForReadyRead(30'000));
            QTest::qSleep(int(random() % 25));
            ::kill(pid_t(child.processId()), SIGKILL);
            child.waitForFinished();
            QCOMPARE(child.exitStatus(), QProcess::CrashExit);
            const auto said = int(child.readAllStandardOutput().size());

            std::string trouble;
            const auto got = recovered(found, trouble);
            QCOMPARE(trouble, std::string());
            const fs::path copy = m_path.parent_path() / "b.las";
            makeFile(copy);
            Work expected{copy, {}};
            for (int k = 0; k < said; ++k) act(expected, round, k);
            std::string where = difference(expected.cloud(), *got);
            if (!where.empty()) {  // what was begun when it was killed may be there, too
                act(expected, round, said);
                where = difference(expected.cloud(), *got);
            }
            QVERIFY2(where.empty(), qPrintable(QStringLiteral("%1: round %2, after %3 edits")
                                                   .arg(QString::fromStdString(where))
                                                   .arg(round)
                                                   .arg(said)));
            most = std::max(most, std::size_t(said));
        }
        qInfo("up to %zu edits and saves before the kill", most);
        QVERIFY(most > 10);
    }

private:
    fs::path journals(std::uint64_t n) const { return m_path.parent_path() / std::to_string(n); }

    std::unique_ptr<QTemporaryDir> m_folder;
    fs::path m_path;
};

int main(int argc, char** argv)
{
    if (argc == 5 && std::string_view(argv[1]) == "--edit")
        return editForever(argv[2], argv[3], std::strtoull(argv[4], nullptr, 10));
    QCoreApplication application(argc, argv);
    JournalSaveTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "JournalSaveTest.moc"
