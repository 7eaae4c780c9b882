// SPDX-License-Identifier: MIT
// Maps as files, by the dialog: what it asks for, what it refuses, and what comes of it.
#include "UiTest.h"

#include "core/task/Progress.h"
#include "ui/document/Workspace.h"
#include "ui/maps/MapDialog.h"
#include "ui/maps/Maps.h"
#include "ui/style/NumberField.h"

#include <QComboBox>
#include <QFile>
#include <QLineEdit>
#include <QMenu>
#include <QMenuBar>
#include <QPushButton>
#include <QSignalSpy>

#include <cmath>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

/// A window with a made survey, and its dialog.
struct MapBench : TestWindow {
    Document* document = nullptr;
    MapDialog* dialog = nullptr;

    bool begin()
    {
        document = openSample(60'000);
        window->activateWindow();  // shortcuts want it, and there may be no window manager to see to it
        return document && settle() && waitFor([&] { return document->spacing() > 0; }) &&
               QTest::qWaitForWindowActive(window.get());
    }
    bool openDialog()
    {
        QTest::keyClick(window.get(), Qt::Key_M, Qt::ControlModifier);
        return waitFor(
            [&] { return (dialog = window->findChild<MapDialog*>()) != nullptr && dialog->isVisible(); });
    }
    /// Chooses by the keyboard.
    void chooseKind(const QString& text)
    {
        auto* const kinds = dialog->findChild<QComboBox*>(QStringLiteral("mapKind"));
        kinds->setFocus();
        while (kinds->currentText() != text && kinds->currentIndex() + 1 < kinds->count())
            QTest::keyClick(kinds, Qt::Key_Down);
    }
    QPushButton* button(const QString& text) const
    {
        for (QPushButton* b : dialog->findChildren<QPushButton*>())
            if (b->text().remove(QLatin1Char('&')) == text) return b;
        return nullptr;
    }
    /// Keeps a picture of the dialog where PUNCTUM_KEEP_PICTURES names a folder.
    void keep(const QString& name) const
    {
        const QString kept = qEnvironmentVariable("PUNCTUM_KEEP_PICTURES");
        if (!kept.isEmpty()) dialog->grab().save(kept + QLatin1Char('/') + name);
    }
};

}  // namespace

class MapsTest : public QObject
{
    Q_OBJECT
private slots:
    void dialogAsksForWhatFits()
    {
        MapBench test;
        QVERIFY(test.begin());
        QVERIFY(test.openDialog());
        const auto terrain = test.dialog->choice();
        QVERIFY(terrain);
        QVERIFY(terrain->form == MapChoice::Form::Raster);
        QVERIFY(terrain->request.kind == MapKind::Dtm);
        const double cell = terrain->request.cell, spacing = test.document->spacing();
        QVERIFY2(cell > spacing && cell < 5 * spacing, qPrintable(QString::number(cell)));
        test.keep(QStringLiteral("terrain.png"));
        test.chooseKind(QStringLiteral("An attribute"));
        const auto attribute = test.dialog->choice();
        QVERIFY(attribute && attribute->request.kind == MapKind::Attribute);
        QCOMPARE(attribute->request.attribute, std::string("Z"));
        test.keep(QStringLiteral("attribute.png"));
        test.chooseKind(QStringLiteral("Contours"));
        const auto contours = test.dialog->choice();
        QVERIFY(contours && contours->form == MapChoice::Form::Contours && contours->contours.step > 0);
        test.keep(QStringLiteral("contours.png"));
    }

    void refusesWhatCannotBe()
    {
        MapBench test;
        QVERIFY(test.begin());
        QVERIFY(test.openDialog());
        QSignalSpy wanted(test.dialog, &MapDialog::wanted);
        auto* const where = test.dialog->findChild<QLineEdit*>(QStringLiteral("mapWhere"));
        QTest::keyClicks(where, QStringLiteral("Classification =="));
        QTest::mouseClick(test.button(QStringLiteral("Save...")), Qt::LeftButton);
        QVERIFY(test.dialog->isVisible() && wanted.isEmpty());
        QVERIFY(!test.dialog->problem().isEmpty());
        test.keep(QStringLiteral("refused.png"));
        where->clear();
        auto* const cell = test.dialog->findChild<NumberField*>();
        cell->setFocus();
        cell->selectAll();
        QTest::keyClicks(cell, QStringLiteral("-3"));
        QTest::mouseClick(test.button(QStringLiteral("Save...")), Qt::LeftButton);
        QVERIFY(test.dialog->isVisible() && wanted.isEmpty());
        QVERIFY(test.dialog->problem().contains(QStringLiteral("more than 0")));
        QTest::mouseClick(test.button(QStringLiteral("Cancel")), Qt::LeftButton);
        QVERIFY(waitFor([&] { return test.window->findChild<MapDialog*>() == nullptr; }));
    }

