// SPDX-License-Identifier: MIT
// The text of a value: exact, with the decimals of scale and offset, and read again as the same value.
#include "core/Text.h"
#include "core/cloud/DecimalScale.h"
#include "core/cloud/ValueText.h"
#include "core/expression/Condition.h"
#include "core/las/Reader.h"
#include "core/process/Step.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <cmath>
#include <filesystem>
#include <limits>
#include <random>

using namespace punctum;

namespace
{

std::size_t found(const PointCloud& cloud, const std::string& condition)
{
    Progress progress;
    return select(cloud, expression::Condition(condition, cloud), progress)->count();
}

std::string text(double scale, double offset, std::int32_t raw)
{
    const CoordinateScale grid{glm::dvec3(scale), glm::dvec3(offset)};
    return coordinateText(grid, 0, grid.steps(0)(raw));
}

}  // namespace

class ValueTextTest : public QObject
{
    Q_OBJECT

private slots:
    void decimalsOfScaleAndOffset_data();
    void decimalsOfScaleAndOffset();
    void valuesAreTheDoublesOfTheirDecimals();
    void whatHasNoDecimalsStaysExact();
    void sixtyFourBits();
    void numbers();
    void floats();
    void whatIsShownFindsItsPoints_data();
    void whatIsShownFindsItsPoints();
    void sizes();
    void whatMayGoToATerminal();
    void tables();
    void realFiles_data();
    void realFiles();
};

void ValueTextTest::decimalsOfScaleAndOffset_data()
{
    QTest::addColumn<double>("scale");
    QTest::addColumn<double>("offset");
    QTest::addColumn<int>("raw");
    QTest::addColumn<QString>("expected");
    QTest::newRow("hundredths") << 0.01 << 0.0 << 84914820 << "849148.20";
    QTest::newRow("a quarter") << 0.25 << 0.0 << 3 << "0.75";
    QTest::newRow("two and a half") << 2.5 << 0.0 << 3 << "7.5";
    QTest::newRow("0.00025") << 0.00025 << 0.0 << 12345679 << "3086.41975";
    QTest::newRow("offset finer than the scale") << 1.0 << 0.5 << 7 << "7.5";
    QTest::newRow("offset with noise") << 0.01 << 849148.2000000001 << 1 << "849148.2100000001";
    QTest::newRow("degrees") << 1e-7 << 0.0 << -1234567890 << "-123.4567890";
    QTest::newRow("whole meters") << 1.0 << 5000000.0 << 12 << "5000012";
    QTest::newRow("tens") << 10.0 << 0.0 << 12 << "120";
    QTest::newRow("downward") << -0.001 << 100.0 << 500 << "99.500";
    QTest::newRow("zero of a negative offset") << 0.01 << -0.0 << 0 << "0.00";
    QTest::newRow("nanometers") << 1e-9 << 0.0 << 2147483647 << "2.147483647";
}

void ValueTextTest::decimalsOfScaleAndOffset()
{
    QFETCH(double, scale);
    QFETCH(double, offset);
    QFETCH(int, raw);
    QTEST(QString::fromStdString(text(scale, offset, raw)), "expected");
}

void ValueTextTest::valuesAreTheDoublesOfTheirDecimals()
{
    // against the decimals put together as text, and read
    std::mt19937_64 random(7);
    for (const double scale : {0.01, 0.001, 1e-7, 0.25, 0.00025, 0.0005})
        for (const double offset : {0.0, 500000.0, 4649000.25, -0.005}) {
            const CoordinateScale grid{glm::dvec3(scale), glm::dvec3(offset)};
            const DecimalScale steps = grid.steps(0);
            QVERIFY(steps.decimals() >= 0);
            const auto unit = std::llround(std::pow(10.0, steps.decimals()));
            for (int n = 0; n < 1000; ++n) {
                const auto raw = std::int32_t(random());
                const long long whole =
                    std::llround(scale * double(unit)) * raw + std::llround(offset * double(unit));
                const std::string digits = std::to_string(whole < 0 ? -whole : whole);
                const double meant =
                    std::stod((whole < 0 ? "-" : "") + digits + "e-" + std::to_string(steps.decimals()));
                QCOMPARE(steps(raw), meant);
                QCOMPARE(steps.raw(meant), double(raw));
                QCOMPARE(std::stod(coordinateText(grid, 0, meant)), meant);
            }
        }
}

