// SPDX-License-Identifier: MIT
// The expression language: against the same condition written in C++, point by point; and what it refuses, and
// where.
#include "core/expression/Condition.h"
#include "core/expression/ExpressionError.h"
#include "core/expression/Rule.h"
#include "core/expression/Syntax.h"
#include "core/steps/Steps.h"
#include "core/task/Progress.h"
#include "tests/core/Complaint.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <cmath>
#include <functional>
#include <limits>

using namespace punctum;
using namespace punctum::expression;

namespace
{

constexpr PointIndex kPoints = 70'001;  // more than a task, and not whole words

constexpr std::int64_t kBig = std::int64_t(1) << 60;  ///< its neighbors are the same double

struct Made {
    std::shared_ptr<PointCloud> cloud;
    std::span<std::uint16_t> intensity;
    std::span<float> normalZ;
    std::span<double> height;
    std::span<std::uint64_t> id;
    std::span<std::int64_t> stamp;
    std::span<std::int16_t> grade;
    std::span<std::uint8_t> classes;
    std::span<std::int32_t> z;

    bool withheld(PointIndex i) const { return (classes[i] & 0x80) != 0; }
    int classOf(PointIndex i) const { return classes[i] & 31; }
};

Made makeCloud()
{
    Made m;
    m.cloud = makeFrame(kPoints, {glm::dvec3(0.01), glm::dvec3(100.0)}, true);
    m.intensity = addScalar<std::uint16_t>(*m.cloud, "Intensity");
    m.normalZ = addScalar<float>(*m.cloud, "NormalZ");
    m.height = addScalar<double>(*m.cloud, "Height above ground");
    m.id = addScalar<std::uint64_t>(*m.cloud, "Id");
    m.stamp = addScalar<std::int64_t>(*m.cloud, "Stamp");
    m.grade = addScalar<std::int16_t>(*m.cloud, "Grade");
    Attribute grade = *m.cloud->findAttribute("Grade");  // -1 is none
    m.cloud->removeAttribute("Grade");
    grade.noData = std::int64_t(-1);
    m.cloud->addColumn(grade.columns[0]);
    m.cloud->addAttribute(grade);
    for (const auto& column : m.cloud->columns())
        if (column->name() == "ClassFlags") m.classes = column->values<std::uint8_t>();
    m.z = rawAxis(*m.cloud, 2);
    std::mt19937_64 random(5);
    for (PointIndex i = 0; i < kPoints; ++i) {
        m.intensity[i] = std::uint16_t(random() % 4000);
        m.normalZ[i] = float(double(random() % 2001) / 1000.0 - 1.0);
        m.height[i] = i % 31 == 0 ? std::numeric_limits<double>::quiet_NaN() : double(random() % 1000) / 50.0 - 2.0;
        m.id[i] = (std::uint64_t(1) << 63) + random() % 5;
        m.stamp[i] = (random() % 2 == 0 ? kBig : -kBig) + std::int64_t(random() % 5);
        m.grade[i] = std::int16_t(std::int64_t(random() % 9) - 4);
        m.classes[i] = std::uint8_t(random());
        m.z[i] = std::int32_t(random() % 4001) - 2000;
    }
    return m;
}

PointSet found(const PointCloud& cloud, const std::string& text)
{
    Progress progress;
    return *select(cloud, Condition(text, cloud), progress);
}

/// Text and meaning of a random expression over three columns of doubles, made together.
struct Random {
    std::mt19937_64 random{11};
    const Made& m;

    struct Value {
        std::string text;
        std::function<double(PointIndex)> of;
    };
    struct Truth {
        std::string text;
        std::function<bool(PointIndex)> of;
    };
    unsigned pick(unsigned n) { return unsigned(random() % n); }

