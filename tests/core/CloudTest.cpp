// SPDX-License-Identifier: MIT
// Attributes as views on raw columns, statistics, point sets, bounds and notices: exact, whatever the type.
#include "core/Error.h"
#include "core/cloud/DistinctValues.h"
#include "core/cloud/PointCloud.h"
#include "core/cloud/PointSet.h"
#include "core/task/Progress.h"
#include "tests/core/MadeCloud.h"

#include <QTest>

#include <cmath>
#include <fstream>
#include <functional>
#include <limits>
#include <utility>
#include <vector>

using namespace punctum;

namespace
{

AttributeStatistics statistics(const Attribute& attribute, std::uint32_t component = 0)
{
    Progress progress;
    return computeStatistics(attribute, component, progress);
}

/// A cloud of one attribute with these values.
template <typename T>
std::shared_ptr<PointCloud> holding(const std::vector<T>& values,
                                    const std::function<void(Attribute&)>& change = {})
{
    auto cloud = makeFrame(values.size());
    Attribute a;
    a.name = "A";
    a.columns[0] = cloud->addColumn(std::make_shared<Column>("A", scalarTypeOf<T>(), values.size()));
    std::copy(values.begin(), values.end(), a.columns[0]->template values<T>().begin());
    if (change) change(a);
    cloud->addAttribute(a);
    return cloud;
}

const Attribute& theAttribute(const std::shared_ptr<PointCloud>& cloud)
{
    return *cloud->findAttribute("A");
}

}  // namespace

class CloudTest : public QObject
{
    Q_OBJECT

private slots:
    void everyTypeIsReadExactly();
    void wideIntegersStayExact();
    void bitFieldsAreCutOut();
    void scaledValues();
    void noDataIsNoNumber();
    void gatherKeepsDigitsByBias();
    void gatherBitsOfManyTypes();
    void statisticsOfSpecialFloats();
    void statisticsOfBitFields();
    void statisticsOfManyPoints();
    void statisticsOfNegativeScale();
    void statisticsOfNothing();
    void statisticsCancel();
    void valuesAreCounted();
    void distinctValuesAreListed();
    void textTellsNumbersApart();
    void pointSets();
    void setsOfNoneAndAll();
    void setsTakeMemoryWhereTheyDiffer();
    void boundsComeFromThePoints();
    void boundsJoin();
    void worldAndBack();
    void attributesAndColumnsGoTogether();
    void compositesNeedEqualParts();
    void noticesReachSubscribers();
    void noticesConcernComposites();
    void buffers();
};

void CloudTest::everyTypeIsReadExactly()
{
    const auto check = [](auto zero) {
        using T = decltype(zero);
        const std::vector<T> values = {T(0), T(1), T(100), std::numeric_limits<T>::max(),
                                       std::numeric_limits<T>::lowest()};
        const auto cloud = holding(values);
        const Attribute& a = theAttribute(cloud);
        QVERIFY(a.type() == scalarTypeOf<T>());
        QCOMPARE(a.integral(), std::is_integral_v<T>);
        for (std::size_t i = 0; i < values.size(); ++i) {
            std::visit([&](auto v) { QVERIFY(T(v) == values[i]); }, a.value(i));
            QCOMPARE(a.number(i), double(values[i]));
        }
        std::vector<double> out(3);
        a.read({1, 4}, out.data());
        for (std::size_t i = 0; i < 3; ++i) QCOMPARE(out[i], double(values[i + 1]));
        const auto s = statistics(a);
        std::visit([&](auto v) { QVERIFY(T(v) == std::numeric_limits<T>::lowest()); }, s.min);
        std::visit([&](auto v) { QVERIFY(T(v) == std::numeric_limits<T>::max()); }, s.max);
        QCOMPARE(s.count, std::uint64_t(5));
    };
    for (int type = 0; type <= int(ScalarType::F64); ++type) visitScalar(ScalarType(type), check);
}

