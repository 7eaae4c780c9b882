// SPDX-License-Identifier: MIT
#include "core/las/Leftovers.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/las/AtomicFile.h"
#include "core/las/SaveManifest.h"

#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <random>
#include <string_view>
#include <system_error>

namespace punctum::las
{

namespace
{

constexpr std::size_t kLongestName = 255;
constexpr std::size_t kRandomDigits = 8;
constexpr std::string_view kMark = ".tmp-", kInstead = ".punctum";

/// What comes before the mark. A name too long to be extended has another one's place.
std::string beforeMark(const std::string& name)
{
    const std::size_t longest = kLongestName - kMark.size() - 20 - 1 - kRandomDigits;  // 20: digits of a process id
    return name.size() + 1 <= longest ? "." + name : std::string(kInstead);
}

}  // namespace

bool isRunning(long process)
{
    return ::kill(pid_t(process), 0) == 0 || errno == EPERM;
}

std::string processSuffix()
{
    std::random_device random;
    return std::to_string(long(::getpid())) + "-" + hexText(random(), int(kRandomDigits));
}

long processOfSuffix(std::string_view text)
{
    pid_t process = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), process);
    if (error != std::errc() || process <= 0) return 0;
    const std::string_view rest = text.substr(std::size_t(end - text.data()));
    const bool ours = rest.size() == 1 + kRandomDigits && rest[0] == '-' &&
                      rest.find_first_not_of("0123456789abcdef", 1) == std::string_view::npos;
    return ours ? process : 0;
}

std::string temporaryName(const std::string& name)
{
    return beforeMark(name) + std::string(kMark) + processSuffix();
}

long temporaryProcess(std::string_view temporary, const std::string& name)
{
    const std::string start = beforeMark(name) + std::string(kMark);
    return temporary.starts_with(start) ? processOfSuffix(temporary.substr(start.size())) : 0;
}

Leftovers::Leftovers(const std::filesystem::path& folder)
{
    std::error_code ec;
    for (auto it = std::filesystem::directory_iterator(folder, ec);
         !ec && it != std::filesystem::directory_iterator(); it.increment(ec)) {
        std::string name = it->path().filename().string();
        if (!name.starts_with('.')) continue;
        m_several = m_several || isManifestName(name);
        const std::size_t mark = name.rfind(kMark);
        if (mark == std::string::npos) continue;
        const long process = processOfSuffix(std::string_view(name).substr(mark + kMark.size()));
        if (process != 0 && !isRunning(process)) m_names.push_back(std::move(name));
    }
    std::sort(m_names.begin(), m_names.end());
}

std::vector<std::string> Leftovers::of(const std::filesystem::path& target) const
{
    std::vector<std::string> sentences;
    for (const std::string& name : m_names) {
        if (temporaryProcess(name, target.filename().string()) == 0) continue;
        sentences.push_back(m_several
                                ? "A save of several files was cut off, and " + shownName(name) +
                                      " beside this one may belong to it; opening them for editing finishes it."
                                : "A save of this file was cut off and left " + shownName(name) +
                                      " beside it; delete that when nothing is missing.");
    }
    return sentences;
}

std::vector<std::string> FolderLeftovers::of(const std::filesystem::path& target)
{
    const std::filesystem::path folder = folderOf(target);
    const std::lock_guard lock(m_mutex);  // while a folder is looked through, others wait for what is found
    return m_folders.try_emplace(folder, folder).first->second.of(target);
}

}  // namespace punctum::las
