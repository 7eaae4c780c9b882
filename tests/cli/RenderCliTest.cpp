// SPDX-License-Identifier: MIT
// punctum render: the picture shows the cloud, from where it was asked for, in the colors asked for.
#include "core/las/Writer.h"
#include "core/sample/Sample.h"
#include "core/task/Progress.h"
#include "tests/cli/Program.h"

#include <QImage>
#include <QImageReader>
#include <QJsonArray>
#include <QTemporaryDir>

#include <algorithm>
#include <set>

using namespace punctum;
using namespace punctum::test;

namespace
{

QImage pictureOf(const QString& path)
{
    return QImage(path).convertToFormat(QImage::Format_RGBA8888);
}

/// Share of pixels that are not fully transparent.
double coveredShare(const QImage& picture)
{
    qint64 covered = 0;
    for (int y = 0; y < picture.height(); ++y)
        for (int x = 0; x < picture.width(); ++x) covered += qAlpha(picture.pixel(x, y)) != 0;
    return double(covered) / double(picture.width()) / picture.height();
}

}  // namespace

class RenderCliTest : public QObject
{
    Q_OBJECT

private:
    QTemporaryDir m_folder;
    QString path(const QString& name) const { return m_folder.filePath(name); }

    /// Renders the survey at 640x400 onto nothing; a null picture when that failed.
    QImage render(const QString& name, const QStringList& more)
    {
        const QString out = path(name);
        const Outcome run = runPunctum(
            QStringList{"render", path("in.las"), "-o", out, "--size", "640x400", "--background", "transparent"} +
            more);
        if (run.exitCode != 0) qWarning("%s", run.said().constData());
        return run.exitCode == 0 ? pictureOf(out) : QImage();
    }

private slots:
    void initTestCase() { PUNCTUM_EXIT(runPunctum({"sample", path("in.las"), "--points", "400000"}), 0); }

    void showsARealCloud()
    {
        const QString file = realFile("autzen_trim.laz");
        if (!QFile::exists(file)) QSKIP("autzen_trim.laz is not here.");
        const Outcome run = runPunctum({"render", file, "-o", path("autzen.png"), "--background", "transparent"});
        PUNCTUM_EXIT(run, 0);
        const QImage picture = pictureOf(path("autzen.png"));
        QCOMPARE(picture.size(), QSize(1280, 800));
        const double covered = coveredShare(picture);
        QVERIFY2(covered > 0.05 && covered < 0.95, qPrintable(QString::number(covered)));
        std::set<QRgb> colors;
        for (int y = 0; y < 800; ++y)
            for (int x = 0; x < 1280; ++x) colors.insert(picture.pixel(x, y));
        QVERIFY(colors.size() > 500);
    }

    /// Marks lie in their corners, and grow with the picture unless they are told otherwise.
    void drawsMarks()
    {
        const QImage plain = render("unmarked.png", {"--attribute", "Classification"});
        QVERIFY(!plain.isNull());
        const auto differing = [&](const QImage& other, const QRect& part) {
            int unlike = 0;
            for (int y = part.top(); y <= part.bottom(); ++y)
                for (int x = part.left(); x <= part.right(); ++x) unlike += plain.pixel(x, y) != other.pixel(x, y);
            return double(unlike) / (part.width() * part.height());
        };
        const QRect left(0, 330, 240, 70), right(400, 320, 240, 80), top(0, 0, 640, 100);
        const QImage bar = render("bar.png", {"--attribute", "Classification", "--scale-bar", "--north-arrow"});
        QCOMPARE(bar.size(), plain.size());
        QVERIFY(differing(bar, left) > 0.2);
        QCOMPARE(differing(bar, right), 0.0);
        const QImage legend = render("legend.png", {"--attribute", "Classification", "--legend"});
        QCOMPARE(differing(legend, left), 0.0);
        QVERIFY(differing(legend, right) > 0.4);
        const QImage small =
            render("small.png", {"--attribute", "Classification", "--legend", "--mark-scale", "0.5"});
        QVERIFY(differing(small, right) < differing(legend, right));
        QVERIFY(differing(small, right) > 0.05);
        QCOMPARE(differing(legend, top), 0.0);
        const Outcome wrong = runPunctum({"render", path("in.las"), "-o", path("wrong.png"), "--ruler"});
        QCOMPARE(wrong.exitCode, 2);
    }

