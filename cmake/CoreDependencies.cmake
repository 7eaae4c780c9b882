# SPDX-License-Identifier: MIT
# What punctum-core builds on. Also installed, for programs that use the library: its package finds the same.

find_package(Threads REQUIRED)
find_package(PkgConfig REQUIRED)
find_package(TBB REQUIRED)
find_package(glm REQUIRED)
if(NOT TARGET glm::glm)
  add_library(glm::glm ALIAS glm)
endif()
pkg_check_modules(PROJ REQUIRED IMPORTED_TARGET proj)
pkg_check_modules(TIFF REQUIRED IMPORTED_TARGET libtiff-4)
pkg_check_modules(ZLIB REQUIRED IMPORTED_TARGET zlib)

# LASzip: the library and its C header, nothing of its header struct (see docs/dev/las.md).
find_path(LASZIP_INCLUDE_DIR laszip/laszip_api.h REQUIRED)
find_library(LASZIP_LIBRARY laszip REQUIRED)
if(NOT TARGET laszip::laszip)
  add_library(laszip::laszip UNKNOWN IMPORTED)
  set_target_properties(laszip::laszip PROPERTIES
    IMPORTED_LOCATION ${LASZIP_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${LASZIP_INCLUDE_DIR})
endif()

# libgeotiff, which has no file for pkg-config everywhere.
find_path(GEOTIFF_INCLUDE_DIR geotiff/geotiff.h REQUIRED)
find_library(GEOTIFF_LIBRARY geotiff REQUIRED)
if(NOT TARGET geotiff::geotiff)
  add_library(geotiff::geotiff UNKNOWN IMPORTED)
  set_target_properties(geotiff::geotiff PROPERTIES
    IMPORTED_LOCATION ${GEOTIFF_LIBRARY} INTERFACE_INCLUDE_DIRECTORIES ${GEOTIFF_INCLUDE_DIR})
endif()
