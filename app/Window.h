// SPDX-License-Identifier: MIT
#pragma once

namespace punctum::app
{

/// Opens the window with the files named on the command line, and runs until it is closed; the exit code.
int runWindowed(int argc, char** argv);

}  // namespace punctum::app
