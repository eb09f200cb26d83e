// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "api/api_walk.h"

#include <algorithm>
#include <utility>

namespace glissade::test {

ApiWalk::ApiWalk(std::uint64_t seed) : random_(seed) {
  now_ = &worlds_.emplace_back();
  // Something to begin with, without surprises.
  const double nasty = std::exchange(random_.nasty, 0.0);
  for (int k = 0; k < 4; ++k) {
    AddVertex<VertexPose>();
    AddVertex<VertexInverseDepth>();
  }
  AddVertices<VertexPointXYZ>();
  for (int k = 0; k < 20; ++k)
    AddSomeEdge();
  random_.nasty = nasty;
}

std::string ApiWalk::Run(int num_calls) {
  for (int k = 0; k < num_calls && failure_.empty(); ++k) {
    now_ = &worlds_[static_cast<std::size_t>(random_.Int(static_cast<int>(worlds_.size())))];
    Call();
    // All of it is compared now and then: it takes longer than most calls.
    const bool whole = k % 12 == 0 || k + 1 == num_calls;
    for (World& world : worlds_) {
      if (whole && failure_.empty()) Fail(world.model.Compare(world.problem));
    }
  }
  if (failure_.empty()) return {};
  std::string text = failure_ + "\nafter";
  for (std::size_t k = log_.size() > 30 ? log_.size() - 30 : 0; k < log_.size(); ++k)
    text += "\n  " + log_[k];
  return text;
}

void ApiWalk::Call() {
  static constexpr void (ApiWalk::*kCalls[])() = {&ApiWalk::AddSomeVertex,
                                                  &ApiWalk::AddSomeVertex,
                                                  &ApiWalk::AddSomeVertex,
                                                  &ApiWalk::AddSomeEdge,
                                                  &ApiWalk::AddSomeEdge,
                                                  &ApiWalk::AddSomeEdge,
                                                  &ApiWalk::AddSomeEdge,
                                                  &ApiWalk::AddEdges,
                                                  &ApiWalk::AddPrior,
                                                  &ApiWalk::RemoveVertex,
                                                  &ApiWalk::RemoveEdge,
                                                  &ApiWalk::SetSomeValue,
                                                  &ApiWalk::SetFixed,
                                                  &ApiWalk::SetEliminated,
                                                  &ApiWalk::SetFirstEstimate,
                                                  &ApiWalk::SetWeight,
                                                  &ApiWalk::SetLoss,
                                                  &ApiWalk::Marginalize,
                                                  &ApiWalk::Marginalize,
                                                  &ApiWalk::ComputePrior,
                                                  &ApiWalk::CloneOrMove,
                                                  &ApiWalk::TakeSnapshot,
                                                  &ApiWalk::RestoreSnapshot,
                                                  &ApiWalk::Solve,
                                                  &ApiWalk::Solve,
                                                  &ApiWalk::Step,
                                                  &ApiWalk::Covariance,
                                                  &ApiWalk::Gauges,
                                                  &ApiWalk::Queries};
  (this->*kCalls[random_.Int(static_cast<int>(std::size(kCalls)))])();
}

void ApiWalk::Fail(std::string what) {
  if (failure_.empty()) failure_ = std::move(what);
}

void ApiWalk::Check(bool condition, const char* what) {
  if (!condition) Fail(what);
}

void ApiWalk::Begin() {
  before_.emplace(now_->problem);
}

bool ApiWalk::End(const Status& status, Expect expected, bool changes) {
  log_.back() += status.ok() ? ": ok" : ": " + status.message();
  if (status.ok() && expected == Expect::kRefused) Fail("taken, and should have been refused");
  if (!status.ok() && expected == Expect::kAccepted) Fail("refused, and should have been taken");
  if (status.ok()) return true;
  Check(!status.message().empty(), "a refusal without a word");
  if (changes) now_->model.refused = true;
  if (before_) {
    const std::string what = Record(now_->problem).Compare(*before_);
    if (!what.empty()) Fail("refused, and has changed: " + what);
  }
  return false;
}

// ---- Handles -----------------------------------------------------------------------------------

AnyVertex ApiWalk::PickVertex() {
  const auto& alive = now_->model.vertices;
  if (!alive.empty() && !random_.Chance(random_.nasty)) {
    return alive[static_cast<std::size_t>(random_.Int(static_cast<int>(alive.size())))].handle;
  }
  if (vertices_.empty() || random_.Chance(0.1)) return {};
  AnyVertex any =
      vertices_[static_cast<std::size_t>(random_.Int(static_cast<int>(vertices_.size())))];
  if (random_.Chance(0.1)) any.generation += 1;
  if (random_.Chance(0.1)) any.slot += 1;
  if (random_.Chance(0.1)) any.graph += 1;
  if (random_.Chance(0.1)) any.type = &kTypeInfo<VertexVector<4>>;
  return any;
}

AnyEdge ApiWalk::PickEdge() {
  const auto& alive = now_->model.edges;
  if (!alive.empty() && !random_.Chance(random_.nasty)) {
    return alive[static_cast<std::size_t>(random_.Int(static_cast<int>(alive.size())))].handle;
  }
  if (edges_.empty() || random_.Chance(0.1)) return {};
  AnyEdge any = edges_[static_cast<std::size_t>(random_.Int(static_cast<int>(edges_.size())))];
  if (random_.Chance(0.1)) any.generation += 1;
  if (random_.Chance(0.1)) any.graph += 1;
  return any;
}

std::vector<AnyVertex> ApiWalk::PickVertices(int most) {
  std::vector<AnyVertex> picked;
  const int count = 1 + random_.Int(most);
  for (int k = 0; k < count; ++k) {
    const AnyVertex vertex = PickVertex();
    // Twice the same is a mistake that is to be rare.
    const bool twice = std::count(picked.begin(), picked.end(), vertex) > 0;
    if (!twice || random_.Chance(random_.nasty)) picked.push_back(vertex);
  }
  return picked;
}

// ---- Vertices ----------------------------------------------------------------------------------

void ApiWalk::Entered(AnyVertex handle, const double* state, int dim, bool eliminated) {
  vertices_.push_back(handle);
  now_->model.vertices.push_back({.handle = handle,
                                  .state = std::vector<double>(state, state + dim),
                                  .eliminated = eliminated});
}

template <VertexType V>
void ApiWalk::AddVertex() {
  log_.push_back("AddVertex " + std::string(kTypeInfo<V>.name));
  const V value = random_.AnyVertexValue<V>();
  Begin();
  const auto added = now_->problem.AddVertex(value);
  if (!End(added.status(), AcceptedIf(IsState(&kTypeInfo<V>, value.Data(), V::kAmbientDim))))
    return;
  Entered(added.value(), value.Data(), V::kAmbientDim, kIsEliminated<V>);
}

template <VertexType V>
void ApiWalk::AddVertices() {
  log_.push_back("AddVertices " + std::string(kTypeInfo<V>.name));
  std::vector<V> values;
  bool good = true;
  for (int k = random_.Int(4); k > 0; --k) {
    values.push_back(random_.AnyVertexValue<V>());
    good = good && IsState(&kTypeInfo<V>, values.back().Data(), V::kAmbientDim);
  }
  Begin();
  const auto added = now_->problem.AddVertices(std::span<const V>(values));
  if (!End(added.status(), AcceptedIf(good))) return;
  for (std::size_t k = 0; k < values.size(); ++k)
    Entered((*added)[k], values[k].Data(), V::kAmbientDim, kIsEliminated<V>);
}

void ApiWalk::AddSomeVertex() {
  switch (random_.Int(8)) {
    case 0:
    case 1:
      return AddVertex<VertexPose>();
    case 2:
    case 3:
      return AddVertex<VertexInverseDepth>();
    case 4:
      return AddVertex<VertexPointXYZ>();
    case 5:
      return AddVertex<VertexSpeedBias>();
    case 6:
      return AddVertices<VertexPose>();
    default:
      return AddVertex<VertexVector<2>>();
  }
}

void ApiWalk::RemoveVertex() {
  const AnyVertex vertex = PickVertex();
  const auto policy = random_.Chance(0.3) ? PriorOnVertex::kRemove : PriorOnVertex::kRefuse;
  log_.push_back("RemoveVertex " + ToString(vertex));
  Model& model = now_->model;
  const bool expected =
      model.Has(vertex) && (policy == PriorOnVertex::kRemove || !model.IsUnderPrior(vertex));
  Begin();
  if (End(now_->problem.RemoveVertex(vertex, policy), AcceptedIf(expected))) model.Remove(vertex);
}

template <VertexType V>
void ApiWalk::SetValue() {
  const VertexHandle<V> vertex = PickVertexOf<V>();
  const V value = random_.AnyVertexValue<V>();
  log_.push_back("Set " + ToString(vertex));
  Model& model = now_->model;
  const bool expected = model.Has(vertex) && IsState(&kTypeInfo<V>, value.Data(), V::kAmbientDim);
  Begin();
  if (!End(now_->problem.Set(vertex, value), AcceptedIf(expected))) return;
  model.Find(vertex)->state.assign(value.Data(), value.Data() + V::kAmbientDim);
}

void ApiWalk::SetSomeValue() {
  switch (random_.Int(3)) {
    case 0:
      return SetValue<VertexPose>();
    case 1:
      return SetValue<VertexInverseDepth>();
    default:
      return SetValue<VertexSpeedBias>();
  }
}

void ApiWalk::SetFixed() {
  constexpr Fix kFixes[] = {Fix::kFree,   Fix::kWhole,      Fix::kPosition, Fix::kPositionAndYaw,
                            Fix::kBiases, Fix::kCoordinate, Fix::kNumbers,  Fix(99)};
  const AnyVertex vertex = PickVertex();
  const Fix fix = kFixes[random_.Int(8)];
  log_.push_back("SetFixed " + ToString(vertex) + " " + std::to_string(static_cast<int>(fix)));
  const bool fits = fix == Fix::kFree || fix == Fix::kWhole ||
                    (fix == Fix::kBiases && vertex.type == &kTypeInfo<VertexSpeedBias>) ||
                    ((fix == Fix::kPosition || fix == Fix::kPositionAndYaw) &&
                     vertex.type == &kTypeInfo<VertexPose>);
  Model& model = now_->model;
  Begin();
  if (!End(now_->problem.SetFixed(vertex, fix), AcceptedIf(fits && model.Has(vertex)))) return;
  model.Find(vertex)->fix = fix;
}

void ApiWalk::SetEliminated() {
  const AnyVertex vertex = PickVertex();
  const bool on = random_.Chance(0.5);
  log_.push_back("SetEliminated " + ToString(vertex));
  Model& model = now_->model;
  bool expected = model.Has(vertex);
  if (expected && on) {
    const bool small =
        vertex.type != &kTypeInfo<VertexPose> && vertex.type != &kTypeInfo<VertexSpeedBias>;
    expected = small && !model.HasEliminatedNeighbour(vertex);
  }
  Begin();
  if (!End(now_->problem.SetEliminated(vertex, on), AcceptedIf(expected))) return;
  model.Find(vertex)->eliminated = on;
}

void ApiWalk::SetFirstEstimate() {
  constexpr FirstEstimates kModes[] = {FirstEstimates::kOff, FirstEstimates::kPriorOnly,
                                       FirstEstimates::kFull};
  if (random_.Chance(0.4)) {
    log_.emplace_back("SetFirstEstimates");
    const bool is_one = random_.Chance(0.8);
    const auto mode =
        is_one ? kModes[random_.Int(3)] : static_cast<FirstEstimates>(3 + random_.Int(9));
    Begin();
    static_cast<void>(End(now_->problem.SetFirstEstimates(mode), AcceptedIf(is_one)));
    return;
  }
  const AnyVertex vertex = PickVertex();
  log_.push_back("SetFirstEstimate " + ToString(vertex));
  std::vector<double> x(7);
  const Model::Vertex* known = now_->model.Find(vertex);
  if (known != nullptr && random_.Chance(0.7)) {
    x = known->state;
    if (random_.Chance(0.3)) x.back() = random_.Number();
  } else {
    const Pose pose = random_.AnyPose();
    std::copy_n(pose.data, 7, x.begin());
  }
  const bool expected = known != nullptr && known->state.size() == x.size() &&
                        IsState(vertex.type, x.data(), x.size());
  Begin();
  if (!End(now_->problem.SetFirstEstimate(vertex, x), AcceptedIf(expected))) return;
  now_->model.Find(vertex)->has_x_lin = true;
}

}  // namespace glissade::test
