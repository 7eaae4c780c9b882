// SPDX-License-Identifier: MIT
#include "core/task/Jobs.h"

#include "core/task/Progress.h"

#include <condition_variable>
#include <list>
#include <mutex>
#include <new>
#include <thread>

namespace punctum
{

namespace
{

struct Job {
    JobId id = 0;
    std::string title;
    Progress progress;
};

JobInfo describe(const Job& job)
{
    return {job.id, job.title, job.progress.stage(), JobState::Running, job.progress.fraction(), {}};
}

}  // namespace

struct Jobs::State {
    mutable std::mutex mutex;
    std::condition_variable ended;
    std::list<std::shared_ptr<Job>> jobs;
    JobId lastId = 0;
};

Jobs::Jobs() : m_state(std::make_shared<State>()) {}

Jobs::~Jobs()
{
    cancelAll();
    waitForAll();
}

JobId Jobs::start(std::string title, Work work, Ended ended)
{
    auto job = std::make_shared<Job>();
    job->title = std::move(title);
    {
        const std::lock_guard lock(m_state->mutex);
        job->id = ++m_state->lastId;
        m_state->jobs.push_back(job);
    }
    // The thread owns the state jointly, so that it may finish its last lines while Jobs is being destroyed.
    std::thread([state = m_state, job, work = std::move(work), ended = std::move(ended)]() mutable {
        JobInfo info{job->id, job->title, {}, JobState::Finished, 1.0, {}};
        try {
            work(job->progress);
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
        const std::lock_guard lock(state->mutex);
        state->jobs.remove(job);
        state->ended.notify_all();
    }).detach();
    return job->id;
}

void Jobs::cancel(JobId id)
{
    const std::lock_guard lock(m_state->mutex);
    for (const auto& job : m_state->jobs)
        if (job->id == id) job->progress.cancel();
}

void Jobs::cancelAll()
{
    const std::lock_guard lock(m_state->mutex);
    for (const auto& job : m_state->jobs) job->progress.cancel();
}

std::vector<JobInfo> Jobs::running() const
{
    const std::lock_guard lock(m_state->mutex);
    std::vector<JobInfo> infos;
    for (const auto& job : m_state->jobs) infos.push_back(describe(*job));
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
