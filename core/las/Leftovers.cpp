// SPDX-License-Identifier: MIT
#include "core/las/Leftovers.h"

#include "core/Error.h"

#include <sys/types.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <csignal>
#include <cstdio>
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

bool isRunning(pid_t process)
{
    return ::kill(process, 0) == 0 || errno == EPERM;
}

/// The process of "PROCESS-RANDOM"; 0 when it is something else.
pid_t processOf(std::string_view text)
{
    long process = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), process);
    if (error != std::errc() || process <= 0) return 0;
    const std::string_view rest = text.substr(std::size_t(end - text.data()));
    const bool ours = rest.size() == 1 + kRandomDigits && rest[0] == '-' &&
                      rest.find_first_not_of("0123456789abcdef", 1) == std::string_view::npos;
    return ours ? pid_t(process) : 0;
}

}  // namespace

std::string temporaryName(const std::string& name)
{
    std::random_device random;
    char suffix[48];
    std::snprintf(suffix, sizeof suffix, "%s%ld-%08x", kMark.data(), long(::getpid()), unsigned(random()));
    return beforeMark(name) + suffix;
}

std::vector<std::string> unfinishedSaves(const std::filesystem::path& target)
{
    std::vector<std::string> sentences;
    const std::string start = beforeMark(target.filename().string()) + std::string(kMark);
    const std::filesystem::path folder = target.has_parent_path() ? target.parent_path() : ".";
    std::error_code ec;
    for (auto it = std::filesystem::directory_iterator(folder, ec);
         !ec && it != std::filesystem::directory_iterator(); it.increment(ec)) {
        const std::string name = it->path().filename().string();
        if (!name.starts_with(start)) continue;
        const pid_t process = processOf(std::string_view(name).substr(start.size()));
        if (process == 0 || isRunning(process)) continue;
        sentences.push_back("A save of this file was cut off and left " + shownName(it->path()) +
                            " beside it; delete that when nothing is missing.");
    }
    std::sort(sentences.begin(), sentences.end());
    return sentences;
}

}  // namespace punctum::las
