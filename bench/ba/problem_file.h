// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>

#include "ba/report.h"

namespace glissade::bench {

/// A folder for problems in binary, gone at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;

  /// A name in it; empty where there could be none.
  [[nodiscard]] std::string Add(const std::string& name);

 private:
  std::string path_;
};

/// What is to be solved: a file, or a city where `city` is not 0.
struct ProblemSource {
  std::string file;
  int city = 0;
  std::uint32_t seed = 1;
};

/// Reads or makes it, in a process of its own, and writes it in binary to `path`, from where every
/// solver reads it. Says what it consists of and what it costs at the start; what went wrong, else
/// "", into `*why`.
ProblemRuns PrepareProblem(const ProblemSource& source, const std::string& path, std::string* why);

}  // namespace glissade::bench
