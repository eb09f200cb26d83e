# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Configures, builds and runs the project of this folder around glissade in SOURCE_DIR; for
# HOW=FetchContent around an archive of what a build of the libraries needs.
include("${CMAKE_CURRENT_LIST_DIR}/../../common/step.cmake")
file(REMOVE_RECURSE "${WORK_DIR}")
file(MAKE_DIRECTORY "${WORK_DIR}")
set(source "${SOURCE_DIR}")
if(HOW STREQUAL "FetchContent")
  set(source "${WORK_DIR}/glissade.tar.gz")
  execute_process(COMMAND "${CMAKE_COMMAND}" -E tar czf "${source}" CMakeLists.txt cmake include src LICENSE
                          README.md CHANGELOG.md CONTRIBUTING.md
                  WORKING_DIRECTORY "${SOURCE_DIR}" RESULT_VARIABLE result)
  if(result)
    message(FATAL_ERROR "no archive could be made of ${SOURCE_DIR}")
  endif()
endif()
unset(ENV{CXXFLAGS})
step("${CMAKE_COMMAND}" -S "${CMAKE_CURRENT_LIST_DIR}" -B "${WORK_DIR}/build" -DCMAKE_BUILD_TYPE=Release
     "-DCMAKE_CXX_COMPILER=${CXX}" "-DSOURCE=${source}" "-DBUILT=${BUILT}" "-DGLISSADE_WITH_METIS=${WITH_METIS}")
step("${CMAKE_COMMAND}" --build "${WORK_DIR}/build" --config Release --target consumer)
step("${WORK_DIR}/build/consumer")
# The library itself has not been built for it.
file(GLOB_RECURSE archives "${WORK_DIR}/build/*libglissade.*")
if(archives)
  message(FATAL_ERROR "the library was built: ${archives}")
endif()
