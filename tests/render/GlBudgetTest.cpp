// SPDX-License-Identifier: MIT
// What the device makes of its clock, which is set here: how many slots there is time for, and which commands.
#include "core/Error.h"
#include "render/gl/EglContext.h"
#include "render/raster/gl/GlBudget.h"

#include <QTest>

#include <optional>

using namespace punctum;
using namespace punctum::render;

namespace
{

struct Decided {
    std::vector<GlVisibility::Command> commands;
    std::uint64_t total = 0;
};
/// 1000 slots were drawn between these times, in ns.
Decided decide(GlBudget& budget, const std::array<std::uint64_t, 3>& times,
               const std::vector<GlBudget::Piece>& pieces, double seconds)
{
    GlTraffic traffic;
    budget.clock().write(0, times.data(), sizeof times, traffic);
    const GlVisibility::Band& band = budget.decide(pieces, 1000, 128, seconds);
    Decided decided;
    decided.commands.resize(pieces.size());
    if (!pieces.empty())
        band.commands.read(0, decided.commands.data(), pieces.size() * sizeof(GlVisibility::Command), traffic);
    decided.total = budget.result().drawn - 1000;
    return decided;
}

}  // namespace

class GlBudgetTest : public QObject
{
    Q_OBJECT

    EglContext m_context;

private slots:
    void initTestCase()
    {
        try {
            m_context = EglContext::create();
            if (!requireGl43().timesToBuffers) QSKIP("This driver does not write times to buffers.");
        } catch (const Error& e) {
            QSKIP(e.what());
        }
    }

    void takesWhatFits()
    {
        GlTraffic traffic;
        GlBudget budget(traffic);
        // a run over the seam of two chunks, and one more
        const std::vector<GlBudget::Piece> pieces{
            {500, 3000, 0, 5000, 100}, {0, 2000, 3000, 5000, 100}, {70, 1000, 0, 1000, 1}};
        struct Case {
            std::array<std::uint64_t, 3> times;
            double seconds;
            std::array<std::uint32_t, 3> counts;
        };
        // One slot costs 1000 ns. The clock's high word counts, and so does what the frame took before.
        const std::uint64_t high = 5ull << 32;
        for (const Case& c : {
                 Case{{0, 0, 1'000'000}, 0.0, {0, 0, 0}},
                 Case{{0, 0, 1'000'000}, 0.00325, {2200, 0, 0}},
                 Case{{0, 0, 1'000'000}, 0.00499, {3000, 900, 0}},
                 Case{{0, 1'500'000, 2'500'000}, 0.00499, {2400, 0, 0}},
                 Case{{high - 500'000, high - 500'000, high + 500'000}, 0.00499, {3000, 900, 0}},
                 Case{{0, 0, 1'000'000}, 0.0065, {3000, 2000, 500}},
                 Case{{0, 0, 1'000'000}, 1e9, {3000, 2000, 1000}},
                 // a clock that did not run, one that went back, one that stood still for long
                 Case{{7, 7, 7}, 0.001, {3000, 2000, 1000}},
                 Case{{9'000, 8'000, 7'000}, 1.0, {0, 0, 0}},
                 Case{{0, 0, high}, 1.0, {0, 0, 0}},
             }) {
            const Decided decided = decide(budget, c.times, pieces, c.seconds);
            std::uint64_t total = 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const GlVisibility::Command& command = decided.commands[k];
                QVERIFY2(command.count == c.counts[k],
                         qPrintable(QStringLiteral("%1 s: %2").arg(c.seconds).arg(command.count)));
                QCOMPARE(command.firstIndex, pieces[k].first);
                QCOMPARE(command.instances, 1u);
                QCOMPARE(command.groups[0], (command.count + 127) / 128);
                QCOMPARE(command.groups[1] * command.groups[2], 1u);
                total += command.count;
            }
            QCOMPARE(decided.total, total);
        }
        QCOMPARE(decide(budget, {0, 0, 1000}, {}, 1.0).total, std::uint64_t(0));
    }

    void noRunIsPassedOver()
    {
        // What is left of the time would do for the second run, but not for a step of the first.
        GlTraffic traffic;
        GlBudget budget(traffic);
        const Decided decided =
            decide(budget, {0, 0, 1'000'000}, {{0, 5000, 0, 5000, 2500}, {0, 100, 0, 100, 1}}, 0.00325);
        QCOMPARE(decided.total, std::uint64_t(0));
    }

    void theClockRuns()
    {
        GlTraffic traffic;
        GlBudget budget(traffic);
        for (const auto moment : {GlBudget::Moment::Start, GlBudget::Moment::FirstBegins,
                                  GlBudget::Moment::FirstDone, GlBudget::Moment::Done})
            budget.mark(moment);
        std::uint64_t times[4]{};
        budget.clock().read(0, times, sizeof times, traffic);
        QVERIFY(times[0] > 0 && times[0] <= times[1] && times[1] <= times[2] && times[2] <= times[3]);
        QVERIFY(times[3] - times[0] < 10'000'000'000);
    }
};

QTEST_GUILESS_MAIN(GlBudgetTest)
#include "GlBudgetTest.moc"
