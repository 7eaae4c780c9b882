// SPDX-License-Identifier: MIT
#include "core/las/PointwiseDecoder.h"

#include "core/las/PointwiseItems.h"

#include <algorithm>

namespace punctum::las
{

struct PointwiseDecoder::Impl {
    explicit Impl(const LazInfo& info) : length(info.recordLength), items(info) {}

    std::size_t length;
    PointwiseItems items;
    RangeDecoder in;
    std::vector<std::byte> bytes;  ///< the chunk, and what the range decoder reads ahead
    std::size_t size = 0;
    bool first = true;
};

bool PointwiseDecoder::supports(const LazInfo& info)
{
    if (info.compressor == LazInfo::Layered) return false;
    return std::all_of(info.items.begin(), info.items.end(), [](const LazInfo::Item& item) {
        return item.version == (item.size == WavePacket::kBytes && item.type == 9 ? 1 : 2);
    });
}

PointwiseDecoder::PointwiseDecoder(const LazInfo& info) : m_impl(std::make_unique<Impl>(info)) {}

PointwiseDecoder::~PointwiseDecoder() = default;

std::string PointwiseDecoder::start(std::span<const std::byte> chunk)
{
    Impl& impl = *m_impl;
    impl.size = 0;
    impl.in = RangeDecoder();
    if (chunk.size() < impl.length) return "it is too short for a point";
    impl.bytes.resize(chunk.size() + RangeDecoder::kReadAhead);
    std::memcpy(impl.bytes.data(), chunk.data(), chunk.size());
    std::fill_n(impl.bytes.data() + chunk.size(), RangeDecoder::kReadAhead, std::byte(0));
    impl.size = chunk.size();
    impl.first = true;
    impl.items.start(impl.bytes.data());
    impl.in = RangeDecoder(std::span(impl.bytes).subspan(impl.length, impl.size - impl.length));
    return impl.in.impossible() ? kImpossibleStart : "";
}

std::size_t PointwiseDecoder::decode(std::size_t count, std::byte* records)
{
    Impl& impl = *m_impl;
    if (impl.size == 0) return 0;
    for (std::size_t k = 0; k < count; ++k, records += impl.length) {
        if (impl.first) {
            std::memcpy(records, impl.bytes.data(), impl.length);
            impl.first = false;
        } else {
            impl.items.decode(impl.in, records);
        }
        if (impl.in.damaged()) return k;
    }
    return count;
}

std::uint64_t PointwiseDecoder::position() const
{
    return m_impl->size == 0 ? 0 : m_impl->length + m_impl->in.taken();
}

unsigned PointwiseDecoder::zerosAtEnd() const
{
    return m_impl->in.zerosAtEnd();
}

bool PointwiseDecoder::endsAsWritten() const
{
    return m_impl->in.zerosAsWritten();
}

}  // namespace punctum::las
