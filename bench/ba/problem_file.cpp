// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/problem_file.h"

#include <cstdlib>
#include <filesystem>
#include <sstream>

#include "ba/audit.h"
#include "ba/child.h"
#include "glissade/io/bal.h"
#include "glissade/sim/city.h"

namespace glissade::bench {

TemporaryFolder::TemporaryFolder() {
  std::error_code error;
  std::string name = (std::filesystem::temp_directory_path(error) / "bench_ba_XXXXXX").string();
  if (!error && mkdtemp(name.data()) != nullptr) path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  if (!path_.empty()) std::filesystem::remove_all(path_, ignored);
}

std::string TemporaryFolder::Add(const std::string& name) {
  return path_.empty() ? std::string() : (std::filesystem::path(path_) / name).string();
}

ProblemRuns PrepareProblem(const ProblemSource& source, const std::string& path, std::string* why) {
  ProblemRuns problem;
  problem.path = path;
  problem.name = source.file;
  if (source.city != 0) {
    problem.name = std::string("city of ").append(std::to_string(source.city)).append(" cameras");
  }
  const auto prepare = [&](std::FILE* out) {
    const auto bal = source.city == 0
                         ? ReadBal(source.file)
                         : sim::MakeCity({.num_cameras = source.city, .seed = source.seed});
    Status status = bal.status();
    if (bal.ok()) status = WriteBal(*bal, path);
    if (!status.ok()) {
      std::fprintf(out, "fails %s\n", status.message().c_str());
      return;
    }
    std::fprintf(out, "is %zu %zu %zu %.17g\n", bal->cameras.size(), bal->points.size(),
                 bal->observations.size(), AuditedCost(*bal, bal->observations));
  };
  const std::string end = RunInChild(prepare, {}, [&](const std::string& line) {
    std::istringstream in(line);
    std::string what;
    in >> what >> std::ws;
    if (what == "is") {
      in >> problem.cameras >> problem.points >> problem.observations >> problem.initial_cost;
    } else {
      std::getline(in, *why);
    }
  });
  if (why->empty() && end != "done") *why = end;
  return problem;
}

}  // namespace glissade::bench
