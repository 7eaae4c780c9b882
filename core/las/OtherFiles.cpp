// SPDX-License-Identifier: MIT
#include "core/las/OtherFiles.h"

#include <algorithm>
#include <string_view>

namespace punctum::las
{

namespace
{

using namespace std::string_view_literals;

/// A kind of file: the bytes that stand at a place in it, what it is called, and what to do with it.
struct Signature {
    std::string_view bytes;
    std::string_view name;
    std::string_view advice = {};
    std::size_t at = 0;
};

constexpr std::string_view kUnpack = "unpack it first";
constexpr std::string_view kConvert = "convert it to LAS or LAZ first";

constexpr Signature kSignatures[] = {
    {"version https://git-lfs.github.com/spec/"sv, "a pointer of Git LFS to one",
     "get the file itself with git lfs pull"},
    {"/annex/objects/"sv, "a pointer of git-annex to one", "get the file itself with git annex get"},
    {"PK\x03\x04"sv, "a ZIP archive", kUnpack},
    {"PK\x05\x06"sv, "an empty ZIP archive"},
    {"\x1F\x8B"sv, "a file compressed by gzip", kUnpack},
    {"BZh"sv, "a file compressed by bzip2", kUnpack},
    {"\xFD\x37zXZ\0"sv, "a file compressed by xz", kUnpack},
    {"\x28\xB5\x2F\xFD"sv, "a file compressed by Zstandard", kUnpack},
    {"7z\xBC\xAF\x27\x1C"sv, "a 7z archive", kUnpack},
    {"Rar!\x1A\x07"sv, "a RAR archive", kUnpack},
    {"ustar"sv, "a tar archive", kUnpack, 257},
    {"ASTM-E57"sv, "an E57 file", kConvert},
    {"ply\n"sv, "a PLY file", kConvert},
    {"ply\r"sv, "a PLY file", kConvert},
    {"# .PCD"sv, "a PCD file", kConvert},
    {"CCB2"sv, "a file of CloudCompare (BIN)", kConvert},
    {"%PDF"sv, "a PDF document"},
    {"\x89PNG\r\n\x1A\n"sv, "a PNG picture"},
    {"\xFF\xD8\xFF"sv, "a JPEG picture"},
    {"II*\0"sv, "a TIFF picture"},
    {"MM\0*"sv, "a TIFF picture"},
    {"II+\0"sv, "a TIFF picture"},
    {"\0\0\x27\x0A"sv, "a shapefile"},
    {"SQLite format 3\0"sv, "an SQLite database"},
    {"\x89HDF\r\n\x1A\n"sv, "an HDF5 file"},
    {"glTF"sv, "a glTF model"},
    {"PAR1"sv, "a Parquet file"},
    {"\x7F"
     "ELF"sv,
     "a program"},
    {"<?xml"sv, "an XML document"},
    {"{"sv, "a JSON document"},
};

std::string sentence(std::string_view name, std::string_view advice)
{
    return "This is not a LAS file but " + std::string(name) + (advice.empty() ? "" : "; " + std::string(advice)) +
           ".";
}

bool beginsLike(std::string_view text, std::string_view lower)
{
    return text.size() >= lower.size() && std::equal(lower.begin(), lower.end(), text.begin(), [](char l, char c) {
               return l == (c >= 'A' && c <= 'Z' ? char(c - 'A' + 'a') : c);
           });
}

}  // namespace

std::string whatInstead(std::span<const std::byte> head)
{
    if (head.empty()) return "The file is empty.";
    std::string_view text(reinterpret_cast<const char*>(head.data()), head.size());
    const auto isZero = [](char c) { return c == '\0'; };
    if (std::all_of(text.begin(), text.end(), isZero))
        return "This is not a LAS file: it begins with nothing but zero bytes, as after an interrupted copy.";
    for (const Signature& kind : kSignatures)
        if (kind.at < text.size() && text.substr(kind.at).starts_with(kind.bytes))
            return sentence(kind.name, kind.advice);

    // Texts may begin with a byte order mark and with blanks.
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
    for (const std::string_view page : {"<!doctype html"sv, "<html"sv, "<head"sv, "<body"sv})
        if (beginsLike(text, page))
            return sentence("a web page", "the link or the login may have failed, so download the file again");
    for (const Signature& kind : kSignatures)
        if (kind.at == 0 && text.starts_with(kind.bytes)) return sentence(kind.name, kind.advice);
    const bool printable = std::all_of(text.begin(), text.end(), [](char c) {
        return static_cast<unsigned char>(c) >= 0x20 || c == '\t' || c == '\r' || c == '\n';
    });
    if (printable) return sentence("a text", "points in lines of text must be converted to LAS or LAZ first");
    return {};
}

}  // namespace punctum::las
