// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gauge/gauge_breaches.h"

#include <algorithm>
#include <cmath>

#include "gauge/gauge_vectors.h"
#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/graph/robust.h"

namespace glissade {

namespace {

using internal::Index;

}  // namespace

GaugeBreaches::GaugeBreaches(const Graph& graph, const LinearizedStates& point, const Orbit& orbit,
                             double tolerance, BreachPoint where)
    : graph_(graph), point_(point), orbit_(orbit), tolerance_(tolerance), where_(where) {}

void GaugeBreaches::Gather(const EdgePoolBase& pool, int edge) {
  const int arity = pool.arity(edge);
  if (vertices_.size() < Index(arity)) vertices_.resize(Index(arity));
  states_.resize(Index(arity));
  const bool at_first = graph_.first_estimates() == FirstEstimates::kFull;
  for (int i = 0; i < arity; ++i) {
    const VertexPoolBase& vertices = *pool.vertex_pool(edge, i);
    const int index = vertices.slots().IndexOf(pool.vertex_slot(edge, i));
    Vertex& vertex = vertices_[Index(i)];
    vertex.dim = vertices.ops().tangent_dim;
    vertex.moves = orbit_.Moves(vertices.HandleAt(index));
    const Fix fix = vertices.fix(index);
    // Biases and plain numbers do not move with the gauge: holding them takes nothing from u.
    vertex.free = fix == Fix::kFree || fix == Fix::kBiases || fix == Fix::kNumbers;
    const double* state = point_.State(vertices, index);
    if (vertex.moves) {
      const double* gauge_state =
          where_ == BreachPoint::kPresent ? state : GaugeState(vertices, index, point_);
      orbit_.Directions(vertices.HandleAt(index), gauge_state, vertex.U);
      if (at_first && gauge_state != state) {
        // Of speed and biases only the speed is taken back.
        std::copy_n(state, vertices.ops().ambient_dim, vertex.state);
        std::copy_n(gauge_state, vertices.ops().first_estimate_size, vertex.state);
        state = vertex.state;
      }
    }
    states_[Index(i)] = state;
  }
}

bool GaugeBreaches::Quadratic(const EdgePoolBase& pool, int edge, const double* H, double* free_sum,
                              double* sum) {
  const int n = orbit_.dim();
  const int arity = pool.arity(edge);
  int size = 0;
  for (int i = 0; i < arity; ++i)
    size += vertices_[Index(i)].dim;
  double terms[Orbit::kMaxDim] = {};
  int row = 0;
  for (int i = 0; i < arity; row += vertices_[Index(i)].dim, ++i) {
    const Vertex& a = vertices_[Index(i)];
    if (!a.moves) continue;
    for (int j = 0, col = 0; j <= i; col += vertices_[Index(j)].dim, ++j) {
      const Vertex& b = vertices_[Index(j)];
      if (!b.moves) continue;
      for (int k = 0; k < n; ++k) {
        double form = 0.0;
        for (int r = 0; r < a.dim; ++r) {
          const double* h = H + static_cast<std::ptrdiff_t>(row + r) * size + col;
          double product = 0.0;
          for (int c = 0; c < b.dim; ++c)
            product += h[c] * b.U[c * n + k];
          form += a.U[r * n + k] * product;
        }
        if (i == j) terms[k] += form;
        sum[k] += i == j ? form : 2.0 * form;
        if (a.free && b.free) free_sum[k] += i == j ? form : 2.0 * form;
      }
    }
  }
  blind_ = true;
  for (int k = 0; k < n; ++k)
    blind_ = blind_ && sum[k] <= 1e-13 * terms[k];
  return true;
}

bool GaugeBreaches::Evaluate(const EdgePoolBase& pool, int edge, double* free_sum, double* sum) {
  const int n = orbit_.dim();
  std::fill_n(sum, n, 0.0);
  std::fill_n(free_sum, n, 0.0);
  Gather(pool, edge);
  if (pool.type() == &kTypeInfo<DynamicEdge>) {
    const double* H = static_cast<const DynamicEdgePool&>(pool).At(edge).ConstantHessian();
    if (H != nullptr) return Quadratic(pool, edge, H, free_sum, sum);
  }
  const int arity = pool.arity(edge);
  const int rows = pool.residual_dim(edge);
  std::size_t size = 0;
  for (int i = 0; i < arity; ++i)
    size += Index(rows * vertices_[Index(i)].dim);
  residual_.resize(std::max(residual_.size(), Index(rows)));
  jacobian_.resize(std::max(jacobian_.size(), size));
  jacobian_of_.resize(Index(arity));
  double* next = jacobian_.data();
  for (int i = 0; i < arity; ++i) {
    const Vertex& vertex = vertices_[Index(i)];
    jacobian_of_[Index(i)] = vertex.moves ? next : nullptr;
    next += rows * vertex.dim;
  }
  if (!pool.Evaluate(edge, states_.data(), residual_.data(), jacobian_of_.data())) return false;

  // J u first, then whitened: less to whiten than J, or than one product per vertex.
  products_.assign(Index(rows * n * 2), 0.0);
  double* const free = products_.data();
  double* const all = free + rows * n;
  double terms[Orbit::kMaxDim] = {};
  bool all_free = true;
  for (int i = 0; i < arity; ++i) {
    const Vertex& vertex = vertices_[Index(i)];
    if (!vertex.moves) continue;
    all_free = all_free && vertex.free;
    for (int r = 0; r < rows; ++r) {
      const double* J = jacobian_of_[Index(i)] + r * vertex.dim;
      double product[Orbit::kMaxDim] = {};
      for (int c = 0; c < vertex.dim; ++c) {
        for (int k = 0; k < n; ++k)
          product[k] += J[c] * vertex.U[c * n + k];
      }
      for (int k = 0; k < n; ++k) {
        terms[k] += product[k] * product[k];
        all[k * rows + r] += product[k];
        if (vertex.free) free[k * rows + r] += product[k];
      }
    }
  }
  blind_ = true;
  for (int k = 0; k < n; ++k) {
    double square = 0.0;
    for (int r = 0; r < rows; ++r)
      square += all[k * rows + r] * all[k * rows + r];
    blind_ = blind_ && square <= 1e-20 * terms[k];
    pool.Whiten(edge, all + k * rows, nullptr);
    if (!all_free) pool.Whiten(edge, free + k * rows, nullptr);
  }
  const auto square = [&](const double* x, double robust, double alpha_over_s) {
    double norm = 0.0, projection = 0.0;
    for (int r = 0; r < rows && alpha_over_s != 0.0; ++r)
      projection += residual_[Index(r)] * x[r];
    for (int r = 0; r < rows; ++r) {
      const double value = robust * (x[r] - alpha_over_s * projection * residual_[Index(r)]);
      norm += value * value;
    }
    return norm;
  };
  double scale = 1.0, alpha_over_s = 0.0;
  if (const Loss& loss = pool.loss(edge); !loss.trivial()) {
    pool.Whiten(edge, residual_.data(), nullptr);
    double s = 0.0;
    for (int r = 0; r < rows; ++r)
      s += residual_[Index(r)] * residual_[Index(r)];
    const internal::RobustScale robust(loss, s);
    scale = robust.jacobian_scale;
    alpha_over_s = robust.alpha_over_s;
  }
  for (int k = 0; k < n; ++k) {
    sum[k] = square(all + k * rows, scale, alpha_over_s);
    free_sum[k] = all_free ? sum[k] : square(free + k * rows, scale, alpha_over_s);
  }
  return true;
}

int GaugeBreaches::Find(const double* information, const double* scale, int max_listed,
                        std::vector<GaugeBreach>* found) {
  const int n = orbit_.dim();
  int count = 0;
  double left[Orbit::kMaxDim], sum[Orbit::kMaxDim], free_sum[Orbit::kMaxDim];
  std::copy_n(information, n, left);
  for (const bool observations : {false, true}) {
    bool explained = observations;
    for (int k = 0; k < n; ++k)
      explained = explained && left[k] <= tolerance_ * scale[k];
    if (explained) break;
    for (const auto& pool : graph_.edge_pools()) {
      if (pool->IsObservation() != observations) continue;
      for (int edge = 0; edge < pool->size(); ++edge) {
        if (!pool->Alive(edge) || !Evaluate(*pool, edge, free_sum, sum)) continue;
        GaugeBreach breach{pool->HandleAt(edge), {}};
        bool breaks = false;
        for (int k = 0; k < n; ++k) {
          left[k] -= free_sum[k];
          if (!(scale[k] > 0.0)) continue;
          breach.kappa[Index(k)] = std::max(0.0, sum[k]) / scale[k];
          breaks = breaks || breach.kappa[Index(k)] > tolerance_;
        }
        if (breaks && count++ < max_listed) found->push_back(breach);
      }
    }
  }
  return count;
}

}  // namespace glissade
