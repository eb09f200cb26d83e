// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <span>
#include <tuple>
#include <type_traits>
#include <vector>

#include "glissade/edges/concept.h"
#include "glissade/edges/same_in_run.h"
#include "glissade/graph/edge_options.h"
#include "glissade/graph/edge_pool_base.h"
#include "glissade/graph/robust.h"
#include "glissade/graph/small_blocks.h"

namespace glissade {

namespace internal {
template <class List>
struct EdgeTuples;
template <class... V>
struct EdgeTuples<VertexList<V...>> {
  using Pools = std::tuple<VertexPool<V>*...>;
  template <int R>
  using Jacobians = std::tuple<Jacobian<R, V::kTangentDim>...>;
};
}  // namespace internal

/// All edges of one typed kind: values, vertices, weights. Linearization is a loop without virtual
/// calls over fixed-size blocks.
template <EdgeType E>
class EdgePool final : public EdgePoolBase {
 public:
  static constexpr int kArity = E::Vertices::kSize;
  static constexpr int kRows = E::kResidualDim;
  static_assert(kArity <= kMaxTypedArity, "a typed edge has at most 16 vertices");
  using Pools = typename internal::EdgeTuples<typename E::Vertices>::Pools;
  using Jacobians = typename internal::EdgeTuples<typename E::Vertices>::template Jacobians<kRows>;
  using SqrtInformation = SquareMatrix<kRows>;
  using VertexSlots = std::array<std::uint32_t, kArity>;

  // What adding needs is defined below and not inline: with pools of built-in types compiled in the
  // library (builtin_pools.h), a consumer's unit then compiles nothing of them.
  explicit EdgePool(const Pools& pools);

  // No Eigen type in any public signature: pools of built-in edges are compiled in the library
  // only (builtin_pools.h), which knows Eigen under another name.
  /// sqrt_information: kRows x kRows, row-major. Reserve() comes first; where the copy of the edge
  /// or of a new loss throws nonetheless, nothing has been added.
  EdgeHandle<E> Add(const E& edge, const EdgeVertexHandles<E>& vertices,
                    const double* sqrt_information, bool identity, const Loss& loss,
                    std::uint64_t stamp, std::uint32_t graph);
  /// All alive, all different, at most one of them eliminated.
  [[nodiscard]] bool CanJoin(const EdgeVertexHandles<E>& vertices) const;
  /// Room for edges on these vertices: adding them will not allocate.
  void Reserve(std::span<const EdgeVertexHandles<E>> vertices);

  [[nodiscard]] const E& At(int edge) const { return edges_[Index(edge)]; }
  [[nodiscard]] E& At(int edge) { return edges_[Index(edge)]; }
  [[nodiscard]] const double* sqrt_information(int edge) const {
    return sqrt_information_[Index(edge)].data();
  }
  [[nodiscard]] bool HasIdentityInformation(int edge) const { return identity_[Index(edge)] != 0; }
  void set_sqrt_information(int edge, const double* value, bool identity) {
    sqrt_information_[Index(edge)] = SqrtInformation(value);
    identity_[Index(edge)] = identity ? 1 : 0;
  }
  [[nodiscard]] const Pools& pools() const { return pools_; }

  /// The vertices of an edge that is alive.
  [[nodiscard]] EdgeVertexHandles<E> HandlesOf(int edge) const {
    EdgeVertexHandles<E> handles;
    ForEachIndex<kArity>([&](auto i) {
      const internal::SlotMap& slots = std::get<i>(pools_)->slots();
      const std::uint32_t slot = vertices_[Index(edge)][i];
      std::get<i>(handles) = {slot, slots.GenerationOf(slot), slots.GraphOf(slot)};
    });
    return handles;
  }

  [[nodiscard]] int arity(int) const override { return kArity; }
  [[nodiscard]] int residual_dim(int) const override { return kRows; }
  [[nodiscard]] VertexPoolBase* vertex_pool(int, int i) const override {
    VertexPoolBase* pool = nullptr;
    ForEachIndex<kArity>([&](auto k) {
      if (k == i) pool = std::get<k>(pools_);
    });
    return pool;
  }
  [[nodiscard]] std::uint32_t vertex_slot(int edge, int i) const override {
    return vertices_[Index(edge)][static_cast<std::size_t>(i)];
  }

  [[nodiscard]] int fixed_arity() const override { return kArity; }
  void AllDenseIndices(std::int32_t* indices) const override {
    for (int edge = 0; edge < size(); ++edge, indices += kArity)
      DenseIndices(edge, indices);
  }

