# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# plotly.min.js, which the report of a run is drawn with: that of scripts/test.sh (build/plotly), or
# of Python's package plotly. Laid where programs look for it, in the build and where they are
# installed. Uses share_from_bin.

if(GLISSADE_PLOTLY_JS AND NOT EXISTS "${GLISSADE_PLOTLY_JS}")
  unset(GLISSADE_PLOTLY_JS CACHE)  # it has gone
endif()
find_file(GLISSADE_PLOTLY_JS plotly.min.js PATHS "${PROJECT_SOURCE_DIR}/build/plotly"
          NO_DEFAULT_PATH DOC "plotly.min.js, for the report of a run")
if(NOT GLISSADE_PLOTLY_JS)
  find_package(Python3 COMPONENTS Interpreter QUIET)
  if(Python3_Interpreter_FOUND)
    execute_process(
      COMMAND "${Python3_EXECUTABLE}" -c
        "import importlib.util as u; print(u.find_spec('plotly').submodule_search_locations[0])"
      OUTPUT_VARIABLE plotly_package OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET
      RESULT_VARIABLE plotly_result)
    if(plotly_result EQUAL 0)
      find_file(GLISSADE_PLOTLY_JS plotly.min.js PATHS "${plotly_package}/package_data"
                NO_DEFAULT_PATH)
    endif()
  endif()
endif()

if(GLISSADE_PLOTLY_JS)
  if(CMAKE_RUNTIME_OUTPUT_DIRECTORY)
    set(plotly_bin "${CMAKE_RUNTIME_OUTPUT_DIRECTORY}")
  else()
    set(plotly_bin "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
  configure_file("${GLISSADE_PLOTLY_JS}" "${plotly_bin}/${share_from_bin}/plotly.min.js" COPYONLY)
  install(FILES "${GLISSADE_PLOTLY_JS}" DESTINATION "${CMAKE_INSTALL_DATADIR}/glissade"
          COMPONENT tools RENAME plotly.min.js)
else()
  message(STATUS "glissade: plotly.min.js not found: no run can be shown as a page "
                 "(pip install plotly, and configure again)")
endif()
