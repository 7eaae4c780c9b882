// SPDX-License-Identifier: MIT
// Attributes are renamed and removed: undone exactly, and saved so that every other byte stays as it was.
#include "core/edit/ListCommand.h"

#include "core/Error.h"
#include "core/edit/AttributeName.h"
#include "core/edit/History.h"
#include "core/edit/Journal.h"
#include "core/las/Diff.h"
#include "core/las/Reader.h"
#include "core/las/Writer.h"
#include "core/steps/MakeCommand.h"
#include "core/steps/Replay.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"
#include "tests/core/MadeCloud.h"

#include <QTemporaryDir>
#include <QTest>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
using lasfiles::save;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kStandard = 30, kPoints = 2500, kNameAt = 4;

/// A descriptor of one value (LAS 1.4 R15, table 24).
Bytes descriptor(const std::string& name, std::uint8_t type)
{
    Bytes b(192);
    b[2] = std::byte(type);
    std::memcpy(b.data() + kNameAt, name.data(), name.size());
    std::memcpy(b.data() + 160, "kept words", 10);
    return b;
}

const Bytes kA = descriptor("A", 3), kB = descriptor("B", 9), kC = descriptor("C", 1);
constexpr std::size_t kBytesA = 2, kBytesB = 4, kBytesC = 1;
constexpr std::uint16_t kLength = kStandard + kBytesA + kBytesB + kBytesC;

Bytes joined(std::initializer_list<Bytes> parts)
{
    Bytes all;
    for (const Bytes& part : parts) lasfiles::append(all, part);
    return all;
}

/// The records without bytes [first, first + count) of each.
Bytes cut(const Bytes& records, std::size_t first, std::size_t count)
{
    Bytes left;
    for (std::size_t i = 0; i < records.size() / kLength; ++i)
        for (std::size_t k = 0; k < kLength; ++k)
            if (k < first || k >= first + count) left.push_back(records[i * kLength + k]);
    return left;
}

/// The payload of the file's only record on extra bytes.
Bytes extraBytesRecord(const Bytes& file)
{
    std::size_t at = lasfiles::get<std::uint16_t>(file, 94);
    for (std::uint32_t k = 0; k < lasfiles::get<std::uint32_t>(file, 100); ++k) {
        const auto length = lasfiles::get<std::uint16_t>(file, at + 20);
        if (lasfiles::get<std::uint16_t>(file, at + 18) == 4)
            return {file.begin() + std::ptrdiff_t(at + 54), file.begin() + std::ptrdiff_t(at + 54 + length)};
        at += 54u + length;
    }
    return {};
}

std::vector<std::string> columnNames(const PointCloud& cloud)
{
    std::vector<std::string> names;
    for (const auto& column : cloud.columns()) names.push_back(column->name());
    return names;
}

}  // namespace

class AttributeListTest : public QObject
{
    Q_OBJECT
private slots:
    void undoneExactly()
    {
        const auto cloud = load(made("undo.las"));
        const auto names = attributeNames(*cloud), columns = columnNames(*cloud);
        const auto before = snapshot(*cloud);
        History history(cloud);
        Progress progress;
        const auto run = [&](const Recipe& recipe) { history.push(makeCommand(recipe, *cloud, progress)); };
        std::vector<std::string> notified;
        const auto subscription = cloud->subscribe([&](const ChangeNotice& n) { notified = n.attributes; });
        run({"rename", {{"attribute", "B"}, {"to", "Slope, steep"}}, nullptr});
        QVERIFY(cloud->findAttribute("B") == nullptr && cloud->findAttribute("Slope, steep") != nullptr);
        QVERIFY((notified == std::vector<std::string>{"B", "Slope, steep"}));
        run({"set", {{"rule", "\"Slope, steep\" = 4"}}, nullptr});
        run({"remove", {{"attribute", "A"}}, nullptr});
        QVERIFY(cloud->findAttribute("A") == nullptr);
        QCOMPARE(cloud->columns().size(), columns.size() - 1);
        run({"normals", {}, nullptr});
        run({"remove", {{"attribute", "Normal"}}, nullptr});
        for (const char* name : {"Normal", "NormalX", "NormalY", "NormalZ"})
            QVERIFY(cloud->findAttribute(name) == nullptr);
        run({"rename", {{"attribute", "C"}, {"to", "A"}}, nullptr});
        for (int round = 0; round < 2; ++round) {
            const auto after = snapshot(*cloud);
            const auto namesAfter = attributeNames(*cloud);
            while (history.canUndo()) history.undo();
            QVERIFY(attributeNames(*cloud) == names);
            QVERIFY(columnNames(*cloud) == columns);
            QVERIFY(snapshot(*cloud) == before);
            while (history.canRedo()) history.redo();
            QVERIFY(attributeNames(*cloud) == namesAfter);
            QVERIFY(snapshot(*cloud) == after);
        }
    }