    /// They darken the relief here and there, the more the less is between them, and bring it themselves.
    void drawsContours()
    {
        const QStringList view{"--view", "top", "--filter", "Classification == 2"};
        const QImage relief = render("relief.png", view + QStringList{"--surface", "heights"});
        QVERIFY(!relief.isNull());
        const auto darker = [&](const QImage& other) {
            int darkened = 0, lightened = 0;
            for (int y = 0; y < relief.height(); ++y)
                for (int x = 0; x < relief.width(); ++x) {
                    const int change = qGray(other.pixel(x, y)) - qGray(relief.pixel(x, y));
                    darkened += int(change < -5);
                    lightened += int(change > 5);
                }
            return lightened == 0 ? darkened : -lightened;
        };
        const int few = darker(render("few.png", view + QStringList{"--contours", "10"}));
        const int many = darker(render("many.png", view + QStringList{"--contours=5"}));
        QVERIFY2(few > 200 && many > few * 3 / 2, qPrintable(QStringLiteral("%1, %2").arg(few).arg(many)));
        const Outcome suitable =
            runPunctum({"render", path("in.las"), "--contours", "-o", path("auto.png"), "--json"});
        PUNCTUM_EXIT(suitable, 0);
        QVERIFY(suitable.json()["contours"].toDouble() > 0);
        for (const QString& wrong : {QString("0"), QString("-1"), QString("often")})
            QCOMPARE(runPunctum({"render", path("in.las"), "-o", path("w.png"), "--contours", wrong}).exitCode, 2);
    }

    void fillsThePictureWithTheCloud()
    {
        const QImage picture = render("plain.png", {"--samples", "1"});
        QCOMPARE(picture.size(), QSize(640, 400));
        const double covered = coveredShare(picture);
        QVERIFY2(covered > 0.1 && covered < 0.9, qPrintable(QString::number(covered)));
        QCOMPARE(qAlpha(picture.pixel(0, 0)), 0);
        QVERIFY(qAlpha(picture.pixel(320, 200)) != 0);
    }

    /// Larger than what is drawn in one piece: made of tiles, which nobody sees.
    void largePictures()
    {
        const Outcome run = runPunctum({"render", path("in.las"), "-o", path("large.png"), "--size", "9000x7800",
                                        "--samples", "1", "--point-size", "12", "--edl", "--json"});
        PUNCTUM_EXIT(run, 0);
        const Outcome small = runPunctum({"render", path("in.las"), "-o", path("small.png"), "--size", "900x780",
                                          "--samples", "1", "--point-size", "1.2", "--edl", "--json"});
        PUNCTUM_EXIT(small, 0);
        const auto covered = [](const Outcome& o) {
            return QJsonDocument::fromJson(o.out).object().value("covered").toDouble();
        };
        QVERIFY(std::abs(covered(run) - covered(small)) < 0.03);
        QImageReader::setAllocationLimit(512);  // MB
        const QImage picture = pictureOf(path("large.png"));
        QCOMPARE(picture.size(), QSize(9000, 7800));
        // across the seams colors change no more than beside them
        const auto change = [&](int x) {
            double sum = 0;
            for (int y = 0; y < picture.height(); y += 3) {
                const QRgb a = picture.pixel(x - 1, y), b = picture.pixel(x, y);
                sum +=
                    std::abs(qRed(a) - qRed(b)) + std::abs(qGreen(a) - qGreen(b)) + std::abs(qBlue(a) - qBlue(b));
            }
            return sum;
        };
        for (const int seam : {2048, 4096, 6144}) {
            double beside = 0;
            for (const int d : {-30, -20, -10, 10, 20, 30}) beside = std::max(beside, change(seam + d));
            QVERIFY2(change(seam) < 1.5 * beside + 100, qPrintable(QString::number(seam)));
        }
    }

