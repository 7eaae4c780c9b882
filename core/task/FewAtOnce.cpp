// SPDX-License-Identifier: MIT
#include "core/task/FewAtOnce.h"

#include <algorithm>
#include <atomic>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

namespace punctum
{

void fewAtOnce(std::size_t count, std::size_t atOnce, const std::function<void(std::size_t)>& task)
{
    std::atomic<std::size_t> next{0};
    std::atomic<bool> failed{false};
    std::mutex mutex;
    std::exception_ptr thrown;
    std::size_t thrower = count;
    const auto work = [&] {
        while (!failed.load()) {
            const std::size_t k = next.fetch_add(1);
            if (k >= count) return;
            try {
                task(k);
            } catch (...) {
                const std::lock_guard lock(mutex);
                if (k < thrower) {
                    thrower = k;
                    thrown = std::current_exception();
                }
                failed.store(true);
            }
        }
    };
    std::vector<std::thread> threads;
    for (std::size_t k = 1; k < std::min(count, atOnce); ++k) {
        try {
            threads.emplace_back(work);
        } catch (const std::system_error&) {
            break;  // then fewer do it all
        }
    }
    work();
    for (std::thread& thread : threads) thread.join();
    if (thrown) std::rethrow_exception(thrown);
}

}  // namespace punctum
