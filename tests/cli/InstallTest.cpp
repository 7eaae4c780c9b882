// SPDX-License-Identifier: MIT
// The installed tree: the program runs from there, and what the desktop reads about it fits together.
#include <QDir>
#include <QFile>
#include <QProcess>
#include <QRegularExpression>
#include <QTemporaryDir>
#include <QTest>
#include <QXmlStreamReader>

class InstallTest : public QObject
{
    Q_OBJECT

private slots:
    void initTestCase();
    void programRuns();
    void desktopEntryFits();
    void fileTypesAreDeclared();
    void metainfoFits();
    void documentsAreThere();

private:
    QString textOf(const QString& path) const
    {
        QFile file(m_prefix.filePath(path));
        return file.open(QIODevice::ReadOnly) ? QString::fromUtf8(file.readAll()) : QString();
    }
    /// Values of the attribute, or texts, of all elements of this name; empty, with a warning, when it is no XML.
    QStringList xmlValues(const QString& path, const QString& element, const QString& attribute = {}) const
    {
        QStringList found;
        QXmlStreamReader xml(textOf(path));
        while (!xml.atEnd()) {
            xml.readNext();
            if (!xml.isStartElement() || xml.name() != element) continue;
            found << (attribute.isEmpty() ? xml.readElementText() : xml.attributes().value(attribute).toString());
        }
        if (!xml.hasError()) return found;
        qWarning("%s, line %lld: %s", qPrintable(path), xml.lineNumber(), qPrintable(xml.errorString()));
        return {};
    }
    QString desktopValue(const QString& key) const
    {
        const QRegularExpression line('^' + key + QStringLiteral("=(.*)$"), QRegularExpression::MultilineOption);
        return line.match(textOf(QStringLiteral("share/applications/punctum.desktop"))).captured(1);
    }
    QString version() const
    {
        QProcess program;
        program.start(m_prefix.filePath(QStringLiteral("bin/punctum")), {QStringLiteral("--version")});
        program.waitForFinished();
        return QString::fromUtf8(program.readAllStandardOutput()).trimmed();
    }

    QTemporaryDir m_prefix;
};

void InstallTest::initTestCase()
{
    QVERIFY(m_prefix.isValid());
    QProcess cmake;
    cmake.setProcessChannelMode(QProcess::MergedChannels);
    cmake.start(QStringLiteral(PUNCTUM_CMAKE), {QStringLiteral("--install"), QStringLiteral(PUNCTUM_BUILD_DIR),
                                                QStringLiteral("--prefix"), m_prefix.path()});
    QVERIFY(cmake.waitForFinished(60'000));
    const QByteArray output = cmake.readAll();
    QVERIFY2(cmake.exitCode() == 0, output.constData());
}

void InstallTest::programRuns()
{
    QVERIFY2(version().startsWith(QStringLiteral("punctum ")), qPrintable(version()));
}

void InstallTest::desktopEntryFits()
{
    const QString program = desktopValue(QStringLiteral("Exec")).section(' ', 0, 0);
    QVERIFY2(QFile::exists(m_prefix.filePath(QStringLiteral("bin/") + program)), qPrintable(program));
    const QString icon = desktopValue(QStringLiteral("Icon"));
    QVERIFY(!xmlValues(QStringLiteral("share/icons/hicolor/scalable/apps/%1.svg").arg(icon),
                       QStringLiteral("circle"), QStringLiteral("r"))
                 .isEmpty());
}

void InstallTest::fileTypesAreDeclared()
{
    const QString path = QStringLiteral("share/mime/packages/punctum.xml");
    const QStringList declared = xmlValues(path, QStringLiteral("mime-type"), QStringLiteral("type"));
    const QStringList opened = desktopValue(QStringLiteral("MimeType")).split(';', Qt::SkipEmptyParts);
    QCOMPARE(opened.size(), 2);
    for (const QString& type : opened) QVERIFY2(declared.contains(type), qPrintable(type));
    QCOMPARE(xmlValues(path, QStringLiteral("glob"), QStringLiteral("pattern")),
             QStringList({QStringLiteral("*.las"), QStringLiteral("*.laz")}));
}

void InstallTest::metainfoFits()
{
    const QString path = QStringLiteral("share/metainfo/punctum.metainfo.xml");
    const QStringList releases = xmlValues(path, QStringLiteral("release"), QStringLiteral("version"));
    QVERIFY(!releases.isEmpty());
    QCOMPARE(QStringLiteral("punctum ") + releases.first(), version());
    const QString date = xmlValues(path, QStringLiteral("release"), QStringLiteral("date")).value(0);
    QVERIFY2(QDate::fromString(date, Qt::ISODate).isValid(), qPrintable(date));
    for (const QString& entry : xmlValues(path, QStringLiteral("launchable")))
        QVERIFY2(QFile::exists(m_prefix.filePath(QStringLiteral("share/applications/") + entry)),
                 qPrintable(entry));
}

void InstallTest::documentsAreThere()
{
    for (const char* name : {"LICENSE", "third-party.md", "user.md", "CHANGELOG.md"})
        QVERIFY2(!textOf(QStringLiteral("share/doc/punctum/") + QString::fromLatin1(name)).isEmpty(), name);
    QVERIFY(textOf(QStringLiteral("share/man/man1/punctum.1"))
                .contains(QStringLiteral(".TH PUNCTUM 1"), Qt::CaseInsensitive));
}

QTEST_APPLESS_MAIN(InstallTest)
#include "InstallTest.moc"
