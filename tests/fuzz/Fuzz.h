// SPDX-License-Identifier: MIT
#pragma once

#include "core/Error.h"
#include "core/las/PointFormat.h"

#include <tbb/global_control.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

/// What the fuzz targets share. A target is one function, LLVMFuzzerTestOneInput, which libFuzzer calls with inputs
/// it thinks of, and which Replay.cpp calls with those that are kept. Whatever the input, the code under test gives
/// a result or throws punctum::Error; anything else that it throws, and every broken promise, ends the program.
namespace fuzz
{

/// Ends the program, and with it the fuzzer, saying what was promised.
inline void promise(bool kept, const char* what)
{
    if (kept) return;
    std::fprintf(stderr, "promise not kept: %s\n", what);
    std::abort();
}

/// An Error is one sentence for a user.
inline void checkSentence(const punctum::Error& e)
{
    const std::string said = e.what();
    promise(said.find('\n') == std::string::npos, "an error is one line");
    promise(said.ends_with('.') || said.ends_with(')') || said.ends_with('?'), "an error is a sentence");
}
/// So is a warning.
inline void checkSentences(const std::vector<std::string>& warnings)
{
    for (const std::string& w : warnings) {
        promise(w.find('\n') == std::string::npos, "a warning is one line");
        promise(w.ends_with('.'), "a warning is a sentence");
    }
}

/// The fields of a record's layout cover it without gap or overlap.
inline void checkLayout(const punctum::las::RecordLayout& layout)
{
    std::uint32_t at = 0;
    for (const punctum::las::RecordField& f : layout.fields) {
        promise(f.offset == at, "fields follow one another");
        promise(f.bytes() > 0, "a field has bytes");
        at += f.bytes();
    }
    promise(at == layout.length, "the fields cover the record");
    promise(layout.attributeFields.size() == layout.attributes.size(), "each attribute has its fields");
    for (const auto& fields : layout.attributeFields)
        for (const std::int32_t f : fields)
            promise(f >= -1 && f < std::int32_t(layout.fields.size()), "an attribute's fields exist");
}

/// A file in memory that has a path, for code that opens files by name.
class MemoryFile
{
public:
    MemoryFile() : m_descriptor(::memfd_create("punctum-fuzz", MFD_CLOEXEC))
    {
        if (m_descriptor < 0) {
            std::perror("memfd_create");
            std::exit(2);
        }
        m_path = "/proc/self/fd/" + std::to_string(m_descriptor);
    }
    ~MemoryFile() { ::close(m_descriptor); }
    MemoryFile(const MemoryFile&) = delete;
    MemoryFile& operator=(const MemoryFile&) = delete;

    const std::filesystem::path& path() const { return m_path; }
    void set(std::span<const std::byte> bytes)
    {
        const bool written = ::ftruncate(m_descriptor, 0) == 0 &&
                             ::pwrite(m_descriptor, bytes.data(), bytes.size(), 0) == ssize_t(bytes.size());
        promise(written, "there is memory for the input");
    }

private:
    int m_descriptor = -1;
    std::filesystem::path m_path;
};

/// All of TBB in one thread, so that an input does the same each time and the machine stays usable.
inline void oneThread()
{
    static const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
}

/// Takes the input's first bytes as parameters; zeros when it is too short.
class Input
{
public:
    Input(const std::uint8_t* data, std::size_t size) : m_bytes(reinterpret_cast<const std::byte*>(data), size) {}

    template <typename T>
    T take()
    {
        T v{};
        const std::size_t n = std::min(sizeof v, m_bytes.size());
        if (n != 0) std::memcpy(&v, m_bytes.data(), n);
        m_bytes = m_bytes.subspan(n);
        return v;
    }
    std::span<const std::byte> take(std::size_t bytes)
    {
        const auto part = m_bytes.first(std::min(bytes, m_bytes.size()));
        m_bytes = m_bytes.subspan(part.size());
        return part;
    }
    std::span<const std::byte> rest() const { return m_bytes; }

private:
    std::span<const std::byte> m_bytes;
};

}  // namespace fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);