    Value value(int depth)
    {
        if (depth == 0) {
            switch (pick(4)) {
                case 0:
                    return {"Intensity", [this](PointIndex i) { return double(m.intensity[i]); }};
                case 1:
                    return {"NormalZ", [this](PointIndex i) { return double(m.normalZ[i]); }};
                case 2:
                    return {"'Height above ground'", [this](PointIndex i) { return m.height[i]; }};
                default:
                    const double c = double(pick(64)) / 8.0;
                    return {std::to_string(c), [c](PointIndex) { return c; }};
            }
        }
        Value a = value(depth - 1), b = value(depth - 1);
        switch (pick(7)) {
            case 0:
                return {"(" + a.text + "+" + b.text + ")", [=](PointIndex i) { return a.of(i) + b.of(i); }};
            case 1:
                return {"(" + a.text + " - " + b.text + ")", [=](PointIndex i) { return a.of(i) - b.of(i); }};
            case 2:
                return {"(" + a.text + "*" + b.text + ")", [=](PointIndex i) { return a.of(i) * b.of(i); }};
            case 3:
                return {"-" + a.text, [=](PointIndex i) { return -a.of(i); }};
            case 4:
                return {"abs(" + a.text + ")", [=](PointIndex i) { return std::abs(a.of(i)); }};
            case 5:
                return {"min(" + a.text + ", " + b.text + ")", [=](PointIndex i) {
                            const double x = a.of(i), y = b.of(i);
                            return std::isnan(x) || std::isnan(y) ? NAN : std::min(x, y);
                        }};
            default:
                const Truth t = truth(depth - 1);
                return {"(" + a.text + " if " + t.text + " else " + b.text + ")",
                        [=](PointIndex i) { return t.of(i) ? a.of(i) : b.of(i); }};
        }
    }

    Truth truth(int depth)
    {
        if (depth <= 0 || pick(3) == 0) {
            const Value a = value(std::max(depth - 1, 0)), b = value(0);
            switch (pick(4)) {
                case 0:
                    return {a.text + " < " + b.text, [=](PointIndex i) { return a.of(i) < b.of(i); }};
                case 1:
                    return {a.text + ">=" + b.text, [=](PointIndex i) { return a.of(i) >= b.of(i); }};
                case 2:
                    return {a.text + " != " + b.text, [=](PointIndex i) { return a.of(i) != b.of(i); }};
                default:
                    return {a.text + " between -0.5 and " + b.text,
                            [=](PointIndex i) { return a.of(i) >= -0.5 && a.of(i) <= b.of(i); }};
            }
        }
        const Truth a = truth(depth - 1), b = truth(depth - 1);
        switch (pick(3)) {
            case 0:
                return {"(" + a.text + " and " + b.text + ")", [=](PointIndex i) { return a.of(i) && b.of(i); }};
            case 1:
                return {"(" + a.text + " or " + b.text + ")", [=](PointIndex i) { return a.of(i) || b.of(i); }};
            default:
                return {"not (" + a.text + ")", [=](PointIndex i) { return !a.of(i); }};
        }
    }
};

}  // namespace

class ExpressionTest : public QObject
{
    Q_OBJECT
private slots:
    void conditionsHoldWhereTheyDoInCpp();
    void randomConditionsToo();
    void storedValuesAreComparedExactly();
    void wholeNumbersOf64BitsAreExact();
    void decimalsMeanTheStepsOfScaledAttributes();
    void refusals_data();
    void refusals();
    void rulesSetWhatTheySay();
    void rulesSetBitsAndTypesExactly();
    void rulesKeepToPointsWithin();
    void rulesAddAttributes();
    void rulesRefuseWhatDoesNotFit();
    void cancelChangesNothing();
    void stepSet();
    void nastyTextsEnd();
};

