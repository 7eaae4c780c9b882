// SPDX-License-Identifier: MIT
// What the documents say exists: links, paths, commands, options, processing steps.
#include <QDirIterator>
#include <QFile>
#include <QFileInfo>
#include <QProcess>
#include <QRegularExpression>
#include <QSet>
#include <QTest>

namespace
{

const QString kRoot = QStringLiteral(PUNCTUM_SOURCE_DIR);

QString textOf(const QString& path)
{
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? QString::fromUtf8(file.readAll()) : QString();
}

/// Every Markdown file of the project, as paths from the root.
QStringList documents()
{
    QStringList found;
    for (const QString& folder : {QStringLiteral("docs"), QStringLiteral("packaging")}) {
        QDirIterator it(kRoot + '/' + folder, {QStringLiteral("*.md")}, QDir::Files, QDirIterator::Subdirectories);
        while (it.hasNext()) found << QDir(kRoot).relativeFilePath(it.next());
    }
    for (const QString& name : QDir(kRoot).entryList({QStringLiteral("*.md")}, QDir::Files)) found << name;
    found.sort();
    return found;
}

QStringList allMatches(const QString& text, const QString& pattern)
{
    QStringList found;
    const QRegularExpression expression(pattern, QRegularExpression::MultilineOption);
    for (auto it = expression.globalMatch(text); it.hasNext();) found << it.next().captured(1);
    found.removeDuplicates();
    return found;
}

/// What `punctum ARGUMENTS` prints on stdout.
QString outputOf(const QStringList& arguments)
{
    QProcess program;
    program.start(QStringLiteral(PUNCTUM_PROGRAM), arguments);
    if (!program.waitForFinished(30'000)) return {};
    return QString::fromUtf8(program.readAllStandardOutput());
}

/// Names listed under "Subcommands:" in the program's help.
QStringList commands()
{
    const QString help = outputOf({QStringLiteral("--help")});
    const qsizetype list = help.indexOf(QStringLiteral("ubcommands:"), 0, Qt::CaseInsensitive);
    return list < 0 ? QStringList() : allMatches(help.mid(list), QStringLiteral("^  ([a-z]+)\\s"));
}

/// Headings as GitHub makes anchors of them.
QStringList anchorsOf(const QString& text)
{
    QStringList anchors;
    for (QString heading : allMatches(text, QStringLiteral("^#+ +(.+)$"))) {
        heading = heading.toLower().remove(QRegularExpression(QStringLiteral("[^\\w\\- ]"))).replace(' ', '-');
        anchors << heading;
    }
    return anchors;
}

}  // namespace

class DocsTest : public QObject
{
    Q_OBJECT

private slots:
    void everyDocumentIsThere();
    void linksLeadSomewhere_data() { documentRows(); }
    void linksLeadSomewhere();
    void pathsExist_data() { documentRows(); }
    void pathsExist();
    void commandsAreDocumented();
    void optionsInTheGuideExist();
    void stepsAreDocumented();

private:
    static void documentRows()
    {
        QTest::addColumn<QString>("path");
        for (const QString& path : documents()) QTest::newRow(qPrintable(path)) << path;
    }
};

void DocsTest::everyDocumentIsThere()
{
    const QStringList found = documents();
    for (const char* path : {"README.md", "CHANGELOG.md", "docs/user.md", "docs/steps.md",
                             "docs/dev/architecture.md", "docs/dev/style.md", "docs/dev/testing.md",
                             "docs/dev/errors.md", "docs/dev/las.md", "docs/dev/rendering.md"})
        QVERIFY2(found.contains(QString::fromLatin1(path)), path);
}

void DocsTest::linksLeadSomewhere()
{
    QFETCH(QString, path);
    const QString text = textOf(kRoot + '/' + path);
    QVERIFY(!text.isEmpty());
    QStringList dead;
    for (const QString& link : allMatches(text, QStringLiteral("\\]\\(([^)\\s]+)\\)"))) {
        if (link.contains(QStringLiteral("://"))) continue;
        const QString target = link.section('#', 0, 0);
        const QString file =
            target.isEmpty() ? kRoot + '/' + path : QFileInfo(kRoot + '/' + path).path() + '/' + target;
        const QString anchor = link.section('#', 1);
        if (!QFileInfo::exists(file) || (!anchor.isEmpty() && !anchorsOf(textOf(file)).contains(anchor)))
            dead << link;
    }
    QVERIFY2(dead.isEmpty(), qPrintable(dead.join(QStringLiteral(", "))));
}

void DocsTest::pathsExist()
{
    QFETCH(QString, path);
    // words that begin with one of our folders; "Name" stands for a name that the reader chooses
    const QString pattern = QStringLiteral(
        "(?<![\\w/.~-])((?:core|render|ui|app|resources|tests|packaging|cmake|docs|\\.ci)"
        "/[\\w./-]*|(?:run|test)\\.sh|CMake\\w+\\.\\w+)");
    QStringList missing;
    for (QString word : allMatches(textOf(kRoot + '/' + path), pattern)) {
        while (word.endsWith('.')) word.chop(1);
        if (word.contains(QStringLiteral("Name"))) continue;
        if (!QFileInfo::exists(kRoot + '/' + word)) missing << word;
    }
    QVERIFY2(missing.isEmpty(), qPrintable(missing.join(QStringLiteral(", "))));
}

void DocsTest::commandsAreDocumented()
{
    const QStringList there = commands();
    QVERIFY2(there.contains(QStringLiteral("info")), "punctum --help lists no commands");
    const QString readme = textOf(kRoot + QStringLiteral("/README.md"));
    for (const QString& named : allMatches(readme, QStringLiteral("^    punctum ([a-z]+)\\s")))
        QVERIFY2(there.contains(named), qPrintable(QStringLiteral("README.md tells of punctum ") + named));
    for (const QString& document :
         {QStringLiteral("README.md"), QStringLiteral("docs/user.md"), QStringLiteral("packaging/punctum.1")}) {
        const QString text = textOf(kRoot + '/' + document);
        for (const QString& command : there)
            QVERIFY2(text.contains(
                         QRegularExpression(QStringLiteral("punctum[ -]%1\\b|^\\.B %1\\b|\\\\fB%1\\b").arg(command),
                                            QRegularExpression::MultilineOption)),
                     qPrintable(document + QStringLiteral(" does not tell of ") + command));
    }
}

void DocsTest::optionsInTheGuideExist()
{
    QString help = outputOf({QStringLiteral("--help")});
    for (const QString& command : commands()) help += outputOf({command, QStringLiteral("--help")});
    for (const QString& what : {QStringLiteral("load"), QStringLiteral("render")})
        help += outputOf({QStringLiteral("bench"), what, QStringLiteral("--help")});
    const QString guide = textOf(kRoot + QStringLiteral("/docs/user.md"));
    const QStringList options = allMatches(guide, QStringLiteral("(?<![\\w-])(--[a-z][a-z-]+)"));
    QVERIFY(options.size() > 5);
    for (const QString& option : options)
        QVERIFY2(help.contains(option), qPrintable(QStringLiteral("docs/user.md tells of ") + option));
}

void DocsTest::stepsAreDocumented()
{
    // the page of steps is what the program says of them; renew it with the command in this message
    const QString said =
        outputOf({QStringLiteral("process"), QStringLiteral("--list-steps"), QStringLiteral("--markdown")});
    const QStringList page = textOf(kRoot + QStringLiteral("/docs/steps.md")).split('\n');
    const QStringList now = said.split('\n');
    QVERIFY2(now.size() > 10, "punctum process --list-steps --markdown prints nothing.");
    for (qsizetype line = 0; line < std::max(page.size(), now.size()); ++line)
        if (page.value(line) != now.value(line))
            QFAIL(qPrintable(
                QStringLiteral("Line %1 of docs/steps.md is \"%2\", but the program says \"%3\". Renew the "
                               "page: build/release/bin/punctum process --list-steps --markdown > "
                               "docs/steps.md")
                    .arg(line + 1)
                    .arg(page.value(line), now.value(line))));
    QVERIFY(textOf(kRoot + QStringLiteral("/docs/user.md")).contains(QStringLiteral("](steps.md)")));
}

QTEST_APPLESS_MAIN(DocsTest)
#include "DocsTest.moc"
