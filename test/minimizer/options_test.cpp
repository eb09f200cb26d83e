// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/resource.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <string>

#include "common/sanitized.h"
#include "glissade/linear/instruction_set.h"
#include "minimizer/strip.h"

namespace glissade {
namespace {

using test::Strip;

// They fell through every switch and something or other was done.
TEST(Options, EnumsThatAreNoneAreRefusedByName) {
  Strip strip;
  const Snapshot before = strip.problem.GetSnapshot();
  const auto refused = [&](const SolveOptions& options, const std::string& name) {
    const SolveSummary& summary = strip.problem.Solve(options);
    EXPECT_EQ(summary.status.code(), StatusCode::kInvalidArgument);
    EXPECT_NE(summary.status.message().find(name), std::string::npos) << summary.status.message();
  };
  SolveOptions options;
  options.method = static_cast<Method>(9);
  refused(options, "method");
  options = {};
  options.damping = static_cast<Damping>(-1);
  refused(options, "damping");
  options = {};
  options.linear_solver_type = static_cast<LinearSolverType>(99);
  refused(options, "linear_solver_type");
  options = {};
  options.pcg.preconditioner = static_cast<Preconditioner>(99);
  refused(options, "preconditioner");
  options = {};
  options.gauge = Gauge::Fixed{strip.frames[0], {}, {}, static_cast<GaugeGroup>(77)};
  refused(options, "group");
  options.gauge = Gauge::Fixed{strip.frames[0]};
  options.gauge.kind = static_cast<Gauge::Kind>(77);
  refused(options, "kind");
  EXPECT_EQ(strip.problem.GetSnapshot().states, before.states);

  NullspaceOptions nullspace;
  nullspace.group = static_cast<GaugeGroup>(77);
  EXPECT_EQ(strip.problem.CheckNullspace(nullspace).status().code(), StatusCode::kInvalidArgument);
  CovarianceOptions covariance;
  covariance.gauge.group = static_cast<GaugeGroup>(77);
  const AnyVertex vertex = strip.frames[3];
  EXPECT_EQ(strip.problem.ComputeCovariance(std::span(&vertex, 1), covariance).status().code(),
            StatusCode::kInvalidArgument);

  MarginalizeOptions marginal;
  marginal.form = static_cast<MarginalForm>(7);
  EXPECT_EQ(strip.problem.Marginalize({strip.frames[0]}, marginal).status().code(),
            StatusCode::kInvalidArgument);
  marginal = {};
  marginal.root = static_cast<InformationRoot>(7);
  EXPECT_EQ(strip.problem.Marginalize({strip.frames[0]}, marginal).status().code(),
            StatusCode::kInvalidArgument);
}

TEST(Options, RelativeCutsThatAreNoneAreRefused) {
  Strip strip;
  const int edges = strip.problem.NumEdges();
  constexpr double kInf = std::numeric_limits<double>::infinity();
  for (const double cut : {std::nan(""), kInf, -kInf, 1.0, 2.0}) {
    MarginalizeOptions options;
    options.relative_cut = cut;
    const auto refused = strip.problem.Marginalize({strip.frames[0]}, options);
    EXPECT_FALSE(refused.ok()) << cut;
    EXPECT_NE(refused.status().message().find("relative_cut"), std::string::npos);
    const Eigen::MatrixXd H = Eigen::MatrixXd::Identity(2, 2);
    EXPECT_FALSE(SchurComplement(H, Eigen::VectorXd::Ones(2), {0}, {1}, cut).ok()) << cut;
  }
  EXPECT_EQ(strip.problem.NumEdges(), edges);
}

// It was ignored without a word. The variable is read once in a process: each in one of its own.
TEST(OptionsDeathTest, AnInstructionSetThatIsNoneIsRefusedByName) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  const auto solve = [](const char* isa) {
    setenv("GLISSADE_ISA", isa, 1);
    Strip strip;
    const SolveSummary& summary = strip.problem.Solve();
    const auto marginal = strip.problem.Marginalize({strip.frames[0]});
    const std::string& message = summary.status.message();
    const bool named = message.find("GLISSADE_ISA") != std::string::npos &&
                       message.find("baseline") != std::string::npos &&
                       message.find("avx512") != std::string::npos;
    if (!CheckInstructionSet().ok()) {
      std::_Exit(!summary.ok() && named && marginal.status().message() == message ? 3 : 4);
    }
    std::_Exit(summary.ok() && marginal.ok() && std::string(InstructionSetName()) == isa ? 5 : 6);
  };
  EXPECT_EXIT(solve("foo"), testing::ExitedWithCode(3), "");
  EXPECT_EXIT(solve("AVX2"), testing::ExitedWithCode(3), "");
  EXPECT_EXIT(solve("baseline"), testing::ExitedWithCode(5), "");
}

/// Bytes of address space that this process has taken.
rlim_t AddressSpace() {
  std::ifstream file("/proc/self/statm");
  rlim_t pages = 0;
  file >> pages;
  return pages * 4096;
}

// std::system_error ended the process, and where it was caught the next solve hung.
TEST(Threads, ThatTheSystemRefusesAreDoneWithout) {
  if (test::kSanitized) GTEST_SKIP() << "sanitizers take more address space than there is";
  Strip few({.noise = 0.5}), one({.noise = 0.5});
  SolveOptions options;
  const SolveSummary& alone = one.problem.Solve(options);
  rlimit old{};
  ASSERT_EQ(getrlimit(RLIMIT_AS, &old), 0);
  rlimit tight = old;
  tight.rlim_cur = AddressSpace() + (100u << 20);  // room for a dozen stacks
  options.num_threads = 1024;
  ASSERT_EQ(setrlimit(RLIMIT_AS, &tight), 0);
  const SolveSummary& summary = few.problem.Solve(options);
  ASSERT_EQ(setrlimit(RLIMIT_AS, &old), 0);
  EXPECT_TRUE(summary.ok()) << summary.BriefReport();
  EXPECT_LT(summary.num_threads, 1024);
  EXPECT_EQ(summary.num_threads + summary.num_threads_refused, 1024);
  EXPECT_NE(summary.BriefReport().find("refused"), std::string::npos) << summary.BriefReport();
  EXPECT_EQ(summary.final_cost, alone.final_cost);
  // The same again does not hang, and what is asked for next is had.
  EXPECT_TRUE(few.problem.Solve(options).ok());
  options.num_threads = 2;
  EXPECT_EQ(few.problem.Solve(options).num_threads, 2);
  EXPECT_EQ(one.problem.Solve({}).BriefReport().find("threads"), std::string::npos);
}

}  // namespace
}  // namespace glissade
