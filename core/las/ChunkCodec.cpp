// SPDX-License-Identifier: MIT
#include "core/las/ChunkCodec.h"

#include "core/Error.h"
#include "core/las/ChunkDecoder.h"
#include "core/las/File.h"
#include "core/las/LaszipHandle.h"
#include "core/las/PointwiseEncoder.h"
#include "core/las/StackGuard.h"
#include "core/task/Progress.h"

#include <algorithm>
#include <exception>
#include <istream>
#include <ostream>
#include <streambuf>
#include <unordered_set>

namespace punctum::las
{

namespace
{

constexpr std::size_t kPointerBytes = 8;
constexpr std::size_t kCancelStep = 4096;  ///< points compressed between two looks at the cancel flag
constexpr std::size_t kFileWindow = std::size_t(1) << 20;

/// Where the optional parts of a record lie; -1: not there.
struct Parts {
    int gps = -1, rgb = -1, wave = -1, extra = -1;
    std::size_t rgbBytes = 0, extraBytes = 0, length = 0;
    bool extended = false;

    Parts(std::uint8_t format, std::uint16_t recordLength)
        : length(recordLength), extended(isExtendedFormat(format))
    {
        int at = extended ? 22 : 20;
        const auto take = [&](std::size_t n) { return std::exchange(at, at + int(n)); };
        if (hasGpsTime(format)) gps = take(8);
        if (hasColor(format)) rgb = take(rgbBytes = hasNir(format) ? 8 : 6);
        if (hasWaveform(format)) wave = take(29);
        if (const std::size_t left = length - std::size_t(at); left > 0) extra = take(extraBytes = left);
    }
    void toRecord(const laszip_point& p, std::byte* r) const;
    void fromRecord(const std::byte* r, laszip_point& p) const;
};

void Parts::toRecord(const laszip_point& p, std::byte* r) const
{
    const auto* raw = reinterpret_cast<const std::byte*>(&p);
    if (!extended) {
        std::memcpy(r, raw, 20);  // the struct begins with the record of format 0
    } else {
        std::memcpy(r, raw, 14);
        const auto flags = std::uint8_t(raw[22]);
        r[14] = raw[24];
        r[15] = std::byte((flags >> 4) | ((flags >> 2) & 3) << 4 | (std::uint8_t(raw[14]) & 0xC0));
        r[16] = raw[23];
        r[17] = std::byte(p.user_data);
        std::memcpy(r + 18, raw + 20, 2);
        std::memcpy(r + 20, raw + 18, 2);
    }
    if (gps >= 0) std::memcpy(r + gps, raw + 32, 8);
    if (rgb >= 0) std::memcpy(r + rgb, raw + 40, rgbBytes);
    if (wave >= 0) std::memcpy(r + wave, raw + 48, 29);
    if (extra >= 0) std::memcpy(r + extra, p.extra_bytes, extraBytes);
}

void Parts::fromRecord(const std::byte* r, laszip_point& p) const
{
    auto* raw = reinterpret_cast<std::byte*>(&p);
    if (!extended) {
        std::memcpy(raw, r, 20);
    } else {
        std::memcpy(raw, r, 14);
        const auto returns = std::uint8_t(r[14]), flags = std::uint8_t(r[15]), cls = std::uint8_t(r[16]);
        // LASzip wants the old fields filled as well: it checks them against the new ones when writing.
        const unsigned ret = std::min(returns & 15, 7), count = std::min(returns >> 4, 7);
        raw[14] = std::byte(ret | count << 3 | (flags & 0xC0));
        raw[15] = std::byte((cls < 32 ? cls : 0) | (flags & 7) << 5);
        raw[16] = std::byte(0);
        raw[17] = r[17];
        std::memcpy(raw + 18, r + 20, 2);
        std::memcpy(raw + 20, r + 18, 2);
        raw[22] = std::byte(1 | ((flags >> 4) & 3) << 2 | (flags & 15) << 4);  // 1: the new fields count
        raw[23] = r[16];
        raw[24] = r[14];
    }
    if (gps >= 0) std::memcpy(raw + 32, r + gps, 8);
    if (rgb >= 0) std::memcpy(raw + 40, r + rgb, rgbBytes);
    if (wave >= 0) std::memcpy(raw + 48, r + wave, 29);
    if (extra >= 0) std::memcpy(p.extra_bytes, r + extra, extraBytes);
}

/// What LASzip reads: a small header made here, then the data, from memory or from the file window by window.
class SourceBuffer : public std::streambuf
{
public:
    SourceBuffer(std::vector<std::byte> prefix, std::span<const std::byte> data)
        : m_prefix(std::move(prefix)), m_data(data), m_size(data.size())
    {
        window(0);
    }
    SourceBuffer(std::vector<std::byte> prefix, const File& file, std::uint64_t offset, std::uint64_t bytes)
        : m_prefix(std::move(prefix)), m_file(&file), m_offset(offset), m_size(bytes)
    {
        window(0);
    }
    std::size_t prefixBytes() const { return m_prefix.size(); }
    /// Throws what reading the file threw: LASzip takes it for damaged data.
    void rethrow() const
    {
        if (m_failure) std::rethrow_exception(m_failure);
    }

protected:
    int_type underflow() override
    {
        if (gptr() == egptr() && !window(position())) return traits_type::eof();
        return traits_type::to_int_type(*gptr());
    }
    /// Tells where it is; LASzip goes nowhere else in a file without a table.
    pos_type seekoff(off_type off, std::ios_base::seekdir way, std::ios_base::openmode) override
    {
        const bool tell = way == std::ios_base::cur && off == 0;
        return tell ? pos_type(std::int64_t(position())) : pos_type(off_type(-1));
    }

private:
    std::uint64_t position() const { return m_windowStart + std::uint64_t(gptr() - eback()); }
    /// Makes the bytes from `at` on the ones that are read next; false at the end.
    bool window(std::uint64_t at)
    {
        m_windowStart = at;
        if (at < m_prefix.size()) {
            show(m_prefix.data() + at, m_prefix.size() - at);
            return true;
        }
        const std::uint64_t in = at - m_prefix.size();
        if (in >= m_size) {
            setg(nullptr, nullptr, nullptr);
            return false;
        }
        if (m_file == nullptr) {
            show(m_data.data() + in, m_data.size() - in);
        } else {
            m_window.resize(std::size_t(std::min<std::uint64_t>(kFileWindow, m_size - in)));
            try {
                m_file->readAt(m_offset + in, m_window);
            } catch (...) {
                m_failure = std::current_exception();
                throw;
            }
            show(m_window.data(), m_window.size());
        }
        return true;
    }
    void show(const std::byte* p, std::size_t n)
    {
        // streambuf wants char*, and does not write through it here
        auto* c = const_cast<char*>(reinterpret_cast<const char*>(p));
        setg(c, c, c + n);
    }

