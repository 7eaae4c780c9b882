// SPDX-License-Identifier: MIT
// The list of a save of several files: lines, whose sums are added, or a whole one. What is understood asks for
// nothing but temporary files of ours, plain names and absolute folders; written and read again it is the same.
#include "core/SummedText.h"
#include "core/las/Leftovers.h"
#include "core/las/SaveManifest.h"
#include "tests/fuzz/Fuzz.h"

using namespace punctum;
using fuzz::promise;

namespace
{

std::string withSums(std::string_view lines)
{
    std::uint32_t sum = 0;
    std::string text;
    while (!lines.empty()) {
        const std::size_t end = std::min(lines.find('\n'), lines.size());
        text += summed(std::string(lines.substr(0, end)), sum);
        lines.remove_prefix(std::min(end + 1, lines.size()));
    }
    return text;
}

bool plain(const std::string& name)
{
    return !name.empty() && name != "." && name != ".." &&
           name.find_first_of(std::string_view("/\0", 2)) == name.npos;
}

void check(const std::string& text)
{
    las::SaveManifest manifest;
    if (las::parseManifest(text, manifest) != las::ManifestState::Whole) return;
    promise(manifest.decider.empty() || (manifest.decider.is_absolute() && manifest.others.empty()),
            "one folder decides");
    for (const auto& folder : manifest.others) promise(folder.is_absolute(), "folders are absolute");
    for (const las::ManifestEntry& entry : manifest.files) {
        promise(plain(entry.temporary) && plain(entry.target), "names are plain");
        promise(las::temporaryProcess(entry.temporary, entry.target) != 0, "what is renamed is a temporary file");
    }
    const std::string written = las::manifestText(manifest);
    las::SaveManifest again;
    promise(las::parseManifest(written, again) == las::ManifestState::Whole, "what is written can be read");
    promise(las::manifestText(again) == written, "and is the same");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size)
{
    const std::string text(reinterpret_cast<const char*>(data), size);
    check(text);
    check(withSums(text));
    return 0;
}
