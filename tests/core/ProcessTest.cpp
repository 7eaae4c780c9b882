// SPDX-License-Identifier: MIT
// Steps as such, and reclassify: against a plain loop over the points.
#include "core/Error.h"
#include "core/las/SourceFile.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <chrono>
#include <cmath>
#include <limits>
#include <random>
#include <set>

using namespace punctum;

namespace
{

std::unique_ptr<Command> run(const PointCloud& cloud, const std::string& text)
{
    const ParsedStep parsed = parseStep(text);
    Progress progress;
    return parsed.step->run(cloud, parsed.values, progress);
}

/// Values of every kind that the type has: extremes, no-data, NaN, and random ones.
template <typename T>
void fillWild(std::span<T> values, std::uint64_t seed)
{
    std::mt19937_64 random(seed);
    using Limits = std::numeric_limits<T>;
    for (std::size_t i = 0; i < values.size(); ++i) {
        if constexpr (std::is_floating_point_v<T>) {
            values[i] = T(double(std::int64_t(random())) / 9e16);
            if (i % 17 == 0) values[i] = Limits::quiet_NaN();
            if (i % 19 == 0) values[i] = Limits::infinity();
            if (i % 23 == 0) values[i] = T(-5.5);
        } else {
            values[i] = T(random());
            if (i % 3 == 0) values[i] = T(random() % 100);
            if (i % 17 == 0) values[i] = Limits::max();
            if (i % 19 == 0) values[i] = Limits::min();
        }
    }
}

struct Case {
    std::string name;
    std::function<void(PointCloud&)> add;
};

template <typename T>
Case plain(const std::string& name, std::optional<Value> noData = {})
{
    return {name, [name, noData](PointCloud& cloud) {
                fillWild(addScalar<T>(cloud, name), 7);
                Attribute a = *cloud.findAttribute(name);
                cloud.removeAttribute(name);
                a.noData = noData;
                cloud.addColumn(a.columns[0]);
                cloud.addAttribute(a);
            }};
}

template <typename T>
Case scaled(const std::string& name, double scale, double offset)
{
    return {name, [=](PointCloud& cloud) {
                fillWild(addScalar<T>(cloud, name), 8);
                Attribute a = *cloud.findAttribute(name);
                cloud.removeAttribute(name);
                a.scaled = true;
                a.scale = scale;
                a.offset = offset;
                a.noData = std::int64_t(12);
                cloud.addColumn(a.columns[0]);
                cloud.addAttribute(a);
            }};
}

std::vector<Case> cases()
{
    return {plain<std::uint8_t>("u8"),
            plain<std::int8_t>("i8", std::int64_t(-128)),
            plain<std::uint16_t>("u16", std::uint64_t(65535)),
            plain<std::int16_t>("i16"),
            plain<std::uint32_t>("u32"),
            plain<std::int32_t>("i32", std::int64_t(7)),
            plain<std::uint64_t>("u64", std::uint64_t(18446744073709551615u)),
            plain<std::int64_t>("i64", std::int64_t(std::numeric_limits<std::int64_t>::min())),
            plain<float>("f32", -5.5),
            plain<double>("f64", std::numeric_limits<double>::quiet_NaN()),
            scaled<std::int16_t>("s16", 0.006, 0.0),
            scaled<std::int32_t>("s32", 0.01, 1234.5),
            scaled<std::int32_t>("negative", -0.5, 3.0),
            scaled<float>("sf32", 2.0, 1.0),
            scaled<std::uint8_t>("flat", 0.0, 3.0)};
}

/// Bounds that meet the ends of the types and lie inside them.
const std::pair<const char*, const char*> kBounds[] = {{"10", "50"},
                                                       {"-5.5", "7.25"},
                                                       {"0", "0"},
                                                       {"-1e300", "1e300"},
                                                       {"-inf", "inf"},
                                                       {"255", "65535"},
                                                       {"-9223372036854775808", "-9223372036854775808"},
                                                       {"18446744073709551615", "18446744073709551615"},
                                                       {"9223372036854775807", "9223372036854775808"},
                                                       {"1e19", "2e19"},
                                                       {"2e19", "3e19"},
                                                       {"-3e19", "-2e19"},
                                                       {"0.25", "0.75"},
                                                       {"3", "3"}};

/// Exact comparison of a value with a bound, integers as integers.
bool atLeast(const Value& value, const Value& bound)
{
    return std::visit(
        [](auto v, auto b) {
            if constexpr (std::is_integral_v<decltype(v)> && std::is_integral_v<decltype(b)>)
                return std::cmp_greater_equal(v, b);
            else
                return static_cast<long double>(v) >= static_cast<long double>(b);  // 64 bits of mantissa: exact
        },
        value, bound);
}

Value numberOf(const std::string& text)
{
    if (text.find_first_of(".ein") != std::string::npos) return std::stod(text);
    if (text.front() == '-') return std::int64_t(std::stoll(text));
    return std::uint64_t(std::stoull(text));
}

}  // namespace

