// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/las/Diff.h"
#include "core/las/Reader.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/Differences.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <algorithm>

using namespace punctum;
using lasfiles::Bytes;
namespace fs = std::filesystem;

/// What saving would change, before it is done, and in few words.
class LasPreviewTest : public QObject
{
    Q_OBJECT

private slots:
    void previewTellsWhatSavingDoes_data();
    void previewTellsWhatSavingDoes();
    void aPlanServesTheSaveAfter_data();
    void aPlanServesTheSaveAfter();
    void aPlanServesNoOtherSave();
    void summaries();

private:
    fs::path make(const std::string& name, const Bytes& bytes) const
    {
        const fs::path path = fs::path(m_dir.path().toStdString()) / name;
        lasfiles::writeFile(path, bytes);
        return path;
    }
    static las::Difference diffOf(const fs::path& a, const fs::path& b)
    {
        Progress progress;
        return las::diffFiles(a, b, {}, progress);
    }

    QTemporaryDir m_dir;
};

void LasPreviewTest::previewTellsWhatSavingDoes_data()
{
    QTest::addColumn<QString>("target");
    QTest::addColumn<bool>("compressed");
    QTest::addColumn<QString>("step");
    for (const bool compressed : {false, true})
        for (const char* target : {"saved.las", "saved.laz"})
            for (const char* step : {"", "reclassify", "normals"})
                QTest::addRow("%s to %s, %s", compressed ? "LAZ" : "LAS", target, step)
                    << target << compressed << step;
}

void LasPreviewTest::previewTellsWhatSavingDoes()
{
    QFETCH(QString, target);
    QFETCH(bool, compressed);
    QFETCH(QString, step);
    Bytes records = lasfiles::randomRecords(3, 34, 3000, 12);
    for (std::size_t i = 0; i < 3000; ++i)
        for (std::size_t k = 0; k < 3; ++k)
            lasfiles::set<std::int32_t>(records, i * 34 + k * 4, int(i * (k + 7) % 997));
    const fs::path original = compressed
                                  ? make("in.laz", lasfiles::lazFile(3, 34, records, 500))
                                  : make("in.las", lasfiles::file(lasfiles::header(2, 3, 34, 3000),
                                                                  {lasfiles::record("u", 7, Bytes(5))}, records));
    Progress progress;
    const auto cloud = las::load(original, progress);
    std::uint64_t changed = 0;
    if (!step.isEmpty()) {
        const Step* s = findStep(step.toStdString());
        StepValues values;
        if (step == "reclassify") values = {{"attribute", "Z"}, {"min", "1"}, {"max", "4"}, {"class", "9"}};
        auto command = s->run(*cloud, completeValues(*s, values), progress);
        changed = command->changedPoints();
        command->apply(*cloud);
    }
    const fs::path out = original.parent_path() / target.toStdString();
    las::WriteOptions options;
    options.compressed = las::isCompressedName(out);
    const las::SavePreview preview = las::previewSave(*cloud, original, out, options, progress);
    const las::WriteReport report = las::write(*cloud, out, options, progress);
    las::Difference real = diffOf(original, out);
    las::Difference said = preview.difference;
    said.container = real.container;
    QCOMPARE_STRING(las::report(said, "a", "b"), las::report(real, "a", "b"));
    QVERIFY(preview.notes == report.notes);
    QCOMPARE(real.differing, PointIndex(step == "reclassify" ? changed : 0));
    if (step.isEmpty()) QVERIFY2(real.contentEqual(), las::report(real, "a", "b").c_str());
    if (step == "reclassify") {
        QCOMPARE_STRING(names(real), "Classification:" + std::to_string(changed) + " ");
        QVERIFY(changed > 0 && real.header.empty() && real.records.empty());
    }
    if (step == "reclassify") {
        // what the history knows need not be looked for
        const std::vector<AttributeChange> known{{"Classification", changed}};
        const las::SavePreview sooner = las::previewSave(*cloud, original, out, options, progress, &known);
        QCOMPARE_STRING(names(sooner.difference), names(real));
        QVERIFY(!las::dropsOrUpgrades(real));
    }
    if (step == "normals") QVERIFY(las::summary(real).starts_with("new: NormalX, NormalY and NormalZ; "));

    // a file that is not the one that was read
    make("other.las", lasfiles::file(lasfiles::header(2, 3, 34, 10), {}, lasfiles::randomRecords(3, 34, 10, 1)));
    QVERIFY_THROWS_EXCEPTION(
        Error, las::previewSave(*cloud, original.parent_path() / "other.las", out, options, progress));
}

void LasPreviewTest::aPlanServesTheSaveAfter_data()
{
    QTest::addColumn<QString>("target");
    QTest::newRow("LAS") << "out.las";
    QTest::newRow("LAZ") << "out.laz";
}

