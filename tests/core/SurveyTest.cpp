// SPDX-License-Identifier: MIT
// Many files as one cloud: what each of them was stays what it was, and edits know no files.
#include "core/cloud/DistinctValues.h"
#include "core/expression/Condition.h"
#include "core/las/CrsChange.h"
#include "core/las/Diff.h"
#include "core/las/Reader.h"
#include "core/neighbors/KdOrder.h"
#include "core/select/Selecting.h"
#include "core/session/KeptJournals.h"
#include "core/session/Session.h"
#include "core/session/SurveyFiles.h"
#include "core/survey/Survey.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <glm/geometric.hpp>

#include <cmath>

using namespace punctum;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kPoints = 3000;

Recipe rule(const std::string& text, std::shared_ptr<const PointSet> within = nullptr)
{
    return {"set", {{"rule", text}}, std::move(within)};
}

}  // namespace

class SurveyTest : public QObject
{
    Q_OBJECT
private slots:
    void init() { m_folder = std::make_unique<QTemporaryDir>(); }

    /// Every file, written from the survey, has the bytes that it gets when it is opened by itself.
    void everyFileComesBack_data()
    {
        QTest::addColumn<QStringList>("names");
        QTest::newRow("one format") << QStringList{"bcts_1.laz", "bcts_2.laz"};
        QTest::newRow("formats 0 to 3, extra bytes")
            << QStringList{"autzen_trim.las", "extrabytes.las", "simple.las", "megaplot.las", "lots_of_vlr.las"};
        QTest::newRow("formats of both kinds")
            << QStringList{"autzen_trim_7.las", "autzen_trim.las", "test1_4.las", "simple1_3.las", "extra.laz"};
        QTest::newRow("waveforms, bytes without a description")
            << QStringList{"vegetation_1_3.las", "unregistered_extra_bytes.las", "MixedConifer.laz",
                           "more/pdrf8-14.laz", "epsg_4326.las"};
        QTest::newRow("normals, terrestrial, records behind the points")
            << QStringList{"cases/normals-metashape.las", "tls_clip.laz", "lone-star.laz", "1_4_w_evlr.laz"};
    }
    void everyFileComesBack()
    {
        QFETCH(QStringList, names);
        std::vector<fs::path> files;
        for (const QString& name : names) {
            const fs::path file = fs::path(PUNCTUM_TEST_DATA) / name.toStdString();
            if (!fs::exists(file)) QSKIP(qPrintable("The file is missing: " + name));
            files.push_back(file);
        }
        las::WriteOptions options;
        options.copyChunks = false;
        const auto survey = opened(files);
        QCOMPARE(survey->parts().size(), files.size());
        fs::create_directory(place("all"));
        survey->save({.target = place("all"), .options = options, .compare = false}, m_progress);
        for (const fs::path& file : files) {
            const auto alone = Session::open(file);
            alone->read(m_progress);
            const fs::path target = place("alone" + file.extension().string());
            alone->save({.target = target, .options = options, .compare = false}, m_progress);
            const lasfiles::Bytes a = lasfiles::readFile(target),
                                  b = lasfiles::readFile(place("all") / file.filename());
            QVERIFY2(a == b, file.c_str());
        }
    }

    /// Values of the survey are those of the files, attribute by attribute.
    void valuesAreThoseOfTheFiles()
    {
        std::vector<fs::path> files;
        for (const char* name : {"autzen_trim_7.las", "autzen_trim.las", "extrabytes.las", "extra.laz"}) {
            files.push_back(fs::path(PUNCTUM_TEST_DATA) / name);
            if (!fs::exists(files.back())) QSKIP("The test data is missing.");
        }
        const auto session = opened(files);
        const PointCloud& all = *session->cloud();
        for (const SessionPart& part : session->parts()) {
            const auto alone = las::load(part.path, m_progress);
            for (const Attribute& a : alone->attributes()) {
                if (a.kind == AttributeKind::Opaque) continue;
                const Attribute* const shared = all.findAttribute(a.name);
                QVERIFY2(shared != nullptr, a.name.c_str());
                for (PointIndex i = 0; i < alone->size(); i += 7) {
                    const double x = a.number(i), y = shared->number(part.points.first + i);
                    const bool close =
                        a.name == "ScanAngle" ? std::abs(x - y) <= 0.003 : x == y || (x != x && y != y);
                    // one byte of a legacy class holds 5 bits, and all of them are there
                    const bool moved = session->survey().parts()[session->survey().partOf(part.points.first)].moved;
                    QVERIFY2(close || (moved && a.name.size() == 1),  // X, Y or Z, shown elsewhere
                             qPrintable(QString("%1 of %2: %3, %4").arg(a.name.c_str()).arg(i).arg(x).arg(y)));
                }
            }
        }
    }

