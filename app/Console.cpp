// SPDX-License-Identifier: MIT
#include "app/Console.h"

#include "core/Error.h"
#include "core/Text.h"
#include "core/task/Progress.h"

#include <unistd.h>

#include <chrono>
#include <cstdio>

namespace punctum::app
{

namespace
{

using namespace std::chrono_literals;

/// Short work ends before a bar would be worth looking at.
constexpr auto kDelay = 300ms;
constexpr auto kPeriod = 100ms;
constexpr int kBarWidth = 30;

/// A bar that may stand on the terminal's line makes room for what is written next.
void wipeBar()
{
    if (isatty(STDERR_FILENO) == 1) std::fputs("\r\033[K", stderr);
}

}  // namespace

ProgressBar::ProgressBar(const Progress& progress) : m_progress(progress)
{
    if (isatty(STDERR_FILENO) != 1) return;
    m_thread = std::thread([this] { draw(); });
}

ProgressBar::~ProgressBar()
{
    if (!m_thread.joinable()) return;
    {
        const std::lock_guard lock(m_mutex);
        m_end = true;
    }
    m_wake.notify_one();
    m_thread.join();
}

void ProgressBar::draw()
{
    std::unique_lock lock(m_mutex);
    if (m_wake.wait_for(lock, kDelay, [this] { return m_end; })) return;
    do {
        const double fraction = m_progress.fraction();
        const int filled = int(fraction * kBarWidth + 0.5);
        const std::string bar =
            std::string(std::size_t(filled), '#') + std::string(std::size_t(kBarWidth - filled), '.');
        std::fprintf(stderr, "\r\033[K[%s] %3d %%  %s", bar.c_str(), int(fraction * 100),
                     m_progress.stage().c_str());
        std::fflush(stderr);
    } while (!m_wake.wait_for(lock, kPeriod, [this] { return m_end; }));
    wipeBar();
    std::fflush(stderr);
}

namespace
{

void writeOut(const std::string& text)
{
    wipeBar();
    if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
        throw Error("The result could not be written to standard output; is the disk full?");
}

}  // namespace

void print(std::string_view text)
{
    writeOut(printable(text, true));  // files hold whatever they like
}

void printJson(const Json& value)
{
    const std::string text = value.dump(2, ' ', false, Json::error_handler_t::replace);
    // What JSON may hold as it is and a terminal may not, only occurs in strings: there it can be escaped.
    writeOut(
        withoutControls(text, [](char32_t c) { return c == '\n' ? std::string("\n") : "\\u" + hexText(c, 4); }) +
        "\n");
}

void complain(std::string_view sentence)
{
    wipeBar();
    std::fprintf(stderr, "punctum: %s\n", printable(sentence).c_str());
}

void note(std::string_view sentence)
{
    wipeBar();
    std::fprintf(stderr, "Note: %s\n", printable(sentence).c_str());
}

}  // namespace punctum::app
