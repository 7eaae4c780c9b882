// SPDX-License-Identifier: MIT
// A stack that overflows is caught where it is meant to be, and nothing else is.
#include "core/las/StackGuard.h"

#include "core/Error.h"

#include <QCoreApplication>
#include <QProcess>
#include <QTest>

#include <sys/mman.h>
#include <sys/resource.h>

#include <climits>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <thread>
#include <vector>

using namespace punctum;

namespace
{

constexpr const char* kFaultArgument = "--fault";
constexpr int kHandled = 43;

/// What this program does when it runs itself: it touches memory that is not there, and that is no stack. Whoever
/// handled SIGSEGV before gets it.
int faultOfSomebodyElse(const std::string& before)
{
    const struct rlimit none {
        0, 0
    };
    ::setrlimit(RLIMIT_CORE, &none);
    struct sigaction action {
    };
    if (before == "informed") {
        action.sa_flags = SA_SIGINFO;
        action.sa_sigaction = [](int, siginfo_t*, void*) { std::exit(kHandled); };
    } else if (before == "plain") {
        action.sa_handler = [](int) { std::exit(kHandled); };
    }
    if (before != "none") ::sigaction(SIGSEGV, &action, nullptr);
    void* const page = ::mmap(nullptr, 4096, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
    las::withStackGuard([&] { *static_cast<volatile char*>(page) = 1; });
    return 0;
}

[[gnu::noinline, gnu::no_sanitize_address]] int deep(int n)
{
    volatile char room[1024];
    room[0] = char(n);
    return n == 0 ? 0 : deep(n - 1) + room[0];
}

}  // namespace

class StackGuardTest : public QObject
{
    Q_OBJECT

private slots:
    void stackThatOverflows();
    void faultsOfOthers_data();
    void faultsOfOthers();
};

void StackGuardTest::stackThatOverflows()
{
    const auto overflows = [] { return !las::withStackGuard([] { deep(INT_MAX); }); };
    QVERIFY(overflows() && overflows());
    QVERIFY(las::withStackGuard([] { deep(10); }));
    // one inside the other: the outer one goes on
    bool within = false;
    QVERIFY(!las::withStackGuard([&] { within = las::withStackGuard([] {}) && overflows(); }));
    QVERIFY(!within);
    QVERIFY_EXCEPTION_THROWN(las::withStackGuard([] { throw Error("Something else."); }), Error);
    QVERIFY(overflows());
    // in a thread, with a stack for signals of its own or without
    bool ours = false, theirs = false;
    std::thread([&] { ours = overflows(); }).join();
    std::thread([&] {
        std::vector<char> memory(1 << 16);
        stack_t stack{};
        stack.ss_sp = memory.data();
        stack.ss_size = memory.size();
        ::sigaltstack(&stack, nullptr);
        theirs = overflows();
        stack.ss_flags = SS_DISABLE;
        ::sigaltstack(&stack, nullptr);
    }).join();
    QVERIFY(ours && theirs);
}

void StackGuardTest::faultsOfOthers_data()
{
    QTest::addColumn<QString>("before");
    for (const char* before : {"none", "plain", "informed"}) QTest::newRow(before) << before;
}

void StackGuardTest::faultsOfOthers()
{
    QFETCH(QString, before);
    QProcess process;
    process.start(QCoreApplication::applicationFilePath(), {kFaultArgument, before});
    QVERIFY(process.waitForFinished(60000));
    if (before == "none")
        QVERIFY(process.exitStatus() == QProcess::CrashExit || process.exitCode() != 0);
    else
        QCOMPARE(process.exitCode(), kHandled);
}

int main(int argc, char** argv)
{
    if (argc == 3 && std::strcmp(argv[1], kFaultArgument) == 0) return faultOfSomebodyElse(argv[2]);
    QCoreApplication app(argc, argv);
    StackGuardTest test;
    return QTest::qExec(&test, argc, argv);
}

#include "StackGuardTest.moc"
