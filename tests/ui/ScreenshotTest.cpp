// SPDX-License-Identifier: MIT
// Pictures of the views as files: any size, with or without marks, and the view goes on meanwhile.
#include "UiTest.h"

#include "ui/document/Workspace.h"
#include "ui/measure/Measurements.h"
#include "ui/screenshot/PictureMarks.h"
#include "ui/screenshot/ScreenshotDialog.h"
#include "ui/screenshot/Screenshots.h"
#include "ui/section/Sections.h"
#include "ui/view/Still.h"
#include "ui/view/ViewSettings.h"
#include "ui/view/Viewport.h"

#include <QCheckBox>
#include <QComboBox>
#include <QDialogButtonBox>
#include <QPushButton>
#include <QSignalSpy>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

/// A window with a made survey.
struct ScreenshotBench : TestWindow {
    Document* document = nullptr;

    bool begin()
    {
        document = openSample(60'000);
        if (!document) return false;
        window->showAttribute(QStringLiteral("Z"));
        return settle(QStringLiteral("Z")) && waitFor([&] { return document->classCounts().has_value(); });
    }
    /// Saves and reads again; a null picture when that failed.
    QImage shot(const ScreenshotOptions& options)
    {
        const QString path = folder.filePath(QStringLiteral("shot.png"));
        QFile::remove(path);
        window->screenshots().save(path, options);
        return settle() ? QImage(path).convertToFormat(QImage::Format_RGBA8888) : QImage();
    }
    ScreenshotOptions bare() const
    {
        ScreenshotOptions options;
        options.size = window->screenshots().viewSize(false);
        options.samples = 1;
        return options;
    }
    void openSection()
    {
        const WorldBounds box = document->bounds();
        const glm::dvec2 from(box.min), to(box.max);
        window->sections().open({from, to, 2.0, window->viewport().camera().stretch}, box.min.z, box.min.z);
    }
};

QImage imageOf(const Frame& frame)
{
    return QImage(reinterpret_cast<const uchar*>(frame.image.pixels.data()), frame.image.width, frame.image.height,
                  QImage::Format_RGBA8888)
        .copy();
}

/// Share of the pixels that differ in a part of two pictures.
double differing(const QImage& a, const QImage& b, const QRect& part)
{
    int unlike = 0;
    for (int y = part.top(); y <= part.bottom(); ++y)
        for (int x = part.left(); x <= part.right(); ++x) unlike += a.pixel(x, y) != b.pixel(x, y) ? 1 : 0;
    return double(unlike) / (part.width() * part.height());
}

}  // namespace

class ScreenshotTest : public QObject
{
    Q_OBJECT
private slots:
    /// In the view's own size and without marks it is the finished picture, bit for bit.
    void isTheFinishedPicture()
    {
        ScreenshotBench test;
        QVERIFY(test.begin());
        ScreenshotOptions options = test.bare();
        const QImage shown = imageOf(*test.frame());
        QCOMPARE(test.shot(options), shown);
        options.transparent = true;
        const QImage clear = test.shot(options);
        QCOMPARE(clear.size(), shown.size());
        QCOMPARE(qAlpha(clear.pixel(0, 0)), 0);
        QCOMPARE(imageOf(*test.frame()), shown);  // the view has nothing of it
    }

    /// Larger than the window, in tiles even, it shows the same from the same place.
    void canBeLargerThanTheWindow()
    {
        ScreenshotBench test;
        QVERIFY(test.begin());
        const auto before = test.frame();
        ScreenshotOptions options = test.bare();
        options.size = options.size * 4;
        options.samples = 8;
        const QImage large = test.shot(options);
        QCOMPARE(large.size(), options.size);
        const QImage small = large.scaled(options.size / 4, Qt::IgnoreAspectRatio, Qt::SmoothTransformation)
                                 .convertToFormat(QImage::Format_RGBA8888);
        const QImage shown = imageOf(*before);
        double sum = 0;
        for (int y = 0; y < small.height(); ++y)
            for (int x = 0; x < small.width(); ++x)
                sum += std::abs(qGreen(small.pixel(x, y)) - qGreen(shown.pixel(x, y)));
        const double mean = sum / (small.width() * small.height());
        QVERIFY2(mean < 12.0, qPrintable(QString::number(mean)));  // points have other edges in the larger one
        QCOMPARE(test.frame()->number, before->number);            // the view drew nothing for it
    }

