// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The walk's calls about marginal priors, copies and snapshots.

#include <algorithm>
#include <utility>

#include "api/api_walk.h"
#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"

namespace glissade::test {

namespace {

/// Whether numbers are states of these vertices, one after the other.
bool AreStates(Model* model, const std::vector<AnyVertex>& vertices,
               const std::vector<double>& states) {
  std::size_t at = 0;
  for (const AnyVertex& vertex : vertices) {
    const Model::Vertex* known = model->Find(vertex);
    if (known == nullptr || at + known->state.size() > states.size()) return false;
    if (!IsState(vertex.type, states.data() + at, known->state.size())) return false;
    at += known->state.size();
  }
  return at == states.size() && AllDifferent(vertices);
}

}  // namespace

// ---- Priors ------------------------------------------------------------------------------------

void ApiWalk::AddPrior() {
  log_.emplace_back("AddEdge, marginal prior");
  Model& model = now_->model;
  const std::vector<AnyVertex> on = PickVertices(3);
  std::vector<const VertexOps*> types;
  std::vector<double> x0;
  int dim = 0;
  bool good = true;
  for (const AnyVertex& vertex : on) {
    const Model::Vertex* known = model.Find(vertex);
    if (known == nullptr) return;  // of what type should it be?
    types.push_back(&now_->problem.PoolOf(vertex.type)->ops());
    dim += types.back()->tangent_dim;
    std::vector<double> x = known->state;
    if (random_.Chance(random_.nasty)) x.back() = random_.Number();
    good = good && IsState(vertex.type, x.data(), x.size());
    x0.insert(x0.end(), x.begin(), x.end());
  }
  const int rows = 1 + random_.Int(dim);
  std::vector<double> r0(static_cast<std::size_t>(rows));
  std::vector<double> J(static_cast<std::size_t>(rows * dim));
  const double nasty = random_.nasty;
  if (random_.Chance(0.8)) random_.nasty = 0.0;
  random_.Fill(r0.data(), rows);
  random_.Fill(J.data(), rows * dim);
  random_.nasty = nasty;
  auto made = EdgeMarginalPrior::Create(types, x0, r0, J);
  if (made.ok()) {
    Check(good && AllFinite(r0) && AllFinite(J), "a prior of what are no numbers");
  }
  if (!made.ok()) return;
  Begin();
  const auto added = now_->problem.AddEdge(std::move(made).value(), on);
  if (!End(added.status(), AcceptedIf(model.CanJoin(on)))) return;
  edges_.emplace_back(added.value());
  model.AddEdge(added.value(), on, true);
}

void ApiWalk::Marginalize() {
  const std::vector<AnyVertex> going = PickVertices(3);
  log_.push_back("Marginalize " + std::to_string(going.size()) + " from " + ToString(going[0]));
  Model& model = now_->model;
  MarginalizeOptions options;
  if (random_.Chance(0.3)) options.form = MarginalForm::kSchur;
  if (random_.Chance(0.3)) options.root = InformationRoot::kEigen;
  if (random_.Chance(0.1)) options.relative_cut = random_.Number();
  std::vector<AnyEdge> drop;
  if (random_.Chance(0.2)) drop.push_back(PickEdge());
  options.drop = drop;
  bool sound = AllDifferent(going) && (drop.empty() || model.Has(drop[0]));
  for (const AnyVertex& vertex : going)
    sound = sound && model.Has(vertex);
  Begin();
  const auto done = now_->problem.Marginalize(going, options);
  if (!End(done.status(), sound ? Expect::kEither : Expect::kRefused)) return;
  Check(std::isfinite(done->report.constant_cost), "constant cost of a marginalization");
  if (done->prior != EdgeHandle<DynamicEdge>()) {
    const auto on = now_->problem.VerticesOf(done->prior);
    Check(on.ok() && AllDifferent(on.value()), "vertices of the new prior");
    for (const AnyVertex& vertex : on.value()) {
      const bool stays = std::count(going.begin(), going.end(), vertex) == 0;
      if (!stays || !model.Has(vertex)) return Fail("a prior on " + ToString(vertex));
    }
    edges_.emplace_back(done->prior);
    model.AddEdge(done->prior, on.value(), true);
  }
  for (const AnyVertex& vertex : going)
    model.Remove(vertex);
  model.TakeElimination(now_->problem);
}

void ApiWalk::ComputePrior() {
  log_.emplace_back("ComputeMarginalPrior");
  const std::vector<AnyVertex> going = PickVertices(3);
  bool sound = AllDifferent(going);
  for (const AnyVertex& vertex : going)
    sound = sound && now_->model.Has(vertex);
  Begin();
  const auto prior = now_->problem.ComputeMarginalPrior(going);
  if (!End(prior.status(), sound ? Expect::kEither : Expect::kRefused, false)) return;
  Check(AllFinite(prior->x0) && AllFinite(prior->r0) && AllFinite(prior->jacobian),
        "a prior that is not finite");
}

// ---- Copies ------------------------------------------------------------------------------------

void ApiWalk::CloneOrMove() {
  const int what = random_.Int(5);
  if (what == 0) {
    log_.emplace_back("Compact");
    return now_->problem.Compact();
  }
  if (what == 1) {
    log_.emplace_back("move, and back");
    Problem moved = std::move(now_->problem);
    // NOLINTNEXTLINE: what is left behind is to be of use.
    Check(now_->problem.NumVertices() == 0 && now_->problem.first_refusal().ok(), "moved from");
    Check(now_->problem.Vertices().empty() && now_->problem.Edges().empty(), "moved from");
    now_->problem = std::move(moved);
    return;
  }
  World* target = nullptr;
  if (worlds_.size() < 3) {
    target = &worlds_.emplace_back();
  } else {
    target = &worlds_[static_cast<std::size_t>(random_.Int(3))];
    if (target == now_) return;
  }
  if (what == 2) {
    log_.emplace_back("a new problem");
    target->problem = Problem();
    target->model = Model();
    return;
  }
  log_.emplace_back("Clone");
  Begin();
  Result<Problem> copy = now_->problem.Clone();
  if (!End(copy.status(), Expect::kAccepted, false)) return;
  target->problem = std::move(copy).value();
  target->model = now_->model;
}

void ApiWalk::TakeSnapshot() {
  log_.emplace_back("GetSnapshot");
  snapshots_.push_back(now_->problem.GetSnapshot());
  const Snapshot& snapshot = snapshots_.back();
  Check(AreStates(&now_->model, snapshot.vertices, snapshot.states), "states of a snapshot");
  Check(AreStates(&now_->model, snapshot.first_estimate_vertices, snapshot.first_estimates),
        "linearization points of a snapshot");
}

void ApiWalk::RestoreSnapshot() {
  if (snapshots_.empty() || random_.Chance(0.3)) TakeSnapshot();
  const int pick = random_.Int(static_cast<int>(snapshots_.size()));
  Snapshot s =
      snapshots_[random_.Chance(0.5) ? snapshots_.size() - 1 : static_cast<std::size_t>(pick)];
  log_.emplace_back("RestoreSnapshot");
  const auto any = [&](auto& list) -> auto& {
    return list[static_cast<std::size_t>(random_.Int(static_cast<int>(list.size())))];
  };
  if (random_.Chance(0.1) && !s.states.empty()) any(s.states) = random_.Number();
  if (random_.Chance(0.05) && !s.vertices.empty()) any(s.vertices) = PickVertex();
  if (random_.Chance(0.05) && !s.states.empty()) s.states.pop_back();
  if (random_.Chance(0.1) && !s.first_estimates.empty()) any(s.first_estimates) = random_.Number();
  if (random_.Chance(0.3) && !s.free_tangents.empty()) {
    FreeTangent& chart = any(s.free_tangents);
    chart.free_dim = random_.Int(100) - 20;
    chart.tangent_dim = random_.Int(100) - 20;
    if (random_.Chance(0.3)) random_.Fill(chart.q0, 4);
    if (random_.Chance(0.3)) random_.Fill(chart.dphi, 3);
    if (random_.Chance(0.1)) s.free_tangents.push_back(chart);
  }
  Model& model = now_->model;
  bool good = s.vertices.size() == model.vertices.size() &&
              AreStates(&model, s.vertices, s.states) &&
              AreStates(&model, s.first_estimate_vertices, s.first_estimates);
  std::vector<AnyVertex> charts;
  for (const FreeTangent& chart : s.free_tangents) {
    double pose[7] = {};
    std::copy_n(chart.q0, 4, pose + 3);
    std::copy_n(chart.dphi, 3, pose);
    good = good && IsState(&kTypeInfo<VertexPose>, pose, 7);
    charts.push_back(chart.vertex);
  }
  good = good && AllDifferent(charts);
  Begin();
  if (!End(now_->problem.RestoreSnapshot(s), AcceptedIf(good))) return;
  const double* from = s.states.data();
  for (const AnyVertex& vertex : s.vertices) {
    std::vector<double>& state = model.Find(vertex)->state;
    std::copy_n(from, state.size(), state.begin());
    from += state.size();
  }
  for (Model::Vertex& vertex : model.vertices)
    vertex.has_x_lin = vertex.has_x_lin && model.IsUnderPrior(vertex.handle);
  for (const AnyVertex& vertex : s.first_estimate_vertices)
    model.Find(vertex)->has_x_lin = true;
}

}  // namespace glissade::test
