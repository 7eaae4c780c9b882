// SPDX-License-Identifier: MIT
// Saving says what it will change before it does, and what it changed after; by real events.
#include "UiTest.h"

#include "core/las/Diff.h"
#include "core/las/Doctor.h"
#include "core/las/Reader.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "ui/basic/Text.h"
#include "ui/docks/PropertiesDock.h"
#include "ui/document/Workspace.h"
#include "ui/view/MessageArea.h"
#include "ui/view/Viewport.h"
#include "ui/window/MainMenu.h"

#include <QApplication>
#include <QDir>
#include <QFileDialog>
#include <QFileInfo>
#include <QLineEdit>
#include <QMessageBox>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QTextBrowser>
#include <QTimer>
#include <QToolButton>
#include <QtEndian>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

/// Puts the record of a spatial index (COPC 1.0) before all others of a LAZ file. Its points stay where they are in
/// the file's order, which is all that matters here.
bool addCopcRecord(const QString& path)
{
    constexpr qsizetype kHead = 54, kInfo = 160;
    QFile file(path);
    if (!file.open(QIODevice::ReadWrite)) return false;
    QByteArray bytes = file.readAll();
    const auto at = [&](qsizetype place) { return bytes.data() + place; };
    const auto moved = [&]<typename T>(qsizetype place, T by) {
        qToLittleEndian(T(qFromLittleEndian<T>(at(place)) + by), at(place));
    };
    const auto header = qFromLittleEndian<std::uint16_t>(at(94));
    const auto points = qFromLittleEndian<std::uint32_t>(at(96));
    moved(points, std::uint64_t(kHead + kInfo));  // where the table of chunks is
    moved(96, std::uint32_t(kHead + kInfo));
    moved(100, std::uint32_t(1));
    if (qFromLittleEndian<std::uint64_t>(at(235)) != 0) moved(235, std::uint64_t(kHead + kInfo));
    QByteArray record(kHead + kInfo, '\0');
    record.replace(2, 4, "copc");
    qToLittleEndian(std::uint16_t(1), record.data() + 18);
    qToLittleEndian(std::uint16_t(kInfo), record.data() + 20);
    bytes.insert(header, record);
    file.seek(0);
    return file.write(bytes) == bytes.size();
}

las::Difference differenceOf(const QString& a, const QString& b)
{
    Progress progress;
    return las::diffFiles(toPath(a), toPath(b), {}, progress);
}

QString lastSentence(TestWindow& test)
{
    const QStringList all = test.window->viewport().messages().sentences();
    return all.isEmpty() ? QString() : all.back();
}

/// A box or window of that object name that is shown.
template <typename W>
W* shown(const char* name)
{
    for (QWidget* widget : QApplication::topLevelWidgets())
        if (widget->isVisible() && widget->objectName() == QLatin1String(name)) return qobject_cast<W*>(widget);
    return nullptr;
}

/// How many points are as high as reclassify(..., "406", "425") takes them.
PointIndex lowPoints(const Document& document)
{
    const Attribute& z = *document.findAttribute(QStringLiteral("Z"));
    PointIndex count = 0;
    for (PointIndex i = 0; i < document.points(); ++i) count += z.number(i) >= 406 && z.number(i) <= 425 ? 1 : 0;
    return count;
}

/// Answers the file dialog that opens next with this path.
void answerFileDialog(QObject* context, const QString& path)
{
    auto* timer = new QTimer(context);
    QObject::connect(timer, &QTimer::timeout, context, [timer, path] {
        auto* dialog = qobject_cast<QFileDialog*>(QApplication::activeModalWidget());
        if (!dialog) return;
        timer->deleteLater();
        dialog->findChild<QLineEdit*>(QStringLiteral("fileNameEdit"))->setText(path);
        QMetaObject::invokeMethod(dialog, "accept", Qt::QueuedConnection);
    });
    timer->start(20);
}

/// Gives a class to a part of the points, and waits until that is done and counted.
bool reclassify(TestWindow& test, Document& document, const char* low, const char* high, const char* code = "9")
{
    test.window->workspace().run(document, *findStep("reclassify"),
                                 {{"attribute", "Z"}, {"min", low}, {"max", high}, {"class", code}});
    return waitFor([&] { return !test.window->workspace().busy(); }) && test.settle();
}

}  // namespace