    std::vector<std::byte> m_prefix;
    std::span<const std::byte> m_data;
    const File* m_file = nullptr;
    std::uint64_t m_offset = 0;
    std::uint64_t m_size = 0;
    std::uint64_t m_windowStart = 0;
    std::vector<std::byte> m_window;
    std::exception_ptr m_failure;
};

/// A LAZ file of one run of points, up to where the compressed bytes begin: header, laszip record, and a table
/// position that says "no table", which LASzip takes as a file that was cut off.
std::vector<std::byte> miniFile(const LazInfo& info, std::uint32_t chunkSize, std::uint64_t count)
{
    const bool extended = isExtendedFormat(info.format);
    Header h;
    h.bytes.resize(standardHeaderSize(extended ? 4 : 2));
    h.setText(at::kSignature, "LASF");
    h.set(at::kVersionMajor, 1);
    h.set(at::kVersionMinor, extended ? 4 : 2);
    h.set(at::kHeaderSize, std::uint16_t(h.bytes.size()));
    h.set(at::kPointOffset, std::uint32_t(h.bytes.size() + Vlr::kHeaderSize + info.payload.size()));
    h.set(at::kVlrCount, 1);
    h.set(at::kPointFormat, info.format | 0x80);
    h.set(at::kRecordLength, info.recordLength);
    h.set(at::kLegacyCount, extended ? 0 : std::uint32_t(std::min<std::uint64_t>(count, UINT32_MAX)));
    h.set(at::kPointCount, count);
    for (std::size_t k = 0; k < 3; ++k) h.set(at::kScale[k], 1.0);

    std::vector<std::byte> bytes = std::move(h.bytes);
    const auto add = [&](const void* p, std::size_t n) {
        const auto* b = static_cast<const std::byte*>(p);
        bytes.insert(bytes.end(), b, b + n);
    };
    const Vlr vlr = makeVlr(kLaszipUser, kLaszipRecordId, "", {});
    const auto length = std::uint16_t(info.payload.size());
    add(&vlr.reserved, 2);
    add(vlr.userId.data(), 16);
    add(&vlr.recordId, 2);
    add(&length, 2);
    add(vlr.description.data(), 32);
    const std::size_t payloadAt = bytes.size();
    add(info.payload.data(), info.payload.size());
    std::memcpy(bytes.data() + payloadAt + LazInfo::kChunkSizeAt, &chunkSize, 4);
    if (info.compressor != LazInfo::Pointwise) {
        const auto here = std::int64_t(bytes.size());
        add(&here, kPointerBytes);
    }
    return bytes;
}

/// Collects what LASzip writes; it goes back once, to fill in the position of the table.
class SinkBuffer : public std::streambuf
{
public:
    std::vector<std::byte> bytes;

protected:
    int_type overflow(int_type c) override
    {
        const char ch = traits_type::to_char_type(c);
        put(&ch, 1);
        return c;
    }
    std::streamsize xsputn(const char* s, std::streamsize n) override
    {
        put(s, std::size_t(n));
        return n;
    }
    pos_type seekoff(off_type off, std::ios_base::seekdir way, std::ios_base::openmode) override
    {
        if (way == std::ios_base::cur) off += off_type(m_at);
        if (way == std::ios_base::end) off += off_type(bytes.size());
        return seekpos(pos_type(off), std::ios_base::out);
    }
    pos_type seekpos(pos_type pos, std::ios_base::openmode) override
    {
        if (off_type(pos) < 0 || off_type(pos) > off_type(bytes.size())) return pos_type(off_type(-1));
        m_at = std::size_t(off_type(pos));
        return pos;
    }

private:
    void put(const char* s, std::size_t n)
    {
        if (m_at + n > bytes.size()) {
            if (m_at + n > bytes.capacity()) bytes.reserve(std::max<std::size_t>(bytes.capacity() * 2, 1 << 16));
            bytes.resize(m_at + n);
        }
        std::memcpy(bytes.data() + m_at, s, n);
        m_at += n;
    }
    std::size_t m_at = 0;
};

constexpr std::size_t kCoderBytes = 4;  ///< that a range coder takes first

/// A range coder's first four bytes are below the full range in what an encoder writes. LASzip does not look, and
/// at 0xFFFFFFFF reads and writes outside its tables.
bool coderBegins(std::span<const std::byte> bytes)
{
    return bytes.size() < kCoderBytes || loadAs<std::uint32_t>(bytes.data()) != UINT32_MAX;
}

/// Whether all coders of a chunk (layered: one a layer, its head is sound) or stream begin as they can.
bool codersBegin(std::span<const std::byte> data, const LazInfo& info)
{
    std::size_t at = info.recordLength;
    if (data.size() < at) return true;
    if (info.compressor != LazInfo::Layered) return coderBegins(data.subspan(at));
    const std::size_t sizes = at + 4, layers = info.layers();
    at = sizes + 4 * layers;
    for (std::size_t k = 0; k < layers && at <= data.size(); ++k) {
        const auto size = loadAs<std::uint32_t>(data.data() + sizes + 4 * k);
        if (size >= kCoderBytes && !coderBegins(data.subspan(at))) return false;
        at += size;
    }
    return true;
}

}  // namespace

struct PointDecoder::Impl {
    SourceBuffer buffer;
    std::istream stream;
    LaszipHandle handle;
    laszip_point* point = nullptr;
    Parts parts;
    bool open = false;

