# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause

# A cache variable that is ON, OFF or AUTO (= ON where the packages for it are found).
function(glissade_tristate name default doc)
  set(${name} ${default} CACHE STRING "${doc}: ON, OFF or AUTO")
  set_property(CACHE ${name} PROPERTY STRINGS AUTO ON OFF)
  string(TOUPPER "${${name}}" value)
  if(value MATCHES "^(AUTO|ON|OFF)$")
  elseif(${name})
    set(value ON)
  else()
    set(value OFF)
  endif()
  set(${name} ${value} PARENT_SCOPE)
endfunction()

# Called where a package for an optional part is missing: fatal if the part was asked for.
macro(glissade_part_missing option part what packages)
  if(${option} STREQUAL "ON")
    message(FATAL_ERROR "glissade: ${option} is ON, but ${what} was not found "
                        "(Debian, Ubuntu: apt-get install ${packages})")
  endif()
  message(STATUS "glissade: ${what} not found: ${part} skipped "
                 "(Debian, Ubuntu: apt-get install ${packages})")
endmacro()

# Sanitizers, coverage and NaN-filled matrices for everything that is built in this directory.
macro(glissade_enable_instrumentation)
  if(GLISSADE_SANITIZE)
    if(NOT GLISSADE_SANITIZE MATCHES "^(address|undefined|address,undefined|thread)$")
      message(FATAL_ERROR "GLISSADE_SANITIZE is '${GLISSADE_SANITIZE}'; it must be empty, address, "
                          "undefined, address,undefined or thread")
    endif()
    add_compile_options(-fsanitize=${GLISSADE_SANITIZE} -fno-sanitize-recover=all
                        -fno-omit-frame-pointer)
    add_link_options(-fsanitize=${GLISSADE_SANITIZE})
    if(GLISSADE_SANITIZE STREQUAL "address,undefined")
      # A third of the time to compile for what AddressSanitizer or the processor finds as well: null
      # pointers, sizes of objects, vector loads that are not aligned.
      add_compile_options(-fno-sanitize=null,alignment,object-size,pointer-overflow,vptr)
    endif()
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU")
      # GCC's flow analysis sees the sanitizer's own branches and warns about Eigen's temporaries.
      add_compile_options(-Wno-maybe-uninitialized)
    endif()
    if(GLISSADE_SANITIZE MATCHES "address")
      # Under AddressSanitizer Eigen puts an address of its own before each block that it takes from
      # malloc; libceres, built without a sanitizer, does not. The linker keeps one copy of an inline
      # function, so that one may free what the other took. glibc's malloc is aligned as Eigen wants.
      add_compile_definitions(EIGEN_MALLOC_ALREADY_ALIGNED=1)
    endif()
  endif()
  if(GLISSADE_COVERAGE)
    add_compile_options(--coverage -fprofile-update=atomic)
    add_link_options(--coverage)
  endif()
  if(GLISSADE_NAN_INIT)
    add_compile_definitions(EIGEN_INITIALIZE_MATRICES_BY_NAN)
  endif()
endmacro()

# What all our own targets share. Warnings are for our builds, not for those who embed us.
function(glissade_target_defaults target)
  set_target_properties(${target} PROPERTIES CXX_EXTENSIONS OFF)
  target_compile_features(${target} PRIVATE cxx_std_20)
  if(PROJECT_IS_TOP_LEVEL)
    target_compile_options(${target} PRIVATE -Wall -Wextra -Wpedantic -Wconversion)
  endif()
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12
     AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # False alarms on std::string's operator+ (GCC bug 105651, mended in 13).
    target_compile_options(${target} PRIVATE -Wno-restrict)
  endif()
  if(GLISSADE_WARNINGS_AS_ERRORS)
    target_compile_options(${target} PRIVATE -Werror)
  endif()
endfunction()

# target_precompile_headers for targets with glissade_target_defaults.
function(glissade_precompile_headers target)
  target_precompile_headers(${target} ${ARGN})
  if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_CXX_COMPILER_VERSION VERSION_GREATER_EQUAL 12
     AND CMAKE_CXX_COMPILER_VERSION VERSION_LESS 13)
    # Of std::string's operator+, too (see above): what comes from a precompiled header does not
    # count as from the system. Which of them come depends on what is inlined: on the optimization
    # and the sanitizer.
    target_compile_options(${target} PRIVATE -Wno-stringop-overflow -Wno-stringop-overread
                                             -Wno-array-bounds)
  endif()
endfunction()

# Sets `out` to those of the given files that do not say "requires: ceres" in their first lines,
# unless Ceres is there.
function(glissade_drop_ceres_sources out)
  set(kept)
  foreach(file IN LISTS ARGN)
    if(NOT GLISSADE_HAVE_CERES)
      file(STRINGS "${file}" head LIMIT_COUNT 5)
      if(head MATCHES "requires: ceres")
        cmake_path(RELATIVE_PATH file BASE_DIRECTORY "${PROJECT_SOURCE_DIR}" OUTPUT_VARIABLE shown)
        message(STATUS "glissade: ${shown} skipped (requires Ceres >= 2.1)")
        continue()
      endif()
    endif()
    list(APPEND kept "${file}")
  endforeach()
  set(${out} "${kept}" PARENT_SCOPE)
endfunction()

# Links the libraries that exist in this build: the core always, io and the Ceres bridge if built.
# Not vision: every program would load OpenCV.
function(glissade_link_all target)
  target_link_libraries(${target} PRIVATE glissade::glissade)
  if(TARGET glissade_io)
    target_link_libraries(${target} PRIVATE glissade::io)
  endif()
  if(TARGET glissade_ceres)
    target_link_libraries(${target} PRIVATE glissade::ceres_bridge)
    target_compile_definitions(${target} PRIVATE GLISSADE_HAVE_CERES=1)
  endif()
endfunction()
