// SPDX-License-Identifier: MIT
#include "SelectBench.h"

#include "core/expression/Condition.h"
#include "core/task/Progress.h"
#include "render/store/PointStore.h"
#include "ui/basic/Text.h"
#include "ui/select/EditDock.h"
#include "ui/select/RuleField.h"
#include "ui/style/Widgets.h"
#include "ui/view/ViewSettings.h"

#include <QCheckBox>
#include <QComboBox>
#include <QFile>
#include <QLineEdit>
#include <QPushButton>

#include <array>
#include <functional>
#include <vector>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

/// A window with the Edit panel in front, and what a preview must leave as it is.
struct RuleBench : Bench {
    std::vector<std::vector<std::byte>> columns;

    bool begin(const QString& attribute)
    {
        if (!Bench::begin(Tool::None)) return false;
        window->editDock().show();
        window->editDock().raise();
        window->viewSettings().setAttribute(attribute);
        columns = valuesNow();
        return settle(attribute);
    }
    EditDock& dock() { return window->editDock(); }
    void type(const QString& rule)
    {
        dock().rule().setFocus();
        dock().rule().clear();
        QTest::keyClicks(&dock().rule(), rule);
    }
    static void press(QPushButton& button) { QTest::mouseClick(&button, Qt::LeftButton); }
    /// Whether the preview comes, and says `text`.
    bool comes(const QString& text)
    {
        return waitFor([&] { return dock().resultText().contains(text); }) && done();
    }
    PointSet holds(const std::string& condition)
    {
        Progress progress;
        const PointCloud& cloud = *document->cloud();
        return *expression::select(cloud, expression::Condition(condition, cloud), progress);
    }
    std::vector<std::vector<std::byte>> valuesNow() const
    {
        std::vector<std::vector<std::byte>> all;
        for (const auto& column : document->cloud()->columns())
            all.emplace_back(column->data(), column->data() + column->size() * column->elementBytes());
        return all;
    }
    bool untouched()
    {
        return valuesNow() == columns && document->history().position() == 0 && !document->modified() &&
               !window->isWindowModified() && !points();
    }
    /// Presses Preview for this rule, until its points are counted and the view no longer shows `before`.
    bool preview(const QString& rule, const render::Image& before)
    {
        type(rule);
        press(dock().previewButton());
        return comes(QStringLiteral("would change")) && waitFor([&] { return frame()->image != before; }) &&
               settle();
    }
    /// Until the view shows that picture.
    bool shows(const render::Image& image)
    {
        return waitFor([&] { return frame()->image == image; }, 20000) && settle();
    }
    /// Until all slots hold the word that `expected` gives for their point.
    bool words(const std::function<std::uint32_t(PointIndex)>& expected)
    {
        const render::PointStore& store = *document->store();
        const auto alike = [&] {
            for (PointIndex i = 0; i < document->points(); ++i)
                if (store.words()[store.order().slotOf(i)] != expected(i)) return false;
            return true;
        };
        return waitFor([&] { return settle() && alike(); }, 20000);
    }
};

}  // namespace

class RulePanelTest : public QObject
{
    Q_OBJECT
private slots:
    void rulesSelectAndApply()
    {
        RuleBench b;
        QVERIFY(b.begin(QStringLiteral("Z")));
        const PointSet expected = b.holds("Z > 420 and Classification == 1");
        b.type(QStringLiteral("Z > 420 and Classification == 1"));
        b.press(b.dock().selectButton());
        QVERIFY(b.done());
        QVERIFY(b.points() && *b.points() == expected);

        b.type(QStringLiteral("Classification=7  IF  Z > 425"));  // of a rule: the points that it names
        b.press(b.dock().selectButton());
        QVERIFY(b.done());
        const PointSet high = b.holds("Z > 425");
        QVERIFY(b.points() && *b.points() == high);
        QVERIFY(b.runEdit([&] { b.press(b.dock().applyButton()); }));
        QVERIFY(b.holds("Classification == 7") == high);
        // the keys are the view's then: Ctrl+Z undoes the edit, not what was typed
        QVERIFY(!b.dock().isAncestorOf(b.dock().window()->focusWidget()));

        b.type(QStringLiteral("Clasification = 5"));
        b.press(b.dock().applyButton());
        QVERIFY(
            waitFor([&] { return b.dock().resultText().contains(QLatin1String("did you mean Classification?")); }));
        QCOMPARE(b.dock().rule().marked(), QStringLiteral("Clasification"));
        b.type(QStringLiteral("  Classification = 5 if Z > 400 and Grund == 1"));
        b.press(b.dock().previewButton());
        QVERIFY(waitFor([&] { return b.dock().rule().marked() == QStringLiteral("Grund"); }));
        b.type(QStringLiteral("Classification = 5"));
        QVERIFY(b.dock().rule().marked().isEmpty() && !b.dock().rule().property("wrong").toBool());
    }