void ExpressionTest::conditionsHoldWhereTheyDoInCpp()
{
    const Made m = makeCloud();
    using Truth = std::function<bool(PointIndex)>;
    const std::vector<std::pair<std::string, Truth>> cases = {
        {"Intensity > 2000", [&](PointIndex i) { return m.intensity[i] > 2000; }},
        {"2000<Intensity", [&](PointIndex i) { return m.intensity[i] > 2000; }},
        {"NormalZ > 0.9 and \"Height above ground\" < 0.2",
         [&](PointIndex i) { return m.normalZ[i] > 0.9 && m.height[i] < 0.2; }},
        {"Classification in (2, 5..7, 9)",
         [&](PointIndex i) {
             const int c = m.classOf(i);
             return c == 2 || (c >= 5 && c <= 7) || c == 9;
         }},
        {"Classification not in 2..6", [&](PointIndex i) { return !(m.classOf(i) >= 2 && m.classOf(i) <= 6); }},
        {"Classification == Ground or Classification == 'low vegetation'",
         [&](PointIndex i) { return m.classOf(i) == 2 || m.classOf(i) == 3; }},
        {"not Withheld AND Intensity <= 100",
         [&](PointIndex i) { return !m.withheld(i) && m.intensity[i] <= 100; }},
        {"Withheld", [&](PointIndex i) { return m.withheld(i); }},
        {"0 < NormalZ <= 0.5", [&](PointIndex i) { return m.normalZ[i] > 0 && m.normalZ[i] <= 0.5; }},
        {"Intensity not between 10 and 3990",
         [&](PointIndex i) { return m.intensity[i] < 10 || m.intensity[i] > 3990; }},
        {"Intensity % 7 == 3", [&](PointIndex i) { return m.intensity[i] % 7 == 3; }},
        {"Intensity // 7 == 3", [&](PointIndex i) { return m.intensity[i] / 7 == 3; }},
        {"-Intensity // 7 == -3", [&](PointIndex i) { return std::floor(-double(m.intensity[i]) / 7) == -3; }},
        {"Intensity / (Classification - 2) > 100",
         [&](PointIndex i) { return m.classOf(i) != 2 && double(m.intensity[i]) / (m.classOf(i) - 2) > 100; }},
        {"2 ** 3 ** 2 == 512 and -2 ** 2 == -4", [](PointIndex) { return true; }},
        {"1 + 2 * 3 == 7 and (1 + 2) * 3 == 9 and 7 - 4 - 3 == 0 and 2 ** -1 == .5",
         [](PointIndex) { return true; }},
        {"round(2.5) == 3 and floor(-0.5) == -1 and ceil(0.2) == 1 and trunc(-1.7) == -1 and sign(-3) == -1",
         [](PointIndex) { return true; }},
        {"max(1, 2, Intensity, 3) == 3", [&](PointIndex i) { return m.intensity[i] <= 3; }},
        {"clamp(Intensity, 100, 200) == 150 or hypot(3, 4) != 5 or degrees(pi) != 180",
         [&](PointIndex i) { return m.intensity[i] == 150; }},
        {"sqrt(abs(NormalZ)) > 0.7 + 1e-3",
         [&](PointIndex i) { return std::sqrt(std::abs(double(m.normalZ[i]))) > 0.7 + 1e-3; }},
        {"exists(Grade)", [&](PointIndex i) { return m.grade[i] != -1; }},
        {"Grade < 2", [&](PointIndex i) { return m.grade[i] != -1 && m.grade[i] < 2; }},
        {"not Grade < 2", [&](PointIndex i) { return m.grade[i] == -1 || m.grade[i] >= 2; }},
        {"Grade in (-4..-1, 3)", [&](PointIndex i) { return m.grade[i] < -1 || m.grade[i] == 3; }},
        {"(Intensity if Withheld else 4000 - Intensity) < 100",
         [&](PointIndex i) { return m.withheld(i) ? m.intensity[i] < 100 : 4000 - m.intensity[i] < 100; }},
        {"Intensity in (Classification, Grade * 10 .. 50)",
         [&](PointIndex i) {
             return m.intensity[i] == m.classOf(i) ||
                    (m.grade[i] != -1 && m.intensity[i] >= m.grade[i] * 10 && m.intensity[i] <= 50);
         }},
    };
    for (const auto& [text, truth] : cases) {
        const PointSet points = found(*m.cloud, text);
        for (PointIndex i = 0; i < kPoints; ++i)
            if (points.contains(i) != truth(i)) QFAIL((text + " at point " + std::to_string(i)).c_str());
    }
}

