// SPDX-License-Identifier: MIT
// The Process panel by real events: finding steps, values, scopes, previews, before and after, chains.
#include "SelectBench.h"

#include "core/Error.h"
#include "core/edit/History.h"
#include "ui/basic/Text.h"
#include "ui/process/ChainFile.h"
#include "ui/process/ChainPanel.h"
#include "ui/process/ClassesField.h"
#include "ui/process/ProcessingDock.h"
#include "ui/process/ScopeField.h"
#include "ui/process/StepChooser.h"
#include "ui/process/StepForm.h"
#include "ui/process/StepPreview.h"
#include "ui/select/RuleField.h"
#include "ui/style/NumberField.h"
#include "ui/style/Widgets.h"
#include "ui/view/Overlays.h"
#include "ui/view/ViewSettings.h"
#include "ui/window/MainMenu.h"

#include <QComboBox>
#include <QFile>
#include <QLabel>
#include <QLineEdit>
#include <QListWidget>
#include <QMenu>
#include <QPushButton>
#include <QToolButton>
#include <QTreeWidget>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

struct PanelBench : Bench {
    bool begin()
    {
        if (!Bench::begin(Tool::None)) return false;
        dock().show();
        dock().raise();
        window->viewSettings().setAttribute(QStringLiteral("Classification"));
        return settle(QStringLiteral("Classification")) &&
               waitFor([&] { return document->classCounts().has_value(); });
    }
    std::vector<std::vector<std::byte>> valuesNow() const
    {
        std::vector<std::vector<std::byte>> all;
        for (const auto& column : document->cloud()->columns())
            all.emplace_back(column->data(), column->data() + column->size() * column->elementBytes());
        return all;
    }
    ProcessingDock& dock() { return window->processingDock(); }
    static void press(QAbstractButton& button) { QTest::mouseClick(&button, Qt::LeftButton); }
    /// Low points become water.
    void chooseWater(int upTo)
    {
        dock().chooseStep(QStringLiteral("reclassify"));
        dock().setValue(QStringLiteral("attribute"), QStringLiteral("Z"));
        dock().setValue(QStringLiteral("min"), QStringLiteral("0"));
        dock().setValue(QStringLiteral("max"), QString::number(upTo));
        dock().setValue(QStringLiteral("class"), QStringLiteral("9"));
    }
    PointIndex low(double upTo, int ofClass = -1) const
    {
        const Attribute& z = *document->findAttribute(QStringLiteral("Z"));
        const Attribute& c = *document->findAttribute(QStringLiteral("Classification"));
        PointIndex count = 0;
        for (PointIndex i = 0; i < document->points(); ++i)
            count += z.number(i) <= upTo && (ofClass < 0 || int(c.number(i)) == ofClass);
        return count;
    }
    PointIndex waters() const
    {
        const Attribute& c = *document->findAttribute(QStringLiteral("Classification"));
        PointIndex count = 0;
        for (PointIndex i = 0; i < document->points(); ++i) count += int(c.number(i)) == 9;
        return count;
    }
    bool says(const QString& text)
    {
        return waitFor([&] { return dock().resultText().contains(text); }, 30000);
    }
    bool ran()
    {
        return waitFor([&] { return !dock().running(); }) && settle();
    }
    render::Image picture()
    {
        settle();
        return frame()->image;
    }
};

}  // namespace

class ProcessPanelTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void stepsAreFoundByKeys()
    {
        PanelBench b;
        QVERIFY(b.begin());
        StepChooser& chooser = b.dock().chooser();
        QVERIFY(waitFor([&] { return chooser.isVisible(); }));
        chooser.search().setFocus();
        QTest::keyClicks(&chooser.search(), QStringLiteral("deviations far"));  // words of its help
        QTest::keyClicks(&chooser.search(), QStringLiteral("zzz"));
        QVERIFY(chooser.list().currentItem() == nullptr);
        chooser.search().clear();
        QTest::keyClicks(&chooser.search(), QStringLiteral("normal"));
        QVERIFY(chooser.list().currentItem());
        QTest::keyClick(&chooser.search(), Qt::Key_Return);
        QVERIFY(b.dock().form().isVisible() && !chooser.isVisible());
        QVERIFY(QString::fromStdString(b.dock().form().step()->title()).contains(QStringLiteral("ormal")));
        QTest::keyClick(&b.dock().previewButton(), Qt::Key_Left, Qt::AltModifier);
        QVERIFY(chooser.isVisible());
        // every step has its picture and its page
        for (const Step* step : allSteps()) {
            b.dock().chooseStep(toQString(step->name()));
            QCOMPARE(b.dock().form().step(), step);
            for (const StepParameter& p : step->parameters())
                if (p.type == StepParameter::Type::Integer && !p.preset.empty())
                    QVERIFY2(b.dock().setValue(toQString(p.key), toQString(p.preset)), p.key.c_str());
        }
    }

    void previewIsAppliedAndCompared()
    {
        PanelBench b;
        QVERIFY(b.begin());
        const auto values = b.valuesNow();
        const render::Image before = b.picture();
        b.chooseWater(440);
        const PointIndex low = b.low(440);
        PanelBench::press(b.dock().previewButton());
        QVERIFY2(b.says(QStringLiteral("%1 would change.").arg(pointsText(low))),
                 qPrintable(b.dock().resultText()));
        QVERIFY(b.dock().resultText().contains(classText(9)));
        QCOMPARE(b.dock().runButton().text(), QStringLiteral("Apply"));
        QVERIFY(b.valuesNow() == values);
        const render::Image previewed = b.picture();
        QVERIFY(difference(before, previewed) > 0.005);
        // the legend has the class that only the preview has
        const auto waterInLegend = [&b] {
            for (const Legend::Entry& entry : b.window->viewport().legend().content().entries)
                if (entry.name == classText(9)) return entry.points;
            return std::uint64_t(0);
        };
        QCOMPARE(waterInLegend(), low);
        // held, the key shows what is
        Viewport& view = b.window->viewport();
        view.setFocus();
        QTest::keyPress(&view, Qt::Key_C);
        QCOMPARE(difference(before, b.picture()), 0.0);
        QCOMPARE(waterInLegend(), std::uint64_t(0));
        QTest::keyRelease(&view, Qt::Key_C);
        QCOMPARE(difference(previewed, b.picture()), 0.0);
        QCOMPARE(waterInLegend(), low);
        // applied, it is what was previewed, and the key shows what was
        PanelBench::press(b.dock().runButton());
        QVERIFY(b.ran());
        QCOMPARE(b.dock().resultText(), QStringLiteral("Reclassify: %1 changed.").arg(pointsText(low)));
        QCOMPARE(b.waters(), low);
        QVERIFY(!b.dock().preview().on() && !b.dock().previewButton().isChecked());
        QCOMPARE(difference(previewed, b.picture()), 0.0);
        QVERIFY(waitFor([&] { return waterInLegend() == low; }));  // counted anew
        QTest::keyPress(&view, Qt::Key_C);
        QVERIFY(b.settle());
        QCOMPARE(difference(before, b.picture()), 0.0);
        QCOMPARE(waterInLegend(), std::uint64_t(0));
        QTest::keyRelease(&view, Qt::Key_C);
        QCOMPARE(difference(previewed, b.picture()), 0.0);
        b.window->menu().undo->trigger();
        QVERIFY(waitFor([&] { return !b.document->modified(); }));
        QVERIFY(b.valuesNow() == values);
    }

    /// As long as it is on; and it ends with the panel, and with what it was made for.
    void previewFollowsValues()
    {
        PanelBench b;
        QVERIFY(b.begin());
        b.chooseWater(440);
        PanelBench::press(b.dock().previewButton());
        QVERIFY(b.says(pointsText(b.low(440))));
        QVERIFY(b.dock().setValue(QStringLiteral("max"), QStringLiteral("450")));
        QVERIFY2(b.says(pointsText(b.low(450))), qPrintable(b.dock().resultText()));
        QVERIFY(b.dock().previewButton().isChecked());
        b.dock().chooseStep(QStringLiteral("normals"));
        QVERIFY(!b.dock().preview().on() && !b.dock().previewButton().isChecked());
        // what is new is seen, though the view shows something else
        const render::Image before = b.picture();
        PanelBench::press(b.dock().previewButton());
        QVERIFY(b.says(QStringLiteral("would change")));
        QVERIFY(difference(before, b.picture()) > 0.1);
        QVERIFY(!b.document->findAttribute(QStringLiteral("Normal")));
        b.dock().hide();
        QVERIFY(waitFor([&] { return !b.dock().preview().on(); }));
        QCOMPARE(difference(before, b.picture()), 0.0);
    }

    /// What is told must not push a button away from under the mouse.
    void buttonsStay()
    {
        PanelBench b;
        QVERIFY(b.begin());
        b.chooseWater(440);
        QCoreApplication::processEvents();
        const QPoint run = b.dock().runButton().mapTo(b.window.get(), QPoint());
        b.press(b.dock().previewButton());
        QVERIFY2(b.says(QStringLiteral("would change")), qPrintable(b.dock().resultText()));
        QVERIFY(b.settle());
        QCOMPARE(b.dock().runButton().mapTo(b.window.get(), QPoint()), run);
    }

    void asksForWhatMatters()
    {
        PanelBench b;
        QVERIFY(b.begin());
        StepForm& form = b.dock().form();
        const auto shown = [&] {
            QStringList names;
            for (const QWidget* field : form.findChildren<QWidget*>())
                if (!qobject_cast<const QToolButton*>(field) && !field->accessibleName().isEmpty() &&
                    field->isVisibleTo(&form))
                    names << field->accessibleName().section(QLatin1Char(' '), 0, 0);
            return names;
        };
        b.dock().chooseStep(QStringLiteral("thin"));
        QCOMPARE(shown(), QStringList({QStringLiteral("Method"), QStringLiteral("Cell"), QStringLiteral("Keep"),
                                       QStringLiteral("Do")}));
        b.dock().setValue(QStringLiteral("keep"), QStringLiteral("lowest"));
        QVERIFY(form.values().contains("keep"));
        b.dock().setValue(QStringLiteral("method"), QStringLiteral("distance"));
        b.dock().setValue(QStringLiteral("do"), QStringLiteral("class"));
        QCOMPARE(shown(), QStringList({QStringLiteral("Method"), QStringLiteral("Distance"), QStringLiteral("Do"),
                                       QStringLiteral("Class")}));
        // what has no effect is not told to the step, nor written into a recipe
        QVERIFY(!form.values().contains("keep") && form.values().contains("method"));
        b.dock().setValue(QStringLiteral("method"), QStringLiteral("grid"));
        QCOMPARE(form.values().at("keep"), std::string("lowest"));
    }

    void scopeIsKept()
    {
        PanelBench b;
        QVERIFY(b.begin());
        b.chooseWater(440);
        ScopeField& scope = b.dock().scope();
        scope.kind().setCurrentIndex(scope.kind().findText(QStringLiteral("Classes")));
        PanelBench::press(b.dock().runButton());  // which?
        QVERIFY(!b.dock().running());
        QVERIFY(!wrongness(scope.classes().edit()).isEmpty());
        scope.classes().setText(QStringLiteral("2"));
        QVERIFY(waitFor([&] { return scope.countText().contains(pointsText((*b.document->classCounts())[2])); }));
        const PointIndex ground = b.low(440, 2);
        PanelBench::press(b.dock().runButton());
        QVERIFY(b.ran());
        QCOMPARE(b.waters(), ground);
        b.window->menu().undo->trigger();
        QVERIFY(waitFor([&] { return b.waters() == 0; }));
        // a condition, and a locked class
        scope.kind().setCurrentIndex(scope.kind().findText(QStringLiteral("Condition")));
        scope.condition().setText(QStringLiteral("Z >"));
        PanelBench::press(b.dock().runButton());
        QVERIFY(!b.dock().running() && !b.dock().resultText().isEmpty());
        scope.condition().setText(QStringLiteral("Z > 430"));
        b.window->viewSettings().setClassLocked(2, true);
        QVERIFY2(waitFor([&] { return scope.countText().contains(QStringLiteral("locked")); }),
                 qPrintable(scope.countText()));
        const PointIndex others = b.low(440) - b.low(440, 2) - (b.low(430) - b.low(430, 2));
        PanelBench::press(b.dock().runButton());
        QVERIFY(b.ran());
        QCOMPARE(b.waters(), others);
    }

    void valuesAreMarkedAndReset()
    {
        PanelBench b;
        QVERIFY(b.begin());
        b.dock().chooseStep(QStringLiteral("outliers"));
        const auto fields = b.dock().form().findChildren<NumberField*>();
        QVERIFY(!fields.empty());
        NumberField& first = *fields.front();
        const QString preset = first.text();
        QToolButton* const reset = first.parentWidget()->findChild<QToolButton*>();
        QVERIFY(reset && !reset->isVisible() && !b.dock().form().anyChanged());
        first.setFocus();
        first.selectAll();
        QTest::keyClicks(&first, QStringLiteral("21"));
        QVERIFY(reset->isVisible() && b.dock().form().anyChanged());
        PanelBench::press(*reset);
        QCOMPARE(first.text(), preset);
        QVERIFY(!reset->isVisible());
        // what fits the data is a number as soon as the data has been looked at
        for (const Step* step : allSteps())
            for (const StepParameter& p : step->parameters()) {
                if (!p.fit.used() || p.advanced) continue;
                b.dock().chooseStep(toQString(step->name()));
                QVERIFY2(waitFor([&] { return b.dock().form().values().contains(p.key); }, 20000), p.key.c_str());
                QVERIFY(!b.dock().form().anyChanged());
                return;
            }
    }

    void classesAreWrittenAndChecked()
    {
        ClassesField field;
        field.setText(QStringLiteral("2,8-9"));
        QVERIFY(field.classes());
        QMetaObject::invokeMethod(field.menuButton().menu(), "aboutToShow");
        QStringList checked;
        for (QAction* action : field.menuButton().menu()->actions())
            if (action->isChecked()) checked << action->text();
        QCOMPARE(checked.size(), 3);
        for (QAction* action : field.menuButton().menu()->actions())
            if (action->text().contains(classText(7))) action->trigger();
        QCOMPARE(field.text(), QStringLiteral("2, 7-9"));
        field.setText(QStringLiteral("ground"));
        QVERIFY(!field.classes());
    }

    void stepsRunOneAfterAnother()
    {
        PanelBench b;
        QVERIFY(b.begin());
        const auto values = b.valuesNow();
        ChainPanel& chain = b.dock().chain();
        QPushButton* add = nullptr;
        for (QPushButton* button : b.dock().findChildren<QPushButton*>())
            if (button->text() == QStringLiteral("Add to chain")) add = button;
        QVERIFY(add);
        b.dock().chooseStep(QStringLiteral("set"));
        b.dock().setValue(QStringLiteral("rule"), QStringLiteral("UserData = 7 if Classification == 9"));
        PanelBench::press(*add);
        b.chooseWater(440);
        b.dock().scope().set({.kind = StepScope::Kind::Classes, .classes = 1 << 2});
        PanelBench::press(*add);
        QCOMPARE(chain.list().count(), 2);
        QCOMPARE(chain.list().currentRow(), 1);
        chain.list().setFocus();
        QTest::keyClick(&chain.list(), Qt::Key_Up, Qt::ControlModifier);  // water first
        QCOMPARE(chain.chain().front().step, std::string("reclassify"));

        // as a recipe and back
        const QString path = b.folder.filePath(QStringLiteral("recipe.json"));
        chain.saveTo(path);
        QVERIFY(waitFor([&] { return QFile::exists(path) && !b.window->workspace().busy(); }));
        QFile file(path);
        QVERIFY(file.open(QIODevice::ReadOnly));
        const QByteArray recipe = file.readAll();
        QVERIFY2(recipe.contains("\"within\": \"Classification in (2)\"") && recipe.contains("\"max\": \"440\""),
                 recipe.constData());
        QCOMPARE(toRecipe(fromRecipe(recipe)), recipe);
        chain.setChain({});
        chain.loadFrom(path);
        QVERIFY(waitFor([&] { return chain.list().count() == 2; }));
        for (const char* bad : {"", "{}", "{\"steps\": [{\"step\": \"fly\"}]}",
                                "{\"steps\": [{\"step\": \"rename\", \"within\": \"Z > 3\"}]}",
                                "{\"steps\": [{\"step\": \"normals\", \"values\": {\"k\": -3}}]}"})
            QVERIFY_THROWS_EXCEPTION(Error, fromRecipe(bad));

        const PointIndex ground = b.low(440, 2);
        PanelBench::press(chain.runButton());
        QVERIFY(b.dock().running());
        QVERIFY(b.ran());
        QVERIFY2(b.dock().resultText().contains(QStringLiteral("2 of 2 steps done")),
                 qPrintable(b.dock().resultText()));
        QCOMPARE(b.document->history().position(), std::size_t(2));
        QCOMPARE(b.waters(), ground);
        b.window->workspace().walk(*b.document, 0);
        QVERIFY(waitFor([&] { return !b.document->modified(); }));
        QVERIFY(b.valuesNow() == values);

        // what a recipe cannot hold is said
        chain.setChain({{"normals", {}, {.kind = StepScope::Kind::Selection}}});
        chain.saveTo(path);
        QVERIFY(b.says(QStringLiteral("means nothing in another file")));
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<ProcessPanelTest>(); });
}
#include "ProcessPanelTest.moc"