void CloudTest::wideIntegersStayExact()
{
    // neighbors that are one and the same as doubles
    const std::uint64_t u = 18446744073709551614u;
    const auto unsignedCloud = holding<std::uint64_t>({u, u + 1, u});
    auto s = statistics(theAttribute(unsignedCloud));
    QVERIFY(std::get<std::uint64_t>(s.min) == u && std::get<std::uint64_t>(s.max) == u + 1);
    QVERIFY(toText(s.max) == "18446744073709551615");
    const std::int64_t i = 9007199254740993;
    const auto signedCloud = holding<std::int64_t>({i, i - 1, -i});
    s = statistics(theAttribute(signedCloud));
    QVERIFY(std::get<std::int64_t>(s.min) == -i && std::get<std::int64_t>(s.max) == i);
    QVERIFY(std::get<std::int64_t>(theAttribute(signedCloud).value(0)) == i);
    QVERIFY(toText(s.max) == "9007199254740993");
    QCOMPARE(theAttribute(unsignedCloud).maxBits(), ~std::uint64_t(0));
}

void CloudTest::bitFieldsAreCutOut()
{
    std::vector<std::uint8_t> bytes(256);
    for (std::size_t i = 0; i < 256; ++i) bytes[i] = std::uint8_t(i);
    for (std::uint8_t shift = 0; shift < 8; ++shift)
        for (std::uint8_t width = 1; width + shift <= 8; ++width) {
            const auto cloud = holding(bytes, [&](Attribute& a) {
                a.bitShift = shift;
                a.bitWidth = width;
            });
            const Attribute& a = theAttribute(cloud);
            QCOMPARE(a.maxBits(), (std::uint64_t(1) << width) - 1);
            for (PointIndex i = 0; i < 256; ++i) {
                const std::uint64_t expected = (i >> shift) & ((1u << width) - 1);
                QVERIFY(std::get<std::uint64_t>(a.value(i)) == expected);
                QCOMPARE(a.number(i), double(expected));
            }
        }
}

void CloudTest::scaledValues()
{
    const auto cloud = holding<std::int32_t>({-100, 0, 41050}, [](Attribute& a) {
        a.scaled = true;
        a.scale = 0.01;
        a.offset = 1e6;
    });
    const Attribute& a = theAttribute(cloud);
    QVERIFY(!a.integral());
    QCOMPARE(a.number(0), -100 * 0.01 + 1e6);
    QCOMPARE(std::get<double>(a.value(2)), 41050 * 0.01 + 1e6);
    const auto s = statistics(a);
    QCOMPARE(toDouble(s.min), 999999.0);
    QCOMPARE(toDouble(s.max), 1000410.5);
    QVERIFY(std::abs(s.mean - (1e6 + (41050 - 100) * 0.01 / 3)) < 1e-6);
}

void CloudTest::noDataIsNoNumber()
{
    const auto cloud = holding<std::uint16_t>({5, 65535, 7}, [](Attribute& a) { a.noData = std::uint64_t(65535); });
    const Attribute& a = theAttribute(cloud);
    QCOMPARE(a.number(0), 5.0);
    QVERIFY(std::isnan(a.number(1)));
    double out[3];
    a.read({0, 3}, out);
    QVERIFY(std::isnan(out[1]) && out[2] == 7.0);
    const auto s = statistics(a);
    QCOMPARE(s.count, std::uint64_t(2));
    QCOMPARE(toDouble(s.max), 7.0);
    QCOMPARE(s.mean, 6.0);
    // no-data is of the raw value, before scaling
    const auto scaled = holding<std::int32_t>({-1, 10}, [](Attribute& b) {
        b.noData = std::int64_t(-1);
        b.scaled = true;
        b.scale = 0.5;
    });
    QVERIFY(std::isnan(theAttribute(scaled).number(0)));
    QCOMPARE(theAttribute(scaled).number(1), 5.0);
    // NaN as the mark of no-data
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const auto marked = holding<double>({1.0, nan}, [&](Attribute& b) { b.noData = nan; });
    QCOMPARE(statistics(theAttribute(marked)).count, std::uint64_t(1));
}

