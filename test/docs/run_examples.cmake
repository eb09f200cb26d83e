# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Configures and builds examples/ in SOURCE_DIR against the package installed in PREFIX, with compiler
# CXX, and runs every example.
file(REMOVE_RECURSE "${WORK_DIR}")

include("${CMAKE_CURRENT_LIST_DIR}/../common/step.cmake")

unset(ENV{CXXFLAGS})
step("${CMAKE_COMMAND}" -S "${SOURCE_DIR}" -B "${WORK_DIR}" "-DCMAKE_PREFIX_PATH=${PREFIX}"
     "-DCMAKE_CXX_COMPILER=${CXX}" -DCMAKE_CXX_FLAGS=-Werror)
step("${CMAKE_COMMAND}" --build "${WORK_DIR}" --config Release)
step("${CMAKE_CTEST_COMMAND}" --test-dir "${WORK_DIR}" -C Release --output-on-failure
     --no-tests=error)
