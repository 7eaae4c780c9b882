// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <string>

namespace punctum
{

/// Thrown by Progress::check() inside long work whose cancel was asked for. Not an Error: nothing failed.
class Cancelled : public std::exception
{
public:
    const char* what() const noexcept override { return "cancelled"; }
};

/// How far a piece of long work has come, and whether it should stop.
///
/// Shared between the thread(s) that work and the one that watches; every member may be called from any
/// thread at any time. Work must call check() (or look at cancelled()) at least every 100 ms.
class Progress
{
public:
    Progress() = default;
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;

    /// Starts a stage of `total` units (points, bytes, chunks); `stage` is shown to the user ("Reading points").
    void begin(const std::string& stage, std::uint64_t total);
    /// While one lives, the work goes on in its stage: what is part of it, and calls begin() itself, begins none.
    class Whole
    {
    public:
        Whole(Progress& progress, const std::string& stage, std::uint64_t total) : m_progress(progress)
        {
            progress.begin(stage, total);
            m_progress.m_wholes.fetch_add(1);
        }
        ~Whole() { m_progress.m_wholes.fetch_sub(1); }
        Whole(const Whole&) = delete;
        Whole& operator=(const Whole&) = delete;

    private:
        Progress& m_progress;
    };
    /// Counts `units` of the current stage as done.
    void add(std::uint64_t units) noexcept { m_done.fetch_add(units, std::memory_order_relaxed); }
    /// Share of the current stage that is done, 0 to 1.
    double fraction() const noexcept;
    std::string stage() const;

    void cancel() noexcept { m_cancelled.store(true, std::memory_order_relaxed); }
    bool cancelled() const noexcept { return m_cancelled.load(std::memory_order_relaxed); }
    /// Throws Cancelled when cancel() was called.
    void check() const
    {
        if (cancelled()) throw Cancelled();
    }

private:
    std::atomic<std::uint64_t> m_done{0};
    std::atomic<std::uint64_t> m_total{0};
    std::atomic<bool> m_cancelled{false};
    std::atomic<int> m_wholes{0};
    mutable std::mutex m_mutex;
    std::string m_stage;
};

}  // namespace punctum