class ProcessTest : public QObject
{
    Q_OBJECT

private slots:
    void stepsAreListed();
    void textIsParsed();
    void errorsSayWhatToDo_data();
    void errorsSayWhatToDo();
    void reclassifyMatchesPlainLoop();
    void reclassifyReadsBitFields();
    void reclassifyTakesTypedDecimals();
    void reclassifyKeepsFlagsAndUndoes();
    void reclassifyWidensClasses();
    void reclassifyChangesNothingTwice();
    void reclassifyRefuses();
    void reclassifyCancels();
    void reclassifyIsFast();
};

void ProcessTest::stepsAreListed()
{
    std::set<std::string> names;
    for (const Step* step : allSteps()) {
        QVERIFY(names.insert(step->name()).second);
        QVERIFY(findStep(step->name()) == step);
        QVERIFY(!step->title().empty());
        QVERIFY(step->help().ends_with('.'));
        for (const StepParameter& p : step->parameters()) {
            QVERIFY(!p.key.empty() && !p.label.empty());
            QVERIFY(p.help.ends_with('.'));
        }
    }
    QVERIFY(names.contains("reclassify"));
    QVERIFY(findStep("nothing") == nullptr);
}

void ProcessTest::textIsParsed()
{
    const auto parsed = parseStep("  reclassify  min=-1.5 attribute=\"Echo width\"\tmax=+3 class=6 ");
    QCOMPARE(QString::fromStdString(parsed.step->name()), QString("reclassify"));
    QVERIFY(
        (parsed.values == StepValues{{"attribute", "Echo width"}, {"min", "-1.5"}, {"max", "+3"}, {"class", "6"}}));
    QVERIFY(parseStep("reclassify attribute='it\"s' min=0 max=1 class=1").values.at("attribute") == "it\"s");
}

void ProcessTest::errorsSayWhatToDo_data()
{
    QTest::addColumn<QString>("text");
    QTest::addColumn<QString>("sentence");
    QTest::newRow("empty") << ""
                           << "Name a step, such as \"normals k=16\"; --list-steps tells which there are.";
    QTest::newRow("unknown") << "sharpen k=3"
                             << "There is no step \"sharpen\"; --list-steps tells which there are.";
    QTest::newRow("key")
        << "normals n=3"
        << "normals has no key \"n\"; its keys are k, radius, orientation, viewpoint and curvature.";
    QTest::newRow("no value")
        << "normals k"
        << "normals: write \"k\" as key=value; its keys are k, radius, orientation, viewpoint and curvature.";
    QTest::newRow("twice") << "normals k=3 k=4"
                           << "normals: k is given twice.";
    QTest::newRow("not a number") << "normals k=many"
                                  << "normals: k must be a whole number from 3 to 1000, not \"many\".";
    QTest::newRow("not whole") << "normals k=3.5"
                               << "normals: k must be a whole number from 3 to 1000, not \"3.5\".";
    QTest::newRow("too small") << "normals k=2"
                               << "normals: k must be a whole number from 3 to 1000, not \"2\".";
    QTest::newRow("nan") << "outliers deviations=nan"
                         << "outliers: deviations must be a number from 0 to 100, not \"nan\".";
    QTest::newRow("trailing") << "outliers deviations=1x"
                              << "outliers: deviations must be a number from 0 to 100, not \"1x\".";
    QTest::newRow("class") << "outliers class=256"
                           << "outliers: class must be a whole number from 0 to 255, not \"256\".";
    QTest::newRow("missing") << "reclassify min=0 max=1 class=2"
                             << "reclassify needs attribute=, the name of an attribute.";
    QTest::newRow("empty value") << "reclassify attribute=Z min= max=1 class=2"
                                 << "reclassify: min must be a number, not \"\".";
    QTest::newRow("quote") << "reclassify attribute=\"Z"
                           << "The step's text has a quotation mark that is not closed.";
}

void ProcessTest::errorsSayWhatToDo()
{
    QFETCH(QString, text);
    QFETCH(QString, sentence);
    QCOMPARE(QString::fromStdString(complaint([&] { parseStep(text.toStdString()); })), sentence);
}

