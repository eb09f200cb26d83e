// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/data_dir.h"

#include <cstdlib>

namespace glissade::test {

std::filesystem::path SourceDir() {
  return GLISSADE_SOURCE_DIR;
}

std::filesystem::path DataDir() {
  const char* data = std::getenv("GLISSADE_DATA");
  return data != nullptr ? std::filesystem::path(data) : SourceDir() / "../shared/data";
}

}  // namespace glissade::test