class SavingTest : public QObject
{
    Q_OBJECT

private slots:
    void saysWhatSavingWillChangeAndWhatItChanged()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("survey.laz"));
        const QString before = test.folder.filePath(QStringLiteral("before.laz"));
        QVERIFY(QFile::copy(surveyFile(), path) && QFile::copy(path, before));
        QFile::setPermissions(path, QFile::ReadOwner | QFile::WriteOwner);
        Document* document = test.open(path);
        QVERIFY(document);
        QVERIFY(document->unsavedChanges().isEmpty());
        QVERIFY(reclassify(test, *document, "406", "425"));

        // before: in the properties, and over the button
        const QString low = countText(lowPoints(*document));
        const QString expected = QStringLiteral("Classification of %1 points").arg(low);
        QCOMPARE(document->unsavedChanges(), expected);
        QVERIFY(test.window->propertiesDock().text().contains(QStringLiteral("Unsaved changes\n") + expected));
        QVERIFY(test.window->menu().save->toolTip().contains(expected));

        // after: in a message, with nothing in the way
        test.window->activateWindow();  // shortcuts want it, and there may be no window manager to see to it
        QVERIFY(QTest::qWaitForWindowActive(test.window.get()));
        QTest::keyClick(test.window.get(), Qt::Key_S, Qt::ControlModifier);
        QVERIFY(waitFor([&] { return lastSentence(test).startsWith(QStringLiteral("Saved")); }));
        QVERIFY(!QApplication::activeModalWidget());
        QVERIFY2(lastSentence(test).contains(expected + QLatin1Char('.')), qPrintable(lastSentence(test)));
        QVERIFY(lastSentence(test).contains(QStringLiteral("read back and compared")));
        QVERIFY(waitFor([&] { return !test.window->workspace().busy(); }));
        QVERIFY(document->unsavedChanges().isEmpty() && !document->modified());

        // and it is true
        const las::Difference d = differenceOf(before, path);
        QCOMPARE(toQString(las::summary(d)), expected);

        // the details
        auto* details = test.window->viewport().messages().findChild<QToolButton*>(QStringLiteral("details"));
        QVERIFY(details);
        QTest::mouseClick(details, Qt::LeftButton);
        QVERIFY(waitFor([&] { return shown<QDialog>("report") != nullptr; }));
        auto* report = shown<QDialog>("report");
        QVERIFY(!report->isModal());
        const QString text = report->findChild<QPlainTextEdit*>()->toPlainText();
        QVERIFY2(text.contains(low + QStringLiteral(" points differ; point 0: 2 -> 9")), qPrintable(text));
        QVERIFY2(text.contains(QStringLiteral("survey.laz before")), qPrintable(text));
        report->close();
        QVERIFY(test.window->propertiesDock().text().contains(QStringLiteral("Show exactly what differs")));

        // changed and changed back: nothing to tell
        QVERIFY(reclassify(test, *document, "426", "440"));
        QVERIFY(!document->unsavedChanges().isEmpty());
        test.window->menu().undo->trigger();
        QVERIFY(waitFor([&] { return !test.window->workspace().busy() && !document->modified(); }));
        QVERIFY(document->unsavedChanges().isEmpty());
        // before what was saved: seen from the other side
        test.window->menu().undo->trigger();
        QVERIFY(waitFor([&] { return document->modified() && !test.window->workspace().busy(); }));
        QCOMPARE(document->unsavedChanges(), expected);
    }

    void whatIsWrongIsToldAndRepaired()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("a.las"));
        const QString mended = test.folder.filePath(QStringLiteral("b.las"));
        writeSample(path, 5000);
        QFile file(path);
        QVERIFY(file.open(QIODevice::ReadWrite));
        const QByteArray sound = file.readAll();
        QVERIFY(file.seek(179) && file.write(QByteArray(48, '\xff')) == 48);  // the box
        file.close();
        PropertiesDock& panel = test.window->propertiesDock();
        auto* const button = panel.findChild<QPushButton*>(QStringLiteral("repair"));
        QVERIFY(button && button->isHidden());
        Document* const document = test.open(path);
        QVERIFY(document);
        QVERIFY(waitFor([&] { return !button->isHidden(); }));
        QVERIFY2(panel.text().contains(QStringLiteral("Doctor\nThe header's box is not that of the points")),
                 qPrintable(panel.text()));
        for (const char* part : {"Density", "points/m", "Return 1", "2 Ground", "Software", "WKT"})
            QVERIFY2(panel.text().contains(QLatin1String(part)), part);

        panel.show();
        panel.raise();
        answerFileDialog(this, mended);
        QTest::mouseClick(button, Qt::LeftButton);
        QVERIFY(waitFor([&] { return QFileInfo::exists(mended) && !test.window->workspace().busy(); }));
        QVERIFY2(lastSentence(test).startsWith(QStringLiteral("The fault is mended in b.las")),
                 qPrintable(lastSentence(test)));
        QFile repaired(mended);
        QVERIFY(repaired.open(QIODevice::ReadOnly) && repaired.readAll() == sound);
        QVERIFY(!document->modified());
        QCOMPARE(document->path(), path);
        // a sound file has nothing to offer
        QVERIFY(test.open(mended));
        QVERIFY(waitFor([&] { return panel.text().contains(QStringLiteral("Density")); }));
        QVERIFY(button->isHidden());
        QVERIFY(!panel.text().contains(QStringLiteral("Doctor")));
    }

    void afterASaveTheFilePanelIsAboutTheFileNow()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("a.las"));
        writeSample(path, 5000);
        QFile file(path);
        QVERIFY(file.open(QIODevice::ReadWrite));
        QVERIFY(file.seek(179) && file.write(QByteArray(48, '\xff')) == 48);  // the box
        file.close();
        PropertiesDock& panel = test.window->propertiesDock();
        Document* const document = test.open(path);
        QVERIFY(document);
        const QString box = QStringLiteral("The header's box is not that of the points");
        QVERIFY2(waitFor([&] { return panel.text().contains(box); }), qPrintable(panel.text()));
        QVERIFY(!panel.text().contains(QStringLiteral("yes, LAZ")));

        // some points go, and the rest is saved under another name, compressed
        const Step* const step = findStep("delete");
        QVERIFY(step);
        test.window->workspace().run(*document, *step, {{"where", "Classification == 2"}});
        QVERIFY(waitFor([&] { return document->deletedPoints() > 0 && !test.window->workspace().busy(); }));
        QVERIFY(panel.text().contains(box));  // as long as it is the file
        const QString saved = test.folder.filePath(QStringLiteral("b.laz"));
        answerFileDialog(this, saved);
        test.window->saveAs();
        QMessageBox* question = nullptr;  // what was damaged will differ, too
        QVERIFY(waitFor([&] { return (question = shown<QMessageBox>("savingQuestion")) != nullptr; }, 20'000));
        QTest::mouseClick(question->button(QMessageBox::Save), Qt::LeftButton);
        QVERIFY2(waitFor([&] { return document->path() == saved && !test.window->workspace().busy(); }, 20'000),
                 qPrintable(lastSentence(test)));
        Progress progress;
        const auto cloud = las::load(toPath(saved), progress);
        const las::Examination now = las::examine(*cloud, progress);
        const QString text = panel.text();
        QVERIFY2(!text.contains(box), qPrintable(text));
        for (const las::Finding& f : now.diagnosis.findings)
            QVERIFY2(text.contains(toQString(f.fault)), f.fault.c_str());
        QCOMPARE(text.contains(QStringLiteral("Doctor")), !now.diagnosis.findings.empty());
        QVERIFY2(text.contains(QStringLiteral("yes, LAZ")), qPrintable(text));
        QVERIFY(text.contains(bytesText(std::uint64_t(QFileInfo(saved).size()))));
        QVERIFY(!text.contains(QStringLiteral("2 Ground")));  // they are not in the file
        QVERIFY2(text.contains(countText(now.figures.returns[1])), qPrintable(text));
        // a save that comes next is looked at as well
        test.window->menu().undo->trigger();
        QVERIFY(waitFor([&] { return document->deletedPoints() == 0 && !test.window->workspace().busy(); }));
        QVERIFY(!panel.text().contains(QStringLiteral("2 Ground")));
        test.window->save();
        QVERIFY(waitFor([&] { return !document->modified() && !test.window->workspace().busy(); }));
        QVERIFY2(panel.text().contains(QStringLiteral("2 Ground")), qPrintable(panel.text()));
    }

    void savingWithoutChangesSaysSo()
    {
        TestWindow test;
        Document* document = test.open(surveyFile());
        QVERIFY(document);
        const QString path = test.folder.filePath(QStringLiteral("same.las"));
        answerFileDialog(this, path);
        test.window->saveAs();
        QVERIFY(waitFor([&] { return QFileInfo::exists(path) && !test.window->workspace().busy(); }));
        QVERIFY2(lastSentence(test).contains(QStringLiteral("Nothing in it changed.")),
                 qPrintable(lastSentence(test)));
        QVERIFY(differenceOf(surveyFile(), path).contentEqual());
    }

    void asksWhereSomethingIsLeftOut()
    {
        TestWindow test;
        const QString copc = test.folder.filePath(QStringLiteral("made.copc.laz"));
        writeSample(copc, 20000);
        QVERIFY(addCopcRecord(copc));
        Document* document = test.open(copc);
        QVERIFY(document);
        const QString path = test.folder.filePath(QStringLiteral("plain.las"));
        for (const bool go : {false, true}) {
            answerFileDialog(this, path);
            test.window->saveAs();
            QVERIFY(waitFor([&] { return shown<QMessageBox>("savingQuestion") != nullptr; }));
            auto* box = shown<QMessageBox>("savingQuestion");
            QVERIFY2(box->informativeText().contains(QStringLiteral("copc/1")), qPrintable(box->informativeText()));
            QVERIFY(box->informativeText().contains(QStringLiteral("spatial index")));
            QTest::mouseClick(box->button(go ? QMessageBox::Save : QMessageBox::Cancel), Qt::LeftButton);
            QVERIFY(waitFor([&] { return !test.window->workspace().busy() && QFileInfo::exists(path) == go; }));
        }
        QVERIFY(lastSentence(test).contains(QStringLiteral("spatial index")));
        QCOMPARE(document->path(), path);
        const las::Difference d = differenceOf(copc, path);
        QVERIFY(d.attributes.empty() && d.differing == 0 && !d.records.empty());
    }

    void damagedFilesSayWhatIsMissing_data()
    {
        QTest::addColumn<QString>("name");
        QTest::addColumn<QString>("missing");
        QTest::newRow("truncated LAS") << QStringLiteral("cut.las") << QStringLiteral("The header says");
        QTest::newRow("damaged LAZ chunk") << QStringLiteral("chunk.laz") << QStringLiteral("are damaged");
        QTest::newRow("count") << QStringLiteral("count.las") << QStringLiteral("The header says 9,000,000");
        QTest::newRow("extended record") << QStringLiteral("evlr.las") << QStringLiteral("extended records");
    }
    void damagedFilesSayWhatIsMissing()
    {
        QFETCH(QString, name);
        QFETCH(QString, missing);
        TestWindow test;
        const QString path = test.folder.filePath(name);
        writeSample(path, 60000);
        QFile file(path);
        QVERIFY(file.open(QIODevice::ReadWrite));
        const auto put = [&](qint64 at, quint64 value, qint64 bytes) {
            file.seek(at);
            file.write(reinterpret_cast<const char*>(&value), bytes);
        };
        if (name == QLatin1String("cut.las")) QVERIFY(file.resize(file.size() * 2 / 3));
        if (name == QLatin1String("chunk.laz"))
            for (qint64 at = 20000; at < 24000; at += 8) put(at, ~quint64(0) / 3 + quint64(at), 8);
        if (name == QLatin1String("count.las")) put(247, 9000000, 8);
        if (name == QLatin1String("evlr.las")) {
            put(235, quint64(file.size()) - 10, 8);
            put(243, 2, 4);
        }
        file.close();
        file.open(QIODevice::ReadOnly);
        const QByteArray before = file.readAll();

        Document* document = test.open(path);
        QVERIFY(document);
        QVERIFY(document->recovered());
        QVERIFY2(document->losses().front().contains(missing), qPrintable(document->losses().join(' ')));
        QVERIFY2(lastSentence(test).startsWith(name + QStringLiteral(" is damaged")),
                 qPrintable(lastSentence(test)));
        QVERIFY2(lastSentence(test).contains(QStringLiteral("another name.")), qPrintable(lastSentence(test)));
        const QString properties = test.window->propertiesDock().text();
        QVERIFY2(properties.contains(QStringLiteral("Missing or damaged\n") + document->losses().front()),
                 qPrintable(properties));
        QVERIFY(!test.window->menu().save->isEnabled());
        QVERIFY(test.window->menu().save->toolTip().endsWith(QLatin1Char('.')));
        QVERIFY(test.window->menu().saveAs->isEnabled());

        // nothing destroys the original
        test.window->saveTo(*document, path);
        QVERIFY(waitFor([&] { return lastSentence(test).contains(QStringLiteral("under another name")); }));
        file.seek(0);
        QVERIFY(file.readAll() == before);
        const QString copy = test.folder.filePath(QStringLiteral("copy.laz"));
        test.window->saveTo(*document, copy);
        QVERIFY(waitFor([&] { return QFileInfo::exists(copy) && !test.window->workspace().busy(); }));
        QVERIFY(!document->recovered());
        QVERIFY(test.window->menu().save->isEnabled());
        file.seek(0);
        QVERIFY(file.readAll() == before);
        const las::Difference d = differenceOf(copy, copy);
        QVERIFY(d.contentEqual() && d.compared > 0);
    }

    void asksOnceForAnotherFormat()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("old.laz"));
        QVERIFY(QFile::copy(surveyFile(), path));
        QFile::setPermissions(path, QFile::ReadOwner | QFile::WriteOwner);
        Document* document = test.open(path);
        QVERIFY(document);
        QCOMPARE(int(document->facts().format), 3);
        QVERIFY(reclassify(test, *document, "406", "425", "200"));
        QCOMPARE(document->findAttribute(QStringLiteral("Classification"))->maxBits(), std::uint64_t(255));
        const PointIndex low = lowPoints(*document);
        QVERIFY(waitFor([&] { return document->classCounts() && (*document->classCounts())[200] == low; }));
        for (const bool go : {false, true}) {
            test.window->save();
            QVERIFY(waitFor([&] { return shown<QMessageBox>("savingQuestion") != nullptr; }));
            auto* box = shown<QMessageBox>("savingQuestion");
            QCOMPARE(box->text(), QStringLiteral("Save as point format 7 of LAS 1.4?"));
            QVERIFY2(box->informativeText().contains(
                         QStringLiteral("%1 points have a class above 31").arg(countText(low))),
                     qPrintable(box->informativeText()));
            QTest::mouseClick(box->button(go ? QMessageBox::Save : QMessageBox::Cancel), Qt::LeftButton);
            QVERIFY(waitFor([&] { return !test.window->workspace().busy() && document->modified() != go; }));
        }
        QVERIFY2(lastSentence(test).contains(QStringLiteral("point format 7")), qPrintable(lastSentence(test)));
        // said once, done from then on
        QVERIFY(reclassify(test, *document, "426", "440", "201"));
        test.window->save();
        QVERIFY(waitFor([&] { return !test.window->workspace().busy() && !document->modified(); }));
        QVERIFY(shown<QMessageBox>("savingQuestion") == nullptr);
        Progress progress;
        const auto saved = las::load(toPath(path), progress);
        QCOMPARE(int(saved->source()->layout.format), 7);
        QCOMPARE(countValues(*saved->findAttribute("Classification"), progress)[200], std::uint64_t(low));
    }

    void whatIsUndoneWhileItIsWrittenStaysUnsaved()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("large.laz"));
        writeSample(path, 400'000);
        Document* document = test.open(path);
        QVERIFY(document);
        QVERIFY(reclassify(test, *document, "-1000", "1000", "30"));
        // The new file grows beside the old one; any other file that comes meanwhile, such as one of the settings,
        // tells nothing. From here on edits wait until it is written.
        const auto writing = [folder = QDir(test.folder.path())] {
            return !folder.entryList({QStringLiteral("*large.laz*.tmp-*")}, QDir::Files | QDir::Hidden).isEmpty();
        };
        test.window->save();
        QVERIFY(waitFor(writing));
        test.window->menu().undo->trigger();
        QVERIFY(waitFor([&] { return !test.window->workspace().busy(); }));
        QVERIFY(document->modified());
        const QStringList said = test.window->viewport().messages().sentences();
        QVERIFY2(said.join(QLatin1Char('\n')).contains(QStringLiteral("save once more")),
                 qPrintable(said.join(QLatin1Char('\n'))));
        Progress progress;
        const auto written = las::load(toPath(path), progress);
        QCOMPARE(countValues(*written->findAttribute("Classification"), progress)[30], std::uint64_t(400'000));

        test.window->save();
        QVERIFY(waitFor([&] { return !test.window->workspace().busy() && !document->modified(); }));
        const auto again = las::load(toPath(path), progress);
        QCOMPARE(countValues(*again->findAttribute("Classification"), progress)[30], std::uint64_t(0));
    }

    void savesAlthoughThereIsNothingToCompareWith()
    {
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("gone.las"));
        writeSample(path, 5000);
        Document* document = test.open(path);
        QVERIFY(document);
        QVERIFY(QFile::remove(path));
        QVERIFY(reclassify(test, *document, "-1000", "1000"));
        QVERIFY(document->unsavedChanges().isEmpty());
        test.window->save();
        QVERIFY(waitFor([&] { return QFileInfo::exists(path) && !test.window->workspace().busy(); }));
        QVERIFY(lastSentence(test).startsWith(QStringLiteral("Saved gone.las: 5,000 points")));
        QVERIFY(!document->modified());
        QVERIFY(document->lastSave()->details.isEmpty());
    }
};

int main(int argc, char** argv)
{
    return runUiTest(argc, argv, [] { return std::make_unique<SavingTest>(); });
}
#include "SavingTest.moc"
