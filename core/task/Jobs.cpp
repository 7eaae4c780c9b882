// SPDX-License-Identifier: MIT
#include "core/task/Jobs.h"

#include "core/task/Progress.h"

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <list>
#include <mutex>
#include <new>
#include <thread>

namespace punctum
{

namespace
{

// Each of them is parallel inside; a few more than cores hide what they wait for on the disk.
constexpr unsigned kFewestAtOnce = 4, kMostAtOnce = 8;

}  // namespace

struct Jobs::Job {
    JobId id = 0;
    std::string title;
    Progress progress;
    bool waiting = false;  ///< guarded by the state's mutex
    Work work;
    Ended ended;

    JobInfo describe() const
    {
        return {id, title, progress.stage(), JobState::Running, waiting, progress.fraction(), {}};
    }
    /// `begin`: false for one that was cancelled before its turn.
    void run(bool begin = true);
};

struct Jobs::State {
    mutable std::mutex mutex;
    std::condition_variable ended;
    std::list<std::shared_ptr<Job>> jobs;
    std::deque<std::shared_ptr<Job>> queued, idle;  ///< waiting for their turn
    unsigned workers = 0;                           ///< threads that take from them
    unsigned mostWorkers = 0;
    JobId lastId = 0;

    void remove(const std::shared_ptr<Job>& job);
    /// The next one whose turn it is; null: none, and the worker that asked has ended.
    std::shared_ptr<Job> next();
    /// Takes those jobs out of the queues that `which` names, for a thread that only ends them.
    template <typename Which>
    std::vector<std::shared_ptr<Job>> takeWaiting(Which which);
};

void Jobs::Job::run(bool begin)
{
    JobInfo info{id, title, {}, JobState::Finished, false, 1.0, {}};
    try {
        if (!begin) throw Cancelled();
        work(progress);
    } catch (const Cancelled&) {
        info.state = JobState::Cancelled;
    } catch (const std::bad_alloc&) {
        info.state = JobState::Failed;
        info.error = "There is not enough memory for this.";
    } catch (const std::exception& e) {
        info.state = JobState::Failed;
        info.error = e.what();
    }
    work = {};
    if (ended) ended(info);
    ended = {};
}

void Jobs::State::remove(const std::shared_ptr<Job>& job)
{
    const std::lock_guard lock(mutex);
    jobs.remove(job);
    ended.notify_all();
}

std::shared_ptr<Jobs::Job> Jobs::State::next()
{
    const std::lock_guard lock(mutex);
    std::deque<std::shared_ptr<Job>>& from = queued.empty() ? idle : queued;
    if (from.empty()) {
        --workers;
        return nullptr;
    }
    std::shared_ptr<Job> job = std::move(from.front());
    from.pop_front();
    job->waiting = false;
    return job;
}

template <typename Which>
std::vector<std::shared_ptr<Jobs::Job>> Jobs::State::takeWaiting(Which which)
{
    std::vector<std::shared_ptr<Job>> taken;
    for (std::deque<std::shared_ptr<Job>>* queue : {&queued, &idle})
        std::erase_if(*queue, [&](const std::shared_ptr<Job>& job) {
            if (!which(*job)) return false;
            job->waiting = false;
            taken.push_back(job);
            return true;
        });
    return taken;
}

Jobs::Jobs(unsigned queuedAtOnce) : m_state(std::make_shared<State>())
{
    m_state->mostWorkers = queuedAtOnce != 0
                               ? queuedAtOnce
                               : std::clamp(std::thread::hardware_concurrency(), kFewestAtOnce, kMostAtOnce);
}

Jobs::~Jobs()
{
    cancelAll();
    waitForAll();
}

JobId Jobs::start(std::string title, Work work, Ended ended, JobTurn turn)
{
    auto job = std::make_shared<Job>();
    job->title = std::move(title);
    job->work = std::move(work);
    job->ended = std::move(ended);
    JobId id = 0;
    bool newWorker = false;
    {
        const std::lock_guard lock(m_state->mutex);
        id = job->id = ++m_state->lastId;
        m_state->jobs.push_back(job);
        if (turn != JobTurn::AtOnce) {
            job->waiting = true;
            (turn == JobTurn::Queued ? m_state->queued : m_state->idle).push_back(job);
            newWorker = m_state->workers < m_state->mostWorkers;
            if (newWorker) ++m_state->workers;
        }
    }
    // Threads own the state jointly, so that they may finish their last lines while Jobs is being destroyed.
    if (turn == JobTurn::AtOnce)
        std::thread([state = m_state, job = std::move(job)] {
            job->run();
            state->remove(job);
        }).detach();
    else if (newWorker)
        std::thread([state = m_state] {
            while (const std::shared_ptr<Job> next = state->next()) {
                next->run();
                state->remove(next);
            }
        }).detach();
    return id;
}

void Jobs::end(std::vector<std::shared_ptr<Job>> jobs)
{
    if (jobs.empty()) return;
    std::thread([state = m_state, jobs = std::move(jobs)] {
        for (const std::shared_ptr<Job>& job : jobs) {
            job->run(false);
            state->remove(job);
        }
    }).detach();
}

void Jobs::cancel(JobId id)
{
    std::vector<std::shared_ptr<Job>> waiting;
    {
        const std::lock_guard lock(m_state->mutex);
        for (const auto& job : m_state->jobs)
            if (job->id == id) job->progress.cancel();
        waiting = m_state->takeWaiting([id](const Job& job) { return job.id == id; });
    }
    end(std::move(waiting));
}

void Jobs::cancelAll()
{
    std::vector<std::shared_ptr<Job>> waiting;
    {
        const std::lock_guard lock(m_state->mutex);
        for (const auto& job : m_state->jobs) job->progress.cancel();
        waiting = m_state->takeWaiting([](const Job&) { return true; });
    }
    end(std::move(waiting));
}

std::vector<JobInfo> Jobs::running() const
{
    const std::lock_guard lock(m_state->mutex);
    std::vector<JobInfo> infos;
    for (const auto& job : m_state->jobs) infos.push_back(job->describe());
    return infos;
}

bool Jobs::idle() const
{
    const std::lock_guard lock(m_state->mutex);
    return m_state->jobs.empty();
}

void Jobs::waitForAll()
{
    std::unique_lock lock(m_state->mutex);
    m_state->ended.wait(lock, [this] { return m_state->jobs.empty(); });
}

}  // namespace punctum
