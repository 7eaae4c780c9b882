// SPDX-License-Identifier: MIT
// What most tests of this folder see, read by the compiler once. Each test includes all it needs for itself.
#pragma once

#include "core/cloud/PointCloud.h"
#include "render/progressive/ProgressiveRenderer.h"
#include "render/raster/gl/GlBackend.h"

#include <QTest>

#include <glm/geometric.hpp>

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
