// SPDX-License-Identifier: MIT
#include "core/las/ExtraBytes.h"

#include "core/Text.h"
#include "core/las/SourceFile.h"

#include <algorithm>
#include <bit>
#include <cstring>

namespace punctum::las
{

namespace
{

constexpr std::size_t kDescriptionAt = 160;

bool isUtf8(std::string_view text)
{
    while (!text.empty()) {
        const std::size_t n = utf8Length(text);
        if (n == 0) return false;
        text.remove_prefix(n);
    }
    return true;
}

void putText(ExtraBytesDescriptor& d, std::size_t at, const std::string& text)
{
    const std::string cut = cutUtf8(text, kDescriptorText);
    std::memcpy(d.bytes.data() + at, cut.data(), cut.size());
}

void putNumber(ExtraBytesDescriptor& d, std::size_t at, double value)
{
    std::memcpy(d.bytes.data() + at, &value, sizeof value);
}

}  // namespace

std::string fixedText(std::span<const std::byte> field)
{
    std::string text(reinterpret_cast<const char*>(field.data()), field.size());
    text.resize(std::min(text.find('\0'), text.size()));
    while (!text.empty() && text.back() == ' ') text.pop_back();
    if (!isUtf8(text)) {
        std::string utf8;
        for (const char ch : text) {
            const auto c = static_cast<unsigned char>(ch);
            if (c < 0x80) {
                utf8 += ch;
            } else {
                utf8 += char(0xC0 | (c >> 6));
                utf8 += char(0x80 | (c & 0x3F));
            }
        }
        text = utf8;
    }
    for (char& c : text)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = '?';
    return text;
}

std::string cutUtf8(const std::string& text, std::size_t bytes)
{
    if (text.size() <= bytes) return text;
    std::size_t end = bytes;
    while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0) == 0x80) --end;
    return text.substr(0, end);
}

std::uint32_t ExtraBytesDescriptor::recordBytes() const
{
    const unsigned kind = type();
    if (kind == 0) return options();
    return kind > 30 ? 0 : std::uint32_t(((kind - 1) / 10 + 1) * sizeOf(ScalarType((kind - 1) % 10)));
}

std::string ExtraBytesDescriptor::name() const
{
    return fixedText(std::span(bytes).subspan(kDescriptorNameAt, kDescriptorText));
}

std::string ExtraBytesDescriptor::description() const
{
    return fixedText(std::span(bytes).subspan(kDescriptionAt, kDescriptorText));
}

std::uint64_t ExtraBytesDescriptor::bits(std::size_t at, std::size_t k) const
{
    std::uint64_t v = 0;
    if (at + k * 8 + 8 <= kSize) std::memcpy(&v, bytes.data() + at + k * 8, 8);
    return v;
}

double ExtraBytesDescriptor::number(std::size_t at, std::size_t k) const
{
    return std::bit_cast<double>(bits(at, k));
}

ExtraBytesDescriptor makeDescriptor(const ExtraBytesField& field)
{
    // LAS 1.4 R15, table 25: types 1 to 10 are in the order of ScalarType.
    ExtraBytesDescriptor d;
    d.bytes[2] = std::byte(int(field.type) + 1);
    d.bytes[3] = std::byte((field.scale ? 8 : 0) | (field.offset ? 16 : 0));
    putText(d, kDescriptorNameAt, field.name);
    putText(d, kDescriptionAt, field.description);
    if (field.scale) putNumber(d, kDescriptorScaleAt, *field.scale);
    if (field.offset) putNumber(d, kDescriptorOffsetAt, *field.offset);
    return d;
}

ExtraBytesDescriptor makeOpaqueDescriptor(std::uint8_t length, const std::string& name)
{
    ExtraBytesDescriptor d;
    d.bytes[3] = std::byte(length);
    putText(d, kDescriptorNameAt, name);
    return d;
}

std::vector<ExtraBytesItem> parseExtraBytes(std::span<const Vlr* const> records, std::uint32_t first,
                                            std::uint32_t last, std::vector<std::string>& warnings)
{
    std::vector<ExtraBytesItem> items;
    std::uint32_t at = first;
    std::size_t number = 0;
    for (const Vlr* record : records) {
        if (record->data.size() % ExtraBytesDescriptor::kSize != 0)
            warnings.push_back("The extra bytes record has " + std::to_string(record->data.size()) +
                               " bytes, which is not a whole number of descriptions; the rest is ignored.");
        for (std::size_t k = 0; k + ExtraBytesDescriptor::kSize <= record->data.size();
             k += ExtraBytesDescriptor::kSize) {
            ++number;
            ExtraBytesItem item;
            std::memcpy(item.descriptor.bytes.data(), record->data.data() + k, ExtraBytesDescriptor::kSize);
            const unsigned type = item.descriptor.type();
            const std::string which =
                "extra bytes description " + std::to_string(number) + " (" + item.descriptor.name() + ")";
            if (type > 30) {
                warnings.push_back("The " + which + " has the reserved type " + std::to_string(type) +
                                   "; the rest of the extra bytes is kept without a meaning.");
                return items;
            }
            if (type == 0) {
                item.opaque = true;
                item.values = item.descriptor.options();
            } else {
                item.type = ScalarType((type - 1) % 10);
                item.values = (type - 1) / 10 + 1;
            }
            item.bytes = std::uint32_t(item.values * sizeOf(item.type));
            if (item.bytes == 0) {
                warnings.push_back("The " + which + " covers no bytes and is ignored.");
                continue;
            }
            if (item.bytes > last - at) {
                warnings.push_back("The " + which +
                                   " reaches beyond the end of the point record; it and what follows "
                                   "it are ignored.");
                return items;
            }
            item.offset = at;
            item.record = std::size_t(std::find(records.begin(), records.end(), record) - records.begin());
            item.place = k;
            at += item.bytes;
            items.push_back(item);
        }
    }
    return items;
}

}  // namespace punctum::las
