// SPDX-License-Identifier: MIT
// Surveys of so many files that not all stay open, and that no file's count is proved before its points are read.
#include "core/las/Reader.h"
#include "core/session/Session.h"
#include "core/survey/Survey.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/LasFiles.h"

#include <QTemporaryDir>
#include <QTest>

#include <sys/resource.h>

#include <algorithm>

using namespace punctum;
namespace fs = std::filesystem;

namespace
{

constexpr std::size_t kFiles = 70;  ///< more than stay open
constexpr std::size_t kPoints = 700;
constexpr std::uint8_t kFormat = 1;
constexpr std::size_t kCountAt = 107;     ///< in the header: number of points
constexpr std::size_t kByReturnAt = 111;  ///< likewise, of first returns
constexpr rlim_t kFewHandles = 48;

/// A LAZ file of one chunk whose header says that it has so many points, by return as well.
lasfiles::Bytes tileOf(std::uint32_t seed, std::uint32_t stated)
{
    const std::uint16_t length = lasfiles::recordLength(kFormat);
    auto bytes = lasfiles::lazFile(kFormat, length, lasfiles::randomRecords(kFormat, length, kPoints, seed, true));
    lasfiles::set<std::uint32_t>(bytes, kCountAt, stated);
    lasfiles::set<std::uint32_t>(bytes, kByReturnAt, stated);
    return bytes;
}

}  // namespace

class ManyFilesTest : public QObject
{
    Q_OBJECT

private slots:
    void init()
    {
        m_folder = std::make_unique<QTemporaryDir>();
        m_files.clear();
        for (std::size_t k = 0; k < kFiles; ++k) write(k, kPoints);
    }

    /// Nothing is decoded to open them, and what is read is what each file holds.
    void everyFileIsAsItIsAlone()
    {
        const auto session = read();
        QVERIFY(m_read.warnings.empty() && m_read.missing.empty() && !session->damaged());
        QCOMPARE(session->cloud()->size(), PointIndex(kFiles * kPoints));
        for (std::size_t k = 0; k < kFiles; ++k) QVERIFY(sameAsAlone(*session, k, kPoints));
    }

    /// A header that counts by return what it states is believed; only when the points are read it turns out wrong.
    void lessThanStated()
    {
        write(5, kPoints + 90);
        write(6, kPoints + 1);
        const auto session = read();
        QVERIFY(mentions(m_read.warnings, "005.laz: The header says 790 points, the file holds 700."));
        QVERIFY(mentions(m_read.warnings, "006.laz: The header says 701 points, the file holds 700."));
        QCOMPARE(m_read.missing.size(), std::size_t(2));
        QCOMPARE(m_read.missing[0].first, PointIndex(6 * kPoints));
        QCOMPARE(m_read.missing[0].size(), PointIndex(90));
        QCOMPARE(m_read.missing[1].size(), PointIndex(1));
        for (const std::size_t k : {4, 5, 6, 7}) {
            QVERIFY(sameAsAlone(*session, k, kPoints));
            QCOMPARE(session->parts()[k].damaged, k == 5 || k == 6);
        }
    }

    /// There is no room for them in the survey: the file is left out, and what is seen is told of.
    void moreThanStated()
    {
        write(5, kPoints - 1);
        const auto session = read();
        QVERIFY(mentions(m_read.warnings,
                         "The header says 699 points, the file holds 700; open it by itself to see "
                         "them. Its points are missing."));
        QVERIFY(session->parts()[5].damaged && !session->parts()[4].damaged);
        QCOMPARE(m_read.missing.size(), std::size_t(1));
        QCOMPARE(m_read.missing[0].size(), PointIndex(kPoints - 1));
        QVERIFY(sameAsAlone(*session, 6, kPoints));
    }

    /// Whose counts by return are others has not counted: the data decides, as for a file alone.
    void headersThatDoNotAgreeAreNotBelieved()
    {
        lasfiles::Bytes bytes = tileOf(5, kPoints + 90);
        lasfiles::set<std::uint32_t>(bytes, kByReturnAt, kPoints);
        lasfiles::writeFile(m_files[5], bytes);
        const auto session = read();
        QCOMPARE(session->cloud()->size(), PointIndex(kFiles * kPoints));
        QVERIFY(m_read.missing.empty());
        QVERIFY(mentions(session->survey().warnings(), "005.laz: The header says 790 points, the file holds 700."));
        QVERIFY(sameAsAlone(*session, 5, kPoints));
    }

