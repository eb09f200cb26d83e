# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Configures, builds and runs the consumer in SOURCE_DIR against the package installed in PREFIX,
# with compiler CXX and FLAGS; ARGUMENTS are further ones of cmake, with | between them.
file(REMOVE_RECURSE "${WORK_DIR}")
string(REPLACE "|" ";" ARGUMENTS "${ARGUMENTS}")

include("${CMAKE_CURRENT_LIST_DIR}/../common/step.cmake")

# No launcher: the time of the compiler is what is printed, not that of a cache.
unset(ENV{CMAKE_CXX_COMPILER_LAUNCHER})
unset(ENV{CXXFLAGS})
step("${CMAKE_COMMAND}" -S "${SOURCE_DIR}" -B "${WORK_DIR}" -DCMAKE_BUILD_TYPE=Release
     "-DCMAKE_PREFIX_PATH=${PREFIX}" "-DCMAKE_CXX_COMPILER=${CXX}" "-DCMAKE_CXX_FLAGS=${FLAGS}"
     ${ARGUMENTS})
step("${CMAKE_COMMAND}" --build "${WORK_DIR}" --config Release --verbose)
step("${WORK_DIR}/consumer")
if(EXISTS "${WORK_DIR}/readme")
  step("${WORK_DIR}/readme")
endif()
