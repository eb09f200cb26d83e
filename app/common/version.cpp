// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/version.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "common/interrupt.h"
#include "common/output_file.h"
#include "glissade/linear/instruction_set.h"

#ifdef GLISSADE_HAVE_CERES
#include <ceres/version.h>
#endif

namespace glissade::app {

std::string VersionText(const std::string& app) {
#ifdef GLISSADE_HAVE_CERES
  const char* ceres = "Ceres " CERES_VERSION_STRING;
#else
  const char* ceres = "without Ceres";
#endif
  return fmt::format(
      "{} (glissade) {}\n"
      "instruction sets: {}; in use here: {}\n"
      "options: {}, {}, zlib, bzip2\n"
      "compiler: {}",
      app, GLISSADE_VERSION, GLISSADE_ISAS, InstructionSetName(), GLISSADE_BUILD_OPTIONS, ceres,
      GLISSADE_COMPILER);
}

nlohmann::ordered_json JsonHeader(const std::string& app, const std::string& file) {
  return {{"schema", "glissade/" + app + "/1"},
          {"version", GLISSADE_VERSION},
          {"isa", InstructionSetName()},
          {"file", file.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(file)},
          {"interrupted", Interrupted()}};
}

Status WriteJson(const std::string& path, const nlohmann::ordered_json& json, int indent) {
  // Names of files need not be UTF-8.
  const auto replace = nlohmann::ordered_json::error_handler_t::replace;
  return WriteFile(path, json.dump(indent, ' ', false, replace) + "\n");
}

}  // namespace glissade::app
