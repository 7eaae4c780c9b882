// SPDX-License-Identifier: MIT
// The journal: what it keeps comes back, damage is found and told, and a program that is killed at any moment loses
// nothing that it had finished. Called with --edit, the test is that program.
#include "core/edit/Journal.h"

#include "core/Error.h"
#include "core/SummedText.h"
#include "core/edit/History.h"
#include "core/edit/ListCommand.h"
#include "core/edit/Literal.h"
#include "core/edit/PackedSet.h"
#include "core/edit/PackedValues.h"
#include "core/steps/MakeCommand.h"
#include "core/steps/Replay.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/CutSpillFile.h"
#include "tests/core/JournalCloud.h"

#include <QProcess>
#include <QTemporaryDir>
#include <QTest>

#include <fcntl.h>
#include <signal.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>

using namespace punctum;

namespace
{

/// The cloud, edited from its beginning with a journal beside it.
struct Edited {
    QTemporaryDir folder{};
    std::string path = folder.filePath(QStringLiteral("a.journal")).toStdString();
    std::shared_ptr<PointCloud> cloud = makeCloud();
    History history{cloud};
    Progress progress{};

    explicit Edited(const std::string& file = "a") { begin(file); }
    void begin(const std::string& file)
    {
        history.setJournal(Journal::create(path, keyOf(*cloud, progress), file));
    }
};

/// The k-th of a row of random edits; nothing for an undo (1) or redo (2).
struct Edit {
    int kind = 0;
    Recipe recipe;
};
Edit editOf(std::uint64_t seed, int k)
{
    std::mt19937_64 random(seed * 1000 + std::uint64_t(k));
    Edit edit;
    edit.kind = random() % 8 == 0 ? 1 : random() % 8 == 0 ? 2 : 0;
    const auto set = [&] {
        auto points = std::make_shared<PointSet>(kPoints);
        const bool runs = random() % 2 == 0;
        for (PointIndex i = random() % 50; i < kPoints; i += 1 + random() % (runs ? 3 : 400)) points->insert(i);
        return points;
    };
    edit.recipe.step = "set";
    switch (random() % 6) {
        case 0:
            edit.recipe.values["rule"] = "Classification = " + std::to_string(random() % 32);
            edit.recipe.within = set();
            break;
        case 1:
            edit.recipe.values["rule"] =
                "Intensity = Intensity + 1 if Z > " + std::to_string(random() % 10) + " and Intensity < 60000";
            break;
        case 2:
            edit.recipe.values["rule"] =
                "\"Big id\" = \"Big id\" * 3 % 1000003 + " + std::to_string(random() % 1000);
            edit.recipe.within = set();
            break;
        case 3:
            edit.recipe.step = "delete";
            edit.recipe.within = set();
            break;
        case 4:
            edit.recipe.step = random() % 2 == 0 ? "restore" : "delete";
            if (edit.recipe.step == "delete") edit.recipe.values["where"] = "Z < 0.1";
            break;
        default:
            edit.recipe.step = "reclassify";
            edit.recipe.values = {{"attribute", "Intensity"},
                                  {"min", "0"},
                                  {"max", std::to_string(random() % 65000)},
                                  {"class", std::to_string(random() % 32)}};
    }
    return edit;
}

/// Does an edit; false when it changed nothing, and so is no entry.
bool follow(History& history, const PointCloud& cloud, const Edit& edit)
{
    Progress progress;
    if (edit.kind == 1) {
        if (!history.canUndo()) return false;
        history.undo();
        return true;
    }
    if (edit.kind == 2) {
        if (!history.canRedo()) return false;
        history.redo();
        return true;
    }
    auto command = makeCommand(edit.recipe, cloud, progress);
    if (!command) return false;
    history.push(std::move(command));
    return true;
}

/// Edits until it is killed, and says after each entry that it is there.
int editForever(const char* path, std::uint64_t seed)
{
    const auto cloud = makeCloud();
    Progress progress;
    History history(cloud);
    history.setJournal(Journal::create(path, keyOf(*cloud, progress), "made"));
    for (int k = 0;; ++k)
        if (follow(history, *cloud, editOf(seed, k)) && ::write(STDOUT_FILENO, ".", 1) != 1) return 1;
}

std::string bytesOf(const std::string& path)
{
    std::ifstream in(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
}
void putBytes(const std::string& path, const std::string& bytes)
{
    std::ofstream(path, std::ios::binary) << bytes;
}

bool linksFail = false;

}  // namespace

/// Stands before the C library's: some disks have no hard links.
extern "C" int link(const char* from, const char* to) noexcept
{
    if (!linksFail) return ::linkat(AT_FDCWD, from, AT_FDCWD, to, 0);
    errno = EPERM;
    return -1;
}

class JournalTest : public QObject
{
    Q_OBJECT
private slots:
    void setsArePackedAndComeBack()
    {
        std::mt19937_64 random(2);
        for (const PointIndex size : {0u, 1u, 63u, 64u, 65u, 1000u, 100'003u})
            for (const unsigned sparse : {1u, 2u, 17u, 900u}) {
                PointSet points(size);
                for (PointIndex i = 0; i < size; ++i)
                    if (random() % sparse == 0) points.insert(i);
                const PackedSet packed(points);
                QVERIFY(packed.unpacked() == points);
                const auto back = PackedSet::fromText(packed.text(), size);
                QVERIFY(back && back->unpacked() == points);
                if (size > 0 && points.contains(size - 1)) QVERIFY(!PackedSet::fromText(packed.text(), size - 1));
            }
        for (const char* text : {"A", "====", "AA=A", "!!!!", "////", "gICAgICAgICAAQE="})
            QVERIFY2(!PackedSet::fromText(text, 100), text);
        PointSet all(1'000'000);
        for (PointIndex i = 0; i < all.size(); ++i) all.insert(i);
        QVERIFY(PackedSet(all).bytes() < 8);
    }

    void keysTellCloudsApart()
    {
        Progress progress;
        const CloudKey key = keyOf(*makeCloud(), progress);
        QVERIFY(keyOf(*makeCloud(), progress) == key);
        const auto other = makeCloud();
        rawAxis(*other, 1)[kPoints - 1] ^= 1;
        QVERIFY(!(keyOf(*other, progress) == key));
        const auto moved = makeFrame(3, {glm::dvec3(0.001), glm::dvec3(1.0, 0, 0)});
        QVERIFY(!(keyOf(*moved, progress) == keyOf(*makeFrame(3), progress)));
    }

    void whatWasDoneIsDoneAgain()
    {
        Edited edited("/some where/a%20b.las");
        auto& [folder, path, cloud, history, progress] = edited;
        QVERIFY(isJournalInUse(path));
        std::size_t entries = 0;
        for (int k = 0; k < 120; ++k) entries += follow(history, *cloud, editOf(3, k)) ? 1 : 0;
        QCOMPARE(history.journal()->failure(), std::string());
        QVERIFY(complaint([&path = path] { Journal::resume(path); }).find("another window") != std::string::npos);

        const JournalContents contents = readJournal(path);
        QCOMPARE(contents.damage, std::string());
        QCOMPARE(contents.entries.size(), entries);
        QCOMPARE(contents.file, std::string("/some where/a%20b.las"));
        auto names = history.names();
        names.resize(history.position());
        QVERIFY(contents.inForce() == names);

        const auto again = makeCloud();
        History second(again);
        const Replayed replayed = replay(contents, *again, second, progress);
        QCOMPARE(replayed.stopped, std::string());
        QCOMPARE(replayed.entries, entries);
        QVERIFY(snapshot(*again) == snapshot(*cloud));
        QCOMPARE(second.position(), history.position());
        while (second.canUndo()) second.undo();
        QVERIFY(snapshot(*again) == snapshot(*makeCloud()));
        QVERIFY(complaint([&, &cloud = cloud, &history = history, &progress = progress] {
                    replay(contents, *cloud, history, progress);
                }).find("another file") != std::string::npos);

        // it goes on where it ended
        history.setJournal(nullptr);
        {
            const auto third = makeCloud();
            History resumed(third);
            replay(contents, *third, resumed, progress);
            resumed.setJournal(Journal::resume(path));
            follow(resumed, *third, editOf(4, 1));
            const auto fourth = makeCloud();
            History last(fourth);
            replay(readJournal(path), *fourth, last, progress);
            QVERIFY(snapshot(*third) == snapshot(*fourth));
            resumed.journal()->remove();
        }
        QVERIFY(!std::filesystem::exists(path));
    }

    void stepsThatChangeOtherPointsAreToldApart()
    {
        Edited edited;
        auto& [folder, path, cloud, history, progress] = edited;
        follow(history, *cloud, {0, {"set", {{"rule", "Classification = 2 if Z > 5"}}, nullptr}});
        follow(history, *cloud, {0, {"set", {{"rule", "Classification = 3 if Z > 2"}}, nullptr}});
        JournalContents contents = readJournal(path);
        contents.entries[1].changed += 1;
        const auto again = makeCloud();
        History second(again);
        const Replayed replayed = replay(contents, *again, second, progress);
        QCOMPARE(replayed.entries, std::size_t(1));
        QVERIFY(replayed.stopped.find("cannot be done again") != std::string::npos);
        QCOMPARE(second.position(), std::size_t(1));
    }

    /// What is undone of before the journal began is told by values.
    void undoneSavesAreToldByValues()
    {
        Edited edited;
        auto& [folder, path, cloud, history, progress] = edited;
        const auto first = [&](History& h, const PointCloud& c) {
            follow(h, c, {0, {"set", {{"rule", "Classification = 2 if Z > 5"}}, nullptr}});
            follow(h, c, {0, {"delete", {{"where", "Z < 1"}}, nullptr}});
            follow(h, c, {0, {"restore", {}, nullptr}});
        };
        history.setJournal(nullptr);
        first(history, *cloud);
        history.markSaved();
        edited.begin("a");
        for (int k = 0; k < 3; ++k) history.undo();
        history.redo();
        follow(history, *cloud, {0, {"set", {{"rule", "Classification = 3 if Z > 5"}}, nullptr}});
        QCOMPARE(history.journal()->failure(), std::string());
        const JournalContents contents = readJournal(path);
        QVERIFY((contents.inForce() == std::vector<std::string>{"Undo Restore deleted points",
                                                                "Undo Delete where Z < 1",
                                                                "Set Classification = 3 if Z > 5"}));
        const auto saved = makeCloud();
        History second(saved);
        first(second, *saved);
        QCOMPARE(replay(contents, *saved, second, progress).stopped, std::string());
        QVERIFY(snapshot(*saved) == snapshot(*cloud));
        // gone on with, the journal knows its own commands
        history.setJournal(nullptr);
        second.setJournal(Journal::resume(path));
        const std::size_t entries = contents.entries.size();
        second.undo();
        QVERIFY(readJournal(path).entries[entries].kind == JournalEntry::Kind::Undo);
    }

    void damageIsFoundAndTold()
    {
        Edited edited;
        auto& [folder, path, cloud, history, progress] = edited;
        std::size_t entries = 0;
        for (int k = 0; k < 12; ++k) entries += follow(history, *cloud, editOf(7, k)) ? 1 : 0;
        history.setJournal(nullptr);
        const std::string whole = bytesOf(path);
        std::vector<std::size_t> ends;  // of lines
        for (std::size_t at = whole.find('\n'); at != std::string::npos; at = whole.find('\n', at + 1))
            ends.push_back(at + 1);
        QCOMPARE(ends.size(), entries + 2);
        const auto wholeLines = [&](std::size_t bytes) {
            return std::size_t(std::upper_bound(ends.begin(), ends.end(), bytes) - ends.begin());
        };
        std::mt19937_64 random(5);
        for (int round = 0; round < 600; ++round) {
            std::string broken = whole;
            const std::size_t at = random() % whole.size();
            const bool cut = round % 2 == 0;
            if (cut)
                broken.resize(at);
            else
                broken[at] = char(broken[at] ^ (1 << random() % 8));
            putBytes(path, broken);
            const std::size_t sound = wholeLines(at);
            if (sound < 2) {
                QVERIFY(complaint([&path = path] { readJournal(path); }) != "no error");
                continue;
            }
            const JournalContents contents = readJournal(path);
            QCOMPARE(contents.entries.size(), sound - 2);
            const bool clean = cut && ends[sound - 1] == at;  // cut between two lines: nothing to see
            QCOMPARE(contents.damage.empty(), clean);
            if (round % 20 != 0 || clean) continue;
            // it can be gone on with: the damage is cut off
            Journal::resume(path);
            QCOMPARE(bytesOf(path), whole.substr(0, ends[sound - 1]));
        }
        // a line that is missing or exchanged is found by the line behind it
        putBytes(path, whole.substr(0, ends[3]) + whole.substr(ends[4]));
        QCOMPARE(readJournal(path).entries.size(), std::size_t(2));
        QVERIFY(!readJournal(path).damage.empty());
        putBytes(path, "something else\n");
        QVERIFY(complaint([&path = path] { readJournal(path); }).find("no journal") != std::string::npos);
    }

    /// Whoever can write the file can give it any lines with the right sums.
    void countsThatNoCloudHasAreRefused()
    {
        const QTemporaryDir folder;
        const std::string path = folder.filePath(QStringLiteral("made.journal")).toStdString();
        const auto put = [&](PointIndex points, const std::vector<std::uint8_t>& runs) {
            std::uint32_t sum = 0;
            std::string text = summed(std::string(kJournalFirstLine), sum);
            text += summed(journalCloudLine({points, 1}, "a"), sum);
            text += summed("do 1 Name set rule=Classification%3d1 @" +
                               toBase64(std::as_bytes(std::span<const std::uint8_t>(runs))),
                           sum);
            putBytes(path, text);
        };
        const std::vector<std::uint8_t> farRun{0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0xFF, 0x7F, 1};  // at 2^49 - 1
        for (const PointIndex points : {~PointIndex(0), ~PointIndex(0) - 62, (PointIndex(1) << 40) + 1}) {
            put(points, farRun);
            QVERIFY(complaint([&path = path] { readJournal(path); }).find("no journal") != std::string::npos);
            QVERIFY(complaint([&] { Journal::resume(path); }).find("no journal") != std::string::npos);
        }
        put(kPoints, farRun);
        QVERIFY(readJournal(path).entries.empty());
        QVERIFY(readJournal(path).damage.find("not understood in line 3") != std::string::npos);
        // What could be is read without room for the points; replaying asks for the key first.
        put(PointIndex(1) << 40, {0, 1});
        const JournalContents contents = readJournal(path);
        QCOMPARE(contents.damage, std::string());
        QVERIFY(contents.entries.size() == 1 && contents.entries[0].within);
        QVERIFY(contents.entries[0].within->bytes() < 8);
        const auto cloud = makeCloud();
        History history(cloud);
        Progress progress;
        QVERIFY(complaint([&, &cloud = cloud, &history = history, &progress = progress] {
                    replay(contents, *cloud, history, progress);
                }).find("another file") != std::string::npos);
    }

    /// A command that no recipe tells leaves a gap, until it is undone.
    void whatCannotBeNotedIsTold()
    {
        Edited edited;
        auto& [folder, path, cloud, history, progress] = edited;
        history.push(std::make_unique<AttributesCommand>("Odd", std::vector{*cloud->findAttribute("Intensity")}));
        QVERIFY(history.journal()->failure().find("\"Odd\" cannot be noted") != std::string::npos);
        history.undo();
        QCOMPARE(history.journal()->failure(), std::string());
        QVERIFY(readJournal(path).entries.empty());
        QVERIFY(complaint([] { readJournal("/no/such.journal"); }).find("cannot be opened") != std::string::npos);

        // points that a save left out are in none of the counts
        history.setJournal(nullptr);
        history.setJournal(Journal::create(path, keyOf(*cloud, progress), "a",
                                           std::make_shared<const KeptPoints>(std::vector<PointRange>{{0, 10}})));
        auto command = std::make_unique<AttributesCommand>("Told", std::vector{*cloud->findAttribute("Intensity")});
        command->setRecipe({"normals", {}, nullptr});
        history.push(std::move(command));
        QCOMPARE(readJournal(path).entries.at(0).changed, PointIndex(10));
    }

    /// Undo that fails ends the replaying like an edit that does: what came before counts.
    void undoThatFailsIsTold()
    {
        const QTemporaryDir folder;
        const auto cloud = makeCloud();
        History history(cloud, {0, 0, folder.path().toStdString()});
        follow(history, *cloud, {0, {"set", {{"rule", "Intensity = X"}}, nullptr}});
        QCOMPARE(history.kept().memory, std::size_t(0));
        QCOMPARE(cutSpillFiles(folder.path().toStdString()), 1);
        Progress progress;
        const auto before = snapshot(*cloud);
        JournalContents contents;
        contents.key = keyOf(*cloud, progress);
        contents.entries.resize(1);
        contents.entries[0].kind = JournalEntry::Kind::Undo;
        const Replayed replayed = replay(contents, *cloud, history, progress);
        QVERIFY2(replayed.stopped.find("\"Undo Set Intensity = X\" cannot be done again") == 0,
                 replayed.stopped.c_str());
        QCOMPARE(replayed.entries, std::size_t(0));
        QVERIFY(snapshot(*cloud) == before);
    }

    void aFullDiskStopsTheJournalAndNotTheEdit()
    {
        if (!std::filesystem::exists("/dev/full")) QSKIP("There is no /dev/full here.");
        const auto cloud = makeCloud();
        QVERIFY(complaint([] {
                    Journal::create("/dev/full", {kPoints, 1}, "a");
                }).find("cannot be written") != std::string::npos);

        Edited edited;
        struct rlimit was {
        };
        QCOMPARE(::getrlimit(RLIMIT_FSIZE, &was), 0);
        const auto ignored = ::signal(SIGXFSZ, SIG_IGN);
        const struct rlimit low {
            rlim_t(std::filesystem::file_size(edited.path)), was.rlim_max
        };
        ::setrlimit(RLIMIT_FSIZE, &low);
        const Edit edit{0, {"set", {{"rule", "Classification = 7"}}, nullptr}};
        const bool followed = follow(edited.history, *edited.cloud, edit);
        ::setrlimit(RLIMIT_FSIZE, &was);
        ::signal(SIGXFSZ, ignored);
        QVERIFY(followed && edited.cloud->findAttribute("Classification")->number(3) == 7.0);
        QVERIFY(edited.history.journal()->failure().find("cannot be written") != std::string::npos);
        // what comes later would stand behind a gap
        follow(edited.history, *edited.cloud, {0, {"set", {{"rule", "Classification = 8"}}, nullptr}});
        QVERIFY(readJournal(edited.path).entries.empty());
    }

    void aDiskWithoutHardLinks()
    {
        const QTemporaryDir folder;
        const std::string path = folder.filePath(QStringLiteral("a.journal")).toStdString();
        QVERIFY(complaint([&] { setJournalAside(path); }).find("cannot be set aside") != std::string::npos);
        linksFail = true;
        for (const char* text : {"first", "second"}) {
            putBytes(path, text);
            const std::filesystem::path aside = setJournalAside(path);
            QVERIFY(bytesOf(aside) == text && !std::filesystem::exists(path));
        }
        linksFail = false;
    }

    void whatNobodyRecoveredIsSetAside()
    {
        Edited first("first");
        QVERIFY(first.history.journal()->setAside().empty());
        const auto edit = [&first](const char* rule) {
            first.history.push(makeCommand({"set", {{"rule", rule}}, nullptr}, *first.cloud, first.progress));
        };
        edit("Classification = 7");
        edit("Classification = 8");
        first.history.setJournal(nullptr);  // as if the program had ended

        first.begin("second");
        const std::filesystem::path aside = first.history.journal()->setAside();
        QCOMPARE(readJournal(aside).file, std::string("first"));
        QCOMPARE(readJournal(aside).entries.size(), std::size_t(2));
        QVERIFY(readJournal(first.path).entries.empty());
        first.history.setJournal(nullptr);

        first.begin("third");  // the second has nothing to recover
        QVERIFY(first.history.journal()->setAside().empty());
        edit("Classification = 9");
        first.history.setJournal(nullptr);
        first.begin("fourth");
        QVERIFY(first.history.journal()->setAside() != aside);
        QCOMPARE(readJournal(aside).file, std::string("first"));
        QCOMPARE(readJournal(first.history.journal()->setAside()).file, std::string("third"));
    }

    void killedAtRandomMomentsNothingIsLost()
    {
        const QTemporaryDir folder;
        std::mt19937_64 random(std::random_device{}());
        const auto before = snapshot(*makeCloud());
        std::size_t most = 0;
        for (std::uint64_t round = 0; round < 100; ++round) {
            const QString path = folder.filePath(QStringLiteral("%1.journal").arg(round));
            QProcess child;
            child.start(QCoreApplication::applicationFilePath(),
                        {QStringLiteral("--edit"), path, QString::number(round)});
            QVERIFY(child.waitForReadyRead(30'000));
            QTest::qSleep(int(random() % 25));
            ::kill(pid_t(child.processId()), SIGKILL);
            child.waitForFinished();
            const auto said = std::size_t(child.readAllStandardOutput().size());

            const JournalContents contents = readJournal(path.toStdString());
            const std::size_t kept = contents.entries.size();
            // what was begun when it was killed may be there, too
            QVERIFY2(kept == said || kept == said + 1, qPrintable(QStringLiteral("%1 of %2").arg(kept).arg(said)));
            most = std::max(most, kept);
            const auto expected = makeCloud(), got = makeCloud();
            History one(expected), two(got);
            std::size_t done = 0;
            for (int k = 0; done < kept; ++k) done += follow(one, *expected, editOf(round, k)) ? 1 : 0;
            Progress progress;
            const Replayed replayed = replay(contents, *got, two, progress);
            QCOMPARE(replayed.stopped, std::string());
            QVERIFY(snapshot(*got) == snapshot(*expected));
        }
        qInfo("up to %zu edits before the kill", most);
        QVERIFY(most > 1);
    }
};

int main(int argc, char** argv)
{
    if (argc == 4 && std::string_view(argv[1]) == "--edit")
        return editForever(argv[2], std::strtoull(argv[3], nullptr, 10));
    QCoreApplication application(argc, argv);
    JournalTest test;
    return QTest::qExec(&test, argc, argv);
}
#include "JournalTest.moc"