void CloudTest::gatherKeepsDigitsByBias()
{
    // GPS times a microsecond apart: lost in a float, kept when a bias is taken off first
    std::vector<double> times(1000);
    for (std::size_t i = 0; i < times.size(); ++i) times[i] = 417312000.0 + double(i) * 1e-6;
    const auto cloud = holding(times);
    const std::uint32_t indices[] = {999, 0, 1, 500};
    float out[4];
    theAttribute(cloud).gather(indices, 417312000.0, out);
    for (int k = 0; k < 4; ++k) QVERIFY(std::abs(double(out[k]) - double(indices[k]) * 1e-6) < 1e-7);
    // and of another component
    for (const char* name : {"Red", "Green", "Blue"}) addScalar<std::uint16_t>(*cloud, name);
    addComposite(*cloud, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    cloud->findAttribute("Blue")->columns[0]->values<std::uint16_t>()[500] = 60000;
    cloud->findAttribute("RGB")->gather(indices, 0.0, out, 2);
    QCOMPARE(out[3], 60000.0f);
    QCOMPARE(out[0], 0.0f);
}

void CloudTest::gatherBitsOfManyTypes()
{
    const std::uint32_t indices[] = {2, 0};
    std::uint32_t out[2];
    theAttribute(holding<std::int8_t>({-1, 0, 5})).gatherBits(indices, out);
    QCOMPARE(out[0], 5u);
    QCOMPARE(out[1], 0xFFFFFFFFu);
    theAttribute(holding<std::uint64_t>({0x1122334455667788u, 0, 1})).gatherBits(indices, out);
    QCOMPARE(out[1], 0x55667788u);
    theAttribute(holding<float>({1.0f, 2.0f, 3.0f})).gatherBits(indices, out);  // has no bits to show
    QCOMPARE(out[0], 0u);
    theAttribute(holding<std::uint8_t>({0xF3, 0, 0x52}, [](Attribute& a) {
        a.bitShift = 4;
        a.bitWidth = 3;
    })).gatherBits(indices, out);
    QCOMPARE(out[0], 5u);
    QCOMPARE(out[1], 7u);

    std::uint8_t bytes[2];
    theAttribute(holding<std::uint16_t>({0x1234, 0xABCD, 0x00FF})).gatherBits({1, 3}, bytes);
    QCOMPARE(unsigned(bytes[0]), 0xCDu);
    QCOMPARE(unsigned(bytes[1]), 0xFFu);
    theAttribute(holding<std::uint8_t>({0xF3, 0, 0x52}, [](Attribute& a) {
        a.bitShift = 4;
        a.bitWidth = 3;
    })).gatherBits({0, 2}, bytes);
    QCOMPARE(unsigned(bytes[0]), 7u);
    QCOMPARE(unsigned(bytes[1]), 0u);
}

void CloudTest::statisticsOfSpecialFloats()
{
    const float nan = std::numeric_limits<float>::quiet_NaN();
    const auto s = statistics(theAttribute(holding<float>({nan, -2.5f, nan, 4.0f, -0.0f})));
    QCOMPARE(s.count, std::uint64_t(3));
    QCOMPARE(toDouble(s.min), -2.5);
    QCOMPARE(toDouble(s.max), 4.0);
    QCOMPARE(s.mean, 0.5);
    QCOMPARE(statistics(theAttribute(holding<float>({nan, nan}))).count, std::uint64_t(0));
}

void CloudTest::statisticsOfBitFields()
{
    const auto cloud = makeFrame(1000, {}, true);
    auto bytes = cloud->columns()[3]->values<std::uint8_t>();
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(0x80 | (3 + i % 5));
    const auto s = statistics(*cloud->findAttribute("Classification"));
    QVERIFY(std::get<std::uint64_t>(s.min) == 3 && std::get<std::uint64_t>(s.max) == 7);
    QCOMPARE(s.mean, 5.0);
}

void CloudTest::statisticsOfManyPoints()
{
    std::vector<std::int32_t> values(1'000'003);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::int32_t(i * 7919 % 1000003) - 500001;
    const auto s = statistics(theAttribute(holding(values)));
    QCOMPARE(toDouble(s.min), -500001.0);
    QCOMPARE(toDouble(s.max), 500001.0);
    QCOMPARE(s.mean, 0.0);
    QCOMPARE(s.count, std::uint64_t(values.size()));

    PointSet leftOut(values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        if (values[i] < -1000 || values[i] > 2000) leftOut.insert(i);
    Progress progress;
    const auto rest = computeStatistics(theAttribute(holding(values)), 0, progress, &leftOut);
    QCOMPARE(toDouble(rest.min), -1000.0);
    QCOMPARE(toDouble(rest.max), 2000.0);
    QCOMPARE(rest.mean, 500.0);
    QCOMPARE(rest.count, std::uint64_t(3001));
}

void CloudTest::statisticsOfNegativeScale()
{
    const auto s = statistics(theAttribute(holding<std::int16_t>({1, 2, 3}, [](Attribute& a) {
        a.scaled = true;
        a.scale = -2.0;
        a.offset = 1.0;
    })));
    QCOMPARE(toDouble(s.min), -5.0);
    QCOMPARE(toDouble(s.max), -1.0);
    QCOMPARE(s.mean, -3.0);
}

void CloudTest::statisticsOfNothing()
{
    const auto cloud = makeFrame(0);
    const auto s = statistics(*cloud->findAttribute("Classification"));
    QCOMPARE(s.count, std::uint64_t(0));
    QCOMPARE(toDouble(s.min), 0.0);
    QCOMPARE(toDouble(s.max), 0.0);
    QCOMPARE(s.mean, 0.0);
    const auto z = statistics(*makeFrame(0, {glm::dvec3(0.01), glm::dvec3(500.0)})->findAttribute("Z"));
    QCOMPARE(z.count, std::uint64_t(0));
    QCOMPARE(z.mean, 0.0);
    QCOMPARE(toDouble(z.min), 0.0);
}

void CloudTest::statisticsCancel()
{
    const auto cloud = makeFrame(1'000'000);
    Progress progress;
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(computeStatistics(*cloud->findAttribute("X"), 0, progress), Cancelled);
    QVERIFY_EXCEPTION_THROWN(countValues(*cloud->findAttribute("Classification"), progress), Cancelled);
}

void CloudTest::valuesAreCounted()
{
    const auto cloud = makeFrame(300'000, {}, true);
    auto bytes = cloud->columns()[3]->values<std::uint8_t>();
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = std::uint8_t(i % 3 == 0 ? 0xE2 : 6);
    Progress progress;
    auto counts = countValues(*cloud->findAttribute("Classification"), progress);
    QCOMPARE(counts[2], std::uint64_t(100'000));
    QCOMPARE(counts[6], std::uint64_t(200'000));
    counts = countValues(theAttribute(holding<std::uint16_t>({0, 254, 255, 256, 65535})), progress);
    QCOMPARE(counts[255], std::uint64_t(3));
    QCOMPARE(counts[254], std::uint64_t(1));
}

void CloudTest::distinctValuesAreListed()
{
    Progress progress;
    const auto cloud = holding<std::int16_t>({7, -3, 7, 7, 300, -3});
    DistinctValues found = distinctValues(theAttribute(cloud), 3, progress);
    QVERIFY(!found.tooMany);
    QCOMPARE(found.values.size(), std::size_t(3));
    const std::pair<std::int64_t, std::uint64_t> expected[] = {{-3, 2}, {7, 3}, {300, 1}};
    for (std::size_t k = 0; k < 3; ++k) {
        QVERIFY(std::get<std::int64_t>(found.values[k].value) == expected[k].first);
        QCOMPARE(found.values[k].points, expected[k].second);
        std::uint32_t bits = 0;
        const std::uint32_t index = k == 0 ? 1 : k == 1 ? 0 : 4;
        theAttribute(cloud).gatherBits(std::span(&index, 1), &bits);
        QCOMPARE(found.values[k].bits, bits);
    }
    found = distinctValues(theAttribute(cloud), 2, progress);
    QVERIFY(found.tooMany && found.values.empty());
    PointSet without(6);
    without.insert(4);
    found = distinctValues(theAttribute(cloud), 2, progress, &without);
    QVERIFY(!found.tooMany);
    QCOMPARE(found.values.size(), std::size_t(2));

    // Many points, in all threads; what is left out is not counted.
    std::vector<std::uint32_t> many(1'000'000);
    for (std::size_t i = 0; i < many.size(); ++i) many[i] = 4'000'000'000u + std::uint32_t(i * 7 % 5);
    const auto large = holding(many);
    found = distinctValues(theAttribute(large), 5, progress);
    QCOMPARE(found.values.size(), std::size_t(5));
    for (const DistinctValue& v : found.values) QCOMPARE(v.points, std::uint64_t(200'000));
    progress.cancel();
    QVERIFY_EXCEPTION_THROWN(distinctValues(theAttribute(large), 5, progress), Cancelled);
}

void CloudTest::textTellsNumbersApart()
{
    QVERIFY(toText(Value(0.1)) == "0.1");
    QVERIFY(toText(Value(0.1 + 0.2)) == "0.30000000000000004");
    QVERIFY(toText(Value(std::int64_t(INT64_MIN))) == "-9223372036854775808");
    QVERIFY(toText(Value(std::uint64_t(UINT64_MAX))) == "18446744073709551615");
    QVERIFY(std::stod(toText(Value(-1.2345678901234567e-300))) == -1.2345678901234567e-300);
}

void CloudTest::pointSets()
{
    PointSet set(200);
    QVERIFY(set.count() == 0 && set.extent().empty());
    for (const PointIndex i : {0, 63, 64, 130, 199}) set.insert(i);
    QVERIFY(set.contains(63) && set.contains(64) && !set.contains(65));
    QCOMPARE(set.count(), PointIndex(5));
    QVERIFY((set.extent() == PointRange{0, 200}));
    std::vector<PointIndex> seen;
    set.forEach([&](PointIndex i) { seen.push_back(i); });
    QVERIFY((seen == std::vector<PointIndex>{0, 63, 64, 130, 199}));
    seen.clear();
    set.forEachInWords(1, 2, [&](PointIndex i) { seen.push_back(i); });
    QVERIFY((seen == std::vector<PointIndex>{64}));
    set.remove(0);
    set.remove(199);
    QVERIFY((set.extent() == PointRange{63, 131}));
    PointSet same(200);
    for (const PointIndex i : {63, 64, 130}) same.insert(i);
    QVERIFY(set == same);
    set.clear();
    QVERIFY(set.count() == 0 && !(set == same));
    QVERIFY(PointSet(0).extent().empty());
}

/// Of this program, in memory at present, bytes; 0 where the system does not say.
static std::size_t residentBytes()
{
    std::ifstream in("/proc/self/statm");
    std::size_t all = 0, resident = 0;
    in >> all >> resident;
    return resident * 4096;
}

// Sets of none and of all, by every operation on both, equal those made point by point.
void CloudTest::setsOfNoneAndAll()
{
    for (const PointIndex size : {0, 1, 63, 64, 65, 1000, 600'000, 20'000'003}) {
        const auto few = [size] {
            PointSet set(size);
            for (PointIndex i = 0; i < size; i += 1 + size / 7) set.insert(i);
            return set;
        };
        PointSet everyone(size);
        everyone.insert(PointRange{0, size});
        const PointSet none(size), all = PointSet::all(size), some = few();
        PointSet others = some;
        others.invert();
        QVERIFY(none.surelyNone() && (size == 0 || all.surelyAll()) && (size == 0 || !some.surelyNone()));
        QVERIFY(all == everyone && everyone == all && none == PointSet(size) && (size == 0 || !(all == none)));
        QVERIFY(none.count() == 0 && all.count() == size && everyone.count() == size);
        QCOMPARE(some.count() + others.count(), size);
        QVERIFY(none.extent().empty() && all.extent() == everyone.extent());
        QVERIFY(none.ranks(100).back() == 0 && all.ranks(100) == everyone.ranks(100));
        PointIndex seen = 0;
        none.forEach([&](PointIndex) { ++seen; });
        QCOMPARE(seen, PointIndex(0));
        all.forEach([&](PointIndex) { ++seen; });
        QCOMPARE(seen, size);
        const auto both = [](PointSet a, const PointSet& b, auto what) {
            what(a, b);
            return a;
        };
        const auto add = [](PointSet& a, const PointSet& b) { a.insert(b); };
        const auto take = [](PointSet& a, const PointSet& b) { a.remove(b); };
        const auto cut = [](PointSet& a, const PointSet& b) { a.intersect(b); };
        for (const PointSet* const full : std::initializer_list<const PointSet*>{&all, &everyone}) {
            QVERIFY(both(*full, some, add) == all && both(some, *full, add) == all);
            QVERIFY(both(*full, some, take) == others && both(some, *full, take) == none);
            QVERIFY(both(*full, some, cut) == some && both(some, *full, cut) == some);
            QVERIFY(both(*full, none, add) == all && both(none, *full, add) == all);
            QVERIFY(both(*full, none, take) == all && both(none, *full, take) == none);
            QVERIFY(both(*full, none, cut) == none && both(none, *full, cut) == none);
            PointSet turned = *full;
            turned.invert();
            QVERIFY(turned == none);
            turned.invert();
            QVERIFY(turned == all);
        }
        QVERIFY(both(none, some, add) == some && both(some, none, take) == some && both(some, none, cut) == none);
        // What was full or empty is so no longer once somebody writes, by whatever way; others stay as they are.
        if (size == 0) continue;
        PointSet one = all;
        one.remove(size - 1);
        QVERIFY(one.count() == size - 1 && all.count() == size && !one.contains(size - 1));
        PointSet last(size);
        last.words().back() |= std::uint64_t(1) << ((size - 1) % 64);
        QVERIFY(last.count() == 1 && last.contains(size - 1) && (last.extent() == PointRange{size - 1, size}));
        PointSet moved = std::move(last);
        QVERIFY(moved.count() == 1);
        last = PointSet::all(size);
        QVERIFY(last == all);
        moved.clear();
        QVERIFY(moved == none && moved.surelyNone());
    }
}

// 64 sets over a billion points, none of them and all of them, would take 8 GB as words; so would copies of a set
// with a point here and there.
void CloudTest::setsTakeMemoryWhereTheyDiffer()
{
    const std::size_t before = residentBytes();
    if (before == 0) QSKIP("The system does not tell the memory of a program.");
    constexpr PointIndex kSize = 1'000'000'007;
    std::vector<PointSet> sets;
    for (int k = 0; k < 32; ++k) {
        sets.push_back(PointSet(kSize));
        sets.push_back(PointSet::all(kSize));
    }
    PointSet sparse(kSize);
    for (PointIndex i = 0; i < 100; ++i) sparse.insert(i * 10'000'000 + 5);
    for (int k = 0; k < 3; ++k) sets.push_back(sparse);
    std::size_t grown = residentBytes() - std::min(before, residentBytes());
    QVERIFY2(grown < std::size_t(24) << 20, qPrintable(QString::number(grown)));
    QCOMPARE(sets.back().count(), PointIndex(100));
    QVERIFY(sets[1].count() == kSize && sets[0].count() == 0 && sets[1].contains(kSize - 1));
    sets[1].remove(777'777'777);
    QCOMPARE(sets[1].count(), kSize - 1);
    QVERIFY(sets[3].contains(777'777'777) && sets[3].count() == kSize);
}

void CloudTest::boundsComeFromThePoints()
{
    QVERIFY(makeFrame(0)->computeBounds().empty());
    const auto cloud = makeFrame(200'000);
    rawAxis(*cloud, 0)[777] = INT32_MIN;
    rawAxis(*cloud, 1)[199'999] = INT32_MAX;
    rawAxis(*cloud, 2)[0] = -5;
    const RawBounds bounds = cloud->computeBounds();
    QVERIFY((bounds == RawBounds{{INT32_MIN, 0, -5}, {0, INT32_MAX, 0}}));
}

void CloudTest::boundsJoin()
{
    WorldBounds all;
    QVERIFY(all.empty());
    all.include(WorldBounds{});
    QVERIFY(all.empty());
    all.include(WorldBounds{glm::dvec3(-5.0), glm::dvec3(-2.0)});
    QVERIFY(all.min == glm::dvec3(-5.0) && all.max == glm::dvec3(-2.0));  // below zero, too
    all.include(WorldBounds{glm::dvec3(1.0), glm::dvec3(3.0)});
    all.include(WorldBounds{});
    QVERIFY(all.min == glm::dvec3(-5.0) && all.max == glm::dvec3(3.0));
}

void CloudTest::worldAndBack()
{
    // large coordinates, and a scale that no binary fraction is
    const CoordinateScale scale{glm::dvec3(0.001), glm::dvec3(1e7, -1e7, 0.0)};
    for (const double raw : {-2147483648.0, -1.0, 0.0, 1.0, 123456789.0, 2147483647.0}) {
        const glm::dvec3 back = scale.toRaw(scale.toWorld(glm::dvec3(raw)));
        for (int axis = 0; axis < 3; ++axis) QCOMPARE(std::round(back[axis]), raw);
    }
    const CoordinateScale mirrored{glm::dvec3(1.0, -1.0, 1.0), glm::dvec3(0.0)};
    RawBounds raw;
    raw.include(1, 2, 3);
    raw.include(4, 5, 6);
    const WorldBounds world = mirrored.toWorld(raw);
    QVERIFY(world.min == glm::dvec3(1, -5, 3) && world.max == glm::dvec3(4, -2, 6));
    QVERIFY(mirrored.toWorld(RawBounds{}).empty());
}

void CloudTest::attributesAndColumnsGoTogether()
{
    const auto cloud = makeFrame(10, {}, true);
    QVERIFY(cloud->findAttribute("Classification") != nullptr && cloud->findAttribute("classification") == nullptr);
    cloud->removeAttribute("Synthetic");  // its byte is still shown by others
    QCOMPARE(cloud->columns().size(), std::size_t(4));
    cloud->removeAttribute("Withheld");
    cloud->removeAttribute("Classification");
    QCOMPARE(cloud->columns().size(), std::size_t(3));
    cloud->removeAttribute("nothing of that name");
    QCOMPARE(cloud->attributes().size(), std::size_t(3));
    const Attribute kept = *cloud->findAttribute("X");  // a copy keeps its column alive
    cloud->removeAttribute("X");
    QCOMPARE(kept.number(3), 0.0);
}

void CloudTest::compositesNeedEqualParts()
{
    const auto cloud = makeFrame(4);
    addScalar<std::uint16_t>(*cloud, "Red");
    addComposite(*cloud, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    QVERIFY(cloud->findAttribute("RGB") == nullptr);
    addScalar<std::uint16_t>(*cloud, "Green");
    addScalar<std::uint8_t>(*cloud, "Blue");
    addComposite(*cloud, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    QVERIFY(cloud->findAttribute("RGB") == nullptr);
    cloud->removeAttribute("Blue");
    addScalar<std::uint16_t>(*cloud, "Blue")[2] = 9;
    addComposite(*cloud, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    const Attribute* rgb = cloud->findAttribute("RGB");
    QVERIFY(rgb != nullptr && rgb->components == 3 && rgb->kind == AttributeKind::Color);
    QCOMPARE(rgb->number(2, 2), 9.0);
}

void CloudTest::noticesReachSubscribers()
{
    const auto cloud = makeFrame(4);
    int first = 0, second = 0;
    auto a = cloud->subscribe([&](const ChangeNotice&) { ++first; });
    {
        const auto b = cloud->subscribe([&](const ChangeNotice&) { ++second; });
        cloud->notify({});
    }
    cloud->notify({});
    QCOMPARE(first, 2);
    QCOMPARE(second, 1);
    Subscription moved = std::move(a);
    cloud->notify({});
    moved.reset();
    cloud->notify({});
    QCOMPARE(first, 3);
    Subscription late;
    {
        const auto gone = makeFrame(1);
        late = gone->subscribe([](const ChangeNotice&) {});
    }
    late.reset();  // after its cloud: nothing happens
}

void CloudTest::noticesConcernComposites()
{
    const auto cloud = makeFrame(4);
    for (const char* name : {"Red", "Green", "Blue"}) addScalar<std::uint16_t>(*cloud, name);
    addComposite(*cloud, "RGB", AttributeKind::Color, {"Red", "Green", "Blue"});
    const ChangeNotice notice{ChangeNotice::Kind::Values, {"Green"}, {}};
    QVERIFY(notice.concerns(*cloud->findAttribute("RGB")));
    QVERIFY(notice.concerns(*cloud->findAttribute("Green")));
    QVERIFY(!notice.concerns(*cloud->findAttribute("Red")));
}

void CloudTest::buffers()
{
    Buffer empty;
    QVERIFY(empty.data() == nullptr && empty.size() == 0);
    Buffer a(5'000'001);
    QCOMPARE(reinterpret_cast<std::uintptr_t>(a.data()) % 64, std::uintptr_t(0));
    for (std::size_t i = 0; i < a.size() + 64; ++i) QCOMPARE(int(a.data()[i]), 0);  // 64 past the end can be read
    a.data()[7] = std::byte(3);
    Buffer b = std::move(a);
    QVERIFY(b.size() == 5'000'001 && int(b.data()[7]) == 3);
    QVERIFY(a.data() == nullptr);  // moved from: empty
    b = Buffer(10);
    QCOMPARE(b.size(), std::size_t(10));
    QVERIFY_EXCEPTION_THROWN(Buffer(std::numeric_limits<std::size_t>::max() - 5), Error);
}

QTEST_APPLESS_MAIN(CloudTest)
#include "CloudTest.moc"
