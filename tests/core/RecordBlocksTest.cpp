// SPDX-License-Identifier: MIT
#include "core/las/RecordBlocks.h"

#include <QTest>

#include <cstring>
#include <memory>
#include <random>
#include <set>

using namespace punctum;
using namespace punctum::las;

/// Records taken apart and put together, against copying byte by byte. All buffers have exactly their size, so that
/// the address sanitizer sees each step beyond.
class RecordBlocksTest : public QObject
{
    Q_OBJECT

private Q_SLOTS:
    void apartAndTogether_data();
    void apartAndTogether();
    void columnsAreLeftOut();
    void madeUpLayouts();
    void spreadOrderVisitsAll();
};

namespace
{

std::vector<std::byte> randomBytes(std::size_t n, std::mt19937& random)
{
    std::vector<std::byte> bytes(n);
    for (std::byte& b : bytes) b = std::byte(random());
    return bytes;
}

/// Fields of all sizes without gaps.
RecordLayout madeLayout(const std::vector<std::uint32_t>& sizes)
{
    RecordLayout layout;
    for (const std::uint32_t size : sizes) {
        RecordField field;
        field.offset = layout.length;
        field.type = size == 8   ? ScalarType::U64
                     : size == 4 ? ScalarType::U32
                     : size == 2 ? ScalarType::U16
                                 : ScalarType::U8;
        field.components = std::uint16_t(size / sizeOf(field.type));
        layout.fields.push_back(field);
        layout.length = std::uint16_t(layout.length + size);
    }
    return layout;
}

/// The columns of the records by Deinterleaver are those copied byte by byte, and make the same records again.
void check(const RecordLayout& layout, std::size_t count, std::mt19937& random, std::set<std::size_t> leftOut = {})
{
    const std::vector<std::byte> bytes = randomBytes(count * layout.length, random);
    const std::unique_ptr<std::byte[]> records(new std::byte[bytes.size()]);
    std::copy(bytes.begin(), bytes.end(), records.get());
    std::vector<std::unique_ptr<std::byte[]>> columns;
    std::vector<std::byte*> to;
    std::vector<const std::byte*> from;
    for (std::size_t k = 0; k < layout.fields.size(); ++k) {
        columns.emplace_back(new std::byte[count * layout.fields[k].bytes()]);
        to.push_back(leftOut.contains(k) ? nullptr : columns.back().get());
        from.push_back(to.back());
    }
    const Deinterleaver deinterleave(layout);
    deinterleave(records.get(), count, to);
    std::vector<std::byte> expected = bytes;
    for (std::size_t k = 0; k < layout.fields.size(); ++k) {
        const std::size_t size = layout.fields[k].bytes();
        for (std::size_t i = 0; i < count; ++i) {
            std::byte* const field = expected.data() + i * layout.length + layout.fields[k].offset;
            if (to[k] == nullptr)
                std::memset(field, 0, size);
            else
                QVERIFY2(std::memcmp(to[k] + i * size, field, size) == 0,
                         qPrintable(QString("field %1 of point %2 of %3").arg(k).arg(i).arg(count)));
        }
    }
    std::vector<std::byte> back(bytes.size());
    interleave(layout, from, count, back.data());
    QVERIFY(back == expected);
}

}  // namespace

void RecordBlocksTest::apartAndTogether_data()
{
    QTest::addColumn<int>("format");
    QTest::addColumn<int>("extra");
    for (int format = 0; format <= kLastPointFormat; ++format)
        for (const int extra : {0, 1, 7, 33}) QTest::addRow("%d %d", format, extra) << format << extra;
}

void RecordBlocksTest::apartAndTogether()
{
    QFETCH(int, format);
    QFETCH(int, extra);
    std::mt19937 random(std::uint32_t(format * 100 + extra));
    std::vector<std::string> warnings;
    const auto length = std::uint16_t(standardRecordLength(std::uint8_t(format)) + extra);
    const RecordLayout layout = makeLayout(std::uint8_t(format), length, {}, {}, warnings);
    for (std::size_t count = 0; count < 40; ++count) check(layout, count, random);
    for (const std::size_t count : {480u, 481u, 1000u, 4097u}) check(layout, count, random);
}

void RecordBlocksTest::columnsAreLeftOut()
{
    std::mt19937 random(5);
    std::vector<std::string> warnings;
    const RecordLayout layout = makeLayout(7, standardRecordLength(7), {}, {}, warnings);
    for (std::size_t k = 0; k < layout.fields.size(); ++k) check(layout, 100, random, {k});
    check(layout, 100, random, {0, 1, 2, 4});
}

void RecordBlocksTest::madeUpLayouts()
{
    std::mt19937 random(17);
    for (int turn = 0; turn < 300; ++turn) {
        std::vector<std::uint32_t> sizes;
        std::uint32_t length = 0;
        while (length < 20 + random() % 60) {
            constexpr std::uint32_t kSizes[] = {1, 1, 2, 2, 4, 4, 8, 8, 3, 5, 24};
            sizes.push_back(kSizes[random() % std::size(kSizes)]);
            length += sizes.back();
        }
        check(madeLayout(sizes), random() % 100, random);
    }
}

void RecordBlocksTest::spreadOrderVisitsAll()
{
    for (const std::uint32_t count : {0u, 1u, 2u, 7u, 8u, 1000u}) {
        const std::vector<std::uint32_t> order = spreadOrder(count);
        QCOMPARE(order.size(), std::size_t(count));
        QCOMPARE((std::set<std::uint32_t>(order.begin(), order.end()).size()), std::size_t(count));
        for (const std::uint32_t k : order) QVERIFY(k < count);
    }
}

QTEST_GUILESS_MAIN(RecordBlocksTest)
#include "RecordBlocksTest.moc"
