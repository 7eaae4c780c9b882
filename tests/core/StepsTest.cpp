// SPDX-License-Identifier: MIT
// What every step must keep to, whichever it is: made from allSteps(), so that a new one is held to it by itself.
#include "core/Error.h"
#include "core/las/Writer.h"
#include "core/process/Values.h"
#include "core/sample/Sample.h"
#include "core/session/Session.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QElapsedTimer>
#include <QTemporaryDir>
#include <QTest>

#include <tbb/global_control.h>

#include <algorithm>
#include <bit>
#include <cctype>
#include <chrono>
#include <cstring>
#include <future>
#include <limits>
#include <map>
#include <set>
#include <thread>

using namespace punctum;

namespace
{

constexpr PointIndex kLifelike = 6'000;
constexpr int kPatience = 20'000;  ///< ms that a step may take on a small cloud, whatever its points are

std::string text(const char* words, const std::string& more = {})
{
    return words + more;
}

bool isSentence(const std::string& s)
{
    return s.size() > 8 && s.back() == '.' && s.find('\n') == std::string::npos &&
           std::isupper(static_cast<unsigned char>(s.front())) != 0;
}

/// A sentence about a value begins with the step's name.
bool isSentenceOf(const Step& step, const std::string& s)
{
    return isSentence(s) || (s.starts_with(step.name()) && s.size() > step.name().size() + 8 && s.back() == '.' &&
                             s.find('\n') == std::string::npos);
}

/// Returns, numbers of them, intensity and an attribute of one's own beside what makeFrame() has.
void addFields(PointCloud& cloud)
{
    const auto returns = addScalar<std::uint8_t>(cloud, "ReturnNumber", AttributeKind::Category);
    const auto numbers = addScalar<std::uint8_t>(cloud, "NumberOfReturns", AttributeKind::Category);
    const auto intensity = addScalar<std::uint16_t>(cloud, "Intensity");
    const auto extra = addScalar<float>(cloud, "Extra");
    for (PointIndex i = 0; i < cloud.size(); ++i) {
        returns[i] = numbers[i] = 1;
        intensity[i] = std::uint16_t(100 + i % 50);
        extra[i] = float(i % 7);
    }
}

using Place = std::array<std::int32_t, 3>;

std::shared_ptr<PointCloud> cloudOf(const std::vector<Place>& places)
{
    auto cloud = makeFrame(places.size(), {glm::dvec3(0.01), glm::dvec3(0.0)});
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto raw = rawAxis(*cloud, axis);
        for (std::size_t i = 0; i < places.size(); ++i) raw[i] = places[i][axis];
    }
    addFields(*cloud);
    for (const auto& column : cloud->columns())
        if (column->name() == "Classification")
            for (PointIndex i = 0; i < cloud->size(); ++i) column->values<std::uint8_t>()[i] = i % 3 == 0 ? 2 : 1;
    return cloud;
}

std::shared_ptr<PointCloud> lifelike(PointIndex points = kLifelike)
{
    Progress progress;
    auto cloud = makeSample(points, 3, progress);
    const auto extra = addScalar<float>(*cloud, "Extra");
    for (PointIndex i = 0; i < cloud->size(); ++i) extra[i] = float(i % 7);
    return cloud;
}

struct Degenerate {
    const char* name;
    std::function<std::shared_ptr<PointCloud>()> make;
};

