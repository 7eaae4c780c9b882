// SPDX-License-Identifier: MIT
#include "core/cloud/PointSet.h"
#include "core/edit/Extract.h"
#include "core/las/Diff.h"
#include "core/las/File.h"
#include "core/las/SourceParser.h"
#include "core/session/Session.h"
#include "tests/core/CopcFiles.h"
#include "tests/core/LoadAndSave.h"

#include <QTemporaryDir>
#include <QTest>

#include <algorithm>

using namespace punctum;
using copcfiles::Key;
using copcfiles::Octree;
using copcfiles::octreeOf;
using lasfiles::Bytes;
using lasfiles::load;
using lasfiles::save;
namespace fs = std::filesystem;

namespace
{

constexpr const char* kReal[] = {"lion_takanawa.copc.laz", "more/ellipsoid-eb.copc.laz",
                                 "more/lasr-example.copc.laz"};

bool hasNote(const las::WriteReport& report, const std::string& part)
{
    return std::any_of(report.notes.begin(), report.notes.end(),
                       [&](const std::string& note) { return note.find(part) != std::string::npos; });
}

bool warnsOfIndex(const las::SourceFile& source, const std::string& part)
{
    return std::any_of(source.warnings.begin(), source.warnings.end(), [&](const std::string& w) {
        return w.starts_with("The spatial index of the COPC file") && w.find(part) != std::string::npos;
    });
}

std::shared_ptr<PointSet> setOf(const PointCloud& cloud, PointRange range)
{
    auto points = std::make_shared<PointSet>(cloud.size());
    points->insert(range);
    return points;
}

/// The node's points in the cloud.
PointRange pointsOf(const PointCloud& cloud, const Key& key)
{
    for (const las::CopcNode& node : cloud.source()->copc->nodes)
        if (Key{node.key.level, node.key.x, node.key.y, node.key.z} == key) return node.points;
    throw std::runtime_error("no such node");
}

template <typename T>
T& value(PointCloud& cloud, const char* column, PointIndex point)
{
    for (const auto& c : cloud.columns())
        if (c->name() == column) return c->values<T>()[point];
    throw std::runtime_error("no such column");
}

}  // namespace

