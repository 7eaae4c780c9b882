// SPDX-License-Identifier: MIT
// Folders are searched for LAS and LAZ files, wholly, in order, and without walking in circles.
#include "core/Error.h"
#include "core/FindFiles.h"
#include "core/task/Progress.h"

#include <QTemporaryDir>
#include <QTest>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

using namespace punctum;

class FindFilesTest : public QObject
{
    Q_OBJECT

    static void write(const std::filesystem::path& path, const std::string& bytes = "12345")
    {
        std::filesystem::create_directories(path.parent_path());
        std::ofstream(path) << bytes;
    }
    static std::string json(std::string text)
    {
        std::replace(text.begin(), text.end(), '\'', '"');
        return text;
    }

private slots:
    void findsThemInAllFolders()
    {
        const QTemporaryDir folder;
        const std::filesystem::path root = folder.path().toStdString();
        write(root / "b.laz");
        write(root / "a.LAS", "123");
        write(root / "notes.txt");
        write(root / "las");         // a name, no ending
        write(root / "c.las.part");  // another ending
        write(root / "deep/er/x.Laz");
        std::filesystem::create_directories(root / "folder.las");  // a folder is no file, whatever its name
        write(root / "folder.las/y.las");
        std::filesystem::create_directory_symlink(root, root / "deep/circle");
        std::filesystem::create_symlink(root / "b.laz", root / "deep/link.laz");
        std::filesystem::create_symlink(root / "nowhere", root / "deep/dangling.laz");

        FoundFiles found;
        Progress progress;
        findFiles(root, found, progress);
        const std::vector<std::filesystem::path> expected{root / "a.LAS", root / "b.laz", root / "deep/er/x.Laz",
                                                          root / "deep/link.laz", root / "folder.las/y.las"};
        QVERIFY(found.files == expected);
        QCOMPARE(found.bytes, std::uint64_t(3 + 4 * 5));
        QCOMPARE(likelyMemory("a.las", 10), std::uint64_t(10));
        QCOMPARE(likelyMemory("a.LAZ", 10), std::uint64_t(70));
        std::uint64_t memory = 0;
        for (const auto& file : found.files) memory += likelyMemory(file, std::filesystem::file_size(file));
        QCOMPARE(found.memory, memory);
        QCOMPARE(found.closedFolders, std::size_t(0));
    }

    void tellsWhatCannotBeRead()
    {
        FoundFiles found;
        Progress progress;
        QVERIFY_EXCEPTION_THROWN(findFiles("/there is/no such folder", found, progress), Error);
        QVERIFY(found.files.empty());

        // a folder inside that is closed to us is counted; others are looked into
        const QTemporaryDir folder;
        const std::filesystem::path root = folder.path().toStdString();
        write(root / "closed/a.las");
        write(root / "open/b.las");
        const uid_t was = ::geteuid();
        ::chmod(root.c_str(), 0755);
        ::chmod((root / "closed").c_str(), 0);
        if (was == 0) QCOMPARE(::seteuid(65534), 0);
        findFiles(root, found, progress);
        if (was == 0) QCOMPARE(::seteuid(was), 0);
        ::chmod((root / "closed").c_str(), 0700);
        QCOMPARE(found.closedFolders, std::size_t(1));
        QVERIFY(found.files == std::vector<std::filesystem::path>{root / "open/b.las"});
    }

    void canBeCancelled()
    {
        const QTemporaryDir folder;
        write(std::filesystem::path(folder.path().toStdString()) / "a.las");
        FoundFiles found;
        Progress progress;
        progress.cancel();
        QVERIFY_EXCEPTION_THROWN(findFiles(folder.path().toStdString(), found, progress), Cancelled);
    }

    void aVirtualCloudNamesFiles()
    {
        const QTemporaryDir folder;
        const std::filesystem::path root = folder.path().toStdString();
        write(root / "tiles/a.laz", "1234567");
        const std::string absolute = (root / "tiles" / "with blank.laz").string();
        write(absolute, "12");
        std::string url = "file://" + absolute;
        url.replace(url.find(' '), 1, "%20");
        write(root / "all.VPC", json("{'type': 'FeatureCollection', 'features': ["
                                     "{'assets': {'data': {'href': './tiles/a.laz', 'roles': ['data']},"
                                     "            'overview': {'href': './over.laz', 'roles': ['overview']}}},"
                                     "{'assets': {'data': {'href': '" +
                                     url +
                                     "'}}},"
                                     "{'assets': {'data': {'href': 'tiles/../tiles/a.laz'}}},"
                                     "{'assets': {'data': {'href': 'https://example.org/b.laz'}}},"
                                     "{'assets': {'data': {'href': 'tiles/missing.laz'}}},"
                                     "{'assets': [7]}, 3, {'assets': {'data': {'href': 4}}}]}"));
        QVERIFY(standsForFiles(root / "all.VPC"));
        QVERIFY(standsForFiles(root));
        QVERIFY(!standsForFiles(root / "tiles/a.laz"));
        QVERIFY(!standsForFiles(root / "nowhere.vpc"));
        FoundFiles found;
        Progress progress;
        addFilesOf(root / "all.VPC", found, progress);
        const std::vector<std::filesystem::path> expected{root / "tiles/a.laz", absolute,
                                                          root / "tiles/missing.laz"};
        QVERIFY(found.files == expected);
        QCOMPARE(found.bytes, std::uint64_t(9));
        QCOMPARE(found.remote, std::size_t(1));
    }

    void otherTextsAreNoVirtualClouds_data()
    {
        QTest::addColumn<QByteArray>("text");
        QTest::addColumn<QString>("why");
        QTest::newRow("empty") << QByteArray() << "no list of features";
        QTest::newRow("no JSON") << QByteArray("LASF\0\1\2", 7) << "no list of features";
        QTest::newRow("cut") << QByteArray::fromStdString(json("{'features': [{'assets': {'data'"))
                             << "no list of features";
        QTest::newRow("deep") << QByteArray(1'000'000, '[') << "no list of features";
        QTest::newRow("no file") << QByteArray::fromStdString(json("{'features': []}")) << "names no file";
        QTest::newRow("servers") << QByteArray::fromStdString(
                                        json("{'features': [{'assets': {'data': {'href': 's3://a/b.laz'}}}]}"))
                                 << "lie on servers";
    }
    void otherTextsAreNoVirtualClouds()
    {
        QFETCH(QByteArray, text);
        QFETCH(QString, why);
        const QTemporaryDir folder;
        const std::filesystem::path file = (folder.path() + "/a.vpc").toStdString();
        write(file, text.toStdString());
        FoundFiles found;
        Progress progress;
        try {
            addFilesOf(file, found, progress);
            QFAIL("It was read.");
        } catch (const Error& error) {
            QVERIFY2(QString::fromUtf8(error.what()).contains(why), error.what());
        }
    }
};

QTEST_GUILESS_MAIN(FindFilesTest)
#include "FindFilesTest.moc"