    template <typename... Source>
    Impl(const LazInfo& info, std::uint32_t chunkSize, std::uint64_t count, Source&&... source)
        : buffer(miniFile(info, chunkSize, count), std::forward<Source>(source)...),
          stream(&buffer),
          parts(info.format, info.recordLength)
    {
        // An exception of ours (the disk failed) ends what LASzip does, which takes it for damage: see rethrow().
        stream.exceptions(std::ios_base::badbit);
    }
    std::string start()
    {
        laszip_BOOL compressed = 0;
        const bool opened = laszip_open_reader_stream(handle.get(), stream, &compressed) == 0;
        buffer.rethrow();
        if (!opened) return handle.error();
        open = true;
        point = handle.point();
        if (parts.extra >= 0 && (point->extra_bytes == nullptr || point->num_extra_bytes != int(parts.extraBytes)))
            return "LASzip sees other extra bytes";
        return {};
    }
    ~Impl()
    {
        if (open) laszip_close_reader(handle.get());
    }
};

PointDecoder::PointDecoder(const LazInfo& info, std::span<const std::byte> data, std::uint64_t count, Codec codec)
{
    if (codec == Codec::Fastest) m_own = ChunkDecoder::make(info);
    if (m_own) {
        restart(data);
    } else {
        const auto chunkSize = std::uint32_t(std::min<std::uint64_t>(count, UINT32_MAX - 1));
        m_impl = std::make_unique<Impl>(info, chunkSize, count, data);
        m_error = codersBegin(data, info) ? m_impl->start() : kImpossibleStart;
    }
}

PointDecoder::PointDecoder(const LazInfo& info, const File& file, std::uint64_t offset, std::uint64_t bytes,
                           std::uint64_t count)
    : m_own(ChunkDecoder::make(info))
{
    if (m_own) {
        // No encoder needs twice the bytes of the records.
        const std::uint64_t most = 2 * std::uint64_t(info.recordLength) * std::min(count, bytes) + kFileWindow;
        std::vector<std::byte> data(std::size_t(std::min(bytes, most)));
        file.readAt(offset, data);
        restart(data);
        return;
    }
    m_impl = std::make_unique<Impl>(info, info.chunkSize, count, file, offset, bytes);
    std::vector<std::byte> head(std::size_t(std::min<std::uint64_t>(bytes, info.recordLength + kCoderBytes)));
    file.readAt(offset, head);
    m_error = codersBegin(head, info) ? m_impl->start() : kImpossibleStart;
}

PointDecoder::~PointDecoder() = default;

void PointDecoder::restart(std::span<const std::byte> data)
{
    m_error = m_own->start(data);
}

std::size_t PointDecoder::decode(std::size_t count, std::byte* records)
{
    if (!m_error.empty()) return 0;
    if (m_own) {
        const std::size_t n = m_own->decode(count, records);
        if (n < count) m_error = "its bytes end too early or are damaged";
        return n;
    }
    const laszip_POINTER handle = m_impl->handle.get();
    const Parts& parts = m_impl->parts;
    std::size_t done = 0;
    const bool fitted = withStackGuard([&] {
        for (; done < count && laszip_read_point(handle) == 0; ++done)
            parts.toRecord(*m_impl->point, records + done * parts.length);
    });
    if (!fitted) {
        m_error = "its GPS times never end";
        return 0;
    }
    m_impl->buffer.rethrow();
    if (done < count) m_error = m_impl->handle.error();
    return done;
}

std::uint64_t PointDecoder::position()
{
    if (m_own) return m_own->position();
    const auto at = m_impl->stream.rdbuf()->pubseekoff(0, std::ios_base::cur, std::ios_base::in);
    return std::uint64_t(std::streamoff(at)) - m_impl->buffer.prefixBytes();
}

struct LaszipEncoder::Impl {
    Impl(const LazInfo& info, std::ostream& out) : parts(info.format, info.recordLength)
    {
        check(laszip_set_point_type_and_size(handle.get(), info.format, info.recordLength));
        check(laszip_request_native_extension(handle.get(), 1));
        check(laszip_set_chunk_size(handle.get(), info.chunkSize));
        check(laszip_open_writer_stream(handle.get(), out, 1, 1));
        point = handle.point();
        if (parts.extra >= 0 && (point->extra_bytes == nullptr || point->num_extra_bytes != int(parts.extraBytes)))
            throw Error("The points cannot be compressed (LASzip sees other extra bytes).");
    }
    void check(laszip_I32 rc) const
    {
        if (rc != 0) throw Error("The points cannot be compressed (LASzip: " + handle.error() + ").");
    }