    void pointsOfFilesThatLackAnAttributeHaveNoValue()
    {
        tile("a.las", 1, 0.0, kPoints);
        tile("b.las", 3, 100.0, kPoints);
        const auto session = opened({place("a.las"), place("b.las")});
        const PointCloud& cloud = *session->cloud();
        const Attribute red = *cloud.findAttribute("Red");
        QVERIFY(std::isnan(red.number(5)) && red.lacks(5));
        QVERIFY(!std::isnan(red.number(kPoints + 5)));
        QCOMPARE(computeStatistics(red, 0, m_progress).count, std::uint64_t(kPoints));
        std::uint64_t listed = 0;
        for (const DistinctValue& one : distinctValues(red, 70'000, m_progress).values) listed += one.points;
        QCOMPARE(listed, std::uint64_t(kPoints));
        std::vector<double> values(20);
        red.read({kPoints - 10, kPoints + 10}, values.data());
        for (std::size_t k = 0; k < 20; ++k) QCOMPARE(std::isnan(values[k]), k < 10);
        for (const char* text : {"Red >= 0", "Red + 1 > 0", "Red <= 65535"})
            QCOMPARE(select(cloud, expression::Condition(text, cloud), m_progress)->count(), PointIndex(kPoints));

        // what is given a value has one; a file whose format has no place for it is not saved without a word
        session->edit(rule("Red = 7 if Z > -1000000"), m_progress);
        QCOMPARE(red.number(5), 7.0);
        const lasfiles::Bytes before = lasfiles::readFile(place("a.las")),
                              other = lasfiles::readFile(place("b.las"));
        QVERIFY(complaint([&] { session->save({}, m_progress); }).find("cannot hold") != std::string::npos);
        QVERIFY(lasfiles::readFile(place("a.las")) == before);
        QVERIFY(lasfiles::readFile(place("b.las")) == other);
        las::WriteOptions upgrade;
        upgrade.upgrade = true;
        session->save({.options = upgrade}, m_progress);
        const auto a = las::load(place("a.las"), m_progress);
        QCOMPARE(a->findAttribute("Red")->number(5), 7.0);
    }

    /// One edit over all files, one undo, one save of those that changed.
    void editsKnowNoFiles()
    {
        tile("a.las", 6, 0.0, kPoints);
        tile("b.las", 6, 30.0, kPoints);
        tile("c.las", 6, 60.0, kPoints);
        const auto session = opened({place("c.las"), place("a.las"), place("b.las")});
        auto across = std::make_shared<PointSet>(3 * kPoints);
        across->insert(PointRange{2 * kPoints - 50, 2 * kPoints + 50});
        const EditOutcome edit = session->edit(rule("UserData = 200 if UserData != 200", across), m_progress);
        QVERIFY(edit.changed > 90);
        QCOMPARE(session->changedParts(m_progress), (std::vector<bool>{false, true, true}));
        QVERIFY(session->unsavedChanges(m_progress).ends_with("in 2 of 3 files"));
        session->undo(m_progress);
        QCOMPARE(session->changedParts(m_progress), (std::vector<bool>{false, false, false}));
        QCOMPARE(session->unsavedChanges(m_progress), std::string());
        session->redo(m_progress);
        const fs::file_time_type untouched = fs::last_write_time(place("a.las"));
        fs::copy_file(place("c.las"), place("old.las"));
        const SaveOutcome saved = session->save({}, m_progress);
        QCOMPARE(saved.parts, (std::vector<std::size_t>{1, 2}));
        QVERIFY(saved.compared);
        QCOMPARE(saved.preview.difference.attributes.size(), std::size_t(1));
        QCOMPARE(saved.preview.difference.attributes[0].points, std::uint64_t(edit.changed));
        QVERIFY(!session->history().modified());
        QVERIFY(fs::last_write_time(place("a.las")) == untouched);
        const las::Difference d = las::diffFiles(place("old.las"), place("c.las"), {}, m_progress);
        QVERIFY(d.differing > 40 && d.differing <= 50);
        QCOMPARE(d.attributes.size(), std::size_t(1));
        // undone beyond the save, and saved again: as it was, but for the day in the header
        session->undo(m_progress);
        session->save({}, m_progress);
        QVERIFY(las::diffFiles(place("c.las"), place("old.las"), {}, m_progress).differing == 0);
    }

    /// Steps that look at neighbors give for two tiles what they give for one file of both; the order by place is
    /// made once, until points are deleted.
    void neighborsCrossTheEdges()
    {
        tile("a.las", 1, 0.0, kPoints);
        tile("b.las", 1, 20.0, kPoints);
        const auto session = opened({place("a.las"), place("b.las")});
        session->merge(place("both.las"), {}, m_progress);
        const auto whole = opened({place("both.las")});
        QVERIFY(!whole->many());
        for (const auto& both : {session, whole}) {
            both->edit({"normals", {{"k", "12"}}, nullptr}, m_progress);
            both->edit({"outliers", {{"k", "8"}, {"deviations", "1.5"}, {"class", "7"}}, nullptr}, m_progress);
        }
        for (const char* name : {"NormalX", "NormalY", "NormalZ", "Classification"}) {
            const Attribute &a = *session->cloud()->findAttribute(name), &b = *whole->cloud()->findAttribute(name);
            for (PointIndex i = 0; i < 2 * kPoints; ++i)
                QVERIFY(a.number(i) == b.number(i) || (std::isnan(a.number(i)) && std::isnan(b.number(i))));
        }
        const auto order = KdOrder::of(*session->cloud(), m_progress);
        session->edit(rule("UserData = 3 if UserData != 3"), m_progress);
        QVERIFY(KdOrder::of(*session->cloud(), m_progress) == order);
        session->edit({"delete", {{"where", "X < 5"}}, nullptr}, m_progress);
        const auto fewer = KdOrder::of(*session->cloud(), m_progress);
        QVERIFY(fewer != order && fewer->size() < order->size());
        session->undo(m_progress);
        QCOMPARE(KdOrder::of(*session->cloud(), m_progress)->size(), order->size());
        KdOrder::drop(*session->cloud());
        Progress cancelled;
        cancelled.cancel();
        QVERIFY_EXCEPTION_THROWN(KdOrder::of(*session->cloud(), cancelled), Cancelled);
        QCOMPARE(KdOrder::of(*session->cloud(), m_progress)->size(), order->size());
    }

    /// A polygon over four tiles: as many points as by looking at each file alone, one undo, and the files that are
    /// saved differ in just those.
    void aPolygonOverFourTiles()
    {
        std::vector<fs::path> tiles;
        for (const char* name : {"bcts_1.laz", "bcts_2.laz"}) {
            const fs::path original = fs::path(PUNCTUM_TEST_DATA) / name;
            if (!fs::exists(original)) QSKIP("The test data is missing.");
            lasfiles::Bytes bytes = lasfiles::readFile(original);
            tiles.push_back(place(name));
            lasfiles::writeFile(tiles.back(), bytes);
            // a neighbor to the north: the same points, and offset and box of the header moved by a tile
            const double height = std::ceil(lasfiles::get<double>(bytes, 195) - lasfiles::get<double>(bytes, 203));
            for (const std::size_t at : {163, 195, 203})
                lasfiles::set(bytes, at, lasfiles::get<double>(bytes, at) - height);
            tiles.push_back(place(std::string("south_of_") + name));
            lasfiles::writeFile(tiles.back(), bytes);
        }
        const auto session = opened(tiles);
        const PointCloud& cloud = *session->cloud();
        QCOMPARE(session->survey().warnings().size(), std::size_t(0));
        const WorldBounds bounds = cloud.coordinates().toWorld(cloud.computeBounds());
        const double px = std::max(bounds.max.x - bounds.min.x, bounds.max.y - bounds.min.y) / 1000.0;
        Region region;
        region.mask = ScreenMask(1000, 1000);
        const std::vector<glm::dvec2> corners{{180, 150}, {820, 260}, {700, 500},
                                              {790, 900}, {400, 600}, {210, 850}};
        region.mask.addPolygon(corners);
        const CoordinateScale& grid = cloud.coordinates();
        region.projection.perspective = false;
        region.projection.rowX = {grid.scale.x / px, 0, 0, (grid.offset.x - bounds.min.x) / px};
        region.projection.rowY = {0, -grid.scale.y / px, 0, (bounds.max.y - grid.offset.y) / px};
        region.projection.rowD = {0, 0, 0, 1};
        const auto selected = std::make_shared<PointSet>(pointsIn(region, cloud, {}, m_progress));

        std::vector<std::uint64_t> expected, changed;
        for (const SessionPart& part : session->parts()) {
            const auto alone = las::load(part.path, m_progress);
            const Attribute* const classes = alone->findAttribute("Classification");
            std::uint64_t inside = 0, others = 0;
            for (PointIndex i = 0; i < alone->size(); ++i) {
                const glm::dvec3 p = alone->world(i);
                const bool in = region.mask.contains(int(std::floor((p.x - bounds.min.x) / px)),
                                                     int(std::floor((bounds.max.y - p.y) / px)));
                inside += in ? 1 : 0;
                others += in && classes->number(i) != 17 ? 1 : 0;
                QCOMPARE(selected->contains(part.points.first + i), in);
            }
            QVERIFY(inside > 1000);
            expected.push_back(inside);
            changed.push_back(others);
        }
        QCOMPARE(selected->count(), expected[0] + expected[1] + expected[2] + expected[3]);
        const EditOutcome edit = session->edit(rule("Classification = 17", selected), m_progress);
        QCOMPARE(edit.changed, changed[0] + changed[1] + changed[2] + changed[3]);
        QCOMPARE(session->history().position(), std::size_t(1));
        session->undo(m_progress);
        QVERIFY(!session->history().modified());
        session->redo(m_progress);
        fs::create_directory(place("before"));
        for (const fs::path& tile : tiles) fs::copy_file(tile, place("before") / tile.filename());
        session->save({}, m_progress);
        for (std::size_t k = 0; k < session->parts().size(); ++k) {
            const fs::path file = session->parts()[k].path;
            const las::Difference d = las::diffFiles(place("before") / file.filename(), file, {}, m_progress);
            QCOMPARE(d.differing, changed[k]);
            QCOMPARE(d.attributes.size(), std::size_t(1));
            QCOMPARE(d.attributes[0].name, std::string("Classification"));
        }
    }

    void savingSomeLeavesTheOthersUnsaved()
    {
        tile("a.las", 1, 0.0, kPoints);
        tile("b.las", 1, 30.0, kPoints);
        const auto session = opened({place("a.las"), place("b.las")});
        session->edit(rule("UserData = 3 if UserData != 3"), m_progress);
        SaveRequest one;
        one.parts = {1};
        const SaveOutcome saved = session->save(one, m_progress);
        QCOMPARE(saved.parts, std::vector<std::size_t>{1});
        QVERIFY(saved.others);
        QVERIFY(session->history().modified());
        QCOMPARE(session->changedParts(m_progress), (std::vector<bool>{true, false}));
        const SaveOutcome rest = session->save({}, m_progress);
        QCOMPARE(rest.parts, std::vector<std::size_t>{0});
        QVERIFY(!rest.others);
        QVERIFY(!session->history().modified());
    }

    void deletedPointsAreLeftOutOfTheirFiles()
    {
        tile("a.las", 1, 0.0, kPoints);
        tile("b.las", 1, 30.0, kPoints + 5);
        const auto session = opened({place("a.las"), place("b.las")});
        auto some = std::make_shared<PointSet>(2 * kPoints + 5);
        some->insert(PointRange{kPoints - 3, kPoints + 100});
        session->edit({"delete", {}, some}, m_progress);
        session->save({}, m_progress);
        QCOMPARE(las::load(place("a.las"), m_progress)->size(), PointIndex(kPoints - 3));
        QCOMPARE(las::load(place("b.las"), m_progress)->size(), PointIndex(kPoints + 5 - 100));
        // a journal of the files as they are now
        session->edit(rule("UserData = 77 if UserData != 77"), m_progress);
        const auto journal = session->history().journal();
        QVERIFY(journal == nullptr);  // no folder was given
    }

    /// What a crash leaves behind is found by the same files, in whatever order they are named.
    void crashesLoseNothing()
    {
        tile("a.las", 6, 0.0, kPoints);
        tile("b.las", 1, 30.0, kPoints);
        HistoryRoom room;
        room.folder = place("journals");
        fs::create_directory(room.folder);
        const std::vector<fs::path> files{place("a.las"), place("b.las")};
        std::vector<double> expected;
        {
            const auto session = Session::open(files, room, m_progress);
            session->read(m_progress);
            session->edit(rule("UserData = 5 if UserData < 100"), m_progress);
            session->edit({"delete", {{"where", "UserData == 5"}}, nullptr}, m_progress);
            session->save({}, m_progress);
            session->edit(rule("Intensity = 9 if UserData > 150"), m_progress);
            session->edit({"set", {{"rule", "Twice = Intensity + 0.5"}, {"new", "float64"}}, nullptr}, m_progress);
            expected = valuesOf(*session);
        }
        QCOMPARE(keptJournals(room.folder, m_progress).size(), std::size_t(1));
        QCOMPARE(keptJournals(room.folder, m_progress)[0].files, files);
        const auto session = Session::open(files, room, m_progress);
        session->read(m_progress);
        const auto found = session->findJournal(m_progress);
        QVERIFY(found.has_value());
        const Replayed replayed = session->recover(*found, m_progress);
        QCOMPARE(replayed.stopped, std::string());
        QCOMPARE(replayed.entries, std::size_t(2));
        QVERIFY(valuesOf(*session) == expected);
    }

    /// What is edited after files were saved into another folder is noted as edits of the files there.
    void journalsNameTheFilesThatAreThere()
    {
        tile("a.las", 1, 0.0, kPoints);
        tile("b.las", 1, 30.0, kPoints);
        HistoryRoom room;
        room.folder = place("journals");
        fs::create_directory(room.folder);
        fs::create_directory(place("there"));
        {
            const auto session = Session::open(std::vector{place("a.las"), place("b.las")}, room, m_progress);
            session->read(m_progress);
            session->edit(rule("UserData = 5 if UserData < 100"), m_progress);
            session->save({.target = place("there")}, m_progress);
            session->edit(rule("UserData = 6 if UserData == 5"), m_progress);
        }
        const auto kept = keptJournals(room.folder, m_progress);
        QCOMPARE(kept.size(), std::size_t(1));
        QCOMPARE(kept[0].files, (std::vector<fs::path>{place("there/a.las"), place("there/b.las")}));
        const auto session = Session::open(kept[0].files, room, m_progress);
        session->read(m_progress);
        const auto found = session->findJournal(m_progress);
        QVERIFY(found.has_value());
        QCOMPARE(session->recover(*found, m_progress).stopped, std::string());
    }

    /// A journal of points in another order than they are found in would be of no use: that is said.
    void filesThatChangeTheirOrderAreNotNoted()
    {
        HistoryRoom room;
        room.folder = place("journals");
        for (const char* folder : {"journals", "there", "d1", "d2"}) fs::create_directory(place(folder));
        tile("d1/b.las", 1, 0.0, kPoints);
        tile("d2/a.las", 1, 30.0, kPoints);
        const auto session = Session::open(std::vector{place("d1/b.las"), place("d2/a.las")}, room, m_progress);
        session->read(m_progress);
        session->edit(rule("UserData = 5 if UserData < 100"), m_progress);
        session->save({.target = place("there")}, m_progress);
        QVERIFY(session->takeWarnings().empty());
        session->edit(rule("UserData = 6 if UserData == 5"), m_progress);
        QVERIFY(session->history().journal() == nullptr);
        const auto warnings = session->takeWarnings();
        QCOMPARE(warnings.size(), std::size_t(1));
        QVERIFY(warnings[0].find("another order") != std::string::npos);
    }

    /// Coordinates of files with other steps and origins are the same numbers in the survey.
    void otherGridsAreExact()
    {
        tile("a.las", 1, 0.0, kPoints, 0.01, 0.0);
        tile("b.las", 1, 100.0, kPoints, 0.01, 12.34);
        tile("c.las", 1, 200.0, kPoints, 0.0025, 1000.0);
        const std::vector<fs::path> files{place("a.las"), place("b.las"), place("c.las")};
        const auto session = opened(files);
        QCOMPARE(session->survey().warnings().size(), std::size_t(0));
        for (const SessionPart& part : session->parts()) {
            const auto alone = las::load(part.path, m_progress);
            for (PointIndex i = 0; i < alone->size(); ++i)
                QVERIFY(session->cloud()->world(part.points.first + i) == alone->world(i));
        }
        session->edit(rule("UserData = 1 if UserData != 1"), m_progress);
        session->save({}, m_progress);
        for (const fs::path& file : files) {
            const auto alone = las::load(file, m_progress);
            const std::size_t part = std::size_t(std::find(files.begin(), files.end(), file) - files.begin());
            for (PointIndex i = 0; i < alone->size(); ++i)
                QVERIFY(session->cloud()->world(session->parts()[part].points.first + i) == alone->world(i));
        }
    }

    /// Steps that differ by the rounding of a float are other steps: far from the offset they are centimeters.
    void stepsThatOnceWereFloats()
    {
        constexpr double kFar = 5'000'000.0;
        tile("a.las", 1, kFar, kPoints, 0.01);
        tile("b.las", 1, kFar + 100.0, kPoints, 0.01);
        tile("c.las", 1, kFar + 200.0, kPoints, double(0.01F));
        const auto session = opened({place("a.las"), place("b.las"), place("c.las")});
        QCOMPARE(session->survey().warnings().size(), std::size_t(1));
        QVERIFY(session->survey().warnings()[0].find("c.las") != std::string::npos);
        const auto alone = las::load(place("c.las"), m_progress);
        for (PointIndex i = 0; i < kPoints; ++i)
            QVERIFY(std::abs(session->cloud()->world(2 * kPoints + i).x - alone->world(i).x) < 0.00501);
    }

    /// What comes from another coordinate system need not lie where one grid of all files reaches.
    void oneGridReachesWhatIsMoved()
    {
        const CoordinateScale fine{glm::dvec3(0.0001), glm::dvec3(0.0)};
        const std::vector<GridOfPart> parts{{fine, {glm::dvec3(0.0), glm::dvec3(1000.0)}, 100},
                                            {fine, {glm::dvec3(430'000.0), glm::dvec3(431'000.0)}, 0}};
        const CommonGrid grid = commonGrid(parts);
        for (int axis = 0; axis < 3; ++axis) {
            const double low = (0.0 - grid.coordinates.offset[axis]) / grid.coordinates.scale[axis],
                         high = (431'000.0 - grid.coordinates.offset[axis]) / grid.coordinates.scale[axis];
            QVERIFY(std::abs(low) < 0x1p31 && std::abs(high) < 0x1p31);
        }
    }

    void filesThatCannotBeReadAreSaid()
    {
        tile("a.las", 1, 0.0, kPoints);
        tile("b.las", 1, 30.0, kPoints);
        lasfiles::writeFile(place("no.las"), lasfiles::Bytes(500));
        const auto session = opened({place("a.las"), place("no.las"), place("b.las"), place("missing.las")});
        QCOMPARE(session->parts().size(), std::size_t(2));
        QCOMPARE(session->survey().losses().size(), std::size_t(2));
        QVERIFY(session->survey().losses()[0].find("left out") != std::string::npos);
        QVERIFY(complaint([&] {
                    opened({place("no.las"), place("missing.las")});
                }).find("missing.las") != std::string::npos);

        lasfiles::Bytes cut = lasfiles::readFile(place("b.las"));
        cut.resize(cut.size() - 20);
        lasfiles::writeFile(place("b.las"), cut);
        const auto damaged = opened({place("a.las"), place("b.las")});
        QVERIFY(!damaged->parts()[0].damaged && damaged->parts()[1].damaged);
        damaged->edit(rule("UserData = 3 if UserData != 3"), m_progress);
        QVERIFY(complaint([&] { damaged->save({}, m_progress); }).find("under another name") != std::string::npos);
        SaveRequest sound;
        sound.parts = {0};
        damaged->save(sound, m_progress);
    }

    void mergedIntoOneFile()
    {
        tile("a.las", 1, 0.0, kPoints);
        tile("b.las", 3, 30.0, kPoints);
        const auto session = opened({place("a.las"), place("b.las")});
        session->edit({"set", {{"rule", "Twice = X * 2"}, {"new", "float64"}}, nullptr}, m_progress);
        QVERIFY(complaint([&] { session->merge(place("a.las"), {}, m_progress); }).find("open") !=
                std::string::npos);
        QCOMPARE(session->merge(place("one.laz"), {}, m_progress).points, PointIndex(2 * kPoints));
        const auto one = las::load(place("one.laz"), m_progress);
        for (const Attribute& a : one->attributes()) {
            const Attribute* const shared = session->cloud()->findAttribute(a.name);
            QVERIFY2(shared != nullptr, a.name.c_str());
            for (PointIndex i = 0; i < one->size(); ++i)
                QVERIFY2(a.number(i) == shared->number(i) || std::isnan(shared->number(i)), a.name.c_str());
        }
        QVERIFY(session->history().modified());
    }

    /// Points that could not be read are no points of the one file.
    void mergedWithoutWhatIsDamaged()
    {
        tile("a.las", 1, 0.0, kPoints);
        tile("b.las", 1, 30.0, kPoints);
        las::WriteOptions packed;
        packed.compressed = true;
        las::write(*las::load(place("b.las"), m_progress), place("b.laz"), packed, m_progress);
        lasfiles::Bytes bytes = lasfiles::readFile(place("b.laz"));
        for (std::size_t k = bytes.size() / 3; k < bytes.size() / 2; ++k) bytes[k] ^= std::byte(0x5A);
        lasfiles::writeFile(place("b.laz"), bytes);

        auto session = Session::open(std::vector{place("a.las"), place("b.laz")}, {}, m_progress);
        const las::ReadResult result = session->read(m_progress);
        PointIndex missing = 0;
        for (const PointRange& range : result.missing) missing += range.size();
        QVERIFY(missing != 0);
        const las::WriteReport report = session->merge(place("one.las"), {}, m_progress);
        QCOMPARE(report.points, 2 * kPoints - missing);
        QCOMPARE(las::load(place("one.las"), m_progress)->size(), 2 * kPoints - missing);
        QVERIFY(report.notes.front().find("could not be read") != std::string::npos);
    }

    /// A file without GPS times says nothing on those of the others.
    void theClockIsThatOfTheFirstFileThatHasTimes()
    {
        constexpr std::size_t kEncodingAt = 6;
        tile("a.las", 0, 0.0, kPoints);
        tile("b.las", 1, 30.0, kPoints);
        lasfiles::Bytes b = lasfiles::readFile(place("b.las"));
        lasfiles::set(b, kEncodingAt, std::uint16_t(las::encoding::kAdjustedGpsTime));
        lasfiles::writeFile(place("b.las"), b);
        const auto session = opened({place("a.las"), place("b.las")});
        QCOMPARE(session->survey().warnings().size(), std::size_t(0));
        QVERIFY(session->merge(place("one.las"), {}, m_progress).notes.empty());
        QVERIFY(las::Reader::open(place("one.las"))->source()->header.says(las::encoding::kAdjustedGpsTime));
        // what one file cannot say of all is told
        tile("c.las", 3, 60.0, kPoints);
        tile("d.las", 4, 90.0, kPoints);
        const auto mixed = opened({place("a.las"), place("b.las"), place("c.las"), place("d.las")});
        auto notes = mixed->merge(place("all.las"), {}, m_progress).notes;
        const auto tells = [&](const char* what) {
            return std::any_of(notes.begin(), notes.end(),
                               [&](const std::string& note) { return note.find(what) != std::string::npos; });
        };
        QVERIFY(tells("GPS times in different ways"));
        QVERIFY(tells("waveforms stay"));
        PointSet some(mixed->cloud()->size());
        some.insert(PointRange{5, 3 * kPoints + 5});
        notes = mixed->extract(some, place("some.las"), {}, m_progress).notes;
        QVERIFY(tells("GPS times in different ways") && tells("waveforms stay"));
    }

    /// Points of another system are shown where they belong, and saved as they were.
    void anotherCoordinateSystem()
    {
        const fs::path utm = fs::path(PUNCTUM_TEST_DATA) / "bcts_1.laz";
        if (!fs::exists(utm)) QSKIP("The test data is missing.");
        const auto reader = las::Reader::open(utm);
        const std::string crs = reader->source()->crs;
        QVERIFY(!crs.empty());
        const auto change = las::CrsChange::between(crs, "EPSG:4326");
        QVERIFY(change != nullptr);
        QVERIFY(las::CrsChange::between(crs, "nonsense") == nullptr);
        QVERIFY(las::sameCrs(crs, crs) && !las::sameCrs(crs, "EPSG:4326"));
        const glm::dvec3 middle = 0.5 * (reader->source()->firstBounds.min + reader->source()->firstBounds.max);
        std::vector<glm::dvec3> there{middle};
        (*change)(there);
        QVERIFY(std::abs(there[0].x) <= 180.0 && std::abs(there[0].y) <= 90.0);
        const auto back = las::CrsChange::between("EPSG:4326", crs);
        (*back)(there);
        QVERIFY(glm::length(there[0] - middle) < 1e-3);
    }

    /// Heights in feet among heights in meters, and files in another unit than their system has.
    void heightsOfAnotherUnit()
    {
        const fs::path data = PUNCTUM_TEST_DATA;
        const fs::path meters = data / "isprs/samp21.laz", feet = data / "test1_4.las";
        if (!fs::exists(meters) || !fs::exists(feet)) QSKIP("The test data is missing.");
        const auto session = opened({meters, feet});
        const std::vector<SessionPart> files = session->parts();
        const std::size_t part = files[0].path == feet ? 0 : 1;
        QVERIFY(session->survey().parts()[part].moved);
        const auto alone = las::load(feet, m_progress);
        constexpr double kFoot = 1200.0 / 3937.0;
        for (PointIndex i = 0; i < alone->size(); i += 7)
            QVERIFY(std::abs(session->cloud()->world(files[part].points.first + i).z - alone->world(i).z * kFoot) <
                    0.02);
        const auto a = las::Reader::open(feet);
        QVERIFY(las::isInUnitsOf(a->source()->units, a->source()->crs));
        CoordinateUnits other = a->source()->units;
        other.horizontalSize = 1.0;
        QVERIFY(!las::isInUnitsOf(other, a->source()->crs));
    }

private:
    fs::path place(const std::string& name) const { return fs::path(m_folder->path().toStdString()) / name; }

    std::shared_ptr<Session> opened(const std::vector<fs::path>& files)
    {
        auto session = Session::open(files, {}, m_progress);
        session->read(m_progress);
        return session;
    }

    /// A file whose points lie in a square of 20 by 20 from (x, 0) on.
    void tile(const std::string& name, int format, double x, std::size_t points, double scale = 0.01,
              double offset = 0.0)
    {
        const std::uint16_t length = lasfiles::recordLength(format);
        lasfiles::Bytes header = lasfiles::header(lasfiles::minorFor(format), format, length, points);
        for (std::size_t axis = 0; axis < 3; ++axis) {
            lasfiles::set(header, 131 + 8 * axis, scale);
            lasfiles::set(header, 155 + 8 * axis, offset);
            lasfiles::set(header, 187 + 16 * axis, axis == 0 ? x : 0.0);
            lasfiles::set(header, 179 + 16 * axis, (axis == 0 ? x : 0.0) + 20.0);
        }
        lasfiles::Bytes records = lasfiles::randomRecords(format, length, points, unsigned(x) + 4);
        for (std::size_t i = 0; i < points; ++i)
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double v = (axis == 0 ? x : 0.0) + 20.0 * double((i * (axis + 7)) % 997) / 997.0;
                lasfiles::set(records, i * length + 4 * axis, std::int32_t(std::llround((v - offset) / scale)));
            }
        lasfiles::writeFile(place(name), lasfiles::file(header, {}, records));
    }

    /// All values of all points that are there.
    static std::vector<double> valuesOf(const Session& session)
    {
        std::vector<double> values;
        const PointCloud& cloud = *session.cloud();
        for (const Attribute& a : cloud.attributes())
            for (PointIndex i = 0; i < cloud.size(); ++i)
                if (!cloud.deleted() || !cloud.deleted()->contains(i)) {
                    const double v = a.number(i);
                    values.push_back(std::isnan(v) ? -1.5e300 : v);
                }
        return values;
    }

    std::unique_ptr<QTemporaryDir> m_folder;
    Progress m_progress;
};

QTEST_GUILESS_MAIN(SurveyTest)
#include "SurveyTest.moc"
