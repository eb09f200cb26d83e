# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# cmake "-DNAMES=kA,kB" "-DkA=FILE" "-DkB=FILE,FILE" "-DOUT=FILE" -P EmbedFiles.cmake
#
# Writes OUT, which defines for each name an array of the bytes of its files, one after another:
# `constexpr unsigned char kA[] = {0x3c, ...};`. An array of numbers, since a string literal of more
# than 64 KiB is more than a compiler need take.
set(text "// Made by EmbedFiles.cmake.\n")
string(REPLACE "," ";" NAMES "${NAMES}")
foreach(name IN LISTS NAMES)
  set(bytes "")
  string(REPLACE "," ";" files "${${name}}")
  foreach(file IN LISTS files)
    file(READ "${file}" hex HEX)
    string(APPEND bytes "${hex}")
  endforeach()
  string(REGEX REPLACE "(................................)" "\\1\n" bytes "${bytes}")
  string(REGEX REPLACE "([0-9a-f][0-9a-f])" "0x\\1," bytes "${bytes}")
  string(APPEND text "constexpr unsigned char ${name}[] = {\n${bytes}};\n")
endforeach()
file(WRITE "${OUT}" "${text}")
