# SPDX-License-Identifier: MIT
# Everything Punctum builds on. Nothing is fetched: packaging/setup.sh installs what is missing.

find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(TBB REQUIRED)
find_package(glm REQUIRED)
if(NOT TARGET glm::glm)
  add_library(glm::glm ALIAS glm)
endif()
pkg_check_modules(PROJ REQUIRED IMPORTED_TARGET proj)
if(NOT PUNCTUM_CORE_ONLY)
  find_package(nlohmann_json REQUIRED)
  find_package(CLI11 REQUIRED)
  pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
  pkg_check_modules(EGL REQUIRED IMPORTED_TARGET egl)
  find_package(Qt6 6.4 REQUIRED COMPONENTS Core Gui Widgets OpenGL OpenGLWidgets)
  if(PUNCTUM_TESTS)
    find_package(Qt6 6.4 REQUIRED COMPONENTS Test)
  endif()
endif()
# PCL's own modules set FLANN_ROOT, which later versions of CMake warn of.
set(CMAKE_POLICY_DEFAULT_CMP0144 NEW)
find_package(PCL 1.13 REQUIRED COMPONENTS common kdtree search)

# LASzip: the library and its C header, nothing of its header struct (see docs/dev/las.md).
find_path(LASZIP_INCLUDE_DIR laszip/laszip_api.h REQUIRED)
find_library(LASZIP_LIBRARY laszip REQUIRED)
add_library(laszip::laszip UNKNOWN IMPORTED)
set_target_properties(laszip::laszip PROPERTIES
  IMPORTED_LOCATION ${LASZIP_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LASZIP_INCLUDE_DIR})