std::vector<Degenerate> degenerates()
{
    const auto grid = [](int side, auto place) {
        std::vector<Place> places;
        for (int y = 0; y < side; ++y)
            for (int x = 0; x < side; ++x) places.push_back(place(x, y));
        return cloudOf(places);
    };
    return {
        {"no point", [] { return cloudOf({}); }},
        {"one point",
         [] {
             return cloudOf({{5, 6, 7}});
         }},
        {"two points",
         [] {
             return cloudOf({{5, 6, 7}, {150, 6, 7}});
         }},
        {"all in one place", [=] { return grid(20, [](int, int) {
                                       return Place{5, 6, 7};
                                   }); }},
        {"on a line", [=] { return grid(20, [](int x, int y) {
                                return Place{20 * x + y, 40 * x + 2 * y, 0};
                            }); }},
        {"on an upright line",
         [=] { return grid(20, [](int x, int y) {
                   return Place{0, 0, 400 * y + 20 * x};
               }); }},
        {"on a plane", [=] { return grid(25, [](int x, int y) {
                                 return Place{50 * x, 50 * y, 10 * x};
                             }); }},
        {"all of them deleted",
         [=] {
             auto cloud = grid(20, [](int x, int y) { return Place{50 * x, 50 * y, x * y % 13}; });
             auto all = std::make_shared<PointSet>(cloud->size());
             all->insert(PointRange{0, cloud->size()});
             cloud->setDeleted(std::move(all));
             return cloud;
         }},
        {"a survey, some of it deleted",
         [] {
             auto cloud = lifelike();
             auto some = std::make_shared<PointSet>(cloud->size());
             for (PointIndex i = 0; i < cloud->size(); i += 5) some->insert(i);
             cloud->setDeleted(std::move(some));
             return cloud;
         }},
        {"one point far away", [=] {
             auto cloud = grid(40, [](int x, int y) { return Place{50 * x, 50 * y, x * y % 13}; });
             for (std::size_t axis = 0; axis < 3; ++axis)
                 rawAxis(*cloud, axis)[77] = std::numeric_limits<std::int32_t>::max() - 5;
             return cloud;
         }}};
}

/// Values for all that has to be given, so that there is something to do.
StepValues neededValues(const Step& step)
{
    StepValues values;
    for (const StepParameter& p : step.parameters()) {
        using Type = StepParameter::Type;
        if (!p.preset.empty() || p.optional || p.fit.used()) continue;
        std::string value;
        switch (p.type) {
            case Type::AttributeName:
                value = p.ownOnly ? "Extra" : "Z";
                break;
            case Type::Rule:
                value = "Intensity = Intensity + 1 if Z >= 0";
                break;
            case Type::Condition:
                value = "Intensity > 120";
                break;
            case Type::Choice:
                value = p.choices.front();
                break;
            case Type::ClassCode:
                value = "9";
                break;
            case Type::ClassCodes:
                value = "2";
                break;
            case Type::Text:
                value = "Renamed";
                break;
            case Type::Integer:
            case Type::Real:
                value = p.key == "max" ? "1000" : p.min < p.max ? std::to_string(int(p.min) + 1) : "1";
                break;
        }
        values.emplace(p.key, value);
    }
    return values;
}

/// What came of a run.
struct Ran {
    std::unique_ptr<Command> command;
    std::string refused;  ///< the sentence of an Error
    bool cancelled = false;
    bool tooLong = false;
};

/// Cancelled after kPatience.
Ran run(const Step& step, const PointCloud& cloud, const StepValues& values, const PointSet* within = nullptr)
{
    Progress progress;
    std::promise<void> ended;
    std::atomic<bool> late = false;
    std::thread watch([&, done = ended.get_future()] {
        if (done.wait_for(std::chrono::milliseconds(kPatience)) == std::future_status::ready) return;
        late = true;
        progress.cancel();
    });
    Ran ran;
    try {
        ran.command = step.run(cloud, values, progress, within);
    } catch (const Cancelled&) {
        ran.cancelled = true;
    } catch (const Error& e) {
        ran.refused = e.what();
    }
    ended.set_value();
    watch.join();
    ran.tooLong = late;
    return ran;
}

/// Does it, or undoes it.
void swap(Command& command, PointCloud& cloud)
{
    command.prepare();
    command.apply(cloud);
}

/// Of each attribute, all values to the last bit, and of each point whether it is deleted.
std::map<std::string, std::vector<std::uint64_t>> valuesByName(const PointCloud& cloud, const PointSet* leftOut)
{
    std::map<std::string, std::vector<std::uint64_t>> all;
    for (const Attribute& a : cloud.attributes())
        for (std::uint32_t c = 0; c < a.components && a.kind != AttributeKind::Opaque; ++c) {
            auto& values = all[a.name + "/" + std::to_string(c)];
            for (PointIndex i = 0; i < cloud.size(); ++i)
                if (leftOut == nullptr || !leftOut->contains(i))
                    values.push_back(std::bit_cast<std::uint64_t>(a.number(i, c)));
        }
    return all;
}

