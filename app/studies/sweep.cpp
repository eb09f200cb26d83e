// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/sweep.h"

#include <array>
#include <cmath>
#include <utility>

#include "common/interrupt.h"
#include "glissade/sim/random.h"
#include "studies/alignment.h"

namespace glissade::app {

namespace {

using PoseNoise = std::vector<std::array<double, 6>>;  // tangent, pose by pose

/// The same for trial k of every row. Drawn when first asked for: an interrupt soon after the start
/// finds trials done, however many there are to be.
class NoiseOfTrials {
 public:
  NoiseOfTrials(const SweepOptions& options, std::size_t num_poses)
      : engine_(options.seed), normal_(0.0, options.pose_noise), num_poses_(num_poses) {}

  const PoseNoise& operator[](int trial) {
    while (drawn_.size() <= static_cast<std::size_t>(trial)) {
      PoseNoise& noise = drawn_.emplace_back(num_poses_);
      for (auto& pose : noise) {
        for (double& x : pose)
          x = normal_(engine_);
      }
    }
    return drawn_[static_cast<std::size_t>(trial)];
  }

 private:
  sim::MinstdRand0 engine_;
  sim::NormalReal normal_;
  std::size_t num_poses_;
  std::vector<PoseNoise> drawn_;
};

SweepStep Measure(const IterationSummary& it, const CourseScene& scene, const Graph& graph,
                  const CourseHandles& handles, int num_priors) {
  SweepStep step;
  step.iteration = it.iteration;
  step.cost = it.cost;
  double sum = 0.0;
  for (const auto& edge : handles.edges)
    sum += graph.Chi2(edge).value();
  step.reprojection_error = std::sqrt(sum / static_cast<double>(handles.edges.size()));
  double p = 0.0;
  double theta = 0.0;
  for (int k = 0; k < num_priors; ++k) {
    const auto i = static_cast<std::size_t>(k);
    double d[6];
    graph.Get(handles.poses[i]).Minus(VertexPose{scene.poses[i]}, d);
    p += d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
    theta += d[3] * d[3] + d[4] * d[4] + d[5] * d[5];
  }
  step.prior_position_error = std::sqrt(p / num_priors);
  step.prior_rotation_error = std::sqrt(theta / num_priors);
  return step;
}

Result<SweepTrial> RunTrial(const CourseScene& scene, const SweepOptions& options,
                            const SweepRow& row, const PoseNoise& noise) {
  Problem problem;
  const auto handles = AddToGraph(scene, problem,
                                  {.fix_poses = row.fixed ? options.num_priors : 0,
                                   .prior_weight = row.weight,
                                   .num_priors = options.num_priors});
  if (!handles.ok()) return handles.status();
  for (std::size_t k = 0; k < noise.size(); ++k) {
    if (row.fixed && static_cast<int>(k) < options.num_priors) continue;
    VertexPose start{scene.poses[k]};
    start.Plus(noise[k].data());
    if (Status s = problem.Set(handles->poses[k], start); !s.ok()) return s;
  }

  SweepTrial trial;
  {
    // Timed without looking, the second time, when code and caches are warm; then solved again,
    // which gives the same bits, to look.
    for (int run = 0; run < 2; ++run) {
      Problem timed = problem.Clone();
      trial.time_s = timed.Solve(options.solve).time.total_s;
    }
  }
  SolveOptions solve = options.solve;
  solve.callback = [&](const IterationSummary& it) {
    if (it.accepted) {
      trial.steps.push_back(Measure(it, scene, problem, *handles, options.num_priors));
    }
    return Interrupted() ? CallbackAction::kStop : CallbackAction::kContinue;
  };
  const SolveSummary& summary = problem.Solve(solve);
  if (!summary.ok()) return summary.status;
  trial.termination = summary.termination;
  trial.converged = summary.converged();
  trial.iterations = summary.accepted_steps + summary.rejected_steps;
  if (row.fixed || row.weight > 0.0) {
    trial.errors = ErrorsOf(scene, problem, *handles);
  } else {
    auto errors = AlignedErrors(scene, problem, *handles);
    if (!errors.ok()) return errors.status();
    trial.errors = *errors;
  }
  return trial;
}

}  // namespace

Result<std::vector<SweepRow>> RunSweep(const CourseScene& scene, const SweepOptions& options) {
  NoiseOfTrials noise(options, scene.poses.size());
  std::vector<SweepRow> rows;
  for (double weight : options.weights)
    rows.push_back({.fixed = false, .weight = weight, .trials = {}});
  rows.push_back({.fixed = true, .weight = 0.0, .trials = {}});
  for (SweepRow& row : rows) {
    for (int k = 0; k < options.trials && !Interrupted(); ++k) {
      auto trial = RunTrial(scene, options, row, noise[k]);
      if (Interrupted()) break;  // that trial may have been cut short
      if (!trial.ok()) return trial.status();
      row.trials.push_back(std::move(trial).value());
    }
  }
  std::erase_if(rows, [](const SweepRow& row) { return row.trials.empty(); });
  return rows;
}

}  // namespace glissade::app