    void refusals_data()
    {
        QTest::addColumn<QString>("step");
        QTest::addColumn<QString>("attribute");
        QTest::addColumn<QString>("to");
        QTest::addColumn<QString>("sentence");
        const auto row = [](const char* name, const char* step, const char* attribute, const char* to,
                            const char* sentence) {
            QTest::newRow(name) << QString::fromLatin1(step) << QString::fromLatin1(attribute)
                                << QString::fromLatin1(to) << QString::fromLatin1(sentence);
        };
        row("a standard field goes", "remove", "Intensity", "", "only extra bytes and computed attributes");
        row("a standard field renamed", "rename", "Z", "Height", "only extra bytes and computed attributes");
        row("not there", "remove", "D", "", "no attribute \"D\"");
        row("taken", "rename", "A", "B", "There is an attribute \"B\" already");
        row("of the standard", "rename", "A", "Red", "is a name of the standard");
        row("a blank before it", "rename", "A", " B2", "begin or end with a blank");
        row("a line break in it", "rename", "A", "B\n2", "hold control characters");
        row("too long", "rename", "A", "a name of more than thirty-two bytes", "is too long");
    }

    void refusals()
    {
        QFETCH(QString, step);
        QFETCH(QString, attribute);
        QFETCH(QString, to);
        QFETCH(QString, sentence);
        const auto cloud = load(made("refused.las"));
        QVERIFY(complaint([&] { checkNewName(*cloud, ""); }).find("Give the attribute a name") !=
                std::string::npos);
        Recipe recipe{step.toStdString(), {{"attribute", attribute.toStdString()}}, nullptr};
        if (!to.isEmpty()) recipe.values["to"] = to.toStdString();
        Progress progress;
        const auto said = QString::fromStdString(complaint([&] { makeCommand(recipe, *cloud, progress); }));
        QVERIFY2(said.contains(sentence), qPrintable(said));
    }

    void saved_data()
    {
        QTest::addColumn<QString>("name");
        QTest::newRow("LAS") << QStringLiteral("saved.las");
        QTest::newRow("LAZ") << QStringLiteral("saved.laz");
    }

    void saved()
    {
        QFETCH(QString, name);
        const fs::path path = made(name.toStdString()), out = temp("out-" + name.toStdString());
        const Bytes before = lasfiles::readFile(path);
        const auto cloud = load(path);
        History history(cloud);
        Progress progress;
        const auto run = [&](const Recipe& recipe) { history.push(makeCommand(recipe, *cloud, progress)); };
        // a name: its 32 bytes in the descriptor, and no more
        run({"rename", {{"attribute", "B"}, {"to", "Slope"}}, nullptr});
        auto report = save(*cloud, out);
        QVERIFY(lasfiles::recordsByLaszip(out, 6, kLength, kPoints) == m_records);
        Bytes slope = kB;
        std::fill_n(slope.begin() + kNameAt, 32, std::byte(0));
        std::memcpy(slope.data() + kNameAt, "Slope", 5);
        QVERIFY(extraBytesRecord(lasfiles::readFile(out)) == joined({kA, slope, kC}));
        QVERIFY(std::count(report.notes.begin(), report.notes.end(), "Renamed: B to Slope.") == 1);
        if (las::isCompressedName(path)) QCOMPARE(report.chunksEncoded, std::uint64_t(0));
        // the journal that is begun after a save is found when that file is opened
        QVERIFY(keyOf(*cloud, progress) == keyOf(*load(out), progress));

        // one that goes: its bytes and its descriptor
        run({"remove", {{"attribute", "A"}}, nullptr});
        las::WriteOptions options;
        options.compressed = las::isCompressedName(path);
        const auto summary = las::summary(las::previewSave(*cloud, out, out, options, progress).difference);
        QVERIFY2(summary.find("no longer there: A") != std::string::npos, summary.c_str());
        report = save(*cloud, out);
        QVERIFY(lasfiles::recordsByLaszip(out, 6, kLength - kBytesA, kPoints) ==
                cut(m_records, kStandard, kBytesA));
        QCOMPARE(lasfiles::get<std::uint16_t>(lasfiles::readFile(out), 105), std::uint16_t(kLength - kBytesA));
        QVERIFY(extraBytesRecord(lasfiles::readFile(out)) == joined({slope, kC}));

        // a new one in its name comes last
        run({"set", {{"rule", "A = 7"}, {"new", "uint8"}}, nullptr});
        save(*cloud, out);
        Bytes expected;
        const Bytes less = cut(m_records, kStandard, kBytesA);
        for (std::size_t i = 0; i < kPoints; ++i) {
            const auto at = less.begin() + std::ptrdiff_t(i * (kLength - kBytesA));
            expected.insert(expected.end(), at, at + (kLength - kBytesA));
            expected.push_back(std::byte(7));
        }
        QVERIFY(lasfiles::recordsByLaszip(out, 6, kLength - kBytesA + 1, kPoints) == expected);

        // all of it undone: the file as it was
        while (history.canUndo()) history.undo();
        save(*cloud, out);
        QVERIFY(lasfiles::readFile(out) == before);
    }