std::string differing(const std::map<std::string, std::vector<std::uint64_t>>& a,
                      const std::map<std::string, std::vector<std::uint64_t>>& b)
{
    std::string names;
    for (const auto& [name, values] : a)
        if (!b.contains(name) || b.at(name) != values) names += (names.empty() ? "" : ", ") + name;
    for (const auto& [name, values] : b)
        if (!a.contains(name)) names += (names.empty() ? "" : ", ") + name;
    return names;
}

/// A state of a cloud, to be compared.
struct State {
    std::vector<std::vector<std::byte>> bytes;
    std::vector<std::string> names;
    explicit State(const PointCloud& cloud) : bytes(snapshot(cloud)), names(attributeNames(cloud)) {}
    friend bool operator==(const State&, const State&) = default;
};

void stepRows()
{
    QTest::addColumn<QString>("name");
    for (const Step* step : allSteps()) QTest::newRow(step->name().c_str()) << QString::fromStdString(step->name());
}

}  // namespace

#define PUNCTUM_SAY(condition, sentence) QVERIFY2(condition, (sentence).c_str())

class StepsTest : public QObject
{
    Q_OBJECT

private slots:
    void saysWhatItIs_data() { stepRows(); }
    void saysWhatItIs();
    void presetsFit_data() { stepRows(); }
    void presetsFit();
    void refusesBadValues_data() { stepRows(); }
    void refusesBadValues();
    void takesAnyPoints_data() { stepRows(); }
    void takesAnyPoints();
    void isTheSameOnAnyThreads_data() { stepRows(); }
    void isTheSameOnAnyThreads();
    void changesOnlyWithin_data() { stepRows(); }
    void changesOnlyWithin();
    void isCancelled_data() { stepRows(); }
    void isCancelled();
    void isSaved_data() { stepRows(); }
    void isSaved();

private:
    static const Step& step()
    {
        QFETCH(QString, name);
        return *findStep(name.toStdString());
    }
};

void StepsTest::saysWhatItIs()
{
    const StepDescription& about = step().description();
    QVERIFY(!about.title.empty() && std::isupper(static_cast<unsigned char>(about.title.front())));
    PUNCTUM_SAY(isSentence(about.help), text("The help is no sentence: ", about.help));
    std::set<std::string> keys;
    for (const StepParameter& p : about.parameters) {
        PUNCTUM_SAY(keys.insert(p.key).second, text("There are two keys ", p.key));
        PUNCTUM_SAY(isSentence(p.help), text("The help is no sentence: ", p.key + ": " + p.help));
        PUNCTUM_SAY(!p.label.empty(), text("No label: ", p.key));
        PUNCTUM_SAY(p.key.find_first_of(" =\"'") == std::string::npos, text("No key: ", p.key));
    }
}

void StepsTest::presetsFit()
{
    const StepValues needed = neededValues(step());
    const StepValues whole = completeValues(step(), needed);
    for (const DataScale scale :
         {DataScale{0, 0}, DataScale{1e-9, 1}, DataScale{0.5, 1}, DataScale{3.3, 0.3048}, DataScale{1e9, 1},
          DataScale{1e300, 1e-300}, DataScale{std::numeric_limits<double>::quiet_NaN(), 1}}) {
        StepValues values = needed;
        for (const StepParameter& p : step().parameters())
            if (const std::string preset = presetOf(p, scale); p.fit.used()) values[p.key] = preset;
        try {
            completeValues(step(), values);
        } catch (const Error& e) {
            QFAIL(e.what());
        }
    }
}