void ProcessTest::reclassifyMatchesPlainLoop()
{
    for (const Case& c : cases())
        for (const auto& [min, max] : kBounds) {
            const auto cloud = makeFrame(70001);
            c.add(*cloud);
            auto classes = cloud->columns()[3]->values<std::uint8_t>();
            for (std::size_t i = 0; i < classes.size(); i += 5) classes[i] = 9;
            const Attribute& a = *cloud->findAttribute(c.name);
            // scaled integers are compared with a slack of a millionth of a step
            const double slack = a.scaled && !isFloating(a.type()) ? std::abs(a.scale) * 1e-6 : 0.0;
            PointSet expected(cloud->size());
            for (PointIndex i = 0; i < cloud->size(); ++i) {
                const double number = a.number(i);
                bool in = false;
                if (a.scaled)
                    in = number >= toDouble(numberOf(min)) - slack && number <= toDouble(numberOf(max)) + slack;
                else
                    in = atLeast(a.value(i), numberOf(min)) && atLeast(numberOf(max), a.value(i));
                if (in && !std::isnan(number) && classes[i] != 9) expected.insert(i);
            }
            const auto command =
                run(*cloud, "reclassify attribute=" + c.name + " min=" + min + " max=" + max + " class=9");
            const QString where = QString::fromStdString(c.name + " " + min + ".." + max);
            QVERIFY2((command == nullptr) == (expected.count() == 0), qPrintable(where));
            if (command == nullptr) continue;
            QVERIFY2(command->changedPoints() == expected.count(), qPrintable(where));
            command->apply(*cloud);
            for (PointIndex i = 0; i < cloud->size(); ++i)
                QVERIFY2((classes[i] == 9) == (expected.contains(i) || i % 5 == 0), qPrintable(where));
        }
}

void ProcessTest::reclassifyReadsBitFields()
{
    const auto cloud = makeFrame(1000, {}, true);
    auto bytes = addScalar<std::uint8_t>(*cloud, "Returns");
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(i);
    addBits(*cloud, "NumberOfReturns", "Returns", 3, 3);
    run(*cloud, "reclassify attribute=NumberOfReturns min=2 max=3 class=5")->apply(*cloud);
    const Attribute classes = *cloud->findAttribute("Classification");
    for (PointIndex i = 0; i < 1000; ++i) {
        const unsigned n = (i >> 3) & 7;
        QCOMPARE(classes.number(i), n == 2 || n == 3 ? 5.0 : 0.0);
    }
}

void ProcessTest::reclassifyTakesTypedDecimals()
{
    const auto cloud = makeFrame(3, {glm::dvec3(0.01), glm::dvec3(0.0, 0.0, 0.1)});
    const auto z = rawAxis(*cloud, 2);
    z[0] = 41039;
    z[1] = 41040;  // 410.40 + 0.1: not exactly 410.5 as a double
    z[2] = 41041;
    const auto command = run(*cloud, "reclassify attribute=Z min=410.5 max=410.5 class=2");
    QVERIFY(command != nullptr);
    QCOMPARE(command->changedPoints(), PointIndex(1));
    command->apply(*cloud);
    QCOMPARE(int(cloud->columns()[3]->values<std::uint8_t>()[1]), 2);
    QCOMPARE(QString::fromStdString(command->name()), QString("Reclassify to 2 Ground"));
}

void ProcessTest::reclassifyKeepsFlagsAndUndoes()
{
    const auto cloud = makeFrame(1000, {}, true);
    auto bytes = cloud->columns()[3]->values<std::uint8_t>();
    std::mt19937 random(3);
    for (auto& b : bytes) b = std::uint8_t(random());
    const auto before = snapshot(*cloud);
    const auto command = run(*cloud, "reclassify attribute=Withheld min=1 max=1 class=31");
    command->apply(*cloud);
    for (std::size_t i = 0; i < bytes.size(); ++i) {
        const auto old = std::uint8_t(before[3][i]);
        QCOMPARE(int(bytes[i]), int((old & 0x80) != 0 ? (old | 31) : old));
    }
    command->apply(*cloud);
    QVERIFY(snapshot(*cloud) == before);
}

