// SPDX-License-Identifier: MIT
// What a journal tells by values: what every command did comes back, and nothing else can be asked for.
#include "core/edit/Literal.h"

#include "core/edit/History.h"
#include "core/edit/Journal.h"
#include "core/edit/ListCommand.h"
#include "core/edit/PackedValues.h"
#include "core/steps/MakeCommand.h"
#include "core/steps/Replay.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/JournalCloud.h"

#include <QTemporaryDir>
#include <QTest>

#include <algorithm>
#include <cstring>

using namespace punctum;

namespace
{

/// One element at all points, as a literal tells it.
QString allOf(const std::vector<std::uint8_t>& element)
{
    std::vector<std::uint8_t> run(sizeof(std::uint32_t));
    const auto count = std::uint32_t(kPoints);
    std::memcpy(run.data(), &count, sizeof count);
    run.insert(run.end(), element.begin(), element.end());
    return QString::fromStdString(toBase64(std::as_bytes(std::span<const std::uint8_t>(run))));
}

}  // namespace

class LiteralTest : public QObject
{
    Q_OBJECT
private slots:
    /// A literal says what comes of it: what it says must not reach what everything relies on.
    void craftedLiteralsAreRefused_data()
    {
        QTest::addColumn<QString>("key");
        QTest::addColumn<QString>("value");
        QTest::addColumn<QString>("key2");
        QTest::addColumn<QString>("value2");
        QTest::addColumn<QString>("said");
        const QString bytes = QStringLiteral("\n0\n1\n\n\n\n\n\nuint8\nruns\n") + allOf({0x07});
        const QString words = QStringLiteral("\n0\n1\n\n\n\n\n\nuint16\nruns\n") + allOf({0x07, 0x07});
        const QString own = QStringLiteral("field of the LAS point format"),
                      notUnderstood = QStringLiteral("not understood");
        const auto one = [&](const char* name, const QString& key, const QString& value, const QString& said) {
            QTest::newRow(name) << key << value << QString() << QString() << said;
        };
        const auto two = [&](const char* name, const QString& key, const QString& value, const QString& key2,
                             const QString& value2) {
            QTest::newRow(name) << key << value << key2 << value2 << notUnderstood;
        };
        const QString first = QStringLiteral("+000"), second = QStringLiteral("+001"),
                      made = QStringLiteral("Made");
        one("good", first, made + bytes, {});
        one("adds a coordinate", first, QStringLiteral("X") + bytes, own);
        one("adds without a name", first, bytes, notUnderstood);
        two("adds twice", first, made + bytes, second, made + words);
        one("adds a scalar named RGB", first, QStringLiteral("RGB") + bytes, notUnderstood);
        one("adds a composite of coordinates", first, QStringLiteral("All\n4\ncomposite\nX\nY\nZ"), own);
        one("adds a composite that is a scalar", first, QStringLiteral("All\n0\ncomposite\nA\nB\nC"),
            notUnderstood);
        one("adds a composite of two types", first, QStringLiteral("All\n4\ncomposite\nA\nB\nBig id"),
            notUnderstood);
        two("adds a composite of what goes", QStringLiteral("-A"), {}, first,
            QStringLiteral("All\n4\ncomposite\nA\nB\nC"));
        one("good composite", first, QStringLiteral("All\n4\ncomposite\nA\nB\nC"), {});
        for (const auto& [noData, said] :
             {std::pair("0-9", ""), {"17", ""}, {"20.5", ""}, {"0x", "not understood"}})
            QTest::addRow("no data %s", noData)
                << first << QString(bytes).replace("\n0\n1\n\n\n", QString("Made\n0\n1\n\n\n") + noData)
                << QString() << QString() << QString(said);
        one("no such type", first, QString(made + bytes).replace("uint8", "uint9"), notUnderstood);
        one("removes a composite", QStringLiteral("-ABC"), {}, notUnderstood);
        one("removes a coordinate", QStringLiteral("-Z"), {}, own);
        one("renames a coordinate", QStringLiteral(">Z"), made, own);
        two("renames two alike", QStringLiteral(">A"), made, QStringLiteral(">B"), made);
        two("renames as it adds", QStringLiteral(">A"), made, first, made + bytes);
        one("renames to one that is there", QStringLiteral(">A"), QStringLiteral("B"),
            QStringLiteral("There is an attribute \"B\" already"));
        one("sets what is not there", QStringLiteral("=D"), QStringLiteral("uint8\nruns\n") + allOf({1}),
            QStringLiteral("no attribute \"D\""));
        one("sets another type", QStringLiteral("=A"), QStringLiteral("uint16\nruns\n") + allOf({1, 1}),
            QStringLiteral("A has another type"));
        one("adds a scalar of two parts", first, QString(made + bytes).replace("\n0\n1\n", "\n0\n2\n"),
            notUnderstood);
        one("renames to nothing", QStringLiteral(">A"), {}, notUnderstood);
        one("sets coordinates", QStringLiteral("=Z"), QStringLiteral("int32\nruns\n") + allOf({1, 2, 3, 4}),
            QStringLiteral("Coordinates stay"));
        one("good values", QStringLiteral("=A"), QStringLiteral("uint8\nruns\n") + allOf({9}), {});
        one("unknown key", QStringLiteral("*A"), {}, notUnderstood);
        one("empty key", {}, {}, notUnderstood);
        one("deleted or not", QStringLiteral("deleted"), QStringLiteral("perhaps"), notUnderstood);
    }
    void craftedLiteralsAreRefused()
    {
        QFETCH(QString, key);
        QFETCH(QString, value);
        QFETCH(QString, key2);
        QFETCH(QString, value2);
        QFETCH(QString, said);
        const auto cloud = makeCloudOfParts();
        Recipe literal;
        literal.step = kLiteralStep;
        literal.values["name"] = "Crafted";
        literal.values[key.toStdString()] = value.toStdString();
        if (!key2.isEmpty()) literal.values[key2.toStdString()] = value2.toStdString();
        std::unique_ptr<Command> command;
        const std::string complained = complaint([&] { command = makeLiteral(literal, *cloud); });
        if (!said.isEmpty()) {
            QVERIFY2(complained.find(said.toStdString()) != std::string::npos, complained.c_str());
            return;
        }
        QCOMPARE(complained, std::string("no error"));
        const auto before = snapshot(*cloud);
        History history(cloud);
        history.push(std::move(command));
        history.undo();
        QVERIFY(snapshot(*cloud) == before);
    }

