# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# What a plain find_package(glissade) looks for, read from CMake's own trace: Eigen, the system's threads,
# and nothing else.
include("${CMAKE_CURRENT_LIST_DIR}/../../common/step.cmake")
file(REMOVE_RECURSE "${WORK_DIR}")
set(trace "${WORK_DIR}/trace.json")
file(MAKE_DIRECTORY "${WORK_DIR}")
step("${CMAKE_COMMAND}" -S "${CMAKE_CURRENT_LIST_DIR}" -B "${WORK_DIR}" "-DCMAKE_PREFIX_PATH=${PREFIX}"
     "-DCMAKE_CXX_COMPILER=${CXX}" --trace-expand --trace-format=json-v1 "--trace-redirect=${trace}")
# But for what CMake itself needs to know of the compiler.
file(STRINGS "${trace}" calls REGEX "\"cmd\":\"(find_(package|library|path|file)|pkg_[a-z_]+)\"")
set(found)
list(FILTER calls EXCLUDE REGEX "/Modules/CMake(Determine|Test)[A-Za-z]*\\.cmake\"")
foreach(call IN LISTS calls)
  string(JSON command GET "${call}" cmd)
  string(JSON what GET "${call}" args 0)
  if(NOT command STREQUAL "find_package")
    message(SEND_ERROR "looks for ${what} by ${command}: ${call}")
  endif()
  list(APPEND found "${what}")
endforeach()
list(REMOVE_DUPLICATES found)
list(SORT found)
if(NOT found STREQUAL "Eigen3;Threads;glissade")
  message(SEND_ERROR "find_package(glissade) looks for: ${found}")
endif()