    /// Damage is told of as it is in a file alone.
    void damage()
    {
        lasfiles::Bytes bytes = tileOf(5, kPoints);
        for (std::size_t k = 0; k < 40; ++k) bytes[bytes.size() / 2 + k] = std::byte(k * 37);
        lasfiles::writeFile(m_files[5], bytes);
        const auto session = read();
        QVERIFY2(mentions(m_read.warnings, "005.laz: The points 0 to 699 are damaged and could not be read"),
                 m_read.warnings.empty() ? "" : m_read.warnings.front().c_str());
        QVERIFY(session->parts()[5].damaged && session->damaged());
    }

    /// Files that go, shrink or become others after their headers were read: a sentence each, and the rest is
    /// there.
    void filesThatVanish()
    {
        const auto session = Session::open(m_files, {}, m_progress);
        fs::remove(m_files[3]);
        fs::resize_file(m_files[7], fs::file_size(m_files[7]) - 1);
        lasfiles::writeFile(m_files[9], tileOf(900, kPoints - 1));
        m_read = session->read(m_progress);
        QVERIFY(mentions(m_read.warnings, "There is no such file. Its points are missing."));
        const std::string changed =
            "The file was changed by another program while it was being opened. Its points are missing.";
        QCOMPARE(std::count_if(m_read.warnings.begin(), m_read.warnings.end(),
                               [&](const std::string& s) { return s.find(changed) != std::string::npos; }),
                 std::ptrdiff_t(2));
        for (const std::size_t k : {3, 7, 9}) QVERIFY(session->parts()[k].damaged);
        QVERIFY(sameAsAlone(*session, 8, kPoints));
    }

    /// More files than the system lets a program open.
    void fewHandles()
    {
        rlimit before{};
        QVERIFY(getrlimit(RLIMIT_NOFILE, &before) == 0);
        const rlimit few{kFewHandles, before.rlim_max};
        QVERIFY(setrlimit(RLIMIT_NOFILE, &few) == 0);
        const std::string trouble = complaint([&] { read(); });
        setrlimit(RLIMIT_NOFILE, &before);
        QCOMPARE(trouble, std::string("no error"));
        QVERIFY(m_read.warnings.empty() && m_read.missing.empty());
    }

private:
    void write(std::size_t k, std::uint32_t stated)
    {
        const std::string number = std::to_string(k);
        const fs::path path =
            fs::path(m_folder->path().toStdString()) / (std::string(3 - number.size(), '0') + number + ".laz");
        lasfiles::writeFile(path, tileOf(std::uint32_t(k), stated));
        if (k == m_files.size()) m_files.push_back(path);
    }
    /// Opens all, and reads the first points before the others, as the window does.
    std::shared_ptr<Session> read()
    {
        auto session = Session::open(m_files, {}, m_progress);
        m_read = session->read(m_progress, [](PointRange) {});
        return session;
    }
    /// Whether the first points of a file have the values that they have when it is opened by itself.
    bool sameAsAlone(const Session& session, std::size_t file, PointIndex points)
    {
        const auto alone = las::load(m_files[file], m_progress);
        const PointIndex first = session.parts()[file].points.first;
        if (alone->size() != points) return false;
        for (const Attribute& a : alone->attributes()) {
            const Attribute* const shared = session.cloud()->findAttribute(a.name);
            if (shared == nullptr) return false;
            for (PointIndex i = 0; i < points; ++i) {
                const double x = a.number(i), y = shared->number(first + i);
                if (!(x == y) && !(x != x && y != y)) return false;
            }
        }
        return true;
    }

    Progress m_progress;
    std::unique_ptr<QTemporaryDir> m_folder;
    std::vector<fs::path> m_files;
    las::ReadResult m_read;
};

QTEST_APPLESS_MAIN(ManyFilesTest)
#include "ManyFilesTest.moc"