void ExpressionTest::randomConditionsToo()
{
    const Made m = makeCloud();
    Random random{.m = m};
    for (int k = 0; k < 200; ++k) {
        const Random::Truth truth = random.truth(4);
        const PointSet points = found(*m.cloud, truth.text);
        for (PointIndex i = 0; i < kPoints; i += i < 2000 ? 1 : 97)
            if (points.contains(i) != truth.of(i)) QFAIL((truth.text + " at " + std::to_string(i)).c_str());
    }
}

/// A field of wild values, with one that stands for none, against constants at and beyond the ends of its type.
template <typename T>
void compareStored(const char* name)
{
    using Limits = std::numeric_limits<T>;
    constexpr PointIndex kCount = 2100;  // two whole blocks and a part of one
    const auto cloud = makeFrame(kCount);
    const auto values = addScalar<T>(*cloud, "Value");
    Attribute attribute = *cloud->findAttribute("Value");
    attribute.noData = std::is_floating_point_v<T> ? Value(12.0) : Value(std::int64_t(12));
    cloud->replaceAttribute(attribute);
    for (PointIndex i = 0; i < kCount; ++i) {
        values[i] = T(double(i % 29) - (std::is_signed_v<T> ? 14 : 0));
        if (i % 31 == 0) values[i] = Limits::max();
        if (i % 37 == 0) values[i] = Limits::lowest();
        if constexpr (std::is_floating_point_v<T>)
            if (i % 41 == 0) values[i] = Limits::quiet_NaN();
    }
    using Real = long double;  // 64 bits of mantissa: every value here is exact
    const std::pair<const char*, Real> constants[] = {
        {"12", 12},  // none
        {"13", 13},
        {"2.5", 2.5L},
        {"-3", -3},
        {"255", 255},
        {"127", 127},
        {"-1e30", Real(-1e30)},
        {"1e30", Real(1e30)},
        {"9223372036854775807", Real(std::numeric_limits<std::int64_t>::max())},
        {"1152921504606846976.0", Real(0x1p60)},
        {"18446744073709551615", Real(std::numeric_limits<std::uint64_t>::max())}};
    const std::pair<const char*, bool (*)(Real, Real)> signs[] = {
        {"<", [](Real a, Real b) { return a < b; }},   {"<=", [](Real a, Real b) { return a <= b; }},
        {">", [](Real a, Real b) { return a > b; }},   {">=", [](Real a, Real b) { return a >= b; }},
        {"==", [](Real a, Real b) { return a == b; }}, {"!=", [](Real a, Real b) { return a != b; }}};
    Progress progress;
    for (const auto& [text, constant] : constants)
        for (const auto& [sign, holds] : signs) {
            const std::string condition = std::string("Value ") + sign + " " + text;
            const auto points = select(*cloud, Condition(condition, *cloud), progress);
            for (PointIndex i = 0; i < kCount; ++i) {
                const bool none = values[i] == T(12) || values[i] != values[i];
                // of a float, constants are doubles
                const Real other = std::is_floating_point_v<T> ? Real(double(constant)) : constant;
                const bool expected = none ? std::string(sign) == "!=" : holds(Real(values[i]), other);
                QVERIFY2(points->contains(i) == expected,
                         qPrintable(QStringLiteral("%1: %2, point %3")
                                        .arg(QLatin1String(name), QString::fromStdString(condition))
                                        .arg(i)));
            }
        }
}

void ExpressionTest::storedValuesAreComparedExactly()
{
    compareStored<std::uint8_t>("u8");
    compareStored<std::int8_t>("i8");
    compareStored<std::uint16_t>("u16");
    compareStored<std::int32_t>("i32");
    compareStored<std::uint64_t>("u64");
    compareStored<std::int64_t>("i64");
    compareStored<float>("f32");
    compareStored<double>("f64");
    // beyond any integer, a bound is a bound all the same
    const auto cloud = makeFrame(100);
    const auto ids = addScalar<std::uint64_t>(*cloud, "Id");
    for (PointIndex i = 0; i < 100; ++i) ids[i] = i;
    Progress progress;
    QCOMPARE(select(*cloud, Condition("Id between -1e300 and 49", *cloud), progress)->count(), PointIndex(50));
    QCOMPARE(select(*cloud, Condition("Id between 50 and 1e300", *cloud), progress)->count(), PointIndex(50));
}

