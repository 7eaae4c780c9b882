// SPDX-License-Identifier: MIT
#pragma once

#include <nlohmann/json.hpp>

#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <thread>

namespace punctum
{
class Progress;
}

namespace punctum::app
{

using Json = nlohmann::ordered_json;

/// A bar on stderr that follows a Progress for as long as it lives; nothing when stderr is not a terminal.
///
/// Drawn by a thread of its own, so that the work need not know of it. The Progress must outlive it.
class ProgressBar
{
public:
    explicit ProgressBar(const Progress& progress);
    /// Wipes the bar off the terminal.
    ~ProgressBar();
    ProgressBar(const ProgressBar&) = delete;
    ProgressBar& operator=(const ProgressBar&) = delete;

private:
    void draw();

    const Progress& m_progress;
    std::mutex m_mutex;
    std::condition_variable m_wake;
    bool m_end = false;
    std::thread m_thread;
};

/// Writes to stdout, at once. Throws Error when it cannot be written in full (a full disk).
void print(std::string_view text);
/// JSON and a line end to stdout; bytes that are not UTF-8 are replaced. Throws Error like print().
void printJson(const Json& value);
/// "punctum: SENTENCE" to stderr.
void complain(std::string_view sentence);
/// "Note: SENTENCE" to stderr.
void note(std::string_view sentence);

}  // namespace punctum::app
