// SPDX-License-Identifier: MIT
// Legend, scale bar and north arrow as they are drawn on a picture, in the view and in saved ones.
#include "UiTest.h"

#include "ui/docks/ClassesDock.h"
#include "ui/docks/PropertiesDock.h"
#include "ui/marks/Legend.h"
#include "ui/marks/ScaleBar.h"
#include "ui/view/Viewport.h"

#include <QImage>
#include <QLabel>
#include <QPainter>

#include <set>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

Legend keyOf(int entries)
{
    Legend legend;
    legend.title = QStringLiteral("PointSourceId");
    for (int k = 0; k < entries; ++k)
        legend.entries.push_back({QColor::fromHsv(k * 5 % 360, 255, 255), QStringLiteral("strip %1").arg(k),
                                  std::uint64_t(k % 7 == 0 ? 1000 + k : k)});
    return legend;
}

Legend barOf(int steps)
{
    Legend legend;
    legend.title = QStringLiteral("Z");
    legend.unit = QStringLiteral("m");
    legend.bar = true;
    legend.table = render::banded(render::findColorMap("viridis")->table, steps);
    for (int k = 0; k <= steps; ++k) legend.values << QString::number(k * 10);
    return legend;
}

QImage painted(const Legend& legend, const MarkStyle& style, QSizeF room)
{
    QImage image(legendSize(legend, style, room).toSize(), QImage::Format_RGB32);
    image.fill(Qt::black);
    QPainter painter(&image);
    paintLegend(painter, {}, legend, style, room);
    return image;
}

/// How many colors of the picture are none of a plate, and none of letters.
int colorsIn(const QImage& image)
{
    std::set<QRgb> colors;
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            const QColor c(image.pixel(x, y));
            if (c.hsvSaturation() > 120 && c.value() > 60) colors.insert(c.rgb());
        }
    return int(colors.size());
}

}  // namespace

class MarksTest : public QObject
{
    Q_OBJECT
private slots:
    void longValuesStandApart()
    {
        const MarkStyle style;
        Legend times = barOf(1);
        times.values = QStringList{QStringLiteral("336,380,160.1059"), QStringLiteral("336,380,160.3939")};
        const QFontMetricsF metrics(style.font);
        const double both = metrics.horizontalAdvance(times.values[0]) + metrics.horizontalAdvance(times.values[1]);
        const QSizeF wide = legendSize(times, style, {2000, 400}), narrow = legendSize(times, style, {180, 400});
        QVERIFY(wide.width() > both + 2 * kMarkMargin);
        QVERIFY(narrow.width() <= 180 && narrow.height() >= wide.height() + metrics.height());
    }

    void legendIsNoWiderThanItsRoom()
    {
        const MarkStyle style;
        for (const Legend& legend : {barOf(1), keyOf(3)}) {
            QVERIFY(legendSize(legend, style, {180, 400}).width() <= 180);
            QVERIFY(legendSize(legend, style, {2000, 400}).width() <= 232);
        }
        Legend wide = keyOf(2);
        wide.entries[0].name = QString(100, QLatin1Char('w'));
        QVERIFY(legendSize(wide, style, {180, 400}).width() <= 180);
    }

    void longKeyLeavesTheRarestOut()
    {
        const MarkStyle style;
        const Legend legend = keyOf(70);
        const QSizeF size = legendSize(legend, style, {300, 160});
        QVERIFY2(size.height() <= 160, qPrintable(QString::number(size.height())));
        QVERIFY(legendSize(legend, style, {300, 4000}).height() > 400);
        // The first of seven is frequent, and there are ten of these: the few that fit are among them.
        const QImage image = painted(legend, style, {300, 160});
        const QColor rare = legend.entries[1].color, frequent = legend.entries[63].color;
        bool sawRare = false, sawFrequent = false;
        for (int y = 0; y < image.height(); ++y)
            for (int x = 0; x < image.width(); ++x) {
                sawRare = sawRare || image.pixel(x, y) == rare.rgb();
                sawFrequent = sawFrequent || image.pixel(x, y) == frequent.rgb();
            }
        QVERIFY(sawFrequent);
        QVERIFY(!sawRare);
    }