/// COPC files: their octree is read where it is sound, and a file that is saved keeps it. What is written is held
/// against a reader of its own (CopcFiles.h).
class CopcTest : public QObject
{
    Q_OBJECT

private slots:
    void octreesAreRead_data() { files(); }
    void octreesAreRead();
    void hostileOctreesAreNotUsed_data();
    void hostileOctreesAreNotUsed();
    void coarseNodesComeFirst();
    void uneditedIsTheSameFile_data() { files(); }
    void uneditedIsTheSameFile();
    void editedNodesAreWrittenAnew_data() { files(); }
    void editedNodesAreWrittenAnew();
    void deletedPointsLeaveTheirNodes();
    void timesFollowEdits();
    void newAttributesKeepTheOctree();
    void whatCannotBeKeptIsSaid();
    void extractsKeepTheOctree();
    void filesOfSurveysKeepTheirs();

private:
    fs::path temp(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    fs::path make(const std::string& name, const Bytes& bytes) const
    {
        lasfiles::writeFile(temp(name), bytes);
        return temp(name);
    }
    static void files();
    /// The file of a row: a copy that may be written.
    fs::path file(const QString& name) const;

    QTemporaryDir m_dir;
};

void CopcTest::files()
{
    QTest::addColumn<QString>("name");
    QTest::newRow("made") << QString();
    for (const char* name : kReal) QTest::newRow(name) << QString(name);
}

fs::path CopcTest::file(const QString& name) const
{
    if (name.isEmpty())
        return make("made.copc.laz", copcfiles::made({lasfiles::wktRecord("LOCAL_CS[\"here\"]", true)}));
    const fs::path path = fs::path(PUNCTUM_TEST_DATA) / name.toStdString();
    return fs::exists(path) ? make("real.copc.laz", lasfiles::readFile(path)) : fs::path();
}

void CopcTest::octreesAreRead()
{
    QFETCH(QString, name);
    const fs::path path = file(name);
    if (path.empty()) QSKIP("the real file is not here");
    copcfiles::checkCubes(path);
    const auto cloud = load(path);
    const las::SourceFile& source = *cloud->source();
    QVERIFY(source.copc);
    QVERIFY(source.copcTrouble.empty() && !warnsOfIndex(source, ""));
    const Octree tree = octreeOf(lasfiles::readFile(path));
    QCOMPARE(source.copc->nodes.size(), tree.nodes.size());
    QCOMPARE(source.copc->spacing, tree.spacing);
    PointIndex sum = 0;
    for (const las::CopcNode& node : source.copc->nodes) {
        const auto& there = tree.nodes.at({node.key.level, node.key.x, node.key.y, node.key.z});
        QCOMPARE(node.points.size(), PointIndex(there.points));
        sum += node.points.size();
        const WorldBounds cube = source.copc->cube(node.key);
        for (PointIndex i = node.points.first; i < node.points.last; ++i) {
            const glm::dvec3 p = cloud->world(i), step = cloud->coordinates().scale;
            for (int k = 0; k < 3; ++k) QVERIFY(p[k] >= cube.min[k] - step[k] && p[k] <= cube.max[k] + step[k]);
        }
    }
    QCOMPARE(sum, cloud->size());
}

void CopcTest::hostileOctreesAreNotUsed_data()
{
    QTest::addColumn<QByteArray>("bytes");
    QTest::addColumn<QString>("said");
    const Bytes sound = copcfiles::made();
    const Octree tree = octreeOf(sound);
    const std::size_t pages = std::size_t(lasfiles::get<std::uint64_t>(sound, copcfiles::kInfo + 40));
    const auto row = [&](const char* name, const char* said, auto&& change) {
        Bytes b = sound;
        change(b);
        QTest::newRow(name) << QByteArray(reinterpret_cast<const char*>(b.data()), qsizetype(b.size()))
                            << QString(said);
    };
    const auto put = [](std::size_t at, auto v) { return [=](Bytes& b) { lasfiles::set(b, at, v); }; };
    const std::size_t info = copcfiles::kInfo, entry = tree.nodes.at({1, 0, 0, 0}).entry;
    row("root beyond the file", "is not in its record", put(info + 40, std::uint64_t(1) << 60));
    row("root among the points", "is not in its record", put(info + 40, std::uint64_t(700)));
    row("root that is too long", "is not in its record", put(info + 48, std::uint64_t(1) << 40));
    row("root of no whole entries", "is not in its record", put(info + 48, std::uint64_t(33)));
    row("no root", "is not in its record", put(info + 48, std::uint64_t(0)));
    row("page that wraps", "is not in its record", put(pages + 32 * 8 + 16, ~std::uint64_t(0) - 8));
    row("page cut", "chunk 9 of 9 is not in it", put(pages + 32 * 8 + 24, std::int32_t(32)));
    row("page of negative size", "a size that cannot be", put(pages + 32 * 8 + 24, std::int32_t(-64)));
    row("circle", "", [&](Bytes& b) {
        lasfiles::set<std::uint64_t>(b, pages + 32 * 8 + 16, pages);
        lasfiles::set<std::int32_t>(b, pages + 32 * 8 + 24, 32 * 9);
    });
    row("page over another", "", put(pages + 32 * 8 + 16, std::uint64_t(pages + 32 * 5)));
    row("node beyond the file", "1-0-0-0 is no chunk", put(entry + 16, std::uint64_t(1) << 50));
    row("node within a chunk", "1-0-0-0 is no chunk",
        put(entry + 16, std::uint64_t(tree.nodes.at({1, 0, 0, 0}).offset + 1)));
    row("wrong size", "1-0-0-0 is no chunk", put(entry + 24, std::int32_t(17)));
    row("wrong count", "1-0-0-0 is no chunk", put(entry + 28, std::int32_t(17)));
    row("count below -1", "a size that cannot be", put(entry + 28, std::int32_t(-2)));
    row("node lost", "is not in it", put(entry + 28, std::int32_t(0)));
    row("two nodes of one chunk", "are the same chunk", [&](Bytes& b) {
        std::copy_n(sound.begin() + std::ptrdiff_t(entry + 16), 16, b.begin() + std::ptrdiff_t(entry + 32 + 16));
    });
    row("key twice", "twice", put(entry + 4, std::int32_t(1)));
    row("key outside", "there is no node", put(entry + 4, std::int32_t(2)));
    row("key negative", "there is no node", put(entry + 8, std::int32_t(-1)));
    row("level negative", "there is no node", put(entry, std::int32_t(-1)));
    row("level 40", "there is no node", put(entry, std::int32_t(40)));
    row("cube nowhere", "nowhere", put(info + 8, std::nan("")));
    row("cube of no size", "no size", put(info + 24, -1.0));
    row("hierarchy of another", "is missing", put(std::size_t(pages - 60 + 18), std::uint16_t(1001)));
    row("info of another length", "160", [&](Bytes& b) {  // it ends earlier, and the rest is another record
        lasfiles::set<std::uint16_t>(b, 375 + 20, 100);
        std::fill(b.begin() + 375 + 54 + 100, b.begin() + 375 + 54 + 160, std::byte(0));
        lasfiles::set<std::uint16_t>(b, 375 + 54 + 100 + 20, 6);
        lasfiles::set<std::uint32_t>(b, 100, 3);
    });
}

void CopcTest::hostileOctreesAreNotUsed()
{
    QFETCH(QByteArray, bytes);
    QFETCH(QString, said);
    Bytes b(std::size_t(bytes.size()));
    std::memcpy(b.data(), bytes.data(), b.size());
    const auto cloud = load(make("hostile.copc.laz", b));
    QVERIFY(!cloud->source()->copc);
    QVERIFY2(warnsOfIndex(*cloud->source(), said.toStdString()), cloud->source()->copcTrouble.c_str());
    QVERIFY(!cloud->source()->recovered);
    const auto sound = load(make("sound.copc.laz", copcfiles::made()));
    QCOMPARE(cloud->size(), sound->size());
    for (std::size_t k = 0; k < sound->columns().size(); ++k) {
        const Column &x = *sound->columns()[k], &y = *cloud->columns()[k];
        QVERIFY(std::memcmp(x.data(), y.data(), std::size_t(x.size() * x.elementBytes())) == 0);
    }
    // What is saved is plain LAZ, and says so.
    const auto report = save(*cloud, temp("saved.copc.laz"));
    QVERIFY(hasNote(report, "The spatial index of the COPC file is left out: it did not belong to the points"));
    QVERIFY(hasNote(report, "an ordinary LAZ file; give it another name"));
    const auto again = load(temp("saved.copc.laz"));
    QVERIFY(again->source()->findVlr("copc", 1) == nullptr && again->source()->findVlr("copc", 1000) == nullptr);
    QVERIFY(!warnsOfIndex(*again->source(), ""));
}

void CopcTest::coarseNodesComeFirst()
{
    // Nodes in the order of the real file: the root comes last.
    const auto reader = las::Reader::open(make("made.copc.laz", copcfiles::made()));
    const auto order = reader->order(false);
    const auto& nodes = reader->source()->copc->nodes;
    QCOMPARE(order.size(), std::size_t(9));
    QVERIFY(std::is_sorted(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
        return nodes[a].key.level < nodes[b].key.level;
    }));
    QCOMPARE(std::set<std::uint32_t>(order.begin(), order.end()).size(), order.size());
    QCOMPARE(reader->source()->copc->levels(), 2);
    QVERIFY(reader->source()->copc->pointsByLevel() == std::vector<PointIndex>({700, 5200}));
    QVERIFY(order == reader->order(true));
}

