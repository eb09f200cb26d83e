# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Looks for the five modules of OpenCV that the vision library uses: by OpenCV's own package file, or,
# since Debian has that only in a package that pulls in all of OpenCV with its viewers, by the modules'
# own headers and libraries. Sets GLISSADE_HAVE_OPENCV.

set(glissade_opencv_modules core imgproc imgcodecs video calib3d)
set(GLISSADE_HAVE_OPENCV FALSE)
find_package(OpenCV 4.5 QUIET COMPONENTS ${glissade_opencv_modules})
if(OpenCV_FOUND)
  set(glissade_opencv_include "${OpenCV_INCLUDE_DIRS}")
  set(GLISSADE_HAVE_OPENCV TRUE)
else()
  find_path(GLISSADE_OPENCV_INCLUDE opencv2/core.hpp PATH_SUFFIXES opencv4)
  mark_as_advanced(GLISSADE_OPENCV_INCLUDE)
  set(glissade_opencv_include "${GLISSADE_OPENCV_INCLUDE}")
  set(glissade_opencv_version "${GLISSADE_OPENCV_INCLUDE}/opencv2/core/version.hpp")
  if(EXISTS "${glissade_opencv_version}")
    foreach(part IN ITEMS MAJOR MINOR)
      file(STRINGS "${glissade_opencv_version}" line REGEX "#define CV_VERSION_${part} ")
      string(REGEX REPLACE ".*CV_VERSION_${part} +" "" glissade_opencv_${part} "${line}")
    endforeach()
    if("${glissade_opencv_MAJOR}.${glissade_opencv_MINOR}" VERSION_GREATER_EQUAL 4.5)
      set(GLISSADE_HAVE_OPENCV TRUE)
    endif()
  endif()
  foreach(module IN LISTS glissade_opencv_modules)
    find_library(GLISSADE_OPENCV_${module} opencv_${module})
    mark_as_advanced(GLISSADE_OPENCV_${module})
    if(NOT GLISSADE_OPENCV_${module} OR NOT EXISTS "${glissade_opencv_include}/opencv2/${module}.hpp")
      set(GLISSADE_HAVE_OPENCV FALSE)
    endif()
  endforeach()
endif()

# Plain names: OpenCV's targets where its package file was found, else libraries for the linker to
# find; both can stand in what is installed.
function(glissade_link_opencv target)
  target_include_directories(${target} SYSTEM PRIVATE ${glissade_opencv_include})
  list(TRANSFORM glissade_opencv_modules PREPEND opencv_ OUTPUT_VARIABLE libraries)
  target_link_libraries(${target} PRIVATE ${libraries})
endfunction()