    // The picture before Apply is the one after it, and each way to end it leaves nothing behind.
    void newClassesAreShownBeforeTheyAre()
    {
        RuleBench b;
        QVERIFY(b.begin(QStringLiteral("Classification")));
        const render::Image plain = b.frame()->image;
        const PointSet high = b.holds("Z > 425 and Classification != 5");
        QVERIFY(high.count() > 1000);
        const Attribute classes = *b.document->findAttribute(QStringLiteral("Classification"));

        b.type(QStringLiteral("Classification = 5 if Z > 425"));
        QVERIFY(!b.dock().endPreviewButton().isVisible());
        b.press(b.dock().previewButton());
        QVERIFY(b.comes(QStringLiteral("would change")));
        QVERIFY(waitFor([&] { return b.frame()->image != plain; }) && b.settle());
        const render::Image previewed = b.frame()->image;
        QVERIFY(difference(plain, previewed) > 0.005);
        QVERIFY(b.words([&](PointIndex i) { return high.contains(i) ? 5u : std::uint32_t(classes.number(i)); }));
        QVERIFY(b.untouched());
        // how many of which class there are today
        std::array<std::uint64_t, 256> counts{};
        high.forEach([&](PointIndex i) { ++counts[std::size_t(classes.number(i))]; });
        for (unsigned code = 0; code < 256; ++code)
            if (counts[code] > high.count() / 3)
                QVERIFY(b.dock().resultText().contains(countText(counts[code]) + QStringLiteral(" of ") +
                                                       classText(code)));
        QVERIFY(b.dock().resultText().contains(QStringLiteral("Then: %1 of 5 ").arg(countText(high.count()))));

        QTest::keyClick(&b.dock().rule(), Qt::Key_Escape);
        QVERIFY(b.shows(plain) && b.dock().resultText().isEmpty());
        QCOMPARE(b.dock().rule().text(), QStringLiteral("Classification = 5 if Z > 425"));

        QTest::keyClick(&b.dock().rule(), Qt::Key_Return);
        QVERIFY(b.comes(QStringLiteral("would change")) && b.shows(previewed));
        b.key(Qt::Key_Escape);  // in the view
        QVERIFY(b.shows(plain));

        b.press(b.dock().previewButton());
        QVERIFY(b.shows(previewed));
        b.press(b.dock().endPreviewButton());
        QVERIFY(b.shows(plain) && !b.dock().endPreviewButton().isVisible());

        b.press(b.dock().previewButton());
        QVERIFY(b.shows(previewed));
        b.dock().rule().setFocus();
        QTest::keyClick(&b.dock().rule(), Qt::Key_Backspace);
        QVERIFY(b.shows(plain));
        QTest::keyClicks(&b.dock().rule(), QStringLiteral("5"));

        b.press(b.dock().previewButton());
        QVERIFY(b.shows(previewed));
        b.window->viewSettings().setAttribute(QStringLiteral("Intensity"));
        QVERIFY(b.settle(QStringLiteral("Intensity")));
        b.window->viewSettings().setAttribute(QStringLiteral("Classification"));
        QVERIFY(b.settle(QStringLiteral("Classification")) && b.shows(plain));
        QVERIFY(b.untouched());

        b.press(b.dock().previewButton());
        QVERIFY(b.shows(previewed));
        QVERIFY(b.runEdit([&] { b.press(b.dock().applyButton()); }));
        QVERIFY(b.shows(previewed) && !b.dock().endPreviewButton().isVisible());
        QVERIFY(b.dock().resultText().contains(countText(high.count())));
        QVERIFY(b.valuesNow() != b.columns);
        b.window->workspace().undo(*b.document);
        QVERIFY(b.shows(plain) && b.untouched());
    }

