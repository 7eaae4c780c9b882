# SPDX-License-Identifier: MIT
# Everything Punctum builds on. Nothing is fetched: packaging/setup.sh installs what is missing.

include(CoreDependencies)
find_package(nlohmann_json REQUIRED)
if(NOT PUNCTUM_CORE_ONLY)
  find_package(CLI11 REQUIRED)
  pkg_check_modules(EPOXY REQUIRED IMPORTED_TARGET epoxy)
  pkg_check_modules(EGL REQUIRED IMPORTED_TARGET egl)
  find_package(Qt6 6.4 REQUIRED COMPONENTS Core Gui Widgets OpenGL OpenGLWidgets)
  if(PUNCTUM_TESTS)
    find_package(Qt6 6.4 REQUIRED COMPONENTS Test)
  endif()
endif()
