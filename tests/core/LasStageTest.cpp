// SPDX-License-Identifier: MIT
#include "core/Error.h"
#include "core/las/Writer.h"
#include "tests/core/LasFiles.h"
#include "tests/core/LoadAndSave.h"

#include <QTemporaryDir>
#include <QTest>

#include <algorithm>
#include <mutex>
#include <optional>

using namespace punctum;
using lasfiles::Bytes;
using lasfiles::load;
namespace fs = std::filesystem;

/// A save in two steps: written and verified beside the target first, under its name later.
class LasStageTest : public QObject
{
    Q_OBJECT

private slots:
    void isWhatWritingGives_data();
    void isWhatWritingGives();
    void withoutCommitNothingIsLeft();
    void editsOfBetweenAreNotInIt();
    void targetChangedBetweenStays();
    void waveformsWait();

private:
    fs::path temp(const std::string& name) const { return fs::path(m_dir.path().toStdString()) / name; }
    std::vector<std::string> names() const
    {
        std::vector<std::string> all;
        for (const auto& e : fs::directory_iterator(m_dir.path().toStdString()))
            all.push_back(e.path().filename().string());
        std::sort(all.begin(), all.end());
        return all;
    }
    static las::StagedWrite stage(const PointCloud& cloud, const fs::path& path)
    {
        Progress progress;
        las::WriteOptions options;
        options.compressed = las::isCompressedName(path);
        return las::stage(cloud, path, options, progress);
    }

    QTemporaryDir m_dir;
};

namespace
{

constexpr std::size_t kPoints = 2500;
constexpr std::uint16_t kLength = 36;

Bytes madeFile(bool compressed)
{
    const Bytes points = lasfiles::randomRecords(7, kLength, kPoints, 3, true);
    if (compressed) return lasfiles::lazFile(7, kLength, points, 1000);
    return lasfiles::file(lasfiles::header(4, 7, kLength, kPoints), {}, points);
}

void edit(PointCloud& cloud, std::uint8_t value)
{
    const auto column = cloud.findAttribute("UserData")->columns[0];
    const std::lock_guard lock(cloud.mutex());
    for (std::size_t i = 0; i < cloud.size(); i += 7) column->values<std::uint8_t>()[i] = value;
}

}  // namespace

void LasStageTest::isWhatWritingGives_data()
{
    QTest::addColumn<QString>("name");
    QTest::newRow("LAS") << "a.las";
    QTest::newRow("LAZ") << "a.laz";
}

void LasStageTest::isWhatWritingGives()
{
    QFETCH(QString, name);
    const fs::path path = temp(name.toStdString()), whole = temp("whole" + path.extension().string());
    const Bytes before = madeFile(las::isCompressedName(path));
    lasfiles::writeFile(path, before);
    const auto cloud = load(path);
    edit(*cloud, 77);
    auto staged = stage(*cloud, path);
    QCOMPARE(staged.target(), path);
    QVERIFY(lasfiles::readFile(path) == before);
    QVERIFY(!cloud->source()->current->get().saved);
    const las::WriteReport report = staged.commit();
    QCOMPARE(report.points, PointIndex(kPoints));
    QCOMPARE(report.bytes, std::uint64_t(fs::file_size(path)));
    const las::CurrentFile current = cloud->source()->current->get();
    QVERIFY(current.saved && current.path == path && las::FileStamp::of(path) == current.stamp);

    lasfiles::save(*cloud, whole);
    QVERIFY(lasfiles::readFile(whole) == lasfiles::readFile(path) && lasfiles::readFile(path) != before);
    fs::remove(path);
    fs::remove(whole);
}

void LasStageTest::withoutCommitNothingIsLeft()
{
    const fs::path path = temp("a.las");
    const Bytes before = madeFile(false);
    lasfiles::writeFile(path, before);
    const auto cloud = load(path);
    edit(*cloud, 1);
    const auto beside = names();
    {
        std::vector<las::StagedWrite> several;
        several.push_back(stage(*cloud, path));
        several.push_back(stage(*cloud, temp("new.laz")));
        QCOMPARE(names().size(), beside.size() + 2);
    }
    QCOMPARE(names(), beside);
    QVERIFY(lasfiles::readFile(path) == before);
    QVERIFY(!cloud->source()->current->get().saved);
    fs::remove(path);
}

void LasStageTest::editsOfBetweenAreNotInIt()
{
    const fs::path path = temp("a.las");
    lasfiles::writeFile(path, madeFile(false));
    auto cloud = load(path);
    edit(*cloud, 1);
    auto staged = stage(*cloud, path);
    edit(*cloud, 2);
    cloud.reset();  // a stage needs it no more
    staged.commit();
    QCOMPARE(load(path)->findAttribute("UserData")->number(7), 1.0);
    fs::remove(path);
}

void LasStageTest::targetChangedBetweenStays()
{
    const fs::path path = temp("a.las");
    lasfiles::writeFile(path, madeFile(false));
    const auto cloud = load(path);
    edit(*cloud, 1);
    const Bytes other(100, std::byte('o'));
    std::string said;
    {
        auto staged = stage(*cloud, path);
        lasfiles::writeFile(path, other);
        try {
            staged.commit();
        } catch (const Error& e) {
            said = e.what();
        }
    }
    QVERIFY2(said.starts_with("a.las: The file was changed by another program"), said.c_str());
    QVERIFY(lasfiles::readFile(path) == other);
    QCOMPARE(names(), std::vector<std::string>{"a.las"});
    fs::remove(path);
}

void LasStageTest::waveformsWait()
{
    const std::uint16_t length = lasfiles::recordLength(9);
    Bytes head = lasfiles::header(4, 9, length, 100);
    lasfiles::set<std::uint16_t>(head, 6, 16 | 4);  // WKT; waveforms in a file of their own
    const fs::path path = temp("w.las");
    lasfiles::writeFile(path, lasfiles::file(head, {}, lasfiles::randomRecords(9, length, 100, 1)));
    lasfiles::writeFile(temp("w.wdp"), Bytes(5000, std::byte('w')));
    const auto cloud = load(path);
    std::optional<las::StagedWrite> staged = stage(*cloud, temp("copy.las"));
    QVERIFY(!fs::exists(temp("copy.las")) && !fs::exists(temp("copy.wdp")));
    QCOMPARE(names().size(), std::size_t(4));
    staged->commit();
    QVERIFY(fs::exists(temp("copy.las")) && fs::exists(temp("copy.wdp")));
    QCOMPARE(names().size(), std::size_t(4));
    staged.reset();
    QCOMPARE(names().size(), std::size_t(4));

    // the name is taken meanwhile: the packets do not stay alone
    fs::remove(temp("copy.las"));
    fs::remove(temp("copy.wdp"));
    {
        auto other = stage(*cloud, temp("copy.las"));
        lasfiles::writeFile(temp("copy.las"), Bytes(10));
        QVERIFY_THROWS_EXCEPTION(Error, other.commit());
    }
    QVERIFY(!fs::exists(temp("copy.wdp")));
    QCOMPARE(names().size(), std::size_t(3));
}

QTEST_GUILESS_MAIN(LasStageTest)
#include "LasStageTest.moc"
