// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "common/data_dir.h"
#include "glissade/io/viowin.h"
#include "glissade/problem/problem.h"

// Published windows: costs at the start and at the optimum, the two paths of landmarks, threads.

namespace glissade {
namespace {

struct Reference {
  double initial[2], optimum[2];  // vision, visual-inertial
};

std::filesystem::path Folder() {
  return test::DataDir() / "windows";
}

std::map<std::string, std::vector<Reference>> ReadReferences() {
  std::map<std::string, std::vector<Reference>> references;
  std::ifstream in(Folder() / "reference_costs.csv");
  std::string line;
  std::getline(in, line);
  while (std::getline(in, line)) {
    std::replace(line.begin(), line.end(), ',', ' ');
    std::istringstream words(line);
    std::string file;
    std::size_t window = 0;
    Reference r{};
    words >> file >> window >> r.initial[0] >> r.optimum[0] >> r.initial[1] >> r.optimum[1];
    EXPECT_TRUE(words) << line;
    EXPECT_EQ(references[file].size(), window);
    references[file].push_back(r);
  }
  return references;
}

constexpr WindowKind kKinds[] = {WindowKind::kVision, WindowKind::kVisualInertial};

SolveOptions EightSteps() {
  SolveOptions options;
  options.max_iterations = 8;
  options.cost_tolerance = options.gradient_tolerance = options.step_tolerance = 0.0;
  return options;
}

class Windows : public ::testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    const auto path = Folder() / (std::string(GetParam()) + ".txt.gz");
    if (!std::filesystem::exists(path)) GTEST_SKIP() << "no file " << path;
    auto windows = ReadViowin(path.string());
    ASSERT_TRUE(windows.ok()) << windows.status().message();
    windows_ = std::move(windows).value();
    references_ = ReadReferences()[std::string(GetParam()) + ".txt"];
    ASSERT_EQ(references_.size(), windows_.size());
    ASSERT_FALSE(windows_.empty());
  }

  Problem MakeProblem(std::size_t window, WindowKind kind) const {
    Problem problem;
    const auto handles = AddToGraph(windows_[window], kind, {}, &problem);
    EXPECT_TRUE(handles.ok()) << handles.status().message();
    return problem;
  }

  std::vector<ViowinWindow> windows_;
  std::vector<Reference> references_;
};

TEST_P(Windows, CostsAtTheStart) {
  for (std::size_t w = 0; w < windows_.size(); ++w) {
    for (const WindowKind kind : kKinds) {
      const double expected = references_[w].initial[static_cast<int>(kind)];
      EXPECT_NEAR(MakeProblem(w, kind).Cost().value(), expected, 1e-9 * expected) << "window " << w;
    }
  }
}

TEST_P(Windows, OptimumOfARunToConvergence) {
  SolveOptions options;
  options.max_iterations = 300;
  options.cost_tolerance = 1e-13;
  options.gradient_tolerance = 0.0;
  options.step_tolerance = 0.0;
  for (std::size_t w = 0; w < windows_.size(); ++w) {
    for (const WindowKind kind : kKinds) {
      Problem problem = MakeProblem(w, kind);
      const SolveSummary& summary = problem.Solve(options);
      EXPECT_TRUE(summary.converged()) << "window " << w << ": " << summary.BriefReport();
      const double expected = references_[w].optimum[static_cast<int>(kind)];
      EXPECT_NEAR(summary.final_cost, expected, 1e-6 * expected) << "window " << w;
    }
  }
}

TEST_P(Windows, ThreadsChangeNoBit) {
  for (std::size_t w = 0; w < std::min<std::size_t>(windows_.size(), 4); ++w) {
    for (const WindowKind kind : kKinds) {
      SolveOptions options = EightSteps();
      Problem one = MakeProblem(w, kind), two = MakeProblem(w, kind);
      const double cost = one.Solve(options).final_cost;
      options.num_threads = 2;
      EXPECT_EQ(two.Solve(options).final_cost, cost) << "window " << w;
      EXPECT_EQ(two.GetSnapshot().states, one.GetSnapshot().states) << "window " << w;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Files, Windows, ::testing::Values("win10", "win11m", "win20", "win50"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace glissade
