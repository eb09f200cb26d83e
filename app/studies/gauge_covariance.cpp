// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/gauge_covariance.h"

#include <Eigen/Core>

#include "glissade/covariance/covariance.h"
#include "glissade/covariance/transform.h"
#include "studies/gauge_method.h"

namespace glissade::app {

namespace {

/// Rows of [p, theta, v] of all keyframes, in that order, out of a joint covariance.
std::vector<double> MotionBlock(const JointCovariance& joint, const sim::ViHandles& handles) {
  std::vector<Eigen::Index> rows;
  const auto take = [&](AnyVertex vertex, int n) {
    const int index = joint.IndexOf(vertex);
    for (int i = 0; index >= 0 && i < n; ++i)
      rows.push_back(joint.offsets[static_cast<std::size_t>(index)] + i);
  };
  for (std::size_t k = 0; k < handles.poses.size(); ++k) {
    take(handles.poses[k], 6);
    take(handles.speed_biases[k], 3);
  }
  const Eigen::MatrixXd all = joint.Matrix();
  std::vector<double> block;
  block.reserve(rows.size() * rows.size());
  for (const Eigen::Index i : rows) {
    for (const Eigen::Index j : rows)
      block.push_back(all(i, j));
  }
  return block;
}

std::vector<GaugeEllipse> Ellipses(const std::vector<double>& block, const sim::ViStates& states) {
  const std::size_t n = 9 * states.poses.size();
  std::vector<GaugeEllipse> ellipses;
  for (std::size_t k = 0; k < states.poses.size(); ++k) {
    const auto p = states.poses[k].pose.p();
    const std::size_t i = 9 * k;
    ellipses.push_back(
        {p[0], p[1], block[i * n + i], block[i * n + i + 1], block[(i + 1) * n + i + 1]});
  }
  return ellipses;
}

/// A problem solved until it converges, ready to be asked for covariances.
struct Solved {
  Problem problem;
  sim::ViHandles handles;
  Gauge gauge;
  sim::ViStates states;
};

Status SolveIn(GaugeMethod method, const sim::ViProblem& problem, Solved* solved) {
  auto handles = sim::AddToGraph(problem, {}, &solved->problem);
  if (!handles.ok()) return handles.status();
  solved->handles = std::move(handles).value();
  solved->gauge = MakeGauge(method, 0.0, problem, solved->handles);
  for (const bool polish : {false, true}) {
    SolveOptions options = ConvergedOptions(polish);
    options.gauge = solved->gauge;
    const SolveSummary& summary = solved->problem.Solve(options);
    if (!summary.ok()) return summary.status;
  }
  solved->states = sim::StatesOf(solved->problem, solved->handles);
  return {};
}

std::vector<AnyVertex> Motion(const sim::ViHandles& handles) {
  std::vector<AnyVertex> vertices;
  for (std::size_t k = 0; k < handles.poses.size(); ++k) {
    vertices.push_back(handles.poses[k]);
    vertices.push_back(handles.speed_biases[k]);
  }
  return vertices;
}

}  // namespace

Result<GaugeCovariances> CompareCovariances(const sim::ViProblem& problem) {
  Solved free, fixed;
  if (Status s = SolveIn(GaugeMethod::kFree, problem, &free); !s.ok()) return s;
  if (Status s = SolveIn(GaugeMethod::kFixed, problem, &fixed); !s.ok()) return s;

  const auto of_fixed =
      ComputeCovariance(&fixed.problem, Motion(fixed.handles), {.gauge = fixed.gauge});
  if (!of_fixed.ok()) return of_fixed.status();
  const auto of_free = RawFreeGaugePseudoInverse(&free.problem);
  if (!of_free.ok()) return of_free.status();
  // To the gauge of the start, which the free solve has left.
  const auto moved =
      TransformCovariance(*of_free, MakeGauge(GaugeMethod::kFixed, 0.0, problem, free.handles));
  if (!moved.ok()) return moved.status();

  GaugeCovariances result;
  result.keyframes = static_cast<int>(problem.truth.poses.size());
  result.size = 9 * result.keyframes;
  result.free = MotionBlock(*of_free, free.handles);
  result.transformed = MotionBlock(*moved, free.handles);
  result.fixed = MotionBlock(*of_fixed, fixed.handles);
  const auto vector = [](const std::vector<double>& x) {
    return Eigen::Map<const Eigen::VectorXd>(x.data(), static_cast<Eigen::Index>(x.size()));
  };
  result.relative_error =
      (vector(result.transformed) - vector(result.fixed)).norm() / vector(result.fixed).norm();
  result.free_ellipses = Ellipses(result.free, free.states);
  result.transformed_ellipses = Ellipses(result.transformed, MovedToStart(free.states, problem));
  result.fixed_ellipses = Ellipses(result.fixed, fixed.states);
  return result;
}

}  // namespace glissade::app