/// A class that five bits cannot hold gets a column of its own; undone, all is as before.
void ProcessTest::reclassifyWidensClasses()
{
    const auto cloud = makeFrame(70000, {}, true);
    auto bytes = cloud->columns()[3]->values<std::uint8_t>();
    std::mt19937 random(4);
    for (auto& b : bytes) b = std::uint8_t(random());
    const auto before = snapshot(*cloud);
    const Attribute narrow = *cloud->findAttribute("Classification");
    const auto placeOf = [&] { return cloud->findAttribute("Classification") - cloud->attributes().data(); };
    const auto place = placeOf();
    std::vector<ChangeNotice::Kind> notices;
    const auto subscription = cloud->subscribe([&](const ChangeNotice& n) {
        QCOMPARE(n.attributes, std::vector<std::string>{"Classification"});
        notices.push_back(n.kind);
    });

    const auto wide = run(*cloud, "reclassify attribute=Withheld min=1 max=1 class=200");
    QCOMPARE(wide->changedPoints(),
             PointIndex(std::count_if(bytes.begin(), bytes.end(), [](auto b) { return b >> 7; })));
    wide->apply(*cloud);
    QCOMPARE(notices, (std::vector{ChangeNotice::Kind::Attributes, ChangeNotice::Kind::Values}));
    QCOMPARE(placeOf(), place);
    QCOMPARE(cloud->findAttribute("Classification")->maxBits(), std::uint64_t(255));
    for (std::size_t i = 0; i < bytes.size(); ++i)
        QCOMPARE(toDouble(cloud->findAttribute("Classification")->value(i)),
                 (bytes[i] & 0x80) != 0 ? 200.0 : double(bytes[i] & 31));
    QVERIFY(run(*cloud, "reclassify attribute=Withheld min=1 max=1 class=200") == nullptr);

    // the next edit is one of the wide column, and is undone before the widening
    const auto next = run(*cloud, "reclassify attribute=Classification min=200 max=200 class=3");
    QCOMPARE(next->changedPoints(), wide->changedPoints());
    next->apply(*cloud);
    next->apply(*cloud);
    wide->apply(*cloud);
    QVERIFY(snapshot(*cloud) == before);
    QCOMPARE(placeOf(), place);
    QVERIFY(cloud->findAttribute("Classification")->columns == narrow.columns);
    wide->apply(*cloud);
    QCOMPARE(toDouble(cloud->findAttribute("Classification")->value(0)),
             (bytes[0] & 0x80) != 0 ? 200.0 : double(bytes[0] & 31));
}

void ProcessTest::reclassifyChangesNothingTwice()
{
    const auto cloud = makeFrame(100);
    run(*cloud, "reclassify attribute=Classification min=0 max=0 class=6")->apply(*cloud);
    QVERIFY(run(*cloud, "reclassify attribute=Classification min=0 max=6 class=6") == nullptr);
    QVERIFY(run(*makeFrame(0), "reclassify attribute=Z min=0 max=6 class=6") == nullptr);
}

void ProcessTest::reclassifyRefuses()
{
    const auto cloud = makeFrame(10, {}, true);
    const auto sentence = [&](const std::string& text) {
        return QString::fromStdString(complaint([&] { run(*cloud, text); }));
    };
    QCOMPARE(sentence("reclassify attribute=Height min=0 max=1 class=2"),
             QString("reclassify: this cloud has no attribute \"Height\"."));
    QCOMPARE(sentence("reclassify attribute=Z min=2 max=1 class=2"),
             QString("reclassify: min is 2, which is above max, 1."));
    for (const char* name : {"Red", "Green", "Blue"}) addScalar<std::uint16_t>(*cloud, name);
    addComposite(*cloud, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    QCOMPARE(sentence("reclassify attribute=RGB min=0 max=1 class=2"),
             QString("reclassify: RGB has three components; choose one of them, such as Red."));
    cloud->removeAttribute("Classification");
    QCOMPARE(sentence("reclassify attribute=Z min=0 max=1 class=2"),
             QString("This cloud has no classes; nothing can be classified."));
}

void ProcessTest::reclassifyCancels()
{
    const auto cloud = makeFrame(100000);
    const ParsedStep parsed = parseStep("reclassify attribute=Z min=0 max=1 class=2");
    Progress progress;
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(parsed.step->run(*cloud, parsed.values, progress), Cancelled);
}

void ProcessTest::reclassifyIsFast()
{
    constexpr PointIndex kPoints = kFastBuild ? 20'000'000 : 1'000'000;
    constexpr double kLeast = kFastBuild ? 30.0 : 0.0;  // M points/s; ten times as many are usual
    const auto cloud = makeFrame(kPoints);
    const auto z = rawAxis(*cloud, 2);
    auto intensity = addScalar<std::uint16_t>(*cloud, "Intensity");
    auto time = addScalar<double>(*cloud, "GpsTime");
    for (PointIndex i = 0; i < kPoints; ++i) {
        z[i] = std::int32_t(i % 100000);
        intensity[i] = std::uint16_t(i);
        time[i] = double(i);
    }
    for (const char* name : {"Intensity", "Z", "GpsTime"}) {
        double best = 1e9;
        for (int round = 0; round < 3; ++round) {
            const auto start = std::chrono::steady_clock::now();
            const auto command =
                run(*cloud, std::string("reclassify attribute=") + name + " min=10 max=100 class=6");
            QVERIFY(command != nullptr);
            best = std::min(best, std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
        }
        const double rate = double(kPoints) / best / 1e6;
        qInfo("reclassify by %s: %.0f M points/s", name, rate);
        QVERIFY2(rate > kLeast, name);
    }
}

QTEST_APPLESS_MAIN(ProcessTest)
#include "ProcessTest.moc"