void ExpressionTest::wholeNumbersOf64BitsAreExact()
{
    const Made m = makeCloud();
    constexpr std::uint64_t kTop = std::uint64_t(1) << 63;
    const std::string top = std::to_string(kTop + 1), big = std::to_string(kBig);
    using Truth = std::function<bool(PointIndex)>;
    const std::vector<std::pair<std::string, Truth>> cases = {
        {"Id == " + top, [&](PointIndex i) { return m.id[i] == kTop + 1; }},
        {"Id > " + top, [&](PointIndex i) { return m.id[i] > kTop + 1; }},
        {"Id - 1 == " + std::to_string(kTop), [&](PointIndex i) { return m.id[i] == kTop + 1; }},
        {"Id in (" + top + ", 7)", [&](PointIndex i) { return m.id[i] == kTop + 1; }},
        {"Id % 5 == 1", [&](PointIndex i) { return m.id[i] % 5 == 1; }},
        {"Stamp == -" + big, [&](PointIndex i) { return m.stamp[i] == -kBig; }},
        {"Stamp + 3 == " + big + " + 4", [&](PointIndex i) { return m.stamp[i] == kBig + 1; }},
        {"abs(Stamp) == " + big, [&](PointIndex i) { return m.stamp[i] == kBig || m.stamp[i] == -kBig; }},
        {"Stamp < Id", [](PointIndex) { return true; }},
        {"Id > 9223372036854775809.0",  // a double, which is 2^63
         [&](PointIndex i) { return m.id[i] > kTop; }},
        {"Stamp > 0.5", [&](PointIndex i) { return m.stamp[i] > 0; }},
        {"0.5 > Stamp", [&](PointIndex i) { return m.stamp[i] < 0; }},
        {"Stamp between -0.5 and " + big + ".0", [&](PointIndex i) { return m.stamp[i] == kBig; }},
        {"max(Stamp, 0) - " + big + " == 2", [&](PointIndex i) { return m.stamp[i] == kBig + 2; }},
        {"exists(Stamp * Stamp * Stamp * Stamp)", [](PointIndex) { return false; }},
        {"(Stamp if Stamp > 0 else Id) > " + top,
         [&](PointIndex i) { return m.stamp[i] <= 0 && m.id[i] > kTop + 1; }},
        {"exists(Stamp // (Intensity - 5))", [&](PointIndex i) { return m.intensity[i] != 5; }},
    };
    for (const auto& [text, truth] : cases) {
        const PointSet points = found(*m.cloud, text);
        for (PointIndex i = 0; i < kPoints; ++i)
            if (points.contains(i) != truth(i)) QFAIL((text + " at point " + std::to_string(i)).c_str());
    }
}

void ExpressionTest::decimalsMeanTheStepsOfScaledAttributes()
{
    const Made m = makeCloud();  // Z = raw * 0.01 + 100
    for (const int raw : {-2000, -777, 3, 29, 57, 1999}) {
        const std::string decimal = QString::number(100.0 + raw * 0.01, 'f', 2).toStdString();
        const auto check = [&](const std::string& text, auto holds) {
            const PointSet points = found(*m.cloud, text);
            for (PointIndex i = 0; i < kPoints; ++i)
                if (points.contains(i) != holds(m.z[i])) QFAIL((text + " at " + std::to_string(i)).c_str());
        };
        check("Z == " + decimal, [=](int z) { return z == raw; });
        check("Z >= " + decimal, [=](int z) { return z >= raw; });
        check(decimal + " > Z", [=](int z) { return z < raw; });
        check("Z between " + decimal + " and 200", [=](int z) { return z >= raw; });
    }
}

