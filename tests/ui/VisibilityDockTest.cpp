// SPDX-License-Identifier: MIT
// Filter, clip box and cuts in the window, by keys and mouse, against what core says is hidden.
#include "UiTest.h"

#include "core/task/Progress.h"
#include "ui/ViewFilter.h"
#include "ui/ViewSettings.h"
#include "ui/Workspace.h"
#include "ui/docks/VisibilityDock.h"

#include <QCheckBox>
#include <QLabel>
#include <QLineEdit>
#include <QPushButton>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

class VisibilityDockTest : public QObject
{
    Q_OBJECT

    template <class Widget>
    static Widget* find(QWidget& dock, const QString& name)
    {
        for (Widget* widget : dock.findChildren<Widget*>())
            if (widget->accessibleName() == name || widget->property("text").toString() == name) return widget;
        return nullptr;
    }
    static QString stateOf(VisibilityDock& dock)
    {
        for (const QLabel* label : dock.findChildren<QLabel*>())
            if (label->text().contains(QStringLiteral("hidden")) ||
                label->text().startsWith(QStringLiteral("Column")))
                return label->text();
        return {};
    }
    static PointIndex hiddenBy(TestWindow& test, const Document& document)
    {
        Progress progress;
        const auto hidden =
            hiddenPoints(*document.cloud(), test.window->viewFilter().visibility(document), progress);
        return hidden ? hidden->count() : 0;
    }

private slots:
    void hidesAndShows()
    {
        const QString file = dataFile(QStringLiteral("autzen_trim.laz"));
        if (file.isEmpty()) QSKIP("autzen_trim.laz is not here.");
        TestWindow test;
        Document* document = test.open(file);
        QVERIFY(document && test.settle());
        VisibilityDock& dock = test.window->visibilityDock();
        dock.show();
        dock.raise();
        const render::Image all = test.frame()->image;

        // a filter, a wrong one, and none
        auto* filter = find<QLineEdit>(dock, QStringLiteral("Filter"));
        QVERIFY(filter);
        filter->setFocus();
        QTest::keyClicks(filter, QStringLiteral("Intensity > 100 and ReturnNumber == 1"));
        QTest::keyClick(filter, Qt::Key_Return);
        QVERIFY(waitFor([&] { return stateOf(dock).contains(QStringLiteral("110,000")); }));
        PointIndex expected = 0;
        const Attribute &intensity = *document->findAttribute(QStringLiteral("Intensity")),
                        &number = *document->findAttribute(QStringLiteral("ReturnNumber"));
        for (PointIndex i = 0; i < document->points(); ++i)
            expected += !(intensity.number(i) > 100 && number.number(i) == 1);
        QCOMPARE(hiddenBy(test, *document), expected);
        QVERIFY2(stateOf(dock).startsWith(QLocale(QLocale::English).toString(expected)), qPrintable(stateOf(dock)));
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) > 0.02; }));
        filter->selectAll();
        QTest::keyClicks(filter, QStringLiteral("Intensty > 100"));
        QTest::keyClick(filter, Qt::Key_Return);
        QVERIFY(waitFor([&] { return stateOf(dock).startsWith(QStringLiteral("Column 1")); }));
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) == 0.0; }));
        filter->clear();
        QVERIFY(waitFor([&] { return stateOf(dock).isEmpty(); }));

        // the box
        auto* box = dock.findChild<QCheckBox*>();
        QTest::mouseClick(box, Qt::LeftButton, {}, QPoint(8, box->height() / 2));
        QVERIFY(box->isChecked() && test.window->viewSettings().display().clip.box);
        QVERIFY(test.settle());
        QVERIFY(waitFor(
            [&] { return difference(all, test.frame()->image) == 0.0; }));  // the file's own box hides nothing
        auto* least = find<QLineEdit>(dock, QStringLiteral("Least X"));
        QVERIFY(least);
        least->setFocus();
        least->selectAll();
        QTest::keyClicks(least, QStringLiteral("636600"));
        QTest::keyClick(least, Qt::Key_Return);
        QVERIFY(test.settle());
        expected = 0;
        for (PointIndex i = 0; i < document->points(); ++i) expected += document->cloud()->world(i).x < 636600;
        QCOMPARE(hiddenBy(test, *document), expected);
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) > 0.02; }));
        QTest::mouseClick(box, Qt::LeftButton, {}, QPoint(8, box->height() / 2));
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) == 0.0; }));

        // cuts
        auto* cut = find<QPushButton>(dock, QStringLiteral("Cut Here"));
        auto* uncut = find<QPushButton>(dock, QStringLiteral("Remove Cuts"));
        QVERIFY(cut && uncut && !uncut->isEnabled());
        QTest::mouseClick(cut, Qt::LeftButton);
        QVERIFY(test.settle());
        const PointIndex hidden = hiddenBy(test, *document);
        QVERIFY(hidden > document->points() / 5 && hidden < document->points() * 4 / 5);
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) > 0.02; }));
        QTest::mouseClick(uncut, Qt::LeftButton);
        QVERIFY(test.settle());
        QVERIFY(waitFor([&] { return difference(all, test.frame()->image) == 0.0; }));
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<VisibilityDockTest>(); });
}

#include "VisibilityDockTest.moc"
