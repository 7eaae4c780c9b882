# SPDX-License-Identifier: MIT
# Everything Punctum builds on. Nothing is fetched: packaging/setup.sh installs what is missing.

include(CoreDependencies)
find_package(nlohmann_json REQUIRED)
# What tests and `punctum bench process` compare with; the other parts of PCL are linked by name, since their modules want VTK.
# PCL's own modules set FLANN_ROOT, which later versions of CMake warn of.
if(PUNCTUM_TESTS OR NOT PUNCTUM_CORE_ONLY)
  set(CMAKE_POLICY_DEFAULT_CMP0144 NEW)
  find_package(PCL 1.13 REQUIRED COMPONENTS common kdtree search)
endif()
if(NOT PUNCTUM_CORE_ONLY)
  find_package(CLI11 REQUIRED)
  pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
  pkg_check_modules(EGL REQUIRED IMPORTED_TARGET egl)
  find_package(Qt6 6.4 REQUIRED COMPONENTS Core Gui Widgets OpenGL OpenGLWidgets)
  if(PUNCTUM_TESTS)
    find_package(Qt6 6.4 REQUIRED COMPONENTS Test)
  endif()
endif()