void ExpressionTest::refusals_data()
{
    QTest::addColumn<QString>("text");
    QTest::addColumn<QString>("sentence");
    const auto row = [](const char* text, const char* sentence) { QTest::newRow(text) << text << sentence; };
    row("", "Column 1: an expression is missing.");
    row("Intensity >", "Column 12: a value is missing: the expression ends here.");
    row("Intensty > 3", "Column 1: there is no attribute \"Intensty\"; did you mean Intensity?");
    row("3 < height", "Column 5: there is no attribute \"height\".");
    row("NormalZ > 0.9 and normalz < 2", "Column 19: there is no attribute \"normalz\"; did you mean NormalZ?");
    row("Hight_above_ground > 1",
        "Column 1: there is no attribute \"Hight_above_ground\"; did you mean \"Height above ground\"?");
    row("Intensity = 3", "Column 11: write \"==\" to compare.");
    row("Intensity == 3 && NormalZ > 1", "Column 16: write \"and\" in place of \"&&\".");
    row("Classification == 2 or 3",
        "Column 24: this is a number, where a condition is needed, such as Classification == 2.");
    row("(Intensity > 3", "Column 15: \")\" is missing: the expression ends here.");
    row("Intensity > 3)", "Column 14: there is no bracket that this one closes.");
    row("Intensity 3", "Column 11: a sign such as + or \"and\" is missing before \"3\".");
    row("Intensity > 3x", "Column 14: a number ends here and a name begins; is a sign missing between them?");
    row("Intensity in 5..2", "Column 14: the range begins above its end.");
    row("Intensity between 3", "Column 20: \"and\" is missing behind \"between\": the expression ends here.");
    row("sqr(4) > 3", "Column 1: there is no function \"sqr\"; did you mean sqrt?");
    row("sqrt(4, 5) > 3", "Column 1: sqrt() takes one value.");
    row("(NormalZ > 1) + 2 > 3", "Column 10: this is a condition, where a number is needed.");
    row("Intensity > 99999999999999999999",
        "Column 13: 99999999999999999999 is too large; whole numbers have 64 bits.");
    row("\"Intensity > 3", "Column 1: the quotation mark is not closed.");
    row("\u00e4\u00f6\u00fc > 3 $", "Column 9: \"$\" means nothing here.");
    row("Intensity == Ground",
        "Column 14: \"Ground\" is a class; it can be compared with, and set for, Classification alone.");
    row("Classification == Grund", "Column 19: there is no class and no attribute \"Grund\"; did you mean Ground?");
    row("Intensity > 1 if NormalZ > 1", "Column 29: \"else\" is missing: the expression ends here.");
    row("(1, 2) == 3", "Column 3: a list of values has its place behind \"in\" only.");
    row("Intensity not 3", "Column 15: \"in\" or \"between\" is missing behind \"not\".");
}

void ExpressionTest::refusals()
{
    QFETCH(QString, text);
    QFETCH(QString, sentence);
    const Made m = makeCloud();
    QCOMPARE(QString::fromStdString(complaint([&] { Condition(text.toStdString(), *m.cloud); })), sentence);
}

void ExpressionTest::rulesSetWhatTheySay()
{
    const Made m = makeCloud();
    const auto before = snapshot(*m.cloud);
    const std::vector<std::uint8_t> bytes(m.classes.begin(), m.classes.end());
    Progress progress;
    const Rule rule(
        "Classification = Ground if NormalZ > 0.9 else 5 if Intensity < 1000 else Classification + 1 "
        "if Classification < 31");
    QCOMPARE(rule.target(), std::string("Classification"));
    const auto command = rule.run(*m.cloud, nullptr, progress);
    QVERIFY(command != nullptr);
    QVERIFY(before == snapshot(*m.cloud));
    command->apply(*m.cloud);
    PointIndex changed = 0;
    for (PointIndex i = 0; i < kPoints; ++i) {
        int expected = bytes[i] & 31;
        if (m.normalZ[i] > 0.9)
            expected = 2;
        else if (m.intensity[i] < 1000)
            expected = 5;
        else if (expected < 31)
            ++expected;
        QCOMPARE(int(m.classes[i]), expected | (bytes[i] & 0xE0));
        changed += m.classes[i] != bytes[i] ? 1 : 0;
    }
    QCOMPARE(command->changedPoints(), changed);
    QVERIFY(rule.run(*m.cloud, nullptr, progress) != nullptr);  // classes have moved on
    command->apply(*m.cloud);
    QVERIFY(before == snapshot(*m.cloud));
    QVERIFY(Rule("Intensity = Intensity").run(*m.cloud, nullptr, progress) == nullptr);
}