void CopcTest::uneditedIsTheSameFile()
{
    QFETCH(QString, name);
    const fs::path path = file(name);
    if (path.empty()) QSKIP("the real file is not here");
    const auto cloud = load(path);
    const auto report = save(*cloud, temp("same.copc.laz"));
    QVERIFY2(report.notes.empty(), report.notes.empty() ? "" : report.notes.front().c_str());
    QCOMPARE(report.chunksEncoded, std::uint64_t(0));
    QVERIFY(lasfiles::readFile(temp("same.copc.laz")) == lasfiles::readFile(path));
    // edited and taken back
    auto& first = value<std::uint8_t>(*cloud, "Classification", 0);
    const std::uint8_t before = first;
    first = std::uint8_t(before + 1);
    save(*cloud, temp("other.laz"));
    QVERIFY(lasfiles::readFile(temp("other.laz")) != lasfiles::readFile(path));
    first = before;
    save(*cloud, path);
    const auto again = load(path);
    Progress progress;
    const las::Difference d = las::diffFiles(path, temp("same.copc.laz"), {}, progress);
    QVERIFY(d.contentEqual());
    copcfiles::checkCubes(path);
    // a chunk of another encoder may have other bytes; LASzip's come back
    if (path.filename() == "made.copc.laz")
        QVERIFY(lasfiles::readFile(path) == lasfiles::readFile(temp("same.copc.laz")));
}