    /// What every kind of command did before a save is told by values when it is undone and done again after it.
    void everyCommandIsToldByValues()
    {
        const QTemporaryDir folder;
        const std::string path = folder.filePath(QStringLiteral("a.journal")).toStdString();
        Progress progress;
        const auto before = [](History& history, const std::shared_ptr<PointCloud>& cloud) {
            auto points = std::make_shared<PointSet>(kPoints);
            points->insert(PointRange{5, 50});
            const std::vector<std::byte> values(45, std::byte(77));
            Recipe several{kLiteralStep.data(), {}, points};
            several.values = {{"name", "Several"}, {"=A", "uint8\nplain\n" + toBase64(values)}, {"deleted", "yes"}};
            history.push(makeLiteral(several, *cloud));
            history.push(ListCommand::remove(*cloud->findAttribute("A")));
            history.push(ListCommand::rename(*cloud->findAttribute("B"), "Bee"));
        };
        const auto cloud = makeCloudOfParts(), second = makeCloudOfParts();
        History history(cloud, {0, 0, folder.path().toStdString()}), other(second);
        before(history, cloud);
        before(other, second);
        QVERIFY(cloud->findAttribute("ABC") == nullptr && cloud->deleted()->count() == 45);
        history.setJournal(Journal::create(path, keyOf(*cloud, progress), "a"));
        const auto sameNow = [&] {
            const Replayed replayed = replay(readJournal(path), *second, other, progress);
            bool same = replayed.stopped.empty() && !cloud->deleted() == !second->deleted();
            auto names = attributeNames(*cloud), theirs = attributeNames(*second);
            std::sort(names.begin(), names.end());
            std::sort(theirs.begin(), theirs.end());
            for (const std::string& name : names) {
                const Attribute *a = cloud->findAttribute(name), *b = second->findAttribute(name);
                for (std::uint32_t c = 0; b != nullptr && c < a->components; ++c)
                    same = same && std::memcmp(a->columns[c]->data(), b->columns[c]->data(),
                                               kPoints * a->columns[c]->elementBytes()) == 0;
            }
            while (other.position() > 3) other.undo();
            return same && names == theirs;
        };
        for (int k = 0; k < 3; ++k) history.undo();
        QCOMPARE(history.journal()->failure(), std::string());
        QVERIFY(cloud->findAttribute("ABC") != nullptr && !cloud->deleted());
        QVERIFY(sameNow());
        history.markSaved();
        history.redo();
        const auto changes = history.changes(progress);
        QVERIFY(changes && changes->empty());  // the points that changed are deleted
        QVERIFY(sameNow());
    }

    void literalsThatDoNotFitTheCloud()
    {
        const auto narrow = makeFrame(10, {}, true);
        auto all = std::make_shared<PointSet>(10);
        all->invert();
        const auto told = [&](const std::string& key, const std::string& value) {
            return complaint([&] {
                makeLiteral({kLiteralStep.data(), {{"name", "L"}, {key, value}}, all}, *narrow);
            });
        };
        const std::string twos = "uint8\nplain\n" + toBase64(std::vector<std::byte>(10, std::byte(2)));
        QVERIFY(told("=Withheld", twos).find("is too narrow") != std::string::npos);
        QCOMPARE(told("=Classification", twos), std::string("no error"));
        QCOMPARE(told("deleted", "yes"), std::string("no error"));
        QVERIFY(told("deleted", "no").find("Other points are deleted") != std::string::npos);
    }

    /// A composite that comes once more, of columns that the cloud has, leaves these to the cloud.
    void aCompositeThatIsThereKeepsLaterEdits()
    {
        const auto cloud = makeCloudOfParts();
        Progress progress;
        for (const char* parts : {"A\nB\nC", "B\nA\nC"}) {
            const QTemporaryDir folder;
            History history(cloud, {0, 0, folder.path().toStdString()});
            history.push(makeLiteral({kLiteralStep.data(),
                                      {{"name", "Again"}, {"+000", std::string("ABC\n4\ncomposite\n") + parts}},
                                      nullptr},
                                     *cloud));
            QCOMPARE(history.kept().file, std::size_t(0));
            const auto values = cloud->findAttribute("A")->columns[0]->values<std::uint8_t>();
            history.push(makeCommand({"set", {{"rule", "A = 200"}}, nullptr}, *cloud, progress));
            QCOMPARE(int(values[7]), 200);
            history.undo();
            history.undo();
            history.push(makeCommand({"set", {{"rule", "A = 100"}}, nullptr}, *cloud, progress));
            QCOMPARE(int(values[7]), 100);
        }
    }
};

QTEST_GUILESS_MAIN(LiteralTest)
#include "LiteralTest.moc"
