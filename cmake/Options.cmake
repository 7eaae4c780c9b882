# SPDX-License-Identifier: MIT
# What can be chosen when configuring, and the settings every target shares.

option(PUNCTUM_TESTS "Build the tests" ON)
option(PUNCTUM_FUZZERS "Build the libFuzzer targets (needs clang)" OFF)
option(PUNCTUM_COVERAGE "Count which lines and branches of core are reached (gcc; tests/coverage.sh)" OFF)
option(PUNCTUM_CORE_ONLY "Only punctum-core and the tests that need no more: no Qt, no OpenGL" OFF)
option(PUNCTUM_ASSERTS "Keep assertions in optimized builds: what is tested is what people get" ON)
option(PUNCTUM_WERROR "Treat warnings as errors" ON)
set(PUNCTUM_SANITIZER "" CACHE STRING "Sanitizers to build with: empty, address,undefined or thread")
set(PUNCTUM_TEST_DATA "${PROJECT_SOURCE_DIR}/../shared/data" CACHE PATH
    "Folder of real LAS/LAZ files; tests that use it are skipped, by name, where it is not there")

if(NOT CMAKE_BUILD_TYPE)
  set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
endif()

set(CMAKE_CXX_STANDARD 20)
set(CMAKE_CXX_STANDARD_REQUIRED ON)
set(CMAKE_CXX_EXTENSIONS OFF)
set(CMAKE_POSITION_INDEPENDENT_CODE ON)
set(CMAKE_EXPORT_COMPILE_COMMANDS ON)

if(PUNCTUM_ASSERTS)
  add_compile_options(-UNDEBUG)
endif()

# punctum_no_hot_loops(TARGET): no loop over points lives there, so it is compiled sooner, with -O1.
function(punctum_no_hot_loops target)
  if(CMAKE_BUILD_TYPE STREQUAL Release)
    target_compile_options(${target} PRIVATE -O1)
  endif()
endfunction()

# Objects are shared between clones: paths below the source folder are told relative.
find_program(PUNCTUM_CCACHE ccache)
if(PUNCTUM_CCACHE)
  set(CMAKE_CXX_COMPILER_LAUNCHER
    ${CMAKE_COMMAND} -E env CCACHE_BASEDIR=${PROJECT_SOURCE_DIR} CCACHE_NOHASHDIR=1
    CCACHE_SLOPPINESS=pch_defines,time_macros ${PUNCTUM_CCACHE})
endif()