void ValueTextTest::whatHasNoDecimalsStaysExact()
{
    // a third, and a hundredth that passed through a float: written with the digits of the double
    for (const double scale : {1.0 / 3.0, double(0.01f)}) {
        const CoordinateScale grid{glm::dvec3(scale), glm::dvec3(1e6)};
        QCOMPARE(grid.steps(0).decimals(), -1);
        for (const int raw : {1, 7, 123456789, -5}) {
            const double value = grid.steps(0)(raw);
            QCOMPARE(value, raw * scale + 1e6);
            QCOMPARE(std::stod(coordinateText(grid, 0, value)), value);
            QCOMPARE(grid.steps(0).raw(value), double(raw));
        }
    }
    for (const double odd : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
        QCOMPARE(DecimalScale(odd, 0.0).decimals(), -1);
    QCOMPARE(DecimalScale(0.01, 1e300).decimals(), -1);
}

void ValueTextTest::sixtyFourBits()
{
    const DecimalScale cents(0.01, 0.0);
    QCOMPARE(cents(std::int64_t(84914820)), 849148.2);
    // beyond 2^53: the nearest there is
    QCOMPARE(cents(std::int64_t(1) << 60), double(std::int64_t(1) << 60) * 0.01);
    QCOMPARE(cents(std::numeric_limits<std::uint64_t>::max()), 0x1p64 * 0.01);
}

void ValueTextTest::numbers()
{
    QVERIFY(shortestText(849148.2) == "849148.2");
    QVERIFY(shortestText(100000.0) == "100000");
    QVERIFY(shortestText(1e15) == "1e+15");
    QVERIFY(shortestText(0.000001) == "0.000001");
    QVERIFY(shortestText(1e-9) == "1e-09");
    QVERIFY(shortestText(-0.0) == "-0");
    QVERIFY(shortestText(-std::numeric_limits<double>::quiet_NaN()) == "nan");
    QVERIFY(shortestText(-std::numeric_limits<double>::infinity()) == "-inf");
    QVERIFY(decimalText(2.0 / 3.0, 3) == "0.667");
    QVERIFY(roundedText(470.28000000000003, 5) == "470.28");
    QVERIFY(roundedText(-0.0000001, 3) == "0");
    QVERIFY(roundedText(1200.0, 0) == "1200");
    // no rows of zeros, nor digits that mean nothing
    QVERIFY(roundedText(1.25e302, 9) == "1.25e+302" && roundedText(5.1294e-17, 20) == "5.129e-17");
    QVERIFY(roundedText(-2.25e-7, 9) == "-2.25e-07" && roundedText(1e-12, 9) == "0");
    QVERIFY(text(1.0 / 127, 0.0, -126) == "-0.9921259842519685" && text(1.0 / 3, 0.0, 99) == "33");
    QVERIFY(decimalText(1e300, 1000).size() < 400);
}

void ValueTextTest::floats()
{
    const auto cloud = makeFrame(3);
    const auto values = addScalar<float>(*cloud, "Amplitude");
    values[0] = 0.1f;
    values[1] = 16777216.0f;
    values[2] = std::numeric_limits<float>::max();
    const Attribute& a = *cloud->findAttribute("Amplitude");
    QVERIFY(valueText(a, a.value(0)) == "0.1");
    QVERIFY(valueText(a, a.value(1)) == "16777216");
    QCOMPARE(writtenValue(a, double(0.1f)), 0.1);
    QCOMPARE(typedValue(a, 0.1), double(0.1f));
    QCOMPARE(typedValue(a, 0.1000001), double(0.1000001f));  // its own float
    QCOMPARE(typedValue(a, 0.10000000001), 0.10000000001);   // no float is written so
    QCOMPARE(found(*cloud, "Amplitude == 0.1"), std::size_t(1));
    QCOMPARE(found(*cloud, "Amplitude <= 0.1"), std::size_t(1));
    QCOMPARE(found(*cloud, "0.1 < Amplitude"), std::size_t(2));
    QCOMPARE(found(*cloud, "Amplitude in 0.1..0.1"), std::size_t(1));
    QCOMPARE(found(*cloud, "Amplitude == " + valueText(a, a.value(2))), std::size_t(1));
}

void ValueTextTest::whatIsShownFindsItsPoints_data()
{
    QTest::addColumn<double>("scale");
    QTest::addColumn<double>("offset");
    for (const double scale : {0.01, 0.25, 2.5, 0.00025, 1e-7, 1e-9, 1.0 / 3.0, double(0.01f), -0.001})
        for (const double offset : {0.0, 849148.2, 849148.2000000001, 0.005})
            QTest::addRow("%g and %.17g", scale, offset) << scale << offset;
}

void ValueTextTest::whatIsShownFindsItsPoints()
{
    QFETCH(double, scale);
    QFETCH(double, offset);
    const auto cloud = makeFrame(500, {glm::dvec3(scale), glm::dvec3(offset)});
    auto x = cloud->columns()[0]->values<std::int32_t>();
    std::mt19937 random(11);
    for (std::size_t k = 0; k < x.size(); ++k) x[k] = std::int32_t(random());
    const Attribute& a = *cloud->findAttribute("X");
    for (PointIndex i = 0; i < x.size(); i += 50) {
        const std::string shown = valueText(a, a.value(i));
        QCOMPARE(std::stod(shown), cloud->world(i).x);
        for (const std::string& condition : {"X == " + shown, "X in " + shown + ".." + shown, "X + 0 == " + shown,
                                             "X >= " + shown + " and X <= " + shown})
            QVERIFY2(found(*cloud, condition) == 1, condition.c_str());
    }
}

void ValueTextTest::sizes()
{
    QVERIFY(sizeText(1) == "1 byte" && sizeText(999) == "999 bytes");
    QVERIFY(sizeText(1001) == "2 kB" && sizeText(602'001) == "603 kB");  // never too little
    QVERIFY(sizeText(2'000'001) == "2.1 MB" && sizeText(2'100'000'000) == "2.1 GB" &&
            sizeText(64'000'000'000) == "64 GB");
    QVERIFY(sizeText(UINT64_MAX) == "19 EB");
}

void ValueTextTest::whatMayGoToATerminal()
{
    QVERIFY(printable("Höhe 高さ") == "Höhe 高さ");
    QVERIFY(printable("\x1b[31mred\x07\x7f\n") == "?[31mred???");
    QVERIFY(printable("two\nlines\r", true) == "two\nlines?");
    QVERIFY(printable("\xff\xc3 \xc2\x9b m \xe2\x80\xae") == "?? ? m ?");  // no UTF-8, CSI as one character, turned
    QCOMPARE(displayWidth("Höhe"), std::size_t(4));
    QCOMPARE(displayWidth("高さ"), std::size_t(4));
    QCOMPARE(displayWidth("e\u0301"), std::size_t(1));  // an accent on the e
    QVERIFY(cutToWidth("高さ高さ高さ", 8) == "高さ...");
    QVERIFY(cutToWidth("short", 8) == "short");
}

void ValueTextTest::tables()
{
    const std::string table = textTable({{"Höhe", "1"}, {"高さ", "22"}, {"a\tb", "333"}}, {{false, true}});
    QVERIFY2(table == "  Höhe    1\n  高さ   22\n  a?b   333\n", table.c_str());
    QVERIFY(textTable({{"a", ""}, {"bb", "c"}}, {{}, 0, 1}) == "a\nbb  c\n");
}

void ValueTextTest::realFiles_data()
{
    QTest::addColumn<QString>("file");
    for (const char* const file : {"cases/scale-quarter.las", "cases/scale-00025.las", "more/lidr-topography.laz",
                                   "cases/gps-within-a-second.las", "autzen_trim.las", "epsg_4326.las"})
        QTest::newRow(file) << QString(file);
}

void ValueTextTest::realFiles()
{
    QFETCH(QString, file);
    const std::string path = std::string(PUNCTUM_TEST_DATA) + "/" + file.toStdString();
    if (!std::filesystem::exists(path)) QSKIP("the file is not here");
    Progress progress;
    const auto cloud = las::load(path, progress);
    for (const Attribute& a : cloud->attributes()) {
        if (a.components != 1 || a.kind == AttributeKind::Opaque) continue;
        const PointIndex last = cloud->size() - 1;
        const std::string shown = valueText(a, a.value(last));
        const std::string condition = "\"" + a.name + "\" == " + shown;
        QVERIFY2(found(*cloud, condition) >= 1, condition.c_str());
    }
}

QTEST_APPLESS_MAIN(ValueTextTest)
#include "ValueTextTest.moc"