    void treesAndAreasWithoutPoints()
    {
        MapBench test;
        QVERIFY(test.begin());
        QVERIFY(test.openDialog());
        test.chooseKind(QStringLiteral("List of trees"));
        QVERIFY(!test.dialog->choice());
        QVERIFY2(test.dialog->problem().contains(QStringLiteral("run the step Trees first")),
                 qPrintable(test.dialog->problem()));
        test.keep(QStringLiteral("trees.png"));
        QTest::mouseClick(test.button(QStringLiteral("Cancel")), Qt::LeftButton);
        QVERIFY(waitFor([&] { return test.window->findChild<MapDialog*>() == nullptr; }));

        Maps* const maps = test.window->findChild<Maps*>();
        QStringList said;
        connect(&test.window->workspace(), &Workspace::message, this,
                [&](MessageKind, const QString& sentence) { said << sentence; });
        MapChoice choice;
        choice.form = MapChoice::Form::Outlines;
        choice.request.where = "Classification == 77";
        const QString none = test.folder.filePath(QStringLiteral("none.geojson"));
        maps->save(none, choice);
        QVERIFY(test.settle());
        QVERIFY(!QFile::exists(none));
        QCOMPARE(said.value(0),
                 QStringLiteral("There is no point for which Classification == 77 holds, so that there is "
                                "nothing to make a map of."));

        Progress progress;
        test.document->session()->edit({"trees", {}, nullptr}, progress);
        QVERIFY(waitFor([&] { return test.document->findAttribute(QStringLiteral("TreeId")) != nullptr; }));
        QVERIFY(test.openDialog());
        test.chooseKind(QStringLiteral("List of trees"));
        const auto trees = test.dialog->choice();
        QVERIFY2(trees && trees->form == MapChoice::Form::Trees, qPrintable(test.dialog->problem()));
        const QString list = test.folder.filePath(QStringLiteral("trees.csv"));
        maps->save(list, *trees);
        QVERIFY(test.settle());
        QVERIFY(QFile(list).size() > 100);
        QVERIFY2(said.last().contains(QStringLiteral(" trees.")), qPrintable(said.join('\n')));
    }

    void writesByAJob()
    {
        MapBench test;
        QVERIFY(test.begin());
        Maps* const maps = test.window->findChild<Maps*>();
        QVERIFY(maps);
        QStringList said;
        connect(&test.window->workspace(), &Workspace::message, this,
                [&](MessageKind, const QString& sentence) { said << sentence; });
        MapChoice choice;
        choice.request.cell = 2.0;
        const QString tif = test.folder.filePath(QStringLiteral("terrain.tif"));
        maps->save(tif, choice);
        QVERIFY(test.settle());
        QVERIFY(QFile(tif).size() > 1000);
        QVERIFY2(said.last().startsWith(QStringLiteral("Saved terrain.tif: ")), qPrintable(said.join('\n')));
        choice.form = MapChoice::Form::Contours;
        const QString lines = test.folder.filePath(QStringLiteral("lines.dxf"));
        maps->save(lines, choice);
        QVERIFY(test.settle());
        QVERIFY(QFile(lines).size() > 1000);
        choice.form = MapChoice::Form::Outlines;
        choice.request.where = "Classification == 2";
        const QString ground = test.folder.filePath(QStringLiteral("ground.geojson"));
        maps->save(ground, choice);
        QVERIFY(test.settle());
        QVERIFY(QFile(ground).size() > 200);
        // what cannot be made leaves no file, and says why
        choice = {};
        choice.request.cell = 1e-5;
        const QString none = test.folder.filePath(QStringLiteral("none.tif"));
        maps->save(none, choice);
        QVERIFY(test.settle());
        QVERIFY(!QFile::exists(none));
        QVERIFY2(said.last().contains(QStringLiteral("larger cells")), qPrintable(said.join('\n')));
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<MapsTest>(); });
}

#include "MapsTest.moc"
