// SPDX-License-Identifier: MIT
#include <QDirIterator>
#include <QFile>
#include <QMap>
#include <QRegularExpression>
#include <QSet>
#include <QTest>

/// Uniforms have the same place on both sides, because both take it from one table.
class ShadersTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void shadersDeclareWhatTheTableHas();
    void codeTakesPlacesFromTheTable();

private:
    static QString textOf(const QString& path);
    static QStringList files(const QString& folder, const QStringList& patterns);
    /// Names, and how many elements they have.
    static QMap<QString, int> table();
};

QString ShadersTest::textOf(const QString& path)
{
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? QString::fromUtf8(file.readAll()) : QString();
}

QStringList ShadersTest::files(const QString& folder, const QStringList& patterns)
{
    QStringList found;
    QDirIterator all(QStringLiteral(PUNCTUM_SOURCE_DIR "/") + folder, patterns, QDir::Files,
                     QDirIterator::Subdirectories);
    while (all.hasNext()) found << all.next();
    return found;
}

QMap<QString, int> ShadersTest::table()
{
    QMap<QString, int> names;
    const QString text = textOf(QStringLiteral(PUNCTUM_SOURCE_DIR "/resources/shaders/uniforms.txt"));
    for (const QString& line : text.split('\n', Qt::SkipEmptyParts)) {
        if (line.startsWith('#')) continue;
        const QStringList parts = line.split(' ');
        names[parts[0]] = parts.size() > 1 ? parts[1].toInt() : 1;
    }
    return names;
}

void ShadersTest::shadersDeclareWhatTheTableHas()
{
    const QMap<QString, int> known = table();
    QVERIFY(known.size() > 30);
    QMap<QString, QString> types;
    QSet<QString> used;
    const QStringList shaders = files("resources/shaders", {"*.glsl"});
    QVERIFY(shaders.size() > 20);
    static const QRegularExpression uniform(R"(^.*\buniform\b[^;]*;)", QRegularExpression::MultilineOption);
    static const QRegularExpression placed(R"(^layout\(location = AT_(\w+)\) uniform (\w+) (\w+)(\[(\d+)\])?;$)");
    static const QRegularExpression bound(R"(^layout\([^)]*binding = \d+\) .*uniform \w*(sampler|image)\w* \w+;$)");
    for (const QString& path : shaders) {
        for (auto all = uniform.globalMatch(textOf(path)); all.hasNext();) {
            const QString line = all.next().captured().trimmed();
            if (line.startsWith("//") || bound.match(line).hasMatch()) continue;
            const auto match = placed.match(line);
            const QByteArray where = (path + ": " + line).toUtf8();
            QVERIFY2(match.hasMatch(), where);
            const QString name = match.captured(1);
            QVERIFY2(name == match.captured(3) && known.contains(name), where);
            QVERIFY2(known[name] == (match.captured(5).isEmpty() ? 1 : match.captured(5).toInt()), where);
            const QString type = match.captured(2);
            QVERIFY2(types.value(name, type) == type, where);
            types[name] = type;
            used << name;
        }
    }
    for (const QString& name : known.keys()) QVERIFY2(used.contains(name), qPrintable(name + " is in no shader"));
}

void ShadersTest::codeTakesPlacesFromTheTable()
{
    static const QRegularExpression call(R"(glUniform\w+\(\s*([^,]+),)");
    int calls = 0;
    for (const QString& path : files("render", {"*.cpp", "*.h"}))
        for (auto all = call.globalMatch(textOf(path)); all.hasNext(); ++calls) {
            const auto match = all.next();
            QVERIFY2(match.captured(1).startsWith("at::k"), qPrintable(path + ": " + match.captured()));
        }
    QVERIFY(calls > 30);
}

QTEST_APPLESS_MAIN(ShadersTest)
#include "ShadersTest.moc"
