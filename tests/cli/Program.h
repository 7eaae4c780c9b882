// SPDX-License-Identifier: MIT
#pragma once

#include <QDir>
#include <QFile>
#include <QJsonDocument>
#include <QJsonObject>
#include <QProcess>
#include <QStringList>
#include <QTest>

namespace punctum::test
{

/// What a run of the program came to.
struct Outcome {
    int exitCode = -1;  ///< -1: it crashed or did not end
    QByteArray out;
    QString err;

    QJsonDocument json() const { return QJsonDocument::fromJson(out); }
    /// stderr is one line that the program wrote: a sentence.
    bool oneSentence() const
    {
        return err.startsWith("punctum: ") && err.count('\n') == 1 && (err.endsWith(".\n") || err.endsWith("?\n"));
    }
    QByteArray said() const { return "exit " + QByteArray::number(exitCode) + ": " + err.toUtf8(); }
};

/// An environment without any display.
inline QProcessEnvironment noDisplay()
{
    QProcessEnvironment environment = QProcessEnvironment::systemEnvironment();
    for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY", "QT_QPA_PLATFORM"}) environment.remove(name);
    return environment;
}

constexpr int kTimeout = 120'000;

/// Runs a program to its end, with no display. `folder`: where it runs; empty: here.
inline Outcome runProgram(const QString& program, const QStringList& arguments, const QString& folder = {})
{
    QProcess process;
    process.setProcessEnvironment(noDisplay());
    process.setStandardInputFile(QProcess::nullDevice());
    if (!folder.isEmpty()) process.setWorkingDirectory(folder);
    process.start(program, arguments);
    Outcome outcome;
    if (!process.waitForFinished(kTimeout)) {
        process.kill();
        process.waitForFinished();
        outcome.err = "did not end: " + process.errorString();
        return outcome;
    }
    if (process.exitStatus() == QProcess::NormalExit) outcome.exitCode = process.exitCode();
    outcome.out = process.readAllStandardOutput();
    outcome.err = QString::fromUtf8(process.readAllStandardError());
    return outcome;
}

/// Runs punctum itself.
inline Outcome runPunctum(const QStringList& arguments, const QString& folder = {})
{
    return runProgram(PUNCTUM_PROGRAM, arguments, folder);
}

/// Real files to test against, those of the folders beside them included; empty where they are not there. Not the
/// ones whose header lies or whose end is lost, which have tests of their own, and not LAS 1.5, which LASzip cannot
/// read.
inline QStringList realFiles()
{
    const QDir data(PUNCTUM_TEST_DATA);
    const QStringList others{"more/bad-vlr-count.las",     "more/pdrf10-las15.las",      "more/pdrf10-las15.laz",
                             "cases/count-zero.las",       "cases/evlr-offset-zero.las", "cases/laz-zero-tail.laz",
                             "cases/vlr-count-garbage.las"};
    QStringList files;
    for (const QString& folder : {QString(), QString("more/"), QString("cases/")})
        for (const QString& name :
             QDir(data.filePath(folder)).entryList({"*.las", "*.laz"}, QDir::Files, QDir::Name))
            if (!others.contains(folder + name)) files << folder + name;
    return files;
}

inline QString realFile(const QString& name)
{
    return QDir(PUNCTUM_TEST_DATA).filePath(name);
}

inline QByteArray contentOf(const QString& path)
{
    QFile file(path);
    return file.open(QIODevice::ReadOnly) ? file.readAll() : QByteArray();
}

}  // namespace punctum::test

/// Fails with what the program said.
#define PUNCTUM_EXIT(outcome, code) QVERIFY2((outcome).exitCode == (code), (outcome).said().constData())
