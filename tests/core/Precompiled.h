// SPDX-License-Identifier: MIT
// What most tests of this folder see, read by the compiler once. Each test includes all it needs for itself.
#pragma once

// clang-format off: TBB uses "emit" as a name, which Qt makes a macro
#include <tbb/parallel_for.h>
#include <tbb/parallel_reduce.h>
// clang-format on

#include "core/cloud/PointCloud.h"
#include "core/las/Reader.h"
#include "core/task/Progress.h"

#include <QProcess>
#include <QTemporaryDir>
#include <QTest>

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <random>
#include <set>
#include <span>
#include <string>
#include <thread>
#include <vector>
