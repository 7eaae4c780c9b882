// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace punctum
{

class Progress;

using JobId = std::uint64_t;

enum class JobState { Running, Finished, Failed, Cancelled };

/// When a job begins.
enum class JobTurn {
    AtOnce,  ///< in a thread of its own
    Queued,  ///< when one of few threads is free: for work that comes by the thousand
    Idle,    ///< likewise, behind all that are queued
};

/// What can be said of a job at one moment.
struct JobInfo {
    JobId id = 0;
    std::string title;  ///< what the user asked for: "Open autzen.laz"
    std::string stage;  ///< what it does now: "Reading points"
    JobState state = JobState::Running;
    bool waiting = false;   ///< for its turn; state is Running
    double fraction = 0.0;  ///< of the stage, 0 to 1
    std::string error;      ///< one sentence when state is Failed
};

/// Runs long work away from the caller's thread, each job in a thread of its own (inner loops use TBB), or, where
/// jobs come by the thousand, a bounded number of them at once, in the order they were started.
///
/// Example:
///     Jobs jobs;
///     jobs.start("Open a.laz", [=](Progress& p) { reader->read(*cloud, p); },
///                [](const JobInfo& end) { ... });       // called once, in the job's thread
///
/// The destructor cancels every job and waits for its thread. All members may be called from any thread.
class Jobs
{
public:
    using Work = std::function<void(Progress&)>;
    using Ended = std::function<void(const JobInfo&)>;

    /// `queuedAtOnce`: how many jobs that are not AtOnce run at the same time; 0: as suits the machine.
    explicit Jobs(unsigned queuedAtOnce = 0);
    ~Jobs();
    Jobs(const Jobs&) = delete;
    Jobs& operator=(const Jobs&) = delete;

    /// Starts `work`, by default at once. An Error or any std::exception that leaves it makes the job Failed,
    /// Cancelled makes it Cancelled. `ended` (may be empty) is called last, in the job's thread, also on failure.
    JobId start(std::string title, Work work, Ended ended = {}, JobTurn turn = JobTurn::AtOnce);
    /// Asks a job to stop; it does within 100 ms, and one that waits for its turn never begins. Unknown ids are
    /// ignored.
    void cancel(JobId id);
    void cancelAll();
    /// The jobs that run or wait for their turn, oldest first.
    std::vector<JobInfo> running() const;
    bool idle() const;
    /// Blocks until no job runs.
    void waitForAll();

private:
    struct Job;
    struct State;
    /// Of jobs that were cancelled before their turn: their ends are told by a thread of its own.
    void end(std::vector<std::shared_ptr<Job>> jobs);
    std::shared_ptr<State> m_state;
};

}  // namespace punctum
