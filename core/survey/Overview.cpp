// SPDX-License-Identifier: MIT
#include "core/survey/Overview.h"

#include "core/Error.h"
#include "core/SummedText.h"
#include "core/cloud/Residency.h"
#include "core/las/AtomicFile.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstring>
#include <string_view>
#include <type_traits>

namespace punctum
{

namespace
{

namespace fs = std::filesystem;

/// What a file begins with; another version begins with something else.
constexpr std::string_view kMagic = "Punctum overview 2\n";
constexpr std::string_view kEnding = ".overview";
constexpr std::uint64_t kMostOfNames = 64u << 20;  ///< bytes beside the values that are looked at

template <typename T>
void putNumber(std::string& out, T value)
{
    static_assert(std::is_arithmetic_v<T>);
    out.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

void putText(std::string& out, std::string_view text)
{
    putNumber(out, std::uint64_t(text.size()));
    out.append(text);
}

/// Takes values off the beginning of what was put; `good` is false once there were too few.
struct Taking {
    std::string_view rest;
    bool good = true;

    template <typename T>
    T number()
    {
        T value{};
        if (rest.size() < sizeof(value)) {
            good = false;
            return value;
        }
        std::memcpy(&value, rest.data(), sizeof(value));
        rest.remove_prefix(sizeof(value));
        return value;
    }
    std::string_view text()
    {
        const auto size = number<std::uint64_t>();
        if (size > rest.size()) good = false;
        if (!good) return {};
        const std::string_view found = rest.substr(0, std::size_t(size));
        rest.remove_prefix(std::size_t(size));
        return found;
    }
};

std::string describe(const std::vector<Overview::Of>& files)
{
    std::string out;
    putNumber(out, std::uint64_t(files.size()));
    for (const Overview::Of& of : files) {
        putText(out, of.path.native());
        putNumber(out, of.stamp.size);
        putNumber(out, of.stamp.modified);
        putNumber(out, of.points);
        putText(out, of.layout);
    }
    return out;
}

/// Those that are kept, the one that was used last in front.
struct Kept {
    fs::path path;
    fs::file_time_type used;
    std::uint64_t bytes = 0;
};

std::vector<Kept> allKept(const fs::path& folder)
{
    std::vector<Kept> all;
    std::error_code error;
    for (fs::directory_iterator entry(folder, error), end; !error && entry != end; entry.increment(error)) {
        std::error_code gone;
        Kept kept{entry->path(), entry->last_write_time(gone), 0};
        if (!gone) kept.bytes = entry->file_size(gone);
        if (gone) continue;
        // What a program that was killed left half written goes after a day.
        if (entry->path().extension() == kEnding)
            all.push_back(std::move(kept));
        else if (fs::file_time_type::clock::now() - kept.used > std::chrono::hours(24))
            fs::remove(kept.path, gone);
    }
    std::sort(all.begin(), all.end(), [](const Kept& a, const Kept& b) { return a.used > b.used; });
    return all;
}

}  // namespace

fs::path Overview::folder()
{
    return Residency::folder() / "overviews";
}

fs::path Overview::place() const
{
    std::uint32_t sum = 0;
    for (const Of& of : m_of) sum = crc32(sum, of.path.native() + '\0');
    char digits[8];
    const auto end = std::to_chars(digits, digits + sizeof(digits), sum, 16).ptr;
    return folder() / (std::string(digits, end) + '-' + std::to_string(m_of.size()) + std::string(kEnding));
}

std::uint64_t Overview::room(std::uint64_t most) const noexcept
{
    std::uint64_t bytes = 1;  // of a point of each file
    for (const Of& of : m_of) bytes += of.bytes;
    return std::min(most, kMostBytes / bytes);
}

void Overview::add(Piece piece)
{
    const std::lock_guard lock(m_mutex);
    m_pieces.push_back(std::move(piece));
}

bool Overview::find()
{
    try {
        const las::File file(place());
        if (file.size() > kMostBytes + kMostOfNames) return false;
        std::string bytes(std::size_t(file.size()), '\0');
        file.readAt(0, std::as_writable_bytes(std::span(bytes)));
        if (!parse(bytes)) return false;
    } catch (const Error&) {
        return false;
    }
    std::error_code ignored;
    fs::last_write_time(place(), fs::file_time_type::clock::now(), ignored);
    return true;
}

/// Whatever the bytes are, the pieces are in the files, and have the values that their columns need.
bool Overview::parse(const std::string& bytes)
{
    std::string_view all = bytes;
    if (all.size() < kMagic.size() + sizeof(std::uint32_t) || !all.starts_with(kMagic)) return false;
    std::uint32_t sum = 0;
    std::memcpy(&sum, all.data() + all.size() - sizeof(sum), sizeof(sum));
    all.remove_suffix(sizeof(sum));
    if (crc32(0, all) != sum) return false;
    all.remove_prefix(kMagic.size());
    const std::string files = describe(m_of);
    if (!all.starts_with(files)) return false;
    Taking taking{all.substr(files.size())};
    std::vector<std::vector<WorldBounds>> boxes(m_of.size());
    for (std::size_t k = 0; k < boxes.size(); ++k) {
        const auto count = taking.number<std::uint64_t>();
        if (count > m_of[k].points || count > taking.rest.size() / (6 * sizeof(double))) return false;
        boxes[k].resize(std::size_t(count));
        for (WorldBounds& box : boxes[k])
            for (glm::dvec3* const corner : {&box.min, &box.max})
                for (int axis = 0; axis < 3; ++axis) {
                    (*corner)[axis] = taking.number<double>();
                    if (!std::isfinite((*corner)[axis])) return false;
                }
    }
    std::vector<Piece> found;
    while (taking.good && !taking.rest.empty()) {
        Piece piece;
        piece.of = std::size_t(taking.number<std::uint64_t>());
        piece.points.first = taking.number<std::uint64_t>();
        piece.points.last = taking.number<std::uint64_t>();
        const std::string_view values = taking.text();
        if (!taking.good || piece.of >= m_of.size()) return false;
        const Of& of = m_of[piece.of];
        if (piece.points.empty() || piece.points.first > piece.points.last || piece.points.last > of.points ||
            piece.points.size() > kMostBytes || values.size() != piece.points.size() * of.bytes)
            return false;
        const auto data = std::as_bytes(std::span(values));
        piece.values.assign(data.begin(), data.end());
        found.push_back(std::move(piece));
    }
    if (!taking.good) return false;
    // No point twice.
    const auto before = [](const Piece& a, const Piece& b) {
        return a.of < b.of || (a.of == b.of && a.points.first < b.points.first);
    };
    std::sort(found.begin(), found.end(), before);
    for (std::size_t k = 1; k < found.size(); ++k)
        if (found[k].of == found[k - 1].of && found[k].points.first < found[k - 1].points.last) return false;
    m_pieces = std::move(found);
    m_boxes = std::move(boxes);
    return true;
}

void Overview::keep() const
{
    std::string bytes(kMagic);
    bytes += describe(m_of);
    for (const std::vector<WorldBounds>& boxes : m_boxes) {
        putNumber(bytes, std::uint64_t(boxes.size()));
        for (const WorldBounds& box : boxes)
            for (const glm::dvec3& corner : {box.min, box.max})
                for (int axis = 0; axis < 3; ++axis) putNumber(bytes, corner[axis]);
    }
    for (const Piece& piece : m_pieces) {
        putNumber(bytes, std::uint64_t(piece.of));
        putNumber(bytes, piece.points.first);
        putNumber(bytes, piece.points.last);
        putText(bytes, std::string_view(reinterpret_cast<const char*>(piece.values.data()), piece.values.size()));
    }
    putNumber(bytes, crc32(0, bytes));

    const fs::path path = place();
    std::error_code error;
    fs::create_directories(path.parent_path(), error);
    std::uint64_t room = kMostInAll - std::min<std::uint64_t>(kMostInAll, bytes.size());
    for (const Kept& kept : allKept(path.parent_path())) {
        if (kept.path == path) continue;
        if (kept.bytes <= room)
            room -= kept.bytes;
        else
            fs::remove(kept.path, error);
    }
    las::AtomicFile file(path, bytes.size());
    file.writeAt(0, std::as_bytes(std::span(bytes)));
    file.commit();
}

void Overview::forget() const noexcept
{
    std::error_code ignored;
    fs::remove(place(), ignored);
}

}  // namespace punctum
