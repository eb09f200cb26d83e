// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What marginalization does to directions that nothing observes: with first estimates in full the
// information about them stays at rounding for ever, without them yaw gains what nobody measured.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

#include "common/sanitized.h"
#include "glissade/marginal/marginalize.h"
#include "glissade/problem/problem.h"
#include "support/vi_walk.h"

namespace glissade {
namespace {

using test::GaugeDirection;
using test::kGaugeDirections;
using test::MeasureGauge;

constexpr double kDegrees = 57.29577951308232;

struct WalkResult {
  double worst_kappa[4] = {};
  double information[4] = {};  // at the end
  double worst_information[4] = {};
  bool ok = true;
};

WalkResult Walk(FirstEstimates mode, int steps, const MarginalizeOptions& options = {}) {
  Problem problem;
  problem.SetFirstEstimates(mode);
  test::ViWalk walk(7);
  walk.Attach(&problem);
  for (int k = 0; k < 6; ++k)
    walk.AddFrame();
  MarginalWorkspace workspace;
  SolveOptions solve;
  solve.max_iterations = 3;
  WalkResult result;
  std::vector<AnyVertex> oldest;
  for (int step = 0; step < steps && result.ok; ++step) {
    walk.AddFrame();
    result.ok = problem.Solve(solve).ok();
    walk.TakeOldest(&oldest);
    const auto done = Marginalize(&problem, oldest, options, &workspace);
    result.ok = result.ok && done.ok();
    EXPECT_TRUE(done.ok()) << done.status().message();
    for (int d = 0; d < 4; ++d) {
      const auto measured = MeasureGauge(problem, kGaugeDirections[d]);
      result.worst_kappa[d] = std::max(result.worst_kappa[d], measured.kappa);
      result.worst_information[d] = std::max(result.worst_information[d], measured.information);
      result.information[d] = measured.information;
    }
  }
  EXPECT_TRUE(result.ok);
  return result;
}

void Print(const char* name, const WalkResult& r, int steps) {
  std::printf(
      "%-24s %6d marginalizations: kappa x %.1e y %.1e z %.1e yaw %.1e, "
      "spurious sigma %.3g m, %.3g deg\n",
      name, steps, r.worst_kappa[0], r.worst_kappa[1], r.worst_kappa[2], r.worst_kappa[3],
      1.0 / std::sqrt(std::max(
                {r.worst_information[0], r.worst_information[1], r.worst_information[2], 1e-300})),
      kDegrees / std::sqrt(std::max(r.worst_information[3], 1e-300)));
}

TEST(GaugeWalk, TenThousandMarginalizationsWithFirstEstimatesGainNothing) {
  constexpr int kSteps = test::kSanitized ? 500 : 10000;
  const WalkResult r = Walk(FirstEstimates::kFull, kSteps);
  Print("square root, kFull", r, kSteps);
  for (const double kappa : r.worst_kappa)
    EXPECT_LT(kappa, 1e-12);
}

TEST(GaugeWalk, SoWithTheSchurForm) {
  constexpr int kSteps = test::kSanitized ? 50 : 1000;
  MarginalizeOptions options;
  options.form = MarginalForm::kSchur;
  const WalkResult r = Walk(FirstEstimates::kFull, kSteps, options);
  Print("Schur, kFull", r, kSteps);
  for (const double kappa : r.worst_kappa)
    EXPECT_LT(kappa, 1e-12);
}

TEST(GaugeWalk, WithoutThemYawIsTakenForObserved) {
  constexpr int kSteps = 500;
  for (const FirstEstimates mode : {FirstEstimates::kOff, FirstEstimates::kPriorOnly}) {
    const WalkResult r = Walk(mode, kSteps);
    Print(mode == FirstEstimates::kOff ? "square root, kOff" : "square root, kPriorOnly", r,
          kSteps);
    for (int d = 0; d < 3; ++d)
      EXPECT_LT(r.worst_kappa[d], 1e-12);
    EXPECT_GT(r.worst_kappa[3], 1e-10);
  }
}

/// The prior is made at one state, the rest is linearized at another, `offset` away.
double SpuriousYawSigma(FirstEstimates mode, double offset) {
  test::ViWalk walk(3, {.start_noise = 0.0});
  Graph& graph = walk.graph();
  graph.SetFirstEstimates(mode);
  for (int k = 0; k < 8; ++k)
    walk.AddFrame();
  const std::vector<AnyVertex> oldest = walk.TakeOldest();
  const auto done = Marginalize(&graph, oldest);
  EXPECT_TRUE(done.ok()) << done.status().message();
  walk.Shake(offset, offset * 20.0);  // 1 mm and 0.02 degrees
  return kDegrees / std::sqrt(MeasureGauge(graph, GaugeDirection::kYaw).information);
}

TEST(GaugeWalk, SpuriousYawSigmaFallsWithTheOffset) {
  const double reference = SpuriousYawSigma(FirstEstimates::kPriorOnly, 1e-2) * 1e-2;
  for (const double offset : {1e-3, 3e-3, 1e-2, 3e-2, 5e-2}) {
    const double sigma = SpuriousYawSigma(FirstEstimates::kPriorOnly, offset);
    const double full = SpuriousYawSigma(FirstEstimates::kFull, offset);
    std::printf(
        "offset %5.1f mm: sigma_yaw %8.3f deg in kPriorOnly (times offset: %.4f deg m), "
        "%.3g deg in kFull\n",
        1e3 * offset, sigma, sigma * offset, full);
    EXPECT_NEAR(sigma * offset, reference, 0.2 * reference);
    EXPECT_GT(full, 1e6);
  }
}

}  // namespace
}  // namespace glissade