  bool Evaluate(int edge, const double* const* states, double* residual,
                double* const* jacobians) const override {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      Vector<kRows> r;
      Jacobians J;
      const std::tuple<EdgeVertex<E, I>...> vertices(
          internal::VertexFromData<EdgeVertex<E, I>>(states[I])...);
      const bool ok = internal::EvaluateEdge(
          At(edge), std::tuple<const EdgeVertex<E, I>&...>(std::get<I>(vertices)...), r,
          (jacobians != nullptr && jacobians[I] != nullptr ? &std::get<I>(J) : nullptr)...);
      double poison = internal::Poison<kRows>(r.data());
      if (!ok || poison != 0.0) return false;
      std::copy_n(r.data(), kRows, residual);
      const auto copy = [&]<int kSize>(std::integral_constant<int, kSize>, const double* block,
                                       double* out) {
        poison += internal::Poison<kSize>(block);
        std::copy_n(block, kSize, out);
      };
      if (jacobians != nullptr) {
        ((jacobians[I] != nullptr
              ? copy(std::integral_constant<int, kRows * EdgeVertex<E, I>::kTangentDim>{},
                     std::get<I>(J).data(), jacobians[I])
              : void()),
         ...);
      }
      return poison == 0.0;
    }
    (std::make_index_sequence<kArity>{});
  }

  [[nodiscard]] const double* whitening(int edge) const override {
    return identity_[Index(edge)] != 0 ? nullptr : sqrt_information(edge);
  }
  [[nodiscard]] bool SameInRun(int edge, int other) const override {
    if constexpr (kEvaluatesInPacks<E>) {
      static_assert(internal::kKnowsWhatDiffers<E>,
                    "the edge has members that are not in kLanes: it needs a SameSensor (or a "
                    "SameInRun) `bool SameSensor(const E& other) const` that compares them; one of "
                    "a base does not know the members that the edge adds");
    }
    if constexpr (requires(const E& e) { e.SameInRun(e); }) {
      return At(edge).SameInRun(At(other));
    } else if constexpr (kEvaluatesInPacks<E> && requires(const E& e) { e.SameSensor(e); }) {
      return At(edge).SameSensor(At(other));
    } else {
      return true;
    }
  }
  [[nodiscard]] const void* edges() const override { return edges_.data(); }

  void Whiten(int edge, double* residual, double* const* jacobians) const override {
    if (identity_[Index(edge)] != 0) return;
    const double* L = sqrt_information(edge);
    internal::MultiplyInPlace<kRows, 1>(L, residual);
    if (jacobians == nullptr) return;
    ForEachIndex<kArity>([&](auto i) {
      if (jacobians[i] == nullptr) return;
      internal::MultiplyInPlace<kRows, EdgeVertex<E, i>::kTangentDim>(L, jacobians[i]);
    });
  }

  [[nodiscard]] double Chi2(int edge) const override {
    return Apply(DenseIndices(edge), [&](const auto&... vertex) {
      Vector<kRows> r;
      if (!EvaluateResidual(At(edge), r, vertex...))
        return std::numeric_limits<double>::quiet_NaN();
      return WhitenedSquaredNorm(edge, r);
    });
  }

  bool Depth(int edge, double* depth) const override {
    return Apply(DenseIndices(edge), [&](const auto&... vertex) {
      if constexpr (requires(const E& e) {
                      { e.Depth(vertex...) } -> std::convertible_to<double>;
                    }) {
        *depth = At(edge).Depth(vertex...);
        return true;
      } else {
        return false;
      }
    });
  }

  [[nodiscard]] const double* Extrinsic(int edge) const override {
    if constexpr (requires(const E& e) {
                    { &e.T_b_c } -> std::same_as<const Pose*>;
                  }) {
      return At(edge).T_b_c.data;
    } else {
      return nullptr;
    }
  }

  bool TwoView(int edge, TwoViewObservation* observation) const override {
    // The library's own types only: these are equal within a run in all that is not measured.
    if constexpr (internal::kLibraryEvaluates<E> && requires(const E& e) { e.TwoView(); }) {
      *observation = At(edge).TwoView();
      return true;
    } else {
      static_cast<void>(edge);
      static_cast<void>(observation);
      return false;
    }
  }

  [[nodiscard]] bool IsDuplicate(int edge, int other) const override {
    if constexpr (requires(const E& e) {
                    { e.SameSensor(e) } -> std::convertible_to<bool>;
                  }) {
      return kEdgeTraits<E>.is_observation && At(edge).SameSensor(At(other));
    } else {
      return kEdgeTraits<E>.is_observation;
    }
  }

