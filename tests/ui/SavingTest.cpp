// SPDX-License-Identifier: MIT
// Saving says what it will change before it does, and what it changed after; by real events.
#include "UiTest.h"

#include "core/las/Diff.h"
#include "core/task/Progress.h"
#include "ui/MainMenu.h"
#include "ui/MessageArea.h"
#include "ui/Text.h"
#include "ui/Viewport.h"
#include "ui/Workspace.h"
#include "ui/docks/PropertiesDock.h"

#include <QApplication>
#include <QFileDialog>
#include <QFileInfo>
#include <QLineEdit>
#include <QMessageBox>
#include <QPlainTextEdit>
#include <QPushButton>
#include <QTextBrowser>
#include <QTimer>
#include <QToolButton>

using namespace punctum;
using namespace punctum::ui;
using namespace punctum::ui::test;

namespace
{

const QString kAutzen = QStringLiteral("autzen_trim.laz");
const QString kCopc = QStringLiteral("lion_takanawa.copc.laz");

#define NEED_DATA(name)                                                                        \
    if (dataFile(name).isEmpty()) QSKIP(qPrintable((name) + QStringLiteral(" is not here."))); \
    static_assert(true)

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

/// Gives class 9 to a part of the points, and waits until that is done and counted.
bool reclassify(TestWindow& test, Document& document, const char* low, const char* high)
{
    test.window->workspace().run(document, *findStep("reclassify"),
                                 {{"attribute", "Z"}, {"min", low}, {"max", high}, {"class", "9"}});
    return waitFor([&] { return !test.window->workspace().busy(); }) && test.settle();
}

}  // namespace

class SavingTest : public QObject
{
    Q_OBJECT

private slots:
    void saysWhatSavingWillChangeAndWhatItChanged()
    {
        NEED_DATA(kAutzen);
        TestWindow test;
        const QString path = test.folder.filePath(QStringLiteral("survey.laz"));
        const QString before = test.folder.filePath(QStringLiteral("before.laz"));
        QVERIFY(QFile::copy(dataFile(kAutzen), path) && QFile::copy(path, before));
        QFile::setPermissions(path, QFile::ReadOwner | QFile::WriteOwner);
        Document* document = test.open(path);
        QVERIFY(document);
        QVERIFY(document->unsavedChanges().isEmpty());
        QVERIFY(reclassify(test, *document, "406", "425"));

        // before: in the properties, and over the button
        const QString expected = QStringLiteral("Classification of 20,884 points");
        QCOMPARE(document->unsavedChanges(), expected);
        QVERIFY(test.window->propertiesDock().text().contains(QStringLiteral("Unsaved changes\n") + expected));
        QVERIFY(test.window->menu().save->toolTip().contains(expected));

        // after: in a message, with nothing in the way
        QApplication::setActiveWindow(test.window.get());
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
        QVERIFY2(text.contains(QStringLiteral("20,884 points differ; point 0: 1 -> 9")), qPrintable(text));
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

    void savingWithoutChangesSaysSo()
    {
        NEED_DATA(kAutzen);
        TestWindow test;
        Document* document = test.open(dataFile(kAutzen));
        QVERIFY(document);
        const QString path = test.folder.filePath(QStringLiteral("same.las"));
        answerFileDialog(this, path);
        test.window->saveAs();
        QVERIFY(waitFor([&] { return QFileInfo::exists(path) && !test.window->workspace().busy(); }));
        QVERIFY2(lastSentence(test).contains(QStringLiteral("Nothing in it changed.")),
                 qPrintable(lastSentence(test)));
        QVERIFY(differenceOf(dataFile(kAutzen), path).contentEqual());
    }

    void asksWhereSomethingIsLeftOut()
    {
        NEED_DATA(kCopc);
        TestWindow test;
        Document* document = test.open(dataFile(kCopc));
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
        const las::Difference d = differenceOf(dataFile(kCopc), path);
        QVERIFY(d.attributes.empty() && d.differing == 0 && !d.records.empty());
    }

    void savesAlthoughThereIsNothingToCompareWith()
    {
        NEED_DATA(kAutzen);
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
