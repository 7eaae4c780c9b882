// SPDX-License-Identifier: MIT
#include "core/survey/Overview.h"

#include "core/Error.h"
#include "core/SummedText.h"

#include <QFile>
#include <QTemporaryDir>
#include <QTest>

#include <filesystem>

using namespace punctum;
namespace fs = std::filesystem;

/// What is kept of a survey between openings.
class OverviewTest : public QObject
{
    Q_OBJECT

private slots:
    void init()
    {
        m_folder = std::make_unique<QTemporaryDir>("/var/tmp/punctum-overview-XXXXXX");  // a disk
        qputenv("XDG_CACHE_HOME", m_folder->path().toUtf8());
    }
    void cleanup() { qunsetenv("XDG_CACHE_HOME"); }

    void isFoundAgain()
    {
        Overview kept(files());
        fill(kept);
        Overview again(files());
        QVERIFY(again.find());
        QCOMPARE(again.pieces().size(), kept.pieces().size());
        for (std::size_t k = 0; k < kept.pieces().size(); ++k) {
            QCOMPARE(again.pieces()[k].of, kept.pieces()[k].of);
            QCOMPARE(again.pieces()[k].points.first, kept.pieces()[k].points.first);
            QCOMPARE(again.pieces()[k].points.last, kept.pieces()[k].points.last);
            QVERIFY(again.pieces()[k].values == kept.pieces()[k].values);
        }
        again.forget();
        QVERIFY(!Overview(files()).find());
    }

    void ofOtherFilesIsNone_data()
    {
        QTest::addColumn<QString>("change");
        for (const char* name : {"size", "time", "points", "layout", "path", "one more", "one less", "order"})
            QTest::newRow(name) << name;
    }
    void ofOtherFilesIsNone()
    {
        keep();
        QFETCH(QString, change);
        auto others = files();
        if (change == "size") ++others[1].stamp.size;
        if (change == "time") ++others[1].stamp.modified;
        if (change == "points") ++others[1].points;
        if (change == "layout") others[1].layout += "NIR";
        if (change == "path") others[1].path += "x";
        if (change == "one more") others.push_back(others[0]);
        if (change == "one less") others.pop_back();
        if (change == "order") std::swap(others[0], others[1]);
        // where it would be looked for, whatever its name
        const fs::path wanted = Overview(others).place(), there = Overview(files()).place();
        if (wanted != there) fs::copy_file(there, wanted);
        QVERIFY(!Overview(others).find());
        QVERIFY(Overview(files()).find());
    }

    /// Cut off anywhere, or with any byte changed, it is none.
    void damagedIsNone()
    {
        keep();
        const QByteArray whole = bytesOf(Overview(files()).place());
        for (qsizetype size = 0; size < whole.size(); size += 7) {
            write(whole.left(size));
            QVERIFY2(!Overview(files()).find(), qPrintable(QString::number(size)));
        }
        for (qsizetype at = 0; at < whole.size(); at += 5) {
            QByteArray changed = whole;
            changed[at] = char(changed[at] ^ 64);
            write(changed);
            QVERIFY2(!Overview(files()).find(), qPrintable(QString::number(at)));
        }
        write(whole);
        QVERIFY(Overview(files()).find());
    }

    /// Pieces that are not in their files, or have not what they need, with a sum that is right.
    void liesAreSeen()
    {
        keep();
        const QByteArray whole = bytesOf(Overview(files()).place());
        // Numbers of the first piece: which file, its first point, the one after the last, bytes.
        const qsizetype at = whole.indexOf(QByteArray::fromRawData("\1\0\0\0\0\0\0\0\12\0\0\0\0\0\0\0", 16));
        QVERIFY(at > 0);
        const auto with = [&](int number, std::uint64_t value) {
            QByteArray changed = whole;
            std::memcpy(changed.data() + at + 8 * number, &value, sizeof(value));
            const std::uint32_t sum = crc32(0, {changed.constData(), std::size_t(changed.size()) - 4});
            std::memcpy(changed.data() + changed.size() - 4, &sum, sizeof(sum));
            write(changed);
            return Overview(files()).find();
        };
        QVERIFY(with(0, 1));
        QVERIFY(!with(0, 7));
        QVERIFY(!with(0, 0));  // another file's values are of another size
        QVERIFY(!with(1, 11));
        QVERIFY(!with(2, 13));
        QVERIFY(!with(2, 3));
        QVERIFY(!with(1, UINT64_MAX - 1));
        QVERIFY(!with(3, UINT64_MAX));
        QVERIFY(!with(3, 1));
    }

    /// Those used longest ago go when there are too many.
    void theyAreBounded()
    {
        std::vector<Overview::Of> big = {{"/a", {0, 0, 1, 1}, 50'000'000, "x", 1}};
        const auto name = [&](int k) {
            big[0].path = "/big" + std::to_string(k);
            return big;
        };
        constexpr int kMany = int(Overview::kMostInAll / Overview::kMostBytes);
        for (int k = 0; k <= kMany; ++k) {
            Overview one(name(k));
            one.add({0, {0, Overview::kMostBytes - 4096}, std::vector<std::byte>(Overview::kMostBytes - 4096)});
            if (k == kMany) QVERIFY(Overview(name(0)).find());  // used just now
            one.keep();
        }
        QVERIFY(Overview(name(0)).find());
        QVERIFY(!Overview(name(1)).find());
        QVERIFY(Overview(name(kMany)).find());
        std::uint64_t bytes = 0;
        for (const auto& entry : fs::directory_iterator(Overview::folder())) bytes += entry.file_size();
        QVERIFY(bytes <= Overview::kMostInAll);
    }

    void aFolderThatCannotBeWrittenIsToldOf()
    {
        qputenv("XDG_CACHE_HOME", "/proc/nowhere");
        Overview none(files());
        QVERIFY(!none.find());
        QVERIFY_EXCEPTION_THROWN(none.keep(), Error);
        none.forget();
    }

private:
    static std::vector<Overview::Of> files()
    {
        return {{"/data/a.laz", {1, 2, 1000, 77}, 100, "X int32, Y int32", 8},
                {"/data/b \n.laz", {1, 3, 2000, 78}, 12, "X int32, Y int32, Z int32", 12}};
    }
    static void fill(Overview& overview)
    {
        const auto values = [](std::size_t bytes) {
            std::vector<std::byte> made(bytes);
            for (std::size_t k = 0; k < bytes; ++k) made[k] = std::byte(3 * k + 1);
            return made;
        };
        overview.add({0, {0, 5}, values(40)});
        overview.add({0, {60, 100}, values(320)});
        overview.add({1, {10, 12}, values(24)});
        overview.keep();
    }
    static void keep()
    {
        Overview overview(files());
        fill(overview);
    }
    static void write(const QByteArray& bytes)
    {
        QFile file(QString::fromStdString(Overview(files()).place().string()));
        QVERIFY(file.open(QIODevice::WriteOnly));
        QCOMPARE(file.write(bytes), bytes.size());
    }
    static QByteArray bytesOf(const fs::path& path)
    {
        QFile file(QString::fromStdString(path.string()));
        return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
    }

    std::unique_ptr<QTemporaryDir> m_folder;
};

QTEST_GUILESS_MAIN(OverviewTest)
#include "OverviewTest.moc"
