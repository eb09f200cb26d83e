# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# Manual pages and completions for bash and zsh, made of what the programs say with --help, where Python
# is found and the programs can be run here. Uses `targets`, the programs.

find_package(Python3 COMPONENTS Interpreter QUIET)
if(NOT Python3_Interpreter_FOUND)
  message(STATUS "glissade: Python 3 not found: no manual pages, no completions for shells")
  return()
endif()
if(CMAKE_CROSSCOMPILING OR GLISSADE_SANITIZE OR GLISSADE_COVERAGE)
  return()
endif()

set(manual_dir "${PROJECT_BINARY_DIR}/man/man1")
set(completions_dir "${PROJECT_BINARY_DIR}/completions")
set(scripts "${PROJECT_SOURCE_DIR}/scripts")
list(GET targets 0 first_target)
set(stamp "${CMAKE_CURRENT_BINARY_DIR}/manual.stamp")
add_custom_command(OUTPUT "${stamp}"
  COMMAND "${CMAKE_COMMAND}" -E rm -rf "${manual_dir}" "${completions_dir}"
  COMMAND "${CMAKE_COMMAND}" -E env PYTHONDONTWRITEBYTECODE=1
          "${Python3_EXECUTABLE}" "${scripts}/make_man.py" --man "${manual_dir}"
          --bash "${completions_dir}/bash" --zsh "${completions_dir}/zsh"
          "$<TARGET_FILE_DIR:${first_target}>"
  COMMAND "${CMAKE_COMMAND}" -E touch "${stamp}"
  DEPENDS ${targets} "${scripts}/make_man.py" "${scripts}/help_text.py" "${scripts}/completions.py"
  COMMENT "Making manual pages and completions" VERBATIM)
add_custom_target(glissade_manual ALL DEPENDS "${stamp}")

# OPTIONAL: what has not been built is not installed, as with the programs.
install(DIRECTORY "${manual_dir}" DESTINATION "${CMAKE_INSTALL_MANDIR}" COMPONENT tools OPTIONAL)
install(DIRECTORY "${completions_dir}/bash/"
        DESTINATION "${CMAKE_INSTALL_DATADIR}/bash-completion/completions" COMPONENT tools OPTIONAL)
# Debian's zsh looks into vendor-completions for what packages bring.
install(CODE "
  set(zsh_folder site-functions)
  if(CMAKE_INSTALL_PREFIX MATCHES \"/usr$\" AND EXISTS /etc/debian_version)
    set(zsh_folder vendor-completions)
  endif()
  file(INSTALL \"${completions_dir}/zsh/\" OPTIONAL
       DESTINATION \"\${CMAKE_INSTALL_PREFIX}/${CMAKE_INSTALL_DATADIR}/zsh/\${zsh_folder}\")
" COMPONENT tools)
