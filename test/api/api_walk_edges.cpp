// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The walk's calls about edges.

#include <tuple>
#include <utility>

#include "api/api_walk.h"

namespace glissade::test {

template <EdgeType E>
void ApiWalk::AddEdge(const E& edge, const EdgeVertexHandles<E>& on) {
  log_.push_back(std::string("AddEdge ").append(kTypeInfo<E>.name));
  std::vector<AnyVertex> handles;
  std::apply([&](const auto&... handle) { (handles.push_back(handle), ...); }, on);
  EdgeOptions<E> options;
  if (random_.Chance(0.5)) options.sqrt_information = random_.AnyInformation<E::kResidualDim>();
  if (random_.Chance(0.1)) options.information = random_.AnyInformation<E::kResidualDim>();
  options.loss = random_.AnyLoss();
  // What is said of weights and losses is the library's own: the tests of these are elsewhere.
  const bool must_refuse = !now_->model.CanJoin(handles) || !edge.Validate().ok();
  const bool plain = !options.sqrt_information && !options.information && options.loss.trivial();
  Begin();
  const auto added = now_->problem.AddEdge(edge, on, options);
  const Expect expected = must_refuse ? Expect::kRefused
                          : plain     ? Expect::kAccepted
                                      : Expect::kEither;
  if (!End(added.status(), expected)) return;
  edges_.emplace_back(added.value());
  now_->model.AddEdge(added.value(), std::move(handles), false);
}

void ApiWalk::AddSomeEdge() {
  const auto pose = [&] { return PickVertexOf<VertexPose>(); };
  switch (random_.Int(7)) {
    case 0:
      return AddEdge(EdgeSE3Prior{random_.AnyPose()}, {pose()});
    case 1:
      return AddEdge(EdgeRelativePose{random_.AnyPose()}, {pose(), pose()});
    case 2:
      return AddEdge(EdgeSpeedBiasPrior{random_.AnyVertexValue<VertexSpeedBias>()},
                     {PickVertexOf<VertexSpeedBias>()});
    case 3: {
      EdgeReprojectionXYZ edge;
      random_.Fill(edge.uv.data(), 2);
      return AddEdge(edge, {pose(), PickVertexOf<VertexPointXYZ>()});
    }
    default: {
      EdgeReprojection edge;
      random_.Fill(edge.uv_host.data(), 2);
      random_.Fill(edge.uv_target.data(), 2);
      if (random_.Chance(random_.nasty)) edge.T_b_c = random_.AnyPose();
      return AddEdge(edge, {pose(), pose(), PickVertexOf<VertexInverseDepth>()});
    }
  }
}

void ApiWalk::AddEdges() {
  log_.emplace_back("AddEdges");
  std::vector<EdgeSE3Prior> edges;
  std::vector<EdgeVertexHandles<EdgeSE3Prior>> on;
  bool good = true;
  for (int k = random_.Int(4); k > 0; --k) {
    edges.push_back({random_.AnyPose()});
    on.emplace_back(PickVertexOf<VertexPose>());
    good = good && edges.back().Validate().ok() && now_->model.Has(std::get<0>(on.back()));
  }
  if (random_.Chance(random_.nasty)) {
    on.emplace_back();
    good = false;
  }
  Begin();
  const auto added = now_->problem.AddEdges(std::span<const EdgeSE3Prior>(edges),
                                            std::span<const EdgeVertexHandles<EdgeSE3Prior>>(on));
  if (!End(added.status(), AcceptedIf(good))) return;
  for (std::size_t k = 0; k < added->size(); ++k) {
    edges_.emplace_back((*added)[k]);
    now_->model.AddEdge((*added)[k], {std::get<0>(on[k])}, false);
  }
}

void ApiWalk::RemoveEdge() {
  const AnyEdge edge = PickEdge();
  log_.push_back("RemoveEdge " + ToString(edge));
  Begin();
  if (End(now_->problem.RemoveEdge(edge), AcceptedIf(now_->model.Has(edge)))) {
    now_->model.Remove(edge);
  }
}

template <EdgeType E>
void ApiWalk::SetInformation() {
  const EdgeHandle<E> edge = PickEdgeOf<E>();
  const SquareMatrix<E::kResidualDim> m = random_.AnyInformation<E::kResidualDim>();
  log_.push_back("SetInformation " + ToString(edge));
  const bool refused = !now_->model.Has(edge) || !m.allFinite();
  Begin();
  const Status status = random_.Chance(0.5) ? now_->problem.SetInformation(edge, m)
                                            : now_->problem.SetSqrtInformation(edge, m);
  (void)End(status, refused ? Expect::kRefused : Expect::kEither);
}

void ApiWalk::SetWeight() {
  return random_.Chance(0.5) ? SetInformation<EdgeReprojection>() : SetInformation<EdgeSE3Prior>();
}

void ApiWalk::SetLoss() {
  const AnyEdge edge = PickEdge();
  const Loss loss = random_.AnyLoss();
  log_.push_back("SetLoss " + ToString(edge));
  const bool quadratic = edge.type == &kTypeInfo<DynamicEdge>;
  const bool expected =
      now_->model.Has(edge) && loss.Validate().ok() && (loss.trivial() || !quadratic);
  Begin();
  (void)End(now_->problem.SetLoss(edge, loss), AcceptedIf(expected));
}

}  // namespace glissade::test
