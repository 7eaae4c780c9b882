// SPDX-License-Identifier: MIT
// Who may include whom (docs/dev/architecture.md): core <- render <- ui <- app, never back; no Qt below ui, no
// OpenGL in core. The check is run on the project, and on a made project that breaks every rule.
#include <QDir>
#include <QDirIterator>
#include <QFile>
#include <QMap>
#include <QRegularExpression>
#include <QTemporaryDir>
#include <QTest>

#include <functional>
#include <optional>

namespace
{

const QStringList kLayers = {"core", "render", "ui", "app"};

bool isQt(const QString& header)
{
    static const QRegularExpression name("^(Qt[A-Za-z0-9]*/.*|Q[A-Z][A-Za-z0-9]*|q[a-z0-9_]+\\.h)$");
    return name.match(header).hasMatch();
}

bool isOpenGl(const QString& header)
{
    static const QRegularExpression name("^(epoxy|GL|GLES[0-9]*|EGL|KHR|GLFW|glad)/");
    return name.match(header).hasMatch();
}

/// Layer of a path from the project's root, or -1.
qsizetype layerOf(const QString& path)
{
    return kLayers.indexOf(path.section('/', 0, 0));
}

/// A table of docs/dev/architecture.md, if that is there: "directions" says who may include whom inside the layers,
/// "closed" which folders other layers may include, beside their own.
std::optional<QMap<QString, QStringList>> tableOf(const QString& root, const QString& name)
{
    QFile file(root + "/docs/dev/architecture.md");
    if (!file.open(QIODevice::ReadOnly)) return std::nullopt;
    const QString text = QString::fromUtf8(file.readAll());
    QMap<QString, QStringList> table;
    for (const QString& line :
         text.section("```" + name + "\n", 1).section("```", 0, 0).split('\n', Qt::SkipEmptyParts))
        table[line.section(':', 0, 0)] = line.section(':', 1).split(' ', Qt::SkipEmptyParts);
    return table;
}

/// Folders of this layer that lead back to themselves by the table, each with its way.
QStringList findCircles(const QMap<QString, QStringList>& directions, const QString& layer)
{
    QStringList circles, done;
    const std::function<void(const QStringList&)> follow = [&](const QStringList& way) {
        const QString& folder = way.back();
        if (way.indexOf(folder) != way.size() - 1) {
            circles += way.mid(way.indexOf(folder)).join(" -> ");
            return;
        }
        if (done.contains(folder)) return;
        for (const QString& next : directions.value(folder)) follow(way + QStringList(next));
        done += folder;
    };
    for (const QString& folder : directions.keys())
        if (folder == layer || folder.startsWith(layer + '/')) follow({folder});
    return circles;
}

/// One sentence for each rule broken by the files of `root`.
QStringList findBreaches(const QString& root)
{
    QStringList breaches;
    const auto directions = tableOf(root, "directions"), closed = tableOf(root, "closed");
    static const QRegularExpression include("^\\s*#\\s*include\\s*[<\"]([^>\"]+)[>\"]");
    static const QRegularExpression linked("(Qt6::|\\bQt6\\b|EPOXY|OpenGL::|PkgConfig::EGL)");
    for (const QString& layer : kLayers) {
        QDirIterator files(root + '/' + layer, QDir::Files, QDirIterator::Subdirectories);
        while (files.hasNext()) {
            const QString path = QDir(root).relativeFilePath(files.next());
            QFile file(root + '/' + path);
            if (!file.open(QIODevice::ReadOnly)) {
                breaches += path + " cannot be read.";
                continue;
            }
            const bool cmake = path.endsWith("CMakeLists.txt");
            static const QRegularExpression source("\\.(h|hpp|inl|cpp|cc|cxx|c)$");
            if (!cmake && !path.contains(source)) continue;
            const qsizetype own = layerOf(path);
            int number = 0;
            for (const QByteArray& line : file.readAll().split('\n')) {
                const QString where = path + ":" + QString::number(++number);
                if (cmake) {
                    const QString text = QString::fromUtf8(line).section('#', 0, 0);
                    const auto match = linked.match(text);
                    if (match.hasMatch() && (own == 0 || (own == 1 && match.captured().startsWith("Qt"))))
                        breaches += where + " links " + match.captured() + ".";
                    for (qsizetype above = own + 1; above < kLayers.size(); ++above)
                        if (text.contains("punctum-" + kLayers[above]))
                            breaches += where + " links punctum-" + kLayers[above] + ".";
                    continue;
                }
                const auto match = include.match(QString::fromUtf8(line));
                if (!match.hasMatch()) continue;
                QString header = match.captured(1);
                if (header.contains("./"))
                    header = QDir::cleanPath(path.section('/', 0, -2) + '/' + header);  // as the compiler finds it
                if (own < 2 && isQt(header)) breaches += where + " includes Qt (" + header + ").";
                if (own < 1 && isOpenGl(header)) breaches += where + " includes OpenGL (" + header + ").";
                const QString folder = path.section('/', 0, -2), other = header.section('/', 0, -2);
                if (directions && layerOf(header) == own && other != folder &&
                    !directions->value(folder).contains(other))
                    breaches += where + " includes " + other + ", to which no direction leads (" + header + ").";
                if (closed && closed->contains(other) && layerOf(header) != own &&
                    !closed->value(other).contains(kLayers[own]))
                    breaches += where + " includes " + other + ", which is closed to it (" + header + ").";
                if (layerOf(header) > own) breaches += where + " includes upward (" + header + ").";
                if (header.startsWith("tests/")) breaches += where + " includes a test (" + header + ").";
            }
        }
    }
    return breaches;
}

void write(const QString& path, const char* text)
{
    QVERIFY(QDir().mkpath(path.section('/', 0, -2)));
    QFile file(path);
    QVERIFY(file.open(QIODevice::WriteOnly));
    file.write(text);
}

}  // namespace