    void steppedBarHasItsSteps()
    {
        const QImage smooth = painted(barOf(1), {}, {232, 400}), steps = painted(barOf(5), {}, {232, 400});
        QVERIFY(colorsIn(smooth) > 60);
        // Each step is one color; the corners of the bar are mixed with the plate.
        QVERIFY2(colorsIn(steps) <= 5 + 30, qPrintable(QString::number(colorsIn(steps))));
    }

    void marksGrowWithTheirScale()
    {
        MarkStyle once, twice;
        twice.scale = 2.0;
        const Legend legend = keyOf(4);
        QCOMPARE(legendSize(legend, twice, {2000, 2000}), 2.0 * legendSize(legend, once, {1000, 1000}));
        render::Camera camera;
        camera.fit({{0, 0, 0}, {100, 100, 10}}, {800, 600});
        // The same camera in a picture of twice the size: the same bar, drawn twice as large.
        const ScaleBar bar = scaleBarOf(camera, 600, 1.0, QStringLiteral("m"));
        QCOMPARE(scaleBarOf(camera, 1200, 2.0, QStringLiteral("m")), bar);
        QCOMPARE(scaleBarSize(bar, twice), 2.0 * scaleBarSize(bar, once));
    }

    void scaleBarIsAsLongAsItSays()
    {
        render::Camera camera;
        camera.setView("top");
        camera.fit({{0, 0, 0}, {100, 100, 0}}, {800, 600});
        const ScaleBar bar = scaleBarOf(camera, 600, 1.0, QStringLiteral("m"));
        QVERIFY(bar.text.endsWith(QStringLiteral(" m")));
        const double length = bar.text.chopped(2).toDouble();
        const double px = length / camera.unitsPerPixel(600);
        QVERIFY2(std::abs(px - bar.length) <= 1.0, qPrintable(QStringLiteral("%1 %2").arg(px).arg(bar.length)));
        QVERIFY(bar.length > 60 && bar.length <= 150);
    }

    /// Of a view of nothing nobody knows how large it is.
    void nothingHasNoScale()
    {
        ScaleBar bar = scaleBarOf(render::Camera(), 600, 1.0, QStringLiteral("m"));
        QVERIFY(!bar.bar);
        QVERIFY2(bar.text.isEmpty(), qPrintable(bar.text));
        QVERIFY(scaleBarSize(bar, {}).width() > 0);  // north is where it is
        bar.arrow = false;
        QCOMPARE(scaleBarSize(bar, {}).width(), 0.0);
        // as it is in the window
        TestWindow test;
        const Document* const document = test.openSample(0);
        QVERIFY(document && waitFor([&] { return document->classCounts().has_value(); }));
        QStringList labels;
        for (const QLabel* label : test.window->classesDock().findChildren<QLabel*>()) labels << label->text();
        QVERIFY2(labels.contains(QStringLiteral("No points")), qPrintable(labels.join(QLatin1Char('|'))));
        Viewport& view = test.window->viewport();
        view.setFocus();
        for (const Qt::Key key : {Qt::Key_PageDown, Qt::Key_Left, Qt::Key_PageDown}) {
            QTest::keyClick(&view, key);
            QTest::qWait(20);
        }
        QVERIFY(!scaleBarOf(view.camera(), view.height(), 1.0, QStringLiteral("m")).bar);
        QVERIFY2(!test.window->propertiesDock().text().contains(QStringLiteral("Lowest")),
                 qPrintable(test.window->propertiesDock().text()));
    }

    void lengthsHaveTheirUnits()
    {
        QCOMPARE(roundLengthText(50.0, QStringLiteral("m")), QStringLiteral("50 m"));
        QCOMPARE(roundLengthText(2000.0, QStringLiteral("m")), QStringLiteral("2 km"));
        QCOMPARE(roundLengthText(0.05, QStringLiteral("m")), QStringLiteral("5 cm"));
        QCOMPARE(roundLengthText(0.002, QStringLiteral("m")), QStringLiteral("2 mm"));
        QCOMPARE(roundLengthText(2000.0, QStringLiteral("ft")), QStringLiteral("2,000 ft"));
        // Nobody knows of what: no kilometers are made up.
        QCOMPARE(roundLengthText(2000.0, QString()), QStringLiteral("2,000 units"));
        QCOMPARE(roundLengthText(1.0, QString()), QStringLiteral("1 unit"));
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<MarksTest>(); });
}
#include "MarksTest.moc"
