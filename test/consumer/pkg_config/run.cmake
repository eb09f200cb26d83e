# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Compiles the package test's program with nothing but what pkg-config says of the package in PREFIX.
find_program(PKG_CONFIG pkg-config)
if(NOT PKG_CONFIG)
  message("SKIPPED: no pkg-config")
  return()
endif()
include("${CMAKE_CURRENT_LIST_DIR}/../../common/step.cmake")
file(MAKE_DIRECTORY "${WORK_DIR}")
# pkg-config does not quote: by way of a link without the spaces of the package's path.
file(REMOVE "${LINK}")
file(CREATE_LINK "${PREFIX}" "${LINK}" SYMBOLIC)
set(ENV{PKG_CONFIG_PATH} "${LINK}/${LIBDIR}/pkgconfig:$ENV{PKG_CONFIG_PATH}")
execute_process(COMMAND "${PKG_CONFIG}" --cflags --libs ${PACKAGES} OUTPUT_VARIABLE flags
                RESULT_VARIABLE result OUTPUT_STRIP_TRAILING_WHITESPACE)
if(result)
  message(FATAL_ERROR "pkg-config ${PACKAGES} failed")
endif()
separate_arguments(flags UNIX_COMMAND "${flags}")
step("${CXX}" "${CMAKE_CURRENT_LIST_DIR}/../package/main.cpp" -DHAS_IO -o "${WORK_DIR}/program" ${flags})
step("${CMAKE_COMMAND}" -E env "LD_LIBRARY_PATH=${LINK}/${LIBDIR}" "${WORK_DIR}/program")