class IncludesTest : public QObject
{
    Q_OBJECT

private slots:
    void theProjectKeepsTheRules();
    void breachesAreFound_data();
    void breachesAreFound();
    void innocentLinesAreNotBreaches();
    void directionsAreKept();
    void directionsHaveNoCircle();
};

void IncludesTest::theProjectKeepsTheRules()
{
    const QString root = PUNCTUM_SOURCE_DIR;
    for (const QString& layer : kLayers) QVERIFY2(QDir(root + '/' + layer).exists(), qPrintable(layer));
    const QStringList breaches = findBreaches(root);
    QVERIFY2(breaches.isEmpty(), qPrintable(breaches.join('\n')));
}

void IncludesTest::breachesAreFound_data()
{
    QTest::addColumn<QString>("path");
    QTest::addColumn<QString>("line");
    QTest::addColumn<QString>("breach");
    const auto row = [](const char* path, const char* line, const char* breach) {
        QTest::newRow(breach) << path << line << breach;
    };
    row("core/a/A.cpp", "#include <QString>", "core/a/A.cpp:2 includes Qt (QString).");
    row("core/A.h", "#include <QtCore/QString>", "core/A.h:2 includes Qt (QtCore/QString).");
    row("core/A.h", "#include <qglobal.h>", "core/A.h:2 includes Qt (qglobal.h).");
    row("core/A.h", "  #  include \"QObject\"", "core/A.h:2 includes Qt (QObject).");
    row("core/A.h", "#include <epoxy/gl.h>", "core/A.h:2 includes OpenGL (epoxy/gl.h).");
    row("core/A.h", "#include <GL/gl.h>", "core/A.h:2 includes OpenGL (GL/gl.h).");
    row("core/A.h", "#include <EGL/egl.h>", "core/A.h:2 includes OpenGL (EGL/egl.h).");
    row("core/A.h", "#include \"render/B.h\"", "core/A.h:2 includes upward (render/B.h).");
    row("core/x/A.h", "#include \"../../ui/B.h\"", "core/x/A.h:2 includes upward (ui/B.h).");
    row("core/A.cpp", "#include \"app/Cli.h\"", "core/A.cpp:2 includes upward (app/Cli.h).");
    row("core/A.cpp", "#include \"tests/core/B.h\"", "core/A.cpp:2 includes a test (tests/core/B.h).");
    row("core/CMakeLists.txt", "target_link_libraries(c Qt6::Core)", "core/CMakeLists.txt:2 links Qt6::.");
    row("core/CMakeLists.txt", "target_link_libraries(c PkgConfig::EPOXY)", "core/CMakeLists.txt:2 links EPOXY.");
    row("core/CMakeLists.txt", "target_link_libraries(c punctum-render)",
        "core/CMakeLists.txt:2 links punctum-render.");
    row("render/A.inl", "#include <QOpenGLContext>", "render/A.inl:2 includes Qt (QOpenGLContext).");
    row("render/A.cpp", "#include \"ui/View.h\"", "render/A.cpp:2 includes upward (ui/View.h).");
    row("render/CMakeLists.txt", "find_package(Qt6)", "render/CMakeLists.txt:2 links Qt6.");
    row("ui/A.cpp", "#include \"app/Window.h\"", "ui/A.cpp:2 includes upward (app/Window.h).");
}

