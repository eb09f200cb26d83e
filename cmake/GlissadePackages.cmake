# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# cpack in the build folder makes Debian packages of the components of GlissadeInstall.cmake:
#
#   libglissade0.1    shared libraries, where BUILD_SHARED_LIBS is set: named by their SOVERSION, so that
#                     those of two minor versions can be installed side by side
#   libglissade-dev   headers, static libraries, files for CMake and pkg-config
#   glissade-tools    programs, manual pages, completions
#   glissade-vision   vio_run and sim_images, which need OpenCV and the eighty packages that it needs
#   glissade-doc      documentation, examples, small data
#
# What programs and shared libraries depend on is found by dpkg-shlibdeps. scripts/check_deb.sh installs
# them in a clean Debian.

set(CPACK_GENERATOR DEB)
set(CPACK_PACKAGE_NAME glissade)
set(CPACK_PACKAGE_VENDOR "The glissade authors")
set(CPACK_PACKAGE_CONTACT "The glissade authors")
set(CPACK_PACKAGE_DESCRIPTION_SUMMARY "${PROJECT_DESCRIPTION}")
set(CPACK_RESOURCE_FILE_LICENSE "${PROJECT_SOURCE_DIR}/LICENSE")
set(CPACK_PACKAGE_DIRECTORY "${PROJECT_BINARY_DIR}/packages")
set(CPACK_PACKAGING_INSTALL_PREFIX /usr)
set(CPACK_STRIP_FILES ON)
set(CPACK_DEB_COMPONENT_INSTALL ON)
set(CPACK_DEBIAN_FILE_NAME DEB-DEFAULT)
set(CPACK_DEBIAN_PACKAGE_SECTION science)
set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS ON)
set(CPACK_DEBIAN_PACKAGE_CONTROL_STRICT_PERMISSION ON)

set(CPACK_DEBIAN_RUNTIME_PACKAGE_NAME libglissade${glissade_soversion})
set(CPACK_DEBIAN_DEV_PACKAGE_NAME libglissade-dev)
set(CPACK_DEBIAN_TOOLS_PACKAGE_NAME glissade-tools)
set(CPACK_DEBIAN_VISION_PACKAGE_NAME glissade-vision)
set(CPACK_DEBIAN_DOCS_PACKAGE_NAME glissade-doc)
set(about "${PROJECT_DESCRIPTION}")
set(CPACK_COMPONENT_RUNTIME_DESCRIPTION "${about}: shared libraries")
set(CPACK_COMPONENT_DEV_DESCRIPTION "${about}: headers and libraries for C++20")
set(CPACK_COMPONENT_TOOLS_DESCRIPTION "${about}: programs")
set(CPACK_COMPONENT_VISION_DESCRIPTION "${about}: programs that read images")
set(CPACK_COMPONENT_DOCS_DESCRIPTION "${about}: documentation and examples")

set(same_version "(= ${PROJECT_VERSION})")
set(glissade_dev_depends libeigen3-dev)
if(TARGET glissade_io)
  list(APPEND glissade_dev_depends zlib1g-dev libbz2-dev)
endif()
if(BUILD_SHARED_LIBS)
  list(APPEND glissade_dev_depends "${CPACK_DEBIAN_RUNTIME_PACKAGE_NAME} ${same_version}")
  set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS ON)
  set(CPACK_DEBIAN_PACKAGE_GENERATE_SHLIBS_POLICY "=")
  set(CPACK_DEBIAN_PACKAGE_SHLIBDEPS_PRIVATE_DIRS "${PROJECT_BINARY_DIR}/src")
  set(CPACK_DEBIAN_TOOLS_PACKAGE_DEPENDS "${CPACK_DEBIAN_RUNTIME_PACKAGE_NAME} ${same_version}")
  set(CPACK_DEBIAN_VISION_PACKAGE_DEPENDS "${CPACK_DEBIAN_RUNTIME_PACKAGE_NAME} ${same_version}, ")
elseif(GLISSADE_HAVE_METIS)
  list(APPEND glissade_dev_depends libmetis-dev)
endif()
list(JOIN glissade_dev_depends ", " CPACK_DEBIAN_DEV_PACKAGE_DEPENDS)
set(CPACK_DEBIAN_DEV_PACKAGE_SUGGESTS "libceres-dev, libopencv-calib3d-dev, \
libopencv-imgcodecs-dev, libopencv-video-dev, libyaml-cpp-dev, glissade-doc")
set(CPACK_DEBIAN_TOOLS_PACKAGE_SUGGESTS "glissade-vision, glissade-doc")
string(APPEND CPACK_DEBIAN_VISION_PACKAGE_DEPENDS "glissade-tools ${same_version}")
set(CPACK_DEBIAN_DOCS_PACKAGE_ARCHITECTURE all)

set(CPACK_COMPONENTS_ALL dev docs)
if(BUILD_SHARED_LIBS)
  list(APPEND CPACK_COMPONENTS_ALL runtime)
endif()
foreach(component IN ITEMS tools vision)
  if(GLISSADE_APP_TARGETS_${component})
    list(APPEND CPACK_COMPONENTS_ALL ${component})
  endif()
endforeach()
foreach(component IN LISTS CPACK_COMPONENTS_ALL)
  string(TOUPPER ${component} upper)
  # Where Debian looks for it; no part of an installation without packages.
  install(FILES "${PROJECT_SOURCE_DIR}/LICENSE" RENAME copyright COMPONENT ${component}
          DESTINATION "${CMAKE_INSTALL_DATADIR}/doc/${CPACK_DEBIAN_${upper}_PACKAGE_NAME}"
          EXCLUDE_FROM_ALL)
endforeach()
include(CPack)
