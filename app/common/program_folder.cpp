// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/program_folder.h"

#include <system_error>

namespace glissade::app {

std::filesystem::path ProgramFolder() {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  return error ? fs::path(GLISSADE_INSTALLED_BIN) : program.parent_path();
}

}  // namespace glissade::app
