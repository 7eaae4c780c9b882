// SPDX-License-Identifier: MIT
#pragma once

#include "render/progressive/DisplaySettings.h"
#include "render/raster/Backend.h"

namespace punctum::app
{

/// What the user's window draws with, by its settings.
struct WindowLook {
    render::DisplaySettings display;
    render::BackendKind backend = render::BackendKind::Cpu;  ///< chosen there, or found to be the fastest
};
WindowLook windowLook();

/// Opens the window with the files named on the command line, and runs until it is closed; the exit code.
int runWindowed(int argc, char** argv);

}  // namespace punctum::app
