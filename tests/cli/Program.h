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

/// Real files to test against; empty where they are not there.
inline QStringList realFiles()
{
    return QDir(PUNCTUM_TEST_DATA).entryList({"*.las", "*.laz"}, QDir::Files, QDir::Name);
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
