// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The walk's calls that compute, and what is asked of a problem.

#include <algorithm>
#include <cmath>
#include <utility>

#include "api/api_walk.h"

namespace glissade::test {

Gauge ApiWalk::PickGauge() {
  switch (random_.Int(6)) {
    case 0:
      return Gauge::Fixed{.anchor = PickVertexOf<VertexPose>()};
    case 1:
      return Gauge::Prior{.anchor = PickVertexOf<VertexPose>(), .weight = random_.Number()};
    case 2:
      return Gauge::FixedPoses{PickVertexOf<VertexPose>(), PickVertexOf<VertexPose>()};
    default:
      return {};
  }
}

void ApiWalk::Solve() {
  log_.emplace_back("Solve");
  Problem& problem = now_->problem;
  Model& model = now_->model;
  if (random_.Chance(0.9)) {
    Check(problem.AcknowledgeRefusal().ok() != model.refused, "AcknowledgeRefusal");
    model.refused = false;
  }
  SolveOptions options;
  options.max_iterations = random_.Int(5);
  options.allow_duplicate_observations = random_.Chance(0.9);
  if (random_.Chance(0.3)) options.method = Method::kDogleg;
  if (random_.Chance(0.2)) options.damping = Damping::kIdentity;
  if (random_.Chance(0.1)) options.damping = Damping::kPoseBlock;
  if (random_.Chance(0.1)) options.course_stop = true;
  if (random_.Chance(0.1)) options.initial_lambda = random_.Number();
  if (random_.Chance(0.05)) options.num_threads = 2;
  constexpr LinearSolverType kSolvers[] = {
      LinearSolverType::kAuto, LinearSolverType::kDenseCholesky, LinearSolverType::kSparseCholesky,
      LinearSolverType::kPcg, LinearSolverType::kImplicitPcg};
  options.linear_solver_type = kSolvers[random_.Int(5)];
  options.gauge = PickGauge();
  const SolveSummary& summary = problem.Solve(options);
  log_.back() += ": " + summary.BriefReport();
  Check(summary.ok() == summary.status.ok(), "a summary that contradicts itself");
  if (model.refused || model.edges.empty()) Check(!summary.ok(), "solved what must not be");
  Check(std::isfinite(summary.initial_cost) && std::isfinite(summary.final_cost), "cost");
  Check(summary.final_cost <= summary.initial_cost * (1.0 + 1e-9), "the cost has risen");
  for (const IterationSummary& it : summary.iterations) {
    Check(std::isfinite(it.cost) && std::isfinite(it.cost_change), "an iteration's cost");
    Check(std::isfinite(it.step_norm), "an iteration's step");
    Check(std::isfinite(it.gradient_max), "an iteration's gradient");
    Check(std::isfinite(it.gain_ratio), "an iteration's gain ratio");
    Check(std::isfinite(it.lambda), "an iteration's lambda");
  }
  // A gauge prior has a cost of its own. Costs are of any order of magnitude, of rounding too: what
  // they are held against must come from the same evaluation, and which landmarks are in groups may
  // depend on the states.
  const bool no_groups = std::ranges::all_of(
      summary.edges, [](const EdgeEvaluation& edges) { return edges.as_twists == 0; });
  if (summary.ok() && options.gauge.kind != Gauge::Kind::kPrior && no_groups) {
    Problem copy = problem.Clone();
    SolveOptions none = options;
    none.gauge = {};
    none.max_iterations = 0;
    const SolveSummary& again = copy.Solve(none);
    Check(again.ok() && std::abs(again.initial_cost - summary.final_cost) <=
                            1e-6 * summary.final_cost + 1e-300,
          "the final cost is not that of the graph");
  }
  Check(problem.first_refusal().ok() != model.refused, "a solve counts as a refusal");
  Fail(model.TakeStates(problem, options.gauge.kind == Gauge::Kind::kPrior
                                     ? Model::MayMove::kWhatIsNotFixed
                                     : Model::MayMove::kWhatIsFree));
}

void ApiWalk::Step() {
  log_.emplace_back("MakeHessian");
  Problem& problem = now_->problem;
  before_.reset();  // it compacts
  if (!End(problem.MakeHessian(), Expect::kEither, false)) return;
  log_.emplace_back("SolveLinearSystem");
  if (!End(problem.SolveLinearSystem(std::abs(random_.Number())), Expect::kEither, false)) return;
  const Snapshot before = problem.GetSnapshot();
  log_.emplace_back("UpdateStates");
  if (!End(problem.UpdateStates(), Expect::kEither, false)) return;
  if (random_.Chance(0.5)) {
    log_.emplace_back("RollbackStates");
    if (!End(problem.RollbackStates(), Expect::kAccepted, false)) return;
    Check(problem.GetSnapshot().states == before.states, "rolled back to something else");
  }
  Fail(now_->model.TakeStates(problem, Model::MayMove::kWhatIsFree));
}

void ApiWalk::Covariance() {
  log_.emplace_back("ComputeCovariance");
  const std::vector<AnyVertex> of = PickVertices(3);
  bool sound = AllDifferent(of);
  for (const AnyVertex& vertex : of)
    sound = sound && now_->model.Has(vertex);
  CovarianceOptions options;
  options.gauge = PickGauge();
  if (random_.Chance(0.1)) options.min_pivot = random_.Number();
  before_.reset();
  const auto joint = now_->problem.ComputeCovariance(of, options);
  if (!End(joint.status(), sound ? Expect::kEither : Expect::kRefused, false)) return;
  Check(AllFinite(joint->values), "a covariance that is not finite");
  for (int k = 0; k < joint->size(); ++k) {
    Check(joint->values[static_cast<std::size_t>(k * joint->size() + k)] >= 0.0,
          "a negative variance");
  }
}

void ApiWalk::Gauges() {
  before_.reset();
  if (random_.Chance(0.5)) {
    log_.emplace_back("CheckNullspace");
    const auto report = now_->problem.CheckNullspace();
    if (!End(report.status(), Expect::kEither, false)) return;
    for (const NullspaceDirection& direction : report->directions) {
      Check(std::isfinite(direction.kappa) && std::isfinite(direction.information), "kappa");
    }
    return;
  }
  log_.emplace_back("MoveToGauge");
  Begin();
  if (!End(now_->problem.MoveToGauge(PickGauge()), Expect::kEither)) return;
  Fail(now_->model.TakeStates(now_->problem, Model::MayMove::kAll));
}

void ApiWalk::Queries() {
  const AnyVertex vertex = PickVertex();
  const AnyEdge edge = PickEdge();
  log_.push_back("queries of " + ToString(vertex) + " and " + ToString(edge));
  const Problem& problem = now_->problem;
  Model& model = now_->model;
  const bool has_vertex = model.Has(vertex), has_edge = model.Has(edge);
  Check(problem.Contains(vertex) == has_vertex, "Contains(vertex)");
  Check(problem.Contains(edge) == has_edge, "Contains(edge)");
  Check(problem.EdgesOf(vertex).ok() == has_vertex, "EdgesOf");
  Check(problem.VerticesOf(edge).ok() == has_edge, "VerticesOf");
  Check(problem.LinearizationPoint(vertex).empty() != has_vertex, "LinearizationPoint");
  Check(has_vertex || !problem.HasFirstEstimate(vertex), "HasFirstEstimate");
  Check(has_edge || problem.Chi2(edge).status().code() == StatusCode::kUnknownHandle, "Chi2");
  Check(has_edge || problem.DepthOf(edge).status().code() == StatusCode::kUnknownHandle, "DepthOf");
  if (const auto pose = vertex.As<VertexPose>()) {
    Check((problem.Find(*pose) != nullptr) == has_vertex, "Find");
    Check(IsState(vertex.type, problem.Get(*pose).Data(), 7), "Get");
  }
  for (const AnyEdge& outlier : problem.GetOutlierEdges({.max_chi2 = random_.Number()}))
    Check(model.Has(outlier), "an outlier that does not exist");
}

}  // namespace glissade::test
