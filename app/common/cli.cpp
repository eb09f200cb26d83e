// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/cli.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "common/output_file.h"

namespace glissade::app {

int Refuse(std::string_view name, std::string_view why, int exit_code) {
  std::string line = fmt::format("{}: {}", name, why);
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::fflush(stdout);
  std::fprintf(stderr, "%s\n", line.c_str());
  return exit_code;
}

std::optional<int> Parse(CLI::App& app, int argc, char** argv) {
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help) {
    return app.exit(help);
  } catch (const CLI::ParseError& error) {
    return Refuse(app.get_name(), fmt::format("{} (see --help)", error.what()));
  }
  return std::nullopt;
}

Status FirstError(std::initializer_list<Status> checks) {
  for (const Status& status : checks) {
    if (!status.ok()) return status;
  }
  return {};
}

Status CheckAtLeast(std::string_view name, double x, double low) {
  if (std::isfinite(x) && x >= low) return {};
  return {StatusCode::kInvalidArgument,
          fmt::format("{}: must be a finite number >= {:g}, not {:g}", name, low, x)};
}

Status CheckRange(std::string_view name, long long x, long long low, long long high) {
  if (x >= low && x <= high) return {};
  return {StatusCode::kInvalidArgument,
          fmt::format("{}: must be an integer from {} to {}, not {}", name, low, high, x)};
}

Status CheckWritable(std::string_view name, const std::string& path) {
  if (path.empty()) return {};
  OutputFile probe;
  if (Status status = probe.Open(path); !status.ok()) {
    return {status.code(), fmt::format("{}: {}", name, status.message())};
  }
  return {};
}

Status CheckDifferent(std::string_view name_a, const std::string& path_a, std::string_view name_b,
                      const std::string& path_b) {
  std::error_code error;
  namespace fs = std::filesystem;
  if (path_a.empty() || path_b.empty()) return {};
  if (fs::weakly_canonical(path_a, error) != fs::weakly_canonical(path_b, error)) return {};
  if (fs::exists(path_a, error) && !fs::is_regular_file(path_a, error)) return {};  // a device
  return {StatusCode::kInvalidArgument,
          fmt::format("{} and {} name the same file {}", name_a, name_b, path_a)};
}

}  // namespace glissade::app