void LasPreviewTest::aPlanServesTheSaveAfter()
{
    QFETCH(QString, target);
    const fs::path original =
        make("plan.laz", lasfiles::lazFile(3, 34, lasfiles::randomRecords(3, 34, 3000, 4), 500));
    Progress progress;
    const auto cloud = las::load(original, progress);
    cloud->findAttribute("UserData")->columns[0]->values<std::uint8_t>()[1700] ^= 1;
    const fs::path out = original.parent_path() / target.toStdString();
    las::WriteOptions options;
    options.compressed = las::isCompressedName(out);
    int asked = 0;
    const las::SavePreview preview = las::previewSave(*cloud, original, out, options, progress);
    const las::KnownPlan known{preview.plan, [&] { return ++asked != 0; }};
    const las::WriteReport report = las::write(*cloud, out, options, progress, known);
    QCOMPARE(asked, 1);
    const Bytes written = lasfiles::readFile(out);
    if (options.compressed) QCOMPARE(report.chunksCopied, std::uint64_t(5));
    const auto again = las::load(original, progress);
    again->findAttribute("UserData")->columns[0]->values<std::uint8_t>()[1700] ^= 1;
    const fs::path other = original.parent_path() / ("other" + out.extension().string());
    const las::WriteReport plain = las::write(*again, other, options, progress);
    QVERIFY(lasfiles::readFile(other) == written && plain.notes == report.notes);
    // it serves another look ahead, too, and is made anew where it does not hold
    QVERIFY(las::previewSave(*cloud, out, out, options, progress, nullptr, known).plan == preview.plan);
    const las::KnownPlan old{preview.plan, [] { return false; }};
    const las::SavePreview later = las::previewSave(*cloud, out, out, options, progress, nullptr, old);
    QVERIFY(later.plan && later.plan != preview.plan);
    // what it says is written, whatever the cloud became: whoever gives it promises that it holds
    auto deleted = std::make_shared<PointSet>(cloud->size());
    deleted->insert(PointRange{0, 10});
    cloud->setDeleted(deleted);
    QCOMPARE(las::write(*cloud, out, options, progress, {preview.plan, {}}).points, PointIndex(3000));
    QCOMPARE(las::write(*cloud, out, options, progress, old).points, PointIndex(2990));
}

void LasPreviewTest::aPlanServesNoOtherSave()
{
    const fs::path original = make(
        "wide.las", lasfiles::file(lasfiles::header(2, 1, 28, 100), {}, lasfiles::randomRecords(1, 28, 100, 4)));
    Progress progress;
    const auto cloud = las::load(original, progress);
    for (const char* name : {"Red", "Green", "Blue"}) {
        Attribute a;
        a.name = name;
        a.columns[0] = std::make_shared<Column>(name, ScalarType::U16, cloud->size());
        cloud->addColumn(a.columns[0]);
        cloud->addAttribute(a);
    }
    const fs::path out = original.parent_path() / "wide2.las";
    las::WriteOptions look, options;
    look.upgrade = true;
    const las::KnownPlan known{las::previewSave(*cloud, original, out, look, progress).plan, {}};
    // the look ahead shows an upgrade; the save asks for it
    QVERIFY_THROWS_EXCEPTION(las::WriteQuestion, las::write(*cloud, out, options, progress, known));
    options.upgrade = true;
    QVERIFY(known.fits(out, options));
    QVERIFY(!known.fits(original, options));
    options.pointFormat = 7;
    QVERIFY(!known.fits(out, options));
    las::write(*cloud, out, options, progress, known);
    QCOMPARE(int(las::load(out, progress)->source()->layout.format), 7);
}

void LasPreviewTest::summaries()
{
    las::Difference d;
    QVERIFY(las::summary(d).empty());
    using Change = las::AttributeDifference::Change;
    d.attributes = {{Change::Changed, "Red", 5, 0, {}, {}, "uint16", "uint16"},
                    {Change::Changed, "Green", 5, 0, {}, {}, "uint16", "uint16"},
                    {Change::Changed, "Classification", 1204, 0, {}, {}, "uint8", "uint8"},
                    {Change::Added, "NormalX", 9, 0, {}, {}, "", "float32"}};
    d.header = {{"creation_day", "creation date", {}, {}},
                {"creation_year", "creation date", {}, {}},
                {"generating_software", "software", {}, {}}};
    las::RecordDifference r;
    r.change = las::RecordDifference::Change::Removed;
    r.user = "copc";
    r.id = 1;
    d.records = {r};
    d.pointsA = 10;
    d.pointsB = 9;
    d.onlyA = 1;
    QCOMPARE_STRING(las::summary(d),
                    "Red and Green of 5 points; Classification of 1,204 points; new: NormalX; 1 point left out; "
                    "creation date and software in the header; record copc/1 removed");

    // more than fit a sentence; other types alone; bytes beside the records
    d = {};
    for (const char* name : {"A", "B", "C", "D", "E", "F", "G"})
        d.attributes.push_back({Change::Added, name, 1, 0, {}, {}, "", "uint8"});
    d.attributes.push_back({Change::Changed, "H", 0, 0, {}, {}, "uint8", "uint16"});
    d.bytes = {{"bytes at the end of the file", 1, 2, 1}};
    QCOMPARE_STRING(las::summary(d),
                    "new: A, B, C, D, E and 2 more; other types, same values: H; bytes at the end of the file");
    d.unreadableA = 1;
    d.unreadableB = 2;
    d.onlyB = 3;
    d.recordsReordered = true;
    r.change = las::RecordDifference::Change::Changed;
    r.extendedA = true;
    d.records = {r};
    const QString report = QString::fromStdString(las::report(d, "a", "b"));
    for (const char* part :
         {"1 byte -> 2 bytes, differ from byte 1", "1 point cannot be read", "2 points cannot be read",
          "lacks 3 points", "in another order", "is no longer extended"})
        QVERIFY2(report.contains(part), qPrintable(report));
    const QString summary = QString::fromStdString(las::summary(d));
    QVERIFY(summary.contains("3 points added") && summary.contains("order of the records"));
}

QTEST_GUILESS_MAIN(LasPreviewTest)
#include "LasPreviewTest.moc"