    void convergesToTheBruteForcePicture_data()
    {
        QTest::addColumn<QStringList>("options");
        QTest::newRow("1 sample") << QStringList{"--samples", "1"};
        QTest::newRow("4 samples") << QStringList{"--samples", "4"};
        QTest::newRow("large points") << QStringList{"--samples", "1", "--point-size", "3.5"};
        QTest::newRow("round, world size") << QStringList{"--samples", "4", "--world-size", "2", "--round"};
        QTest::newRow("by density, averaged") << QStringList{"--adaptive-size", "1.5", "--average"};
        QTest::newRow("filter and planes") << QStringList{"--filter",    "Classification == 2", "--clip-plane",
                                                          "0,0,-1,-1e5", "--clip-plane",        "1,0,0,0"};
        QTest::newRow("a quantity") << QStringList{"--samples", "4", "--attribute", "Z", "--view", "front"};
    }
    void convergesToTheBruteForcePicture()
    {
        QFETCH(QStringList, options);
        const QImage converged = render("converged.png", options);
        const QImage reference = render("reference.png", options + QStringList{"--brute-force"});
        QVERIFY(!converged.isNull() && !reference.isNull());
        QVERIFY(converged == reference);
    }

    void drawsTheSameByOpenGl_data()
    {
        QTest::addColumn<QStringList>("look");
        QTest::addColumn<QString>("backend");
        for (const char* backend : {"gl-points", "gl-compute"}) {
            QTest::addRow("1 sample, %s", backend) << QStringList{"--samples", "1"} << backend;
            QTest::addRow("4 samples, %s", backend) << QStringList{"--samples", "4"} << backend;
            QTest::addRow("averaged, %s", backend) << QStringList{"--samples", "1", "--average"} << backend;
        }
        QTest::newRow("8 samples, gl-compute") << QStringList{"--samples", "8"} << "gl-compute";
    }
    void drawsTheSameByOpenGl()
    {
        QFETCH(QStringList, look);
        QFETCH(QString, backend);
        const QStringList options = look + QStringList{"--point-size", "2"};
        const QImage cpu = render("cpu.png", options + QStringList{"--backend", "cpu"});
        const Outcome run = runPunctum(QStringList{"render", path("in.las"), "-o", path("gl.png"), "--size",
                                                   "640x400", "--background", "transparent", "--backend", backend} +
                                       options);
        if (run.exitCode == 1 && run.err.contains("OpenGL") && run.err.contains("no"))
            QSKIP(qPrintable("This machine has no OpenGL to test: " + run.err));
        PUNCTUM_EXIT(run, 0);
        const QImage gl = pictureOf(path("gl.png"));
        qint64 covered = 0;
        qint64 different = 0;
        for (int y = 0; y < 400; ++y)
            for (int x = 0; x < 640; ++x) {
                if (qAlpha(cpu.pixel(x, y)) == 0 && qAlpha(gl.pixel(x, y)) == 0) continue;
                ++covered;
                different += cpu.pixel(x, y) != gl.pixel(x, y);
            }
        // Points whose edge passes a sample within the rounding of the GPU's fixed-point positions (1/256 px), and
        // points of nearly the same depth, may fall the other way: measured well below 1 % of the covered pixels.
        QVERIFY(covered > 10'000);
        QVERIFY2(different * 100 <= covered, qPrintable(QString("%1 of %2").arg(different).arg(covered)));
    }

    /// Each hides something, and nothing else is drawn.
    void hidesWhatItIsTold()
    {
        const QStringList top{"--view", "top", "--samples", "1", "--attribute", "Classification"};
        const double all = coveredShare(render("all.png", top));
        const Outcome info = runPunctum({"info", path("in.las"), "--json"});
        const QJsonArray low = info.json()["min"].toArray(), high = info.json()["max"].toArray();
        const auto at = [&](int axis, double share) {
            return QString::number(low[axis].toDouble() + share * (high[axis].toDouble() - low[axis].toDouble()));
        };
        const QString half =
            at(0, 0) + ',' + at(1, 0) + ',' + at(2, -1) + ':' + at(0, 0.5) + ',' + at(1, 1) + ',' + at(2, 2);
        QVERIFY(coveredShare(render("filter.png", top + QStringList{"--filter", "Classification == 6"})) <
                0.5 * all);
        const QImage plane = render("plane.png", top + QStringList{"--clip-plane", "-1,0,0,-" + at(0, 0.5)});
        QVERIFY(coveredShare(plane) < 0.7 * all);
        QVERIFY(render("clip.png", top + QStringList{"--clip", half}) != render("all.png", top));
        const QStringList command{"render", path("in.las"), "-o", path("no.png")};
        for (const QStringList& wrong :
             {QStringList{"--filter", "Intensity >"}, QStringList{"--clip", "1,2:3"},
              QStringList{"--clip", "1,2,3:0,9,9"}, QStringList{"--clip-plane", "0,0,0,1"}})
            PUNCTUM_EXIT(runPunctum(command + wrong), 2);
        for (const QStringList& wrong :
             {QStringList{"--filter", "NoSuchThing > 3"}, QStringList{"--clip", "-9,-9,-9:-8,-8,-8"}}) {
            const Outcome run = runPunctum(command + wrong);
            PUNCTUM_EXIT(run, 1);
            QVERIFY2(run.oneSentence(), run.said().constData());
        }
        QVERIFY(!QFile::exists(path("no.png")));
    }

    /// The picture is fitted to what is drawn, without points far away, of which a note tells.
    void fitsToWhatIsDrawn()
    {
        Progress progress;
        const auto cloud = makeSample(20'000, 7, progress);
        cloud->columns()[0]->values<std::int32_t>()[77] += std::int32_t(60'000 / cloud->coordinates().scale.x);
        las::WriteOptions options;
        options.verify = false;
        las::write(*cloud, path("stray.las").toStdString(), options, progress);
        const auto run = [&](const QStringList& more) {
            return runPunctum(QStringList{"render", path("stray.las"), "-o", path("stray.png"), "--view", "top",
                                          "--size", "640x400", "--json"} +
                              more);
        };
        const Outcome typical = run({});
        PUNCTUM_EXIT(typical, 0);
        QVERIFY(typical.json()["covered"].toDouble() > 0.2);
        // The survey has some noise high above it, too.
        const int strays = typical.json()["strays"].toInt();
        QVERIFY2(strays >= 1 && strays < 10, typical.said().constData());
        QVERIFY2(typical.err.contains("far away from all the others"), typical.said().constData());
        const Outcome all = run({"--with-strays"});
        PUNCTUM_EXIT(all, 0);
        QVERIFY(all.json()["covered"].toDouble() < 0.01);
        QVERIFY2(!all.err.contains("far away"), all.said().constData());
        const Outcome filtered =
            run({"--with-strays", "--filter", "X < " + QString::number(cloud->world(0).x + 30'000)});
        PUNCTUM_EXIT(filtered, 0);
        QVERIFY2(filtered.json()["covered"].toDouble() > 0.02, filtered.said().constData());
        QCOMPARE(filtered.json()["shown"].toInt(), 19'999);
        const Outcome nothing = run({"--filter", "X < 0 and X > 0"});
        PUNCTUM_EXIT(nothing, 1);
        QVERIFY2(nothing.oneSentence(), nothing.said().constData());
    }

    /// Colors of the file can be made brighter; those of a quantity stay.
    void tonesColors()
    {
        const auto brightness = [](const QImage& picture) {
            double sum = 0, count = 0;
            for (int y = 0; y < picture.height(); ++y)
                for (int x = 0; x < picture.width(); ++x)
                    if (const QColor c = picture.pixelColor(x, y); c.alpha() == 255) {
                        sum += c.value();
                        ++count;
                    }
            return sum / count;
        };
        const QStringList colors{"--attribute", "RGB", "--samples", "1"};
        const double plain = brightness(render("plain.png", colors));
        QVERIFY(brightness(render("bright.png", colors + QStringList{"--brightness", "0.2"})) > plain + 20);
        QVERIFY(brightness(render("gamma.png", colors + QStringList{"--gamma", "2"})) > plain + 10);
        QVERIFY(render("contrast.png", colors + QStringList{"--contrast", "0.4"}) != render("plain.png", colors));
        const QStringList height{"--attribute", "Z", "--samples", "1"};
        QVERIFY(render("z.png", height) == render("z-bright.png", height + QStringList{"--brightness", "0.2"}));
        PUNCTUM_EXIT(runPunctum({"render", path("in.las"), "-o", path("no.png"), "--gamma", "0"}), 2);
    }

    void looksFromWhereItIsTold()
    {
        std::vector<QImage> pictures;
        for (const char* view : {"top", "front", "left", "iso"}) {
            pictures.push_back(render(QString(view) + ".png", {"--view", view, "--samples", "1"}));
            QVERIFY2(coveredShare(pictures.back()) > 0.01, view);
        }
        for (std::size_t a = 0; a < pictures.size(); ++a)
            for (std::size_t b = a + 1; b < pictures.size(); ++b) QVERIFY(pictures[a] != pictures[b]);
        QVERIFY(coveredShare(pictures[0]) > coveredShare(pictures[1]));  // a survey is flat: more to see from above
    }

    /// Plans and elevations are orthographic, and in perspective when told so.
    void projectsAsItIsTold()
    {
        const QStringList common{"render", path("in.las"), "-o", path("p.png"), "--size", "200x160", "--json"};
        const auto orthographic = [&](const QStringList& options) -> QJsonValue {
            return runPunctum(common + options).json()["camera"].toObject()["orthographic"];
        };
        for (const char* view : {"top", "bottom", "front", "back", "left", "right"}) {
            QCOMPARE(orthographic({"--view", view}), QJsonValue(true));
            QCOMPARE(orthographic({"--view", view, "--projection", "perspective"}), QJsonValue(false));
        }
        QCOMPARE(orthographic({"--view", "iso"}), QJsonValue(false));
        QCOMPARE(orthographic({}), QJsonValue(false));
        QCOMPARE(orthographic({"--projection", "orthographic"}), QJsonValue(true));
        PUNCTUM_EXIT(runPunctum(common + QStringList{"--projection", "parallel"}), 2);
        PUNCTUM_EXIT(runPunctum(common + QStringList{"--projection", "perspective", "--camera", path("c.json")}),
                     2);
        PUNCTUM_EXIT(runPunctum(common + QStringList{"--projection", "perspective", "--section", "0,0:1,1"}), 2);
    }

    void takesACameraThatItGave()
    {
        const QStringList common{"render", path("in.las"), "--size", "320x200", "--samples", "1", "--json", "-o"};
        const Outcome first = runPunctum(common + QStringList{path("a.png"), "--view", "left"});
        PUNCTUM_EXIT(first, 0);
        QCOMPARE(first.json()["width"].toInt(), 320);
        QVERIFY(first.json()["covered"].toDouble() > 0.01);
        QFile camera(path("camera.json"));
        QVERIFY(camera.open(QIODevice::WriteOnly));
        camera.write(QJsonDocument(first.json()["camera"].toObject()).toJson());
        camera.close();
        PUNCTUM_EXIT(runPunctum(common + QStringList{path("b.png"), "--camera", path("camera.json")}), 0);
        QVERIFY(pictureOf(path("a.png")) == pictureOf(path("b.png")));
    }

    void refusesCamerasThatAreNone_data()
    {
        QTest::addColumn<QByteArray>("content");
        QTest::newRow("not JSON") << QByteArray("eye 1 2 3");
        QTest::newRow("empty") << QByteArray();
        QTest::newRow("a list") << QByteArray("[1, 2, 3]");
        QTest::newRow("two numbers") << QByteArray("{\"eye\": [1, 2]}");
        QTest::newRow("unknown key") << QByteArray("{\"yaw\": 3, \"roll\": 5}");
        QTest::newRow("text for a number") << QByteArray("{\"pitch\": \"down\"}");
        QTest::newRow("out of bounds") << QByteArray("{\"fov\": 190}");
    }
    void refusesCamerasThatAreNone()
    {
        QFETCH(QByteArray, content);
        QFile camera(path("wrong.json"));
        QVERIFY(camera.open(QIODevice::WriteOnly) && camera.write(content) == content.size());
        camera.close();
        const Outcome run =
            runPunctum({"render", path("in.las"), "-o", path("wrong.png"), "--camera", path("wrong.json")});
        PUNCTUM_EXIT(run, 1);
        QVERIFY2(run.oneSentence(), run.said());
        QVERIFY(!QFile::exists(path("wrong.png")));
    }

    void colorsByAttributeMapAndRange()
    {
        const QStringList base{"--view", "top", "--samples", "1"};
        const QImage rgb = render("rgb.png", base);
        const QImage height = render("height.png", base + QStringList{"--attribute", "Z"});
        const QImage lower = render("lower.png", base + QStringList{"--attribute", "z"});
        const QImage grey = render("grey.png", base + QStringList{"--attribute", "Z", "--color-map", "grey"});
        const QImage narrow =
            render("narrow.png", base + QStringList{"--attribute", "Z", "--range", "-9000:-8000"});
        QVERIFY(rgb != height && height != grey && height != narrow);
        QVERIFY(height == lower);  // however the name is spelt
        bool allGray = true;
        std::set<QRgb> narrowColors;
        for (int y = 0; y < grey.height(); ++y)
            for (int x = 0; x < grey.width(); ++x) {
                const QRgb g = grey.pixel(x, y);
                if (qAlpha(g) != 0) allGray = allGray && qRed(g) == qGreen(g) && qGreen(g) == qBlue(g);
                if (qAlpha(narrow.pixel(x, y)) != 0) narrowColors.insert(narrow.pixel(x, y));
            }
        QVERIFY(allGray);
        QCOMPARE(narrowColors.size(), std::size_t(1));  // everything lies above: one color

        const Outcome run = runPunctum({"render", path("in.las"), "-o", path("no.png"), "--attribute", "Zest"});
        PUNCTUM_EXIT(run, 1);
        QVERIFY2(run.oneSentence() && run.err.contains("Intensity"), run.said());
    }

    void paintsTheBackground()
    {
        const auto corner = [this](const QString& background, bool bottom) {
            runPunctum({"render", path("in.las"), "-o", path("background.png"), "--size", "200x100", "--view",
                        "top", "--background", background});
            const QImage picture = pictureOf(path("background.png"));
            return picture.pixel(0, bottom ? 99 : 0);
        };
        QCOMPARE(corner("white", false), qRgba(255, 255, 255, 255));
        QCOMPARE(corner("#102030", true), qRgba(16, 32, 48, 255));
        QCOMPARE(corner("red:blue", false), qRgba(255, 0, 0, 255));
        QCOMPARE(corner("red:blue", true), qRgba(0, 0, 255, 255));
        QCOMPARE(qAlpha(corner("transparent", false)), 0);
    }

    /// A section is the picture that its four planes and its camera give.
    void section()
    {
        const Outcome info = runPunctum({"info", "--json", path("in.las")});
        const QJsonArray low = info.json()["min"].toArray(), high = info.json()["max"].toArray();
        const auto middle = [&](int axis) { return (low[axis].toDouble() + high[axis].toDouble()) / 2; };
        const double x1 = middle(0) - 40, x2 = middle(0) + 60, y = middle(1);
        const auto number = [](double v) { return QString::number(v, 'f', 6); };
        const QString line = number(x1) + ',' + number(y) + ':' + number(x2) + ',' + number(y);
        const QStringList size{"--size", "800x300", "--samples", "1", "--json", "--background", "transparent"};
        const Outcome run = runPunctum(QStringList{"render", path("in.las"), "-o", path("section.png"), "--section",
                                                   line, "--section-width", "6", "--exaggeration", "1"} +
                                       size);
        PUNCTUM_EXIT(run, 0);
        const QImage picture = pictureOf(path("section.png"));
        QVERIFY(coveredShare(picture) > 0.005);
        const QJsonObject camera = run.json()["camera"].toObject();
        QCOMPARE(camera["pitch"].toDouble(), 0.0);
        QCOMPARE(camera["yaw"].toDouble(), 0.0);  // looks north
        QVERIFY(camera["orthographic"].toBool());
        QFile file(path("section.json"));
        QVERIFY(file.open(QIODevice::WriteOnly));
        file.write(QJsonDocument(camera).toJson());
        file.close();
        const Outcome same =
            runPunctum(QStringList{"render", path("in.las"), "-o", path("planes.png"), "--camera",
                                   path("section.json"), "--clip-plane", "1,0,0," + number(x1 - 1e-4),
                                   "--clip-plane", "-1,0,0," + number(-x2 - 1e-4), "--clip-plane",
                                   "0,1,0," + number(y - 3), "--clip-plane", "0,-1,0," + number(-y - 3)} +
                       size);
        PUNCTUM_EXIT(same, 0);
        QVERIFY(picture == pictureOf(path("planes.png")));
        // heights reach twice as far
        const auto reach = [](const QImage& image) {
            int first = image.height(), last = 0;
            for (int row = 0; row < image.height(); ++row)
                for (int x = 0; x < image.width(); ++x)
                    if (qAlpha(image.pixel(x, row)) != 0) {
                        first = std::min(first, row);
                        last = row;
                    }
            return last - first;
        };
        const int once = reach(render("once.png", {"--section", line, "--exaggeration", "0.2"}));
        const int twice = reach(render("twice.png", {"--section", line, "--exaggeration", "0.4"}));
        QVERIFY2(std::abs(twice - 2 * once) <= 4, qPrintable(QStringLiteral("%1 %2").arg(once).arg(twice)));
        const QString back = number(x2) + ',' + number(y) + ':' + number(x1) + ',' + number(y);
        QVERIFY(!render("back.png", {"--section", back}).isNull());
        // what a filter hides has no height
        const double ceiling = camera["pivot"].toArray()[2].toDouble();
        const Outcome filtered =
            runPunctum(QStringList{"render", path("in.las"), "-o", path("filtered.png"), "--section", line,
                                   "--section-width", "6", "--filter", "Z < " + number(ceiling)} +
                       size);
        PUNCTUM_EXIT(filtered, 0);
        const QJsonObject below = filtered.json()["camera"].toObject();
        QVERIFY(below["pivot"].toArray()[2].toDouble() < ceiling - 0.1);

        for (const QStringList& wrong : {QStringList{"--section", "1,2:1,2"},
                                         {"--section", "1,2,3:4,5,6"},
                                         {"--section", "1,2"},
                                         {"--section-width", "4"},
                                         {"--section", line, "--section-width", "0"},
                                         {"--section", line, "--view", "top"}})
            PUNCTUM_EXIT(runPunctum(QStringList{"render", path("in.las"), "-o", path("no.png")} + wrong), 2);
        const Outcome beside =
            runPunctum({"render", path("in.las"), "-o", path("no.png"), "--section", "-9000000,0:-9000010,0"});
        PUNCTUM_EXIT(beside, 1);
        QVERIFY2(beside.oneSentence(), beside.said());
        QVERIFY(!QFile::exists(path("no.png")));
    }

    void drawsSeveralFilesTogether()
    {
        const QString first = realFile("bcts_1.laz");
        const QString second = realFile("bcts_2.laz");
        if (!QFile::exists(first) || !QFile::exists(second)) QSKIP("bcts_1.laz and bcts_2.laz are not here.");
        const Outcome run = runPunctum({"render", first, second, "-o", path("both.png"), "--view", "top", "--size",
                                        "400x300", "--json", "--samples", "1", "--background", "transparent"});
        PUNCTUM_EXIT(run, 0);
        double points = 0;
        for (const QString& file : {first, second}) {
            const Outcome info = runPunctum({"info", "--json", file});
            points += info.json()["points"].toDouble();
        }
        QCOMPARE(run.json()["points"].toDouble(), points);
        QVERIFY(coveredShare(pictureOf(path("both.png"))) > 0.1);
    }

    void writesThePictureWholeOrNotAtAll()
    {
        QDir().mkdir(path("full"));
        const QString command = QString("ulimit -f 2; exec '%1' render ../in.las -o out.png").arg(PUNCTUM_PROGRAM);
        const Outcome run = runProgram("/bin/bash", {"-c", command}, path("full"));
        PUNCTUM_EXIT(run, 1);
        QVERIFY2(run.oneSentence(), run.said());
        QVERIFY(QDir(path("full")).isEmpty(QDir::AllEntries | QDir::Hidden | QDir::NoDotAndDotDot));
    }
};

QTEST_GUILESS_MAIN(RenderCliTest)
#include "RenderCliTest.moc"