    void newClassesAreShownWhateverIsShown()
    {
        RuleBench b;
        QVERIFY(b.begin(QStringLiteral("Z")));
        const render::Image heights = b.frame()->image;
        b.type(QStringLiteral("Classification = 40 if Intensity > 100"));
        b.press(b.dock().previewButton());
        QVERIFY(b.comes(QStringLiteral("would change")) && b.settle(QStringLiteral("Classification")));
        const PointSet bright = b.holds("Intensity > 100");
        const Attribute classes = *b.document->findAttribute(QStringLiteral("Classification"));
        QVERIFY(b.words([&](PointIndex i) { return bright.contains(i) ? 40u : std::uint32_t(classes.number(i)); }));
        b.press(b.dock().endPreviewButton());
        QVERIFY(b.shows(heights) && b.frame()->attribute == QStringLiteral("Z"));
        QVERIFY(b.untouched());

        b.type(QStringLiteral("Classification = 5 if Z > 1e6"));
        b.press(b.dock().previewButton());
        QVERIFY(b.comes(QStringLiteral("No point would change.")));
        QVERIFY(b.shows(heights) && !b.dock().endPreviewButton().isVisible());
        b.type(QStringLiteral("Classification = 5 if Z >"));
        b.press(b.dock().previewButton());
        QVERIFY(b.comes(QStringLiteral("a value is missing")) && b.shows(heights));
    }

    // Where the view shows something else, the points look as if they were selected; else they show their new
    // values.
    void otherChangesAreTintedOrShown()
    {
        RuleBench b;
        QVERIFY(b.begin(QStringLiteral("Classification")));
        const render::Image plain = b.frame()->image;
        QVERIFY(b.preview(QStringLiteral("Intensity = 9 if Z > 425"), plain) && b.untouched());
        const render::Image tinted = b.frame()->image;
        b.press(b.dock().endPreviewButton());
        QVERIFY(b.shows(plain));
        b.type(QStringLiteral("Z > 425 and Intensity != 9"));
        b.press(b.dock().selectButton());
        QVERIFY(b.done() && b.shows(tinted));
        b.selection().clear();
        QVERIFY(b.shows(plain));

        b.window->viewSettings().setAttribute(QStringLiteral("RGB"));
        QVERIFY(b.settle(QStringLiteral("RGB")));
        const render::Image colors = b.frame()->image;
        QVERIFY(b.preview(QStringLiteral("Red = 65535 if Z > 425"), colors));
        const render::Image reddened = b.frame()->image;
        QVERIFY(b.untouched());
        QVERIFY(b.runEdit([&] { b.press(b.dock().applyButton()); }));
        QVERIFY(b.shows(reddened));
    }

    void classOfTheSelectedPoints()
    {
        RuleBench b;
        QVERIFY(b.begin(QStringLiteral("Classification")));
        const render::Image plain = b.frame()->image;
        b.type(QStringLiteral("Z > 420"));
        b.press(b.dock().selectButton());
        QVERIFY(b.done());
        const PointSet expected = b.holds("Z > 420 and Classification == 1");
        QVERIFY(expected.count() > 100);
        const auto choose = [](QComboBox& box, int code) {  // by keys, as the list is long
            box.setFocus();
            QTest::keyClick(&box, Qt::Key_Home);
            for (int k = 0; box.currentData().toInt() != code && k < 300; ++k) QTest::keyClick(&box, Qt::Key_Down);
        };
        choose(b.dock().fromClass(), 1);
        choose(b.dock().toClass(), 6);
        b.press(b.dock().previewClassButton());
        QVERIFY(b.comes(QStringLiteral("would change")));
        const Attribute classes = *b.document->findAttribute(QStringLiteral("Classification"));
        QVERIFY(
            b.words([&](PointIndex i) { return expected.contains(i) ? 6u : std::uint32_t(classes.number(i)); }));
        b.selection().clear();  // what was previewed is no longer what is meant
        QVERIFY(b.shows(plain) && b.untouched());
    }

    void savingMeanwhileKnowsNothingOfIt()
    {
        RuleBench b;
        QVERIFY(b.begin(QStringLiteral("Classification")));
        const render::Image plain = b.frame()->image;
        const auto saveTo = [&](const QString& name) {
            const QString path = b.folder.filePath(name);
            bool saved = false;
            b.window->workspace().save(*b.document, path, [&](bool ok) { saved = ok; });
            QFile file(path);
            return waitFor([&] { return saved; }) && file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
        };
        QVERIFY(b.preview(QStringLiteral("Classification = 5"), plain));
        const QByteArray during = saveTo(QStringLiteral("during.las"));
        b.dock().hide();  // nobody could tell what the view shows
        QVERIFY(b.shows(plain) && b.untouched());
        const QByteArray after = saveTo(QStringLiteral("after.las"));
        QVERIFY(!during.isEmpty() && during == after);
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<RulePanelTest>(); });
}
#include "RulePanelTest.moc"
