// SPDX-License-Identifier: MIT
#include "core/las/StackGuard.h"

#include <pthread.h>
#include <sys/mman.h>

#include <csetjmp>
#include <csignal>
#include <cstddef>
#include <cstdint>

namespace punctum::las::detail
{

namespace
{

constexpr std::size_t kHandlerStack = std::size_t(64) << 10;
/// How far from the stack's lowest byte an overflow faults: within it or its guard pages (a thread's), or in the
/// gap that the kernel keeps below the first thread's.
constexpr std::uintptr_t kBelow = std::uintptr_t(1) << 20, kAbove = std::uintptr_t(64) << 10;

/// Where a thread goes on; null when it is not inside work().
constinit thread_local sigjmp_buf* threadGoesOn = nullptr;
constinit thread_local std::uintptr_t threadLowest = 0;

struct sigaction handlerBefore;

void onFault(int signal, siginfo_t* info, void* context)
{
    const auto address = reinterpret_cast<std::uintptr_t>(info->si_addr);
    if (threadGoesOn != nullptr && address + kBelow >= threadLowest && address < threadLowest + kAbove)
        siglongjmp(*threadGoesOn, 1);
    // Somebody else's: the handler before ours, or the end of the program when the fault happens again.
    if ((handlerBefore.sa_flags & SA_SIGINFO) != 0)
        handlerBefore.sa_sigaction(signal, info, context);
    else if (handlerBefore.sa_handler != SIG_DFL && handlerBefore.sa_handler != SIG_IGN)
        handlerBefore.sa_handler(signal);
    else
        ::sigaction(signal, &handlerBefore, nullptr);
}

void installHandler()
{
    struct sigaction action {
    };
    action.sa_sigaction = onFault;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
    sigemptyset(&action.sa_mask);
    ::sigaction(SIGSEGV, &action, &handlerBefore);
}

/// The stack that the handler runs on, since the thread's own is full. For the life of the thread.
class HandlerStack
{
public:
    HandlerStack()
    {
        pthread_attr_t attributes;
        void* lowest = nullptr;
        std::size_t size = 0;
        if (pthread_getattr_np(pthread_self(), &attributes) != 0) return;
        if (pthread_attr_getstack(&attributes, &lowest, &size) == 0)
            threadLowest = reinterpret_cast<std::uintptr_t>(lowest);
        pthread_attr_destroy(&attributes);

        stack_t there{};
        if (::sigaltstack(nullptr, &there) == 0 && (there.ss_flags & SS_DISABLE) == 0) {
            m_ready = threadLowest != 0;  // somebody else's (a sanitizer's) will do
            return;
        }
        void* memory = ::mmap(nullptr, kHandlerStack, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        if (memory == MAP_FAILED) return;
        stack_t ours{};
        ours.ss_sp = memory;
        ours.ss_size = kHandlerStack;
        if (::sigaltstack(&ours, nullptr) != 0) {
            ::munmap(memory, kHandlerStack);
            return;
        }
        m_memory = memory;
        m_ready = threadLowest != 0;
    }
    ~HandlerStack()
    {
        if (m_memory == nullptr) return;
        stack_t none{};
        none.ss_flags = SS_DISABLE;
        if (::sigaltstack(&none, nullptr) == 0) ::munmap(m_memory, kHandlerStack);
    }
    HandlerStack(const HandlerStack&) = delete;
    HandlerStack& operator=(const HandlerStack&) = delete;

    bool ready() const { return m_ready; }

private:
    void* m_memory = nullptr;
    bool m_ready = false;
};

}  // namespace

bool runGuarded(void (*work)(void*), void* context)
{
    static const bool installed = [] {
        installHandler();
        return true;
    }();
    thread_local const HandlerStack stack;
    if (!installed || !stack.ready() || threadGoesOn != nullptr) {
        work(context);
        return true;
    }
    /// Also when work() throws.
    struct Forget {
        ~Forget() { threadGoesOn = nullptr; }
    };
    sigjmp_buf here;
    if (sigsetjmp(here, 0) != 0) {
        threadGoesOn = nullptr;
        return false;
    }
    const Forget forget;
    threadGoesOn = &here;
    work(context);
    return true;
}

}  // namespace punctum::las::detail