void IncludesTest::breachesAreFound()
{
    QFETCH(QString, path);
    QFETCH(QString, line);
    QFETCH(QString, breach);
    QTemporaryDir root;
    write(root.path() + "/core/Good.h", "#include <vector>\n#include \"core/Other.h\"\n");
    write(root.path() + '/' + path, ("// first line\n" + line + "\n").toUtf8().constData());
    QCOMPARE(findBreaches(root.path()), QStringList(breach));
}

void IncludesTest::innocentLinesAreNotBreaches()
{
    QTemporaryDir root;
    write(root.path() + "/core/A.cpp",
          "// #include <QString>\n#include <glm/vec3.hpp>\n#include \"core/x/../A.h\"\n#include <queue>\n"
          "const char* s = \"#include <QString>\";\n#include <Eigen/Core>\n");
    write(root.path() + "/core/CMakeLists.txt",
          "# no Qt6:: here, nor punctum-render\nadd_library(punctum-core A.cpp)\n");
    write(root.path() + "/render/B.cpp",
          "#include \"core/A.h\"\n#include <epoxy/gl.h>\n#include \"resources.h\"\n");
    write(root.path() + "/ui/C.cpp", "#include <QWidget>\n#include \"render/B.h\"\n#include \"core/A.h\"\n");
    write(root.path() + "/app/D.cpp", "#include <QApplication>\n#include \"ui/C.h\"\n");
    QCOMPARE(findBreaches(root.path()), QStringList());
}

void IncludesTest::directionsAreKept()
{
    QTemporaryDir root;
    write(root.path() + "/docs/dev/architecture.md", "x\n```directions\ncore/a: core/b\ncore/b:\n```\ny\n");
    write(root.path() + "/core/a/A.h", "#include \"core/b/B.h\"\n#include \"core/a/C.h\"\n");
    write(root.path() + "/core/b/B.h", "#include <vector>\n");
    QCOMPARE(findBreaches(root.path()), QStringList());
    write(root.path() + "/core/b/B.h", "#include \"core/a/A.h\"\n");
    QCOMPARE(findBreaches(root.path()),
             QStringList("core/b/B.h:1 includes core/a, to which no direction leads (core/a/A.h)."));
    write(root.path() + "/core/b/B.h", "#include <vector>\n");
    write(root.path() + "/core/new/N.h", "#include \"core/b/B.h\"\n");
    QCOMPARE(findBreaches(root.path()),
             QStringList("core/new/N.h:1 includes core/b, to which no direction leads (core/b/B.h)."));

    write(root.path() + "/core/new/N.h", "#include <vector>\n");
    write(root.path() + "/docs/dev/architecture.md",
          "```directions\ncore/a: core/b\ncore/b:\n```\n```closed\ncore/b: app\n```\n");
    write(root.path() + "/app/C.cpp", "#include \"core/b/B.h\"\n");
    QCOMPARE(findBreaches(root.path()), QStringList());
    write(root.path() + "/ui/C.cpp", "#include \"core/a/A.h\"\n#include \"core/b/B.h\"\n");
    QCOMPARE(findBreaches(root.path()),
             QStringList("ui/C.cpp:2 includes core/b, which is closed to it (core/b/B.h)."));
}

void IncludesTest::directionsHaveNoCircle()
{
    QCOMPARE(
        findCircles({{"a/x", {"a/y"}}, {"a/y", {"a/z"}}, {"a/z", {"a/y"}}, {"b", {"b/x"}}, {"b/x", {"b"}}}, "a"),
        QStringList("a/y -> a/z -> a/y"));
    QCOMPARE(findCircles({{"a/x", {"a/y", "a/z"}}, {"a/y", {"a/z"}}, {"a/z", {}}}, "a"), QStringList());
    const auto directions = tableOf(PUNCTUM_SOURCE_DIR, "directions");
    QVERIFY(directions);
    // Layers that have been set in order; none of them may fall back.
    for (const QString& layer : {QStringLiteral("render"), QStringLiteral("ui")}) {
        const QStringList circles = findCircles(*directions, layer);
        QVERIFY2(circles.isEmpty(), qPrintable(circles.join('\n')));
    }
}

QTEST_APPLESS_MAIN(IncludesTest)
#include "IncludesTest.moc"