void CopcTest::editedNodesAreWrittenAnew()
{
    QFETCH(QString, name);
    const fs::path path = file(name);
    if (path.empty()) QSKIP("the real file is not here");
    const Bytes before = lasfiles::readFile(path);
    const Octree was = octreeOf(before);
    const auto cloud = load(path);
    const PointRange root = pointsOf(*cloud, {0, 0, 0, 0});
    const PointIndex edited[] = {root.first, root.first + 3, root.last - 1};
    for (const PointIndex i : edited) ++value<std::uint8_t>(*cloud, "Classification", i);
    const auto report = save(*cloud, temp("edited.copc.laz"));
    QVERIFY2(report.notes.empty(), report.notes.empty() ? "" : report.notes.front().c_str());
    QCOMPARE(report.chunksEncoded, std::uint64_t(1));

    const Bytes after = lasfiles::readFile(temp("edited.copc.laz"));
    const Octree now = octreeOf(after);
    copcfiles::checkCubes(temp("edited.copc.laz"));
    QCOMPARE(now.nodes.size(), was.nodes.size());
    for (const auto& [key, node] : was.nodes) {
        QCOMPARE(now.nodes.at(key).points, node.points);
        if (key[0] != 0 && node.points > 0) QVERIFY(now.chunk(after, key) == was.chunk(before, key));
    }
    QVERIFY(now.chunk(after, {0, 0, 0, 0}) != was.chunk(before, {0, 0, 0, 0}));
    // of header and records before the points nothing else changed than where the extended records are
    const std::size_t points = lasfiles::get<std::uint32_t>(before, 96);
    for (std::size_t k = 0; k < points; ++k) {
        const bool place = (k >= 235 && k < 243) || (k >= copcfiles::kInfo + 40 && k < copcfiles::kInfo + 48);
        QVERIFY2(place || before[k] == after[k], qPrintable(QString::number(k)));
    }
    // what differs are three classes
    Progress progress;
    const las::Difference d = las::diffFiles(path, temp("edited.copc.laz"), {}, progress);
    QCOMPARE(d.differing, PointIndex(3));
    QCOMPARE(d.attributes.size(), std::size_t(1));
    QVERIFY(d.attributes.front().name == "Classification");
    QVERIFY(d.records.empty() && d.header.empty() && d.bytes.empty() && !d.recordsReordered);
    // as a look ahead says
    las::WriteOptions options;
    options.compressed = true;
    const las::SavePreview preview = las::previewSave(*load(temp("edited.copc.laz")), temp("edited.copc.laz"),
                                                      temp("edited.copc.laz"), options, progress);
    QVERIFY(preview.difference.contentEqual() && preview.notes.empty());
}