    /// Each mark changes its corner, and nothing else does.
    void marksAreDrawnWhereTheyBelong()
    {
        ScreenshotBench test;
        QVERIFY(test.begin());
        const ScreenshotOptions bare = test.bare();
        const QImage plain = test.shot(bare);
        const int w = plain.width(), h = plain.height();
        const QRect left(0, h - 70, 260, 70), right(w - 250, h - 80, 250, 80), rest(0, 0, w, h / 2);
        ScreenshotOptions options = bare;
        options.legend = true;
        QImage marked = test.shot(options);
        QVERIFY(differing(plain, marked, right) > 0.4);
        QCOMPARE(differing(plain, marked, left), 0.0);
        QCOMPARE(differing(plain, marked, rest), 0.0);
        options = bare;
        options.scaleBar = true;
        marked = test.shot(options);
        QVERIFY(differing(plain, marked, left) > 0.2);
        QCOMPARE(differing(plain, marked, right), 0.0);
        options.northArrow = true;
        QVERIFY(differing(marked, test.shot(options), left) > 0.02);

        const auto& cloud = *test.document->cloud();
        std::vector<MeasuredPoint> points{{0, cloud.world(0)}, {cloud.size() - 1, cloud.world(cloud.size() - 1)}};
        test.window->measurements().add(*test.document, MeasureKind::Distance, points);
        QVERIFY(test.settle());
        QCOMPARE(test.shot(bare), plain);
        options = bare;
        options.measurements = true;
        QVERIFY(differing(plain, test.shot(options), QRect(0, 0, w, h)) > 0.001);
    }

    void aSectionHasItsRuler()
    {
        ScreenshotBench test;
        QVERIFY(test.begin());
        test.openSection();
        QVERIFY(test.settle());
        ScreenshotOptions options = test.window->screenshots().preset();
        QVERIFY(options.section && options.ruler);
        options.samples = 1;
        options.legend = options.measurements = false;
        const QImage ruled = test.shot(options);
        QCOMPARE(ruled.size(), test.window->sections().viewport().pictureSize());
        options.ruler = false;
        QVERIFY(differing(ruled, test.shot(options), ruled.rect()) > 0.01);
        test.window->viewport().setFocus();
        QVERIFY(!test.window->screenshots().preset().section);
    }

    /// The dialog shows a small one as things are chosen, and remembers them.
    void theDialogShowsWhatWillBeSaved()
    {
        ScreenshotBench test;
        QVERIFY(test.begin());
        test.window->screenshots().choose();
        auto* const dialog = test.window->findChild<ScreenshotDialog*>();
        QVERIFY(dialog);
        QSignalSpy previews(dialog, &ScreenshotDialog::previewed), wanted(dialog, &ScreenshotDialog::wanted);
        QVERIFY(waitFor([&] { return previews.count() == 1; }));
        QCOMPARE(dialog->options().size, test.window->screenshots().viewSize(false));
        QCheckBox* legend = nullptr;
        for (QCheckBox* box : dialog->findChildren<QCheckBox*>())
            if (box->text() == QStringLiteral("&Legend")) legend = box;
        QVERIFY(legend && legend->isChecked());
        legend->setChecked(false);
        QVERIFY(waitFor([&] { return previews.count() == 2; }));
        QVERIFY(!dialog->options().legend);
        dialog->reject();
        QVERIFY(waitFor([&] { return !test.window->findChild<ScreenshotDialog*>(); }));
        QCOMPARE(wanted.count(), 0);
        QVERIFY(test.settle());
    }

    /// Cancelled, it leaves no file and the next one is drawn; so does another attribute, with a word.
    void canBeCancelled()
    {
        ScreenshotBench test;
        QVERIFY(test.begin());
        ScreenshotOptions options = test.bare();
        options.size = {kLargestSide, kLargestSide};
        options.samples = 16;
        const QString path = test.folder.filePath(QStringLiteral("huge.png"));
        test.window->screenshots().save(path, options);
        QTest::qWait(300);
        for (const JobInfo& job : test.window->workspace().jobs().running())
            test.window->workspace().cancel(job.id);
        QVERIFY(test.settle());
        QVERIFY(!QFile::exists(path));
        QVERIFY(!test.shot(test.bare()).isNull());
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<ScreenshotTest>(); });
}

#include "ScreenshotTest.moc"
