# SPDX-License-Identifier: MIT
# One value, PUNCTUM_SANITIZER, for every target alike.

if(PUNCTUM_SANITIZER)
  add_compile_options(-fsanitize=${PUNCTUM_SANITIZER} -fno-omit-frame-pointer -fno-sanitize-recover=all)
  add_link_options(-fsanitize=${PUNCTUM_SANITIZER})
endif()

# Every library counts for libFuzzer which of its code an input reached.
if(PUNCTUM_FUZZERS)
  if(NOT CMAKE_CXX_COMPILER_ID MATCHES Clang)
    message(FATAL_ERROR "The fuzz targets need clang: cmake --preset fuzz")
  endif()
  add_compile_options(-fsanitize=fuzzer-no-link)
endif()