void CopcTest::deletedPointsLeaveTheirNodes()
{
    const Bytes before = copcfiles::made();
    const auto cloud = load(make("made.copc.laz", before));
    const Octree was = octreeOf(before);
    const PointRange emptied = pointsOf(*cloud, {1, 1, 0, 0}), thinned = pointsOf(*cloud, {1, 1, 1, 1});
    auto gone = setOf(*cloud, emptied);
    for (PointIndex i = thinned.first; i < thinned.last; i += 2) gone->insert(i);
    cloud->setDeleted(gone);
    auto report = save(*cloud, temp("fewer.copc.laz"));
    QVERIFY(hasNote(report, "deleted") && !hasNote(report, "index"));
    QCOMPARE(report.chunksEncoded, std::uint64_t(1));
    QCOMPARE(report.chunksCopied, std::uint64_t(7));
    const Bytes after = lasfiles::readFile(temp("fewer.copc.laz"));
    Octree now = octreeOf(after);
    copcfiles::checkCubes(temp("fewer.copc.laz"));
    for (const auto& [key, node] : was.nodes) {
        if (key == Key{1, 1, 0, 0}) {
            QCOMPARE(now.nodes.at(key).points, 0);
        } else if (key == Key{1, 1, 1, 1}) {
            QCOMPARE(now.nodes.at(key).points, node.points / 2);
        } else {
            QCOMPARE(now.nodes.at(key).points, node.points);
            if (node.points > 0) QVERIFY(now.chunk(after, key) == was.chunk(before, key));
        }
    }
    // times: the last node, which had the highest, lost its even points
    QCOMPARE(now.firstTime, 1000.0);
    QCOMPARE(now.lastTime, 1800.999);
    QVERIFY(las::Reader::open(temp("fewer.copc.laz"))->source()->copc);

    // the rest of what is deleted, saved over the file of before, whose chunks are the origin now
    cloud->setDeleted(setOf(*cloud, {0, cloud->size()}));
    save(*cloud, temp("fewer.copc.laz"));
    now = octreeOf(lasfiles::readFile(temp("fewer.copc.laz")));
    for (const auto& [key, node] : now.nodes) QCOMPARE(node.points, 0);
    QVERIFY(las::Reader::open(temp("fewer.copc.laz"))->source()->copc);

    // all of it back again: the file that it was, as LASzip made it and makes it
    cloud->setDeleted(nullptr);
    report = save(*cloud, temp("fewer.copc.laz"));
    QVERIFY(report.notes.empty());
    QVERIFY(lasfiles::readFile(temp("fewer.copc.laz")) == before);
}

void CopcTest::timesFollowEdits()
{
    const auto cloud = load(make("made.copc.laz", copcfiles::made()));
    value<double>(*cloud, "GpsTime", 5) = -3.5;
    value<double>(*cloud, "GpsTime", 6) = std::nan("");
    value<double>(*cloud, "GpsTime", cloud->size() - 1) = 1e9;
    save(*cloud, temp("times.copc.laz"));
    const Octree now = octreeOf(lasfiles::readFile(temp("times.copc.laz")));
    QCOMPARE(now.firstTime, -3.5);
    QCOMPARE(now.lastTime, 1e9);

    // what was wrong from the start stays as it is
    Bytes wrong = copcfiles::made();
    lasfiles::set<double>(wrong, copcfiles::kInfo + 56, 7.0);
    const auto other = load(make("wrong.copc.laz", wrong));
    ++value<std::uint8_t>(*other, "Classification", 0);
    save(*other, temp("wrong2.copc.laz"));
    QCOMPARE(octreeOf(lasfiles::readFile(temp("wrong2.copc.laz"))).firstTime, 7.0);
}

void CopcTest::newAttributesKeepTheOctree()
{
    const auto cloud = load(make("made.copc.laz", copcfiles::made()));
    const auto column = std::make_shared<Column>("Id", ScalarType::U32, cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i) column->values<std::uint32_t>()[i] = std::uint32_t(i);
    cloud->addColumn(column);
    Attribute attribute;
    attribute.name = "Id";
    attribute.columns[0] = column;
    cloud->addAttribute(attribute);
    const auto report = save(*cloud, temp("id.copc.laz"));
    QVERIFY(!hasNote(report, "index"));
    QCOMPARE(report.chunksEncoded, std::uint64_t(9));
    copcfiles::checkCubes(temp("id.copc.laz"));
    const auto again = load(temp("id.copc.laz"));
    QVERIFY(again->source()->copc && again->findAttribute("Id") != nullptr);
    QCOMPARE(again->findAttribute("Id")->number(1234), 1234.0);
}

