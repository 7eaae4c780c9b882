# SPDX-License-Identifier: MIT
# The warnings every target of ours is built with: link punctum-warnings PRIVATE.

add_library(punctum-warnings INTERFACE)
target_compile_options(punctum-warnings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -Wold-style-cast -Wcast-qual -Woverloaded-virtual
  -Wformat=2 -Wimplicit-fallthrough $<$<BOOL:${PUNCTUM_WERROR}>:-Werror>
  # g++ 12 reports false positives of these inside its own library and TBB when optimizing
  $<$<CXX_COMPILER_ID:GNU>:-Wno-stringop-overflow -Wno-array-bounds -Wno-stringop-overread
  -Wno-maybe-uninitialized -Wno-restrict>
  # files that are compiled together are included, and what is in their unnamed namespaces is nobody else's all the same
  $<$<AND:$<CXX_COMPILER_ID:GNU>,$<BOOL:${CMAKE_UNITY_BUILD}>>:-Wno-subobject-linkage>)