  bool Linearize(const std::int32_t* words, int count, NormalEquationsSink* sink) const override {
    for (int k = 0; k < count; ++k, words += plan::NumWords(kArity)) {
      if (!LinearizeOne(words, sink)) {
        sink->failed_edge = words[plan::kEdge];
        return false;
      }
    }
    return true;
  }

  bool Cost(const std::int32_t* words, int count, NormalEquationsSink* sink) const override {
    for (int k = 0; k < count; ++k, words += plan::NumWords(kArity)) {
      const int edge = words[plan::kEdge];
      const double cost = Apply(words + plan::State(0), [&](const auto&... vertex) {
        Vector<kRows> r;
        if (!EvaluateResidual(At(edge), r, vertex...)) {
          return std::numeric_limits<double>::quiet_NaN();
        }
        const double s = WhitenedSquaredNorm(edge, r);
        const Loss& rho = loss(edge);
        // Before a bounded loss makes a number of it.
        if (std::isnan(s)) return s;
        return rho.trivial() ? 0.5 * s : internal::RobustScale(rho, s).cost;
      });
      if (!std::isfinite(cost)) {
        sink->failed_edge = edge;
        return false;
      }
      sink->cost += cost;
    }
    return true;
  }

  void Compact() override {
    if (slots_.NumAlive() == size()) return;
    slots_.Compact([this](int from, int to) {
      const std::size_t f = Index(from), t = Index(to);
      edges_[t] = std::move(edges_[f]);
      vertices_[t] = vertices_[f];
      sqrt_information_[t] = sqrt_information_[f];
      identity_[t] = identity_[f];
      loss_of_edge_[t] = loss_of_edge_[f];
    });
    const auto n = static_cast<std::size_t>(slots_.Size());
    edges_.erase(edges_.begin() + static_cast<std::ptrdiff_t>(n), edges_.end());
    vertices_.resize(n);
    sqrt_information_.resize(n);
    identity_.resize(n);
    loss_of_edge_.resize(n);
    lists_.Clear();
    for (int edge = 0; edge < size(); ++edge)
      Link(edge);
  }

  [[nodiscard]] std::unique_ptr<EdgePoolBase> Clone(
      const std::vector<std::unique_ptr<VertexPoolBase>>& vertex_pools, AnyEdge*) const override {
    auto copy = std::make_unique<EdgePool>(*this);
    ForEachIndex<kArity>([&](auto i) {
      for (const auto& pool : vertex_pools) {
        if (pool->ops().type == &kTypeInfo<EdgeVertex<E, i>>) {
          std::get<i>(copy->pools_) = static_cast<VertexPool<EdgeVertex<E, i>>*>(pool.get());
        }
      }
    });
    copy->lists_.Rebind(vertex_pools);
    return copy;
  }