    LaszipHandle handle;
    Parts parts;
    laszip_point* point = nullptr;
};

LaszipEncoder::LaszipEncoder(const LazInfo& info, std::ostream& out) : m_impl(std::make_unique<Impl>(info, out)) {}

LaszipEncoder::~LaszipEncoder() = default;

void LaszipEncoder::add(std::span<const std::byte> records)
{
    const Parts& parts = m_impl->parts;
    for (std::size_t at = 0; at + parts.length <= records.size(); at += parts.length) {
        parts.fromRecord(records.data() + at, *m_impl->point);
        m_impl->check(laszip_write_point(m_impl->handle.get()));
    }
}

void LaszipEncoder::finish()
{
    m_impl->check(laszip_close_writer(m_impl->handle.get()));
}

namespace
{

constexpr std::size_t kTimeAt = 22;  ///< GPS time in the formats 6 to 10

/// LASzip compares GPS times of the formats 6 to 10 as numbers, to which -0 and 0 are the same, so that it loses
/// the sign; but it codes the differences of their bits, or 32 bits that are the lower half. So when the same
/// number is added to the upper half of all times, the coded bytes stay the same, while no two times look equal
/// that are not. Gives such a number; 0 where none is needed.
std::uint32_t timeShift(std::span<const std::byte> records, std::size_t length)
{
    bool positive = false, negative = false;
    for (std::size_t at = kTimeAt; at < records.size(); at += length) {
        const auto time = loadAs<std::uint64_t>(records.data() + at);
        positive = positive || time == 0;
        negative = negative || time == 1ull << 63;
    }
    if (!positive || !negative) return 0;
    std::unordered_set<std::uint32_t> upper;
    for (std::size_t at = kTimeAt; at < records.size(); at += length)
        upper.insert(loadAs<std::uint32_t>(records.data() + at + 4));
    // No time may become 0 or -0, nor come so close to 0 that LASzip codes the difference to it.
    const auto taken = [&](std::uint32_t shift) {
        return upper.contains(0u - shift) || upper.contains(UINT32_MAX - shift) ||
               upper.contains(0x80000000u - shift);
    };
    std::uint32_t shift = 1;
    while (taken(shift)) ++shift;
    return shift;
}

/// By LASzip, as a file of one chunk.
std::vector<std::byte> encodeLayered(const LazInfo& info, std::span<const std::byte> records,
                                     const Progress& progress)
{
    LazInfo one = info;
    one.chunkSize = std::uint32_t(records.size() / info.recordLength);
    SinkBuffer sink;
    std::ostream stream(&sink);
    LaszipEncoder encoder(one, stream);
    const std::size_t step = kCancelStep * info.recordLength;
    for (std::size_t at = 0; at < records.size(); at += step) {
        progress.check();
        encoder.add(records.subspan(at, std::min(step, records.size() - at)));
    }
    encoder.finish();
    // [0, 8): where LASzip's own table begins, which ends the chunk
    const auto tableAt = sink.bytes.size() >= kPointerBytes ? loadAs<std::int64_t>(sink.bytes.data()) : -1;
    if (stream.fail() || tableAt < std::int64_t(kPointerBytes) || std::uint64_t(tableAt) > sink.bytes.size())
        throw Error("The points cannot be compressed (LASzip gave no chunk).");
    sink.bytes.resize(std::size_t(tableAt));
    sink.bytes.erase(sink.bytes.begin(), sink.bytes.begin() + kPointerBytes);
    return std::move(sink.bytes);
}

/// The chunk, although there are times of 0 and of -0 in it.
std::vector<std::byte> encodeShifted(const LazInfo& info, std::span<const std::byte> records, std::uint32_t shift,
                                     const Progress& progress)
{
    std::vector<std::byte> shifted(records.begin(), records.end());
    for (std::size_t at = kTimeAt; at < shifted.size(); at += info.recordLength) {
        const std::uint64_t time = loadAs<std::uint64_t>(shifted.data() + at) + (std::uint64_t(shift) << 32);
        std::memcpy(shifted.data() + at, &time, sizeof time);
    }
    std::vector<std::byte> chunk = encodeLayered(info, shifted, progress);
    // The first record stands in the chunk as it is.
    std::memcpy(chunk.data() + kTimeAt, records.data() + kTimeAt, sizeof(std::uint64_t));
    return chunk;
}

}  // namespace

std::vector<std::byte> encodeChunk(const LazInfo& info, std::span<const std::byte> records,
                                   const Progress& progress)
{
    const std::size_t count = records.size() / info.recordLength;
    if (count == 0 || count >= kVariableChunks) throw Error("A chunk cannot hold that many points.");
    if (!isExtendedFormat(info.format)) return encodePointwise(info, records, progress);
    if (const std::uint32_t shift = timeShift(records, info.recordLength); shift != 0)
        return encodeShifted(info, records, shift, progress);
    return encodeLayered(info, records, progress);
}

}  // namespace punctum::las
