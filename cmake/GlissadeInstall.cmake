# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Each library has an export file of its own, so that find_package(glissade) asks a consumer for
# zlib, bzip2 or Ceres only where the part that needs them is asked for.
#
# Components, which become packages (GlissadePackages.cmake): runtime (shared libraries), dev (headers,
# static libraries, what CMake and pkg-config need), tools (the programs), vision (those that need
# OpenCV), docs.

set(glissade_cmake_dir "${CMAKE_INSTALL_LIBDIR}/cmake/glissade")
set(glissade_installed_parts)

function(glissade_install_library target part)
  if(NOT TARGET ${target})
    return()
  endif()
  install(TARGETS ${target} EXPORT ${target}Targets
    ARCHIVE DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT dev
    LIBRARY DESTINATION "${CMAKE_INSTALL_LIBDIR}" COMPONENT runtime NAMELINK_COMPONENT dev
    RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT runtime)
  install(EXPORT ${target}Targets NAMESPACE glissade:: DESTINATION "${glissade_cmake_dir}"
          COMPONENT dev)
  set(glissade_installed_parts ${glissade_installed_parts} ${part} PARENT_SCOPE)
endfunction()

glissade_install_library(glissade core)
glissade_install_library(glissade_io io)
glissade_install_library(glissade_vision vision)
glissade_install_library(glissade_ceres ceres_bridge)

# ---- For builds without CMake: pkg-config --cflags --libs glissade [glissade_io glissade_vision] ------
file(RELATIVE_PATH glissade_pc_prefix "/${CMAKE_INSTALL_LIBDIR}/pkgconfig" "/")
string(REGEX REPLACE "/$" "" glissade_pc_prefix "${glissade_pc_prefix}")
function(glissade_install_pkg_config name description requires libs)
  set(glissade_pc_name "${name}")
  set(glissade_pc_description "${description}")
  set(glissade_pc_requires "${requires}")
  set(glissade_pc_libs "${libs}")
  set(glissade_pc_cflags "-std=c++20")
  configure_file("${PROJECT_SOURCE_DIR}/cmake/glissade.pc.in" "${PROJECT_BINARY_DIR}/${name}.pc" @ONLY)
  install(FILES "${PROJECT_BINARY_DIR}/${name}.pc" DESTINATION "${CMAKE_INSTALL_LIBDIR}/pkgconfig"
          COMPONENT dev)
endfunction()

# A shared library brings along what it needs itself; a static one passes it on.
set(glissade_pc_private)
if(GLISSADE_HAVE_METIS AND NOT BUILD_SHARED_LIBS)
  set(glissade_pc_private " ${GLISSADE_METIS_LIBRARY}")
endif()
glissade_install_pkg_config(glissade "${PROJECT_DESCRIPTION}" eigen3
                            "-lglissade${glissade_pc_private} -pthread")
if(TARGET glissade_io)
  glissade_install_pkg_config(glissade_io "Files of glissade" glissade "-lglissade_io -lz -lbz2")
endif()
if(TARGET glissade_vision)
  list(TRANSFORM glissade_opencv_modules PREPEND "-lopencv_" OUTPUT_VARIABLE glissade_pc_opencv)
  list(JOIN glissade_pc_opencv " " glissade_pc_opencv)
  glissade_install_pkg_config(glissade_vision "Images for glissade" "glissade_io"
                              "-lglissade_vision -lyaml-cpp ${glissade_pc_opencv}")
endif()

if(EXISTS "${PROJECT_SOURCE_DIR}/include/glissade")
  install(DIRECTORY "${PROJECT_SOURCE_DIR}/include/glissade"
    DESTINATION "${CMAKE_INSTALL_INCLUDEDIR}" COMPONENT dev FILES_MATCHING PATTERN "*.h")
endif()
# README.md names docs/, examples/ and data/ beside it.
install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" "${PROJECT_SOURCE_DIR}/README.md"
              "${PROJECT_SOURCE_DIR}/CHANGELOG.md" "${PROJECT_SOURCE_DIR}/CONTRIBUTING.md"
        DESTINATION "${CMAKE_INSTALL_DOCDIR}" COMPONENT docs)
foreach(folder IN ITEMS docs examples data)
  if(IS_DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}")
    install(DIRECTORY "${PROJECT_SOURCE_DIR}/${folder}" DESTINATION "${CMAKE_INSTALL_DOCDIR}"
            COMPONENT docs)
  endif()
endforeach()

# Apps: those that have been built.
foreach(component IN ITEMS tools vision)
  if(GLISSADE_APP_TARGETS_${component})
    install(TARGETS ${GLISSADE_APP_TARGETS_${component}}
            RUNTIME DESTINATION "${CMAKE_INSTALL_BINDIR}" COMPONENT ${component} OPTIONAL)
  endif()
endforeach()

set(glissade_io_is_static TRUE)
if(BUILD_SHARED_LIBS)
  set(glissade_io_is_static FALSE)
endif()
configure_package_config_file("${PROJECT_SOURCE_DIR}/cmake/glissadeConfig.cmake.in"
  "${PROJECT_BINARY_DIR}/glissadeConfig.cmake" INSTALL_DESTINATION "${glissade_cmake_dir}"
  NO_SET_AND_CHECK_MACRO)
# Before 1.0 a minor version may break: only the same minor version is compatible.
write_basic_package_version_file("${PROJECT_BINARY_DIR}/glissadeConfigVersion.cmake"
  COMPATIBILITY SameMinorVersion)
install(FILES "${PROJECT_BINARY_DIR}/glissadeConfig.cmake"
              "${PROJECT_BINARY_DIR}/glissadeConfigVersion.cmake"
  DESTINATION "${glissade_cmake_dir}" COMPONENT dev)