void StepsTest::refusesBadValues()
{
    const StepValues needed = neededValues(step());
    const auto refuse = [&](const std::string& key, const std::string& value) -> std::string {
        StepValues values = needed;
        values[key] = value;
        try {
            completeValues(step(), values);
        } catch (const Error& e) {
            return isSentenceOf(step(), e.what()) ? "" : text("No sentence: ", e.what());
        }
        return key + "=" + value + " is not refused.";
    };
    PUNCTUM_SAY(refuse("no-such-key", "3").empty(), refuse("no-such-key", "3"));
    for (const StepParameter& p : step().parameters()) {
        using Type = StepParameter::Type;
        std::vector<std::string> bad;
        switch (p.type) {
            case Type::Integer:
                bad = {"many", "2.5", "1e400"};
                break;
            case Type::Real:
                bad = {"many", "nan", "3 m"};
                break;
            case Type::ClassCode:
                bad = {"256", "-1", "2.5", "ground"};
                break;
            case Type::ClassCodes:
                bad = {"256", "9-2", "2,,3", "ground", "-1"};
                break;
            case Type::Choice:
                bad = {"neither of them"};
                break;
            case Type::Rule:
                bad = {"Z =", "if Z > 3"};
                break;
            case Type::Condition:
                bad = {"Z >", "Z > 3 and"};
                break;
            case Type::AttributeName:
            case Type::Text:
                break;
        }
        if ((p.type == Type::Integer || p.type == Type::Real) && p.min < p.max) {
            const bool whole = p.type == Type::Integer;
            bad.push_back(whole ? std::to_string(std::int64_t(p.min) - 1) : std::to_string(p.min - 1));
            bad.push_back(whole ? std::to_string(std::int64_t(p.max) + 1) : std::to_string(p.max * 2 + 1));
        }
        for (const std::string& value : bad) PUNCTUM_SAY(refuse(p.key, value).empty(), refuse(p.key, value));
    }
}

void StepsTest::takesAnyPoints()
{
    for (const Degenerate& row : degenerates()) {
        const auto cloud = row.make();
        const State before(*cloud);
        const Ran ran = run(step(), *cloud, neededValues(step()));
        const std::string where = text(row.name, ": ");
        PUNCTUM_SAY(!ran.tooLong, where + "takes more than 20 s.");
        PUNCTUM_SAY(State(*cloud) == before, where + "making the command has changed the cloud.");
        PUNCTUM_SAY(ran.refused.empty() || isSentenceOf(step(), ran.refused),
                    where + "no sentence: " + ran.refused);
        if (!ran.command) continue;
        PUNCTUM_SAY(ran.command->finding().empty() || isSentence(ran.command->finding()) ||
                        std::isdigit(static_cast<unsigned char>(ran.command->finding().front())),
                    where + "no sentence: " + ran.command->finding());
        PUNCTUM_SAY(ran.command->changedPoints() <= cloud->size(), where + "more points change than there are.");
        if (const auto points = ran.command->points(); points && cloud->deleted() && step().name() != "restore") {
            PointSet both = *points;
            both.intersect(*cloud->deleted());
            PUNCTUM_SAY(both.count() == 0, where + "changes deleted points.");
        }
        swap(*ran.command, *cloud);
        const State after(*cloud);
        PUNCTUM_SAY(after != before, where + "a command that changes nothing; null is wanted.");
        swap(*ran.command, *cloud);
        PUNCTUM_SAY(State(*cloud) == before, where + "undone, it is not as it was.");
        swap(*ran.command, *cloud);
        PUNCTUM_SAY(State(*cloud) == after, where + "redone, it is not as it was done.");
    }
}

void StepsTest::isTheSameOnAnyThreads()
{
    std::optional<State> first;
    std::string finding;
    for (const int threads : {1, 2, 5}) {
        const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, std::size_t(threads));
        const auto cloud = lifelike();
        const Ran ran = run(step(), *cloud, neededValues(step()));
        PUNCTUM_SAY(ran.refused.empty(), text("Refused: ", ran.refused));
        if (ran.command) swap(*ran.command, *cloud);
        const State state(*cloud);
        if (!first) {
            first = state;
            finding = ran.command ? ran.command->finding() : "";
            continue;
        }
        PUNCTUM_SAY(state == *first, std::to_string(threads) + " threads find something else than one does.");
        QCOMPARE(ran.command ? ran.command->finding() : std::string(), finding);
    }
}

