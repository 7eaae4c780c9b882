// SPDX-License-Identifier: MIT
#pragma once

namespace punctum
{
class Progress;
}

namespace punctum::app
{

/// While it lives, Ctrl+C (SIGINT), SIGTERM and SIGHUP cancel a Progress, so that the work ends in order and leaves
/// no half-written file behind. A second Ctrl+C ends the program at once. One at a time.
class Interrupt
{
public:
    explicit Interrupt(Progress& progress);
    ~Interrupt();
    Interrupt(const Interrupt&) = delete;
    Interrupt& operator=(const Interrupt&) = delete;
};

}  // namespace punctum::app