    /// Removed, saved in place, undone: a journal tells all of an attribute that the file lacks.
    void whatAnUndoneSaveRemovedComesBackAfterACrash()
    {
        Bytes a = kA;
        const auto put = [&](std::size_t at, auto value) { std::memcpy(a.data() + at, &value, sizeof value); };
        put(3, std::uint8_t(1 | 8 | 16));  // no data, scale, offset
        put(40, std::uint64_t(77));
        put(112, 0.5);
        put(136, 10.25);
        const fs::path path = temp("undone.las"), journal = temp("undone.journal");
        lasfiles::writeFile(path, lasfiles::file(lasfiles::header(4, 6, kLength, kPoints),
                                                 {lasfiles::record("LASF_Spec", 4, joined({a, kB, kC}))},
                                                 lasfiles::randomRecords(6, kLength, kPoints, 8, true)));
        const auto cloud = load(path);
        QVERIFY(cloud->findAttribute("A")->scaled && cloud->findAttribute("A")->noData);
        History history(cloud);
        Progress progress;
        for (const char* name : {"A", "C"})
            history.push(makeCommand({"remove", {{"attribute", name}}, nullptr}, *cloud, progress));
        history.push(makeCommand({"rename", {{"attribute", "B"}, {"to", "New name"}}, nullptr}, *cloud, progress));
        save(*cloud, path);
        history.markSaved();
        history.setJournal(Journal::create(journal, keyOfFile(*cloud, progress), "a"));
        while (history.canUndo()) history.undo();
        QCOMPARE(history.journal()->failure(), std::string());

        const auto reopened = load(path);
        QVERIFY(reopened->findAttribute("A") == nullptr && reopened->findAttribute("New name") != nullptr);
        History second(reopened);
        QCOMPARE(replay(readJournal(journal), *reopened, second, progress).stopped, std::string());
        for (const Attribute& is : cloud->attributes()) {
            const Attribute* const got = reopened->findAttribute(is.name);
            QVERIFY2(got, is.name.c_str());
            QVERIFY(got->kind == is.kind && got->type() == is.type() && got->noData == is.noData);
            QVERIFY(got->scaled == is.scaled && got->scale == is.scale && got->offset == is.offset);
            QVERIFY(got->unit == is.unit && got->description == is.description);
            const std::size_t bytes = kPoints * is.columns[0]->elementBytes();
            QVERIFY(std::memcmp(got->columns[0]->data(), is.columns[0]->data(), bytes) == 0);
        }
        QCOMPARE(reopened->attributes().size(), cloud->attributes().size());
        while (second.canUndo()) second.undo();
        QVERIFY(snapshot(*reopened) == snapshot(*load(path)));
    }

private:
    fs::path temp(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    fs::path made(const std::string& name)
    {
        m_records = lasfiles::randomRecords(6, kLength, kPoints, 8, true);
        const Bytes record = lasfiles::record("LASF_Spec", 4, joined({kA, kB, kC}));
        if (las::isCompressedName(temp(name))) {
            lasfiles::writeFile(temp("plain.las"),
                                lasfiles::file(lasfiles::header(4, 6, kLength, kPoints), {record}, m_records));
            save(*load(temp("plain.las")), temp(name));
        } else {
            lasfiles::writeFile(temp(name),
                                lasfiles::file(lasfiles::header(4, 6, kLength, kPoints), {record}, m_records));
        }
        return temp(name);
    }
    Bytes m_records;
    QTemporaryDir m_dir;
};

QTEST_GUILESS_MAIN(AttributeListTest)
#include "AttributeListTest.moc"
