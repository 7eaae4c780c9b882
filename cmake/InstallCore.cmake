# SPDX-License-Identifier: MIT
# punctum-core for other programs: headers, library and a CMake package (docs/dev/example is such a program).
include(GNUInstallDirs)
include(CMakePackageConfigHelpers)

set(package ${CMAKE_INSTALL_LIBDIR}/cmake/punctum-core)
install(TARGETS punctum-core EXPORT punctum-core
  ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR} COMPONENT devel)
install(DIRECTORY ${PROJECT_SOURCE_DIR}/core DESTINATION ${CMAKE_INSTALL_INCLUDEDIR}/punctum COMPONENT devel
  FILES_MATCHING PATTERN "*.h")
install(EXPORT punctum-core FILE punctum-core-targets.cmake NAMESPACE punctum:: DESTINATION ${package} COMPONENT devel)
file(CONFIGURE OUTPUT punctum-core-config.cmake @ONLY CONTENT
"list(PREPEND CMAKE_MODULE_PATH \${CMAKE_CURRENT_LIST_DIR})
include(CoreDependencies)
list(POP_FRONT CMAKE_MODULE_PATH)
include(\${CMAKE_CURRENT_LIST_DIR}/punctum-core-targets.cmake)
")
write_basic_package_version_file(${CMAKE_CURRENT_BINARY_DIR}/punctum-core-config-version.cmake
  COMPATIBILITY SameMinorVersion)
install(FILES ${CMAKE_CURRENT_BINARY_DIR}/punctum-core-config.cmake
  ${CMAKE_CURRENT_BINARY_DIR}/punctum-core-config-version.cmake ${PROJECT_SOURCE_DIR}/cmake/CoreDependencies.cmake
  DESTINATION ${package} COMPONENT devel)