 private:
  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }

  /// Which column of lists_ the vertices of each argument have: one for each type.
  static constexpr std::array<int, kArity> kColumn = [] {
    std::array<int, kArity> column{};
    int count = 0;
    ForEachIndex<kArity>([&](auto i) {
      int first = -1;
      ForEachIndex<i>([&](auto j) {
        if constexpr (std::is_same_v<EdgeVertex<E, i>, EdgeVertex<E, j>>) {
          if (first < 0) first = column[j];
        }
      });
      column[i] = first >= 0 ? first : count++;
    });
    return column;
  }();

  void Link(int edge) {
    const VertexSlots& slots = vertices_[Index(edge)];
    for (std::size_t i = 0; i < slots.size(); ++i)
      lists_.Append(kColumn[i], slots[i], edge);
  }

  void DenseIndices(int edge, std::int32_t* indices) const {
    ForEachIndex<kArity>([&](auto i) {
      indices[i] = std::get<i>(pools_)->slots().IndexOf(vertices_[Index(edge)][i]);
    });
  }
  [[nodiscard]] std::array<std::int32_t, kArity> DenseIndices(int edge) const {
    std::array<std::int32_t, kArity> indices;
    DenseIndices(edge, indices.data());
    return indices;
  }

  template <class Indices, class F>
  auto Apply(const Indices& state, F&& f) const {
    return [&]<std::size_t... I>(std::index_sequence<I...>) {
      return f(std::get<I>(pools_)->At(state[I])...);
    }
    (std::make_index_sequence<kArity>{});
  }

  template <class... V>
  static bool EvaluateResidual(const E& edge, Vector<kRows>& r, const V&... vertex) {
    return internal::EvaluateEdge(edge, std::tuple<const V&...>(vertex...), r,
                                  static_cast<Jacobian<kRows, V::kTangentDim>*>(nullptr)...);
  }

  double WhitenedSquaredNorm(int edge, Vector<kRows> r) const {
    if (identity_[Index(edge)] == 0) {
      internal::MultiplyInPlace<kRows, 1>(sqrt_information(edge), r.data());
    }
    return internal::SquaredNorm<kRows>(r.data());
  }

  bool LinearizeOne(const std::int32_t* words, NormalEquationsSink* sink) const;
  bool EvaluateFirstEstimates(const std::int32_t* words, double* residual,
                              Jacobians* jacobians) const;
  bool AccumulateWide(const std::int32_t* words, const double* r, const Jacobians& jacobians,
                      NormalEquationsSink* sink) const;
  template <int I>
  static void ScatterWide(const std::int32_t* words, const double* products, const double* gradient,
                          NormalEquationsSink* sink);
  template <int I>
  static void AccumulateVertex(const std::int32_t* words, const double* r,
                               const Jacobians& jacobians, NormalEquationsSink* sink);
  template <int I, int J>
  static void AccumulatePair(const std::int32_t* words, const Jacobians& jacobians,
                             NormalEquationsSink* sink);

  Pools pools_;
  std::vector<E> edges_;
  std::vector<VertexSlots> vertices_;
  std::vector<SqrtInformation> sqrt_information_;
  std::vector<std::uint8_t> identity_;
};

template <EdgeType E>
EdgePool<E>::EdgePool(const Pools& pools)
    : EdgePoolBase(&kTypeInfo<E>, kEdgeTraits<E>, kArity), pools_(pools) {
  ForEachIndex<kArity>([&](auto i) { lists_.ColumnOf(std::get<i>(pools_)); });
}

template <EdgeType E>
EdgeHandle<E> EdgePool<E>::Add(const E& edge, const EdgeVertexHandles<E>& vertices,
                               const double* sqrt_information, bool identity, const Loss& loss,
                               std::uint64_t stamp, std::uint32_t graph) {
  VertexSlots slots;
  ForEachIndex<kArity>([&](auto i) { slots[i] = std::get<i>(vertices).slot; });
  const std::uint32_t loss_index = FindOrAddLoss(loss);
  edges_.push_back(edge);
  vertices_.push_back(slots);
  sqrt_information_.emplace_back(sqrt_information);
  identity_.push_back(identity ? 1 : 0);
  loss_of_edge_.push_back(loss_index);
  const auto address = slots_.Add(stamp, graph);
  Link(size() - 1);
  return {address.slot, address.generation, graph};
}

template <EdgeType E>
bool EdgePool<E>::CanJoin(const EdgeVertexHandles<E>& vertices) const {
  int eliminated = 0;
  bool ok = true;
  ForEachIndex<kArity>([&](auto i) {
    const auto& vertex = std::get<i>(vertices);
    const auto* pool = std::get<i>(pools_);
    ok = ok && pool->slots().Contains(vertex);
    if (ok && pool->eliminated(pool->slots().IndexOf(vertex.slot))) ++eliminated;
    ForEachIndex<i>([&](auto j) {
      if constexpr (std::is_same_v<EdgeVertex<E, i>, EdgeVertex<E, j>>) {
        ok = ok && vertex.slot != std::get<j>(vertices).slot;
      }
    });
  });
  return ok && eliminated <= 1;
}

template <EdgeType E>
void EdgePool<E>::Reserve(std::span<const EdgeVertexHandles<E>> vertices) {
  const std::size_t count = vertices.size();
  slots_.MakeRoom(count);
  internal::MakeRoomIn(&edges_, count);
  internal::MakeRoomIn(&vertices_, count);
  internal::MakeRoomIn(&sqrt_information_, count);
  internal::MakeRoomIn(&identity_, count);
  internal::MakeRoomIn(&loss_of_edge_, count);
  lists_.MakeRoomForLinks(kArity * count);
  ForEachIndex<kArity>([&](auto i) {
    std::uint32_t last = 0;
    for (const EdgeVertexHandles<E>& of_edge : vertices)
      last = std::max(last, std::get<i>(of_edge).slot);
    lists_.MakeRoom(kColumn[i], last);
  });
}

}  // namespace glissade

#include "glissade/graph/edge_pool_linearize.h"