void CopcTest::whatCannotBeKeptIsSaid()
{
    const auto cloud = load(make("made.copc.laz", copcfiles::made()));
    Progress progress;
    las::WriteOptions options;
    QVERIFY(hasNote(las::write(*cloud, temp("plain.las"), options, progress), "an ordinary LAS file"));
    QVERIFY(!las::Reader::open(temp("plain.las"))->source()->findVlr("copc", 1));
    options.compressed = true;
    options.versionMinor = 5;
    auto report = las::write(*cloud, temp("newest.copc.laz"), options, progress);
    QVERIFY(hasNote(report, "COPC has no point format 7 of LAS 1.5") && hasNote(report, "another name"));
    options.versionMinor.reset();
    options.pointFormat = std::uint8_t(10);
    QVERIFY(hasNote(las::write(*cloud, temp("ten.laz"), options, progress), "COPC has no point format 10"));
    // another format that it has, and chunks that are all compressed anew
    options.pointFormat = std::uint8_t(8);
    options.copyChunks = false;
    report = las::write(*cloud, temp("eight.copc.laz"), options, progress);
    QVERIFY(!hasNote(report, "index") && !hasNote(report, "name"));
    copcfiles::checkCubes(temp("eight.copc.laz"));
    // from there back again, which has no chunks of that kind
    const auto wide = load(temp("eight.copc.laz"));
    QVERIFY(wide->source()->copc);
}

void CopcTest::extractsKeepTheOctree()
{
    const Bytes before = copcfiles::made();
    const auto cloud = load(make("made.copc.laz", before));
    const PointRange whole = pointsOf(*cloud, {1, 0, 1, 0}), partly = pointsOf(*cloud, {0, 0, 0, 0});
    auto wanted = setOf(*cloud, whole);
    for (PointIndex i = partly.first + 1; i < partly.last; i += 3) wanted->insert(i);
    Progress progress;
    const auto part = extracted(*cloud, *wanted, progress);
    const auto report = save(*part, temp("part.copc.laz"));
    QVERIFY(!hasNote(report, "index") && !hasNote(report, "name"));
    QCOMPARE(report.chunksCopied, std::uint64_t(1));
    QCOMPARE(report.chunksEncoded, std::uint64_t(1));
    const Bytes after = lasfiles::readFile(temp("part.copc.laz"));
    const Octree was = octreeOf(before), now = octreeOf(after);
    copcfiles::checkCubes(temp("part.copc.laz"));
    QCOMPARE(now.nodes.at({1, 0, 1, 0}).points, int(whole.size()));
    QVERIFY(now.chunk(after, {1, 0, 1, 0}) == was.chunk(before, {1, 0, 1, 0}));
    QCOMPARE(now.nodes.at({0, 0, 0, 0}).points, 233);
    QCOMPARE(now.nodes.at({1, 0, 0, 0}).points, 0);
    QCOMPARE(now.firstTime, 1000.001);
    const auto again = load(temp("part.copc.laz"));
    QVERIFY(again->source()->copc);
    QCOMPARE(again->size(), wanted->count());
}

void CopcTest::filesOfSurveysKeepTheirs()
{
    const fs::path folder = temp("survey");
    fs::create_directories(folder);
    const Bytes before = copcfiles::made();
    for (const char* name : {"a.copc.laz", "b.copc.laz"}) lasfiles::writeFile(folder / name, before);
    Progress progress;
    HistoryRoom room;
    room.folder = temp("journals");
    const auto session = Session::open({folder / "a.copc.laz", folder / "b.copc.laz"}, room, progress);
    session->read(progress);
    const PointIndex each = session->cloud()->size() / 2;
    auto points = std::make_shared<PointSet>(2 * each);
    points->insert(each + 5);
    session->edit({"set", {{"rule", "UserData = UserData + 1"}}, points}, progress);
    const SaveOutcome outcome = session->save({{}, {}, false, {}, {}}, progress);
    QVERIFY(!hasNote(outcome.report, "index") && !hasNote(outcome.report, "name"));
    QVERIFY(lasfiles::readFile(folder / "a.copc.laz") == before);
    QVERIFY(lasfiles::readFile(folder / "b.copc.laz") != before);
    copcfiles::checkCubes(folder / "b.copc.laz");
    QVERIFY(las::diffFiles(folder / "a.copc.laz", folder / "b.copc.laz", {}, progress).differing == 1);
}

QTEST_GUILESS_MAIN(CopcTest)
#include "CopcTest.moc"