void ExpressionTest::rulesSetBitsAndTypesExactly()
{
    const Made m = makeCloud();
    Progress progress;
    const auto set = [&](const std::string& text) {
        const auto command = Rule(text).run(*m.cloud, nullptr, progress);
        QVERIFY2(command != nullptr, text.c_str());
        command->apply(*m.cloud);
    };
    const std::vector<std::uint8_t> bytes(m.classes.begin(), m.classes.end());
    set("Withheld = 1 if Intensity > 2000 else 0");
    set("Id = Id + 1 if Id < 9223372036854775810");
    set("Stamp = -Stamp if Stamp > 0");
    set("NormalZ = Intensity / 0 if Intensity == 7 else 0.1");
    set("Grade = 3.5 if Intensity == 8 else Grade / 0 if Intensity == 9");
    for (PointIndex i = 0; i < kPoints; ++i) {
        QCOMPARE(m.withheld(i), m.intensity[i] > 2000);
        QCOMPARE(m.classes[i] & 0x7F, bytes[i] & 0x7F);
        QVERIFY(m.id[i] > std::uint64_t(1) << 63);
        QVERIFY(m.stamp[i] < 0);
        QVERIFY(m.intensity[i] == 7 ? std::isnan(m.normalZ[i]) : m.normalZ[i] == 0.1f);
        if (m.intensity[i] == 8) QCOMPARE(m.grade[i], std::int16_t(4));
        if (m.intensity[i] == 9) QCOMPARE(m.grade[i], std::int16_t(-1));
    }
}

void ExpressionTest::rulesKeepToPointsWithin()
{
    const Made m = makeCloud();
    PointSet within(kPoints);
    for (PointIndex i = 3; i < kPoints; i += 5) within.insert(i);
    Progress progress;
    const std::vector<std::uint16_t> before(m.intensity.begin(), m.intensity.end());
    Rule("Intensity = 7").run(*m.cloud, &within, progress)->apply(*m.cloud);
    for (PointIndex i = 0; i < kPoints; ++i) QCOMPARE(m.intensity[i], i % 5 == 3 ? std::uint16_t(7) : before[i]);
}

void ExpressionTest::rulesAddAttributes()
{
    const Made m = makeCloud();
    Progress progress;
    const auto command = Rule("Level = floor(Intensity / 100) if Intensity >= 500")
                             .add(*m.cloud, ScalarType::I16, nullptr, progress);
    command->apply(*m.cloud);
    const Attribute* const level = m.cloud->findAttribute("Level");
    QVERIFY(level != nullptr);
    for (PointIndex i = 0; i < kPoints; ++i)
        QCOMPARE(level->columns[0]->values<std::int16_t>()[i],
                 std::int16_t(m.intensity[i] >= 500 ? m.intensity[i] / 100 : 0));
    command->apply(*m.cloud);
    QVERIFY(m.cloud->findAttribute("Level") == nullptr);
    // classes above 31: the field of formats 0 to 5 is widened, and comes back
    const auto before = snapshot(*m.cloud);
    const auto wide = Rule("Classification = 64 + Classification % 2").run(*m.cloud, nullptr, progress);
    wide->apply(*m.cloud);
    const Attribute classes = *m.cloud->findAttribute("Classification");
    for (PointIndex i = 0; i < kPoints; ++i) QCOMPARE(int(classes.number(i)), 64 + m.classOf(i) % 2);
    wide->apply(*m.cloud);
    QVERIFY(before == snapshot(*m.cloud));
    const auto refused = [&](const std::string& name) {
        return complaint([&] { Rule("\"" + name + "\" = 1").add(*m.cloud, ScalarType::U8, nullptr, progress); });
    };
    QCOMPARE(refused("Intensity"),
             std::string("There is an attribute \"Intensity\" already; choose another name."));
    QCOMPARE(refused("Red"), std::string("\"Red\" is a name of the standard; choose another one."));
    QVERIFY(refused(std::string(33, 'x')).find("too long") != std::string::npos);
}

