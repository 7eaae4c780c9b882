// SPDX-License-Identifier: MIT
#pragma once

#include <type_traits>

namespace punctum::las
{

namespace detail
{
bool runGuarded(void (*work)(void*), void* context);
}

/// Calls work() and gives true; gives false when it used up the stack of this thread, at the point where it did.
///
/// For LASzip alone. Its decoders of GPS times call themselves as often as the data says ("switch to another
/// sequence and read on"), so that a run of 0xFF bytes, which is what damaged flash memory holds, ends in a
/// segmentation fault, and no check of ours can see it coming. The fault is caught on a stack of its own, as GNU
/// libsigsegv does. What work() was about is left as it was at that moment: no destructor between there and here is
/// run, so nothing in there may hold a lock or own memory that nobody else knows. Other faults go on as without us.
/// Any thread.
template <typename Work>
bool withStackGuard(Work&& work)
{
    return detail::runGuarded([](void* w) { (*static_cast<std::remove_reference_t<Work>*>(w))(); }, &work);
}

}  // namespace punctum::las