void StepsTest::changesOnlyWithin()
{
    const auto cloud = lifelike();
    PointSet within(cloud->size());
    for (PointIndex i = 0; i < cloud->size(); ++i)
        if (i % 3 != 0) within.insert(i);
    if (!step().description().narrows) {
        const Ran ran = run(step(), *cloud, neededValues(step()), &within);
        PUNCTUM_SAY(isSentence(ran.refused), text("It does not refuse to be told which points: ", ran.refused));
        return;
    }
    // done once for all, so that what it adds is there; then all values of that are others
    const auto before = attributeNames(*cloud);
    if (const Ran ran = run(step(), *cloud, neededValues(step())); ran.command && step().name() != "delete") {
        swap(*ran.command, *cloud);
        const auto is = [](const std::string& name) { return [name](const auto& other) { return other == name; }; };
        for (const Attribute& a : cloud->attributes())
            if (std::none_of(before.begin(), before.end(), is(a.name)))
                for (std::uint32_t c = 0; c < a.components; ++c)
                    std::memset(a.columns[c]->data(), 0x3F, a.columns[c]->size() * a.columns[c]->elementBytes());
        for (const Attribute& a : cloud->attributes())
            if (a.name == "Classification")
                for (std::uint8_t& code : a.columns[0]->values<std::uint8_t>())
                    if (code != 2) code = 1;  // some steps need the ground
    }
    PointSet outside = within;
    outside.invert();
    if (const auto deleted = cloud->deleted()) outside.remove(*deleted);  // by the first run
    const auto values = valuesByName(*cloud, &within);
    const Ran ran = run(step(), *cloud, neededValues(step()), &within);
    PUNCTUM_SAY(ran.refused.empty(), text("Refused: ", ran.refused));
    if (!ran.command) return;
    swap(*ran.command, *cloud);
    const auto after = valuesByName(*cloud, &within);
    PUNCTUM_SAY(differing(values, after).empty(),
                "Other points than those that it was told have changed: " + differing(values, after));
    if (const auto deleted = cloud->deleted()) {
        outside.intersect(*deleted);
        QCOMPARE(outside.count(), PointIndex(0));
    }
}

void StepsTest::isCancelled()
{
    const auto cloud = lifelike(20'000);
    const State before(*cloud);
    const StepValues values = neededValues(step());
    const auto cancelAfter = [&](std::chrono::microseconds wait, bool& cancelled, qint64& late) {
        Progress progress;
        QElapsedTimer since;
        std::thread canceller([&] {
            std::this_thread::sleep_for(wait);
            since.start();
            progress.cancel();
        });
        cancelled = false;
        try {
            step().run(*cloud, values, progress);
        } catch (const Cancelled&) {
            cancelled = true;
        } catch (const Error& e) {
            qWarning("%s", e.what());
        }
        const bool asked = progress.cancelled();
        late = asked ? since.elapsed() : 0;
        canceller.join();
    };
    Progress atOnce;
    atOnce.cancel();
    const bool looksAtNoPoint = step().description().group == StepGroup::Attributes || step().name() == "restore";
    bool cancelled = false;
    try {
        step().run(*cloud, values, atOnce);
    } catch (const Cancelled&) {
        cancelled = true;
    }
    QVERIFY2(cancelled || looksAtNoPoint, "It does not see that it is cancelled.");
    QElapsedTimer whole;
    whole.start();
    run(step(), *cloud, values);
    const auto time = std::chrono::microseconds(whole.nsecsElapsed() / 1000);
    for (const int part : {4, 2}) {
        qint64 late = 0;
        cancelAfter(time / part, cancelled, late);
        QVERIFY2(late < 1000, qPrintable(QStringLiteral("It ends %1 ms after it was cancelled.").arg(late)));
        QVERIFY2(State(*cloud) == before, "Cancelled, it has changed the cloud.");
    }
}

void StepsTest::isSaved()
{
    const QTemporaryDir folder;
    const std::filesystem::path in = folder.filePath("in.las").toStdString(),
                                out = folder.filePath("out.las").toStdString();
    Progress progress;
    las::write(*lifelike(), in, {}, progress);
    const auto session = Session::open(in);
    session->read(progress);
    try {
        session->edit({step().name(), neededValues(step()), nullptr}, progress);
    } catch (const Error& e) {
        QFAIL(e.what());
    }
    const auto there = valuesByName(*session->cloud(), session->cloud()->deleted().get());
    las::WriteOptions options;
    options.upgrade = true;
    session->save({.target = out, .options = options, .compare = false}, progress);
    const auto again = Session::open(out);
    again->read(progress);
    const auto saved = valuesByName(*again->cloud(), nullptr);
    PUNCTUM_SAY(differing(there, saved).empty(),
                "Saved and read again, these are others: " + differing(there, saved));
    session->undo(progress);
    session->redo(progress);
    PUNCTUM_SAY(differing(there, valuesByName(*session->cloud(), session->cloud()->deleted().get())).empty(),
                std::string("Undone and redone, it is not as it was done."));
}

QTEST_GUILESS_MAIN(StepsTest)
#include "StepsTest.moc"