void ExpressionTest::rulesRefuseWhatDoesNotFit()
{
    const Made m = makeCloud();
    Progress progress;
    const auto refused = [&](const std::string& text) {
        return complaint([&] { Rule(text).run(*m.cloud, nullptr, progress); });
    };
    m.intensity[3] = 77;
    QVERIFY(refused("Classification = 256 if Intensity == 77")
                .find("Classification holds 0 to 255; the value 256 of") == 0);
    QVERIFY(refused("Intensity = -1").find("Intensity holds 0 to 65535; the value -1 of point 0") == 0);
    QVERIFY(refused("Stamp = Id * 2").find("Stamp holds -9223372036854775808 to 9223372036854775807") == 0);
    QCOMPARE(refused("Z = 3"), std::string("Column 1: coordinates stay as they are; set another attribute."));
    QCOMPARE(refused("Classfication = 3"),
             std::string("Column 1: there is no attribute \"Classfication\"; did you mean Classification?"));
    QCOMPARE(complaint([] { Rule("Classification == 3"); }),
             std::string("Column 16: a rule sets with a single \"=\"."));
    QCOMPARE(
        complaint([] { Rule("2 = 3"); }),
        std::string("Column 1: a rule begins with the name of the attribute it sets, such as Classification = 2."));
    QVERIFY(Rule("Intensity = 70000 if NormalZ > 99").run(*m.cloud, nullptr, progress) == nullptr);
}

void ExpressionTest::cancelChangesNothing()
{
    const Made m = makeCloud();
    Progress progress;
    progress.cancel();
    QVERIFY_THROWS_EXCEPTION(Cancelled, Rule("Intensity = 7").run(*m.cloud, nullptr, progress));
    QVERIFY_THROWS_EXCEPTION(Cancelled, select(*m.cloud, Condition("Intensity > 7", *m.cloud), progress));
}

void ExpressionTest::stepSet()
{
    const Made m = makeCloud();
    Progress progress;
    const ParsedStep step = parseStep("set rule='Classification = 7 if \"Height above ground\" > 10'");
    const auto command = step.step->run(*m.cloud, step.values, progress);
    PointIndex expected = 0;
    for (PointIndex i = 0; i < kPoints; ++i) expected += m.height[i] > 10 && m.classOf(i) != 7 ? 1 : 0;
    QCOMPARE(command->changedPoints(), expected);
    QCOMPARE(complaint([] { parseStep("set rule='Classification = 7 if'"); }),
             std::string("Column 22: a value is missing: the expression ends here."));
    const ParsedStep add = parseStep("set rule='Level = 3' new=uint8");
    QVERIFY(add.step->run(*m.cloud, add.values, progress) != nullptr);
    QVERIFY(complaint([] { parseStep("set rule='Level = 3' new=int7"); }).find("must be one of uint8, int8") !=
            std::string::npos);
}

void ExpressionTest::nastyTextsEnd()
{
    const Made m = makeCloud();
    const auto repeated = [](const std::string& part, int n) {
        std::string all;
        for (int k = 0; k < n; ++k) all += part;
        return all;
    };
    for (const std::string part :
         {"(", "-", "not ", "abs(", "1+", "a<", "2**", "1 if 1>", "\"", "e", "9", "(1,", "\xff"})
        QVERIFY(complaint([&] { Condition(repeated(part, 100'000), *m.cloud); }).size() < 200'000);
    // long, but of use
    const PointSet points = found(*m.cloud, "Intensity" + repeated("+1", 450) + " == 550");
    for (PointIndex i = 0; i < kPoints; ++i) QCOMPARE(points.contains(i), m.intensity[i] == 100);
    std::mt19937_64 random(3);
    const std::string letters = "Intensity 0.1e9+-*/%()<>=!,andornotifelse\"'Z";
    for (int k = 0; k < 20'000; ++k) {
        std::string text;
        for (std::size_t n = random() % 30; n > 0; --n) text += letters[random() % letters.size()];
        complaint([&] { Condition(text, *m.cloud); });
    }
}

QTEST_GUILESS_MAIN(ExpressionTest)
#include "ExpressionTest.moc"
