// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "gauge/move_priors.h"

#include <Eigen/LU>

namespace glissade {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

bool IsMarginalPrior(const EdgePoolBase& pool, int edge) {
  if (pool.type() != &kTypeInfo<DynamicEdge>) return false;
  const DynamicEdge& value = static_cast<const DynamicEdgePool&>(pool).At(edge);
  return dynamic_cast<const EdgeMarginalPrior*>(&value) != nullptr;
}

bool IsMovablePrior(const TypeInfo& type) {
  return &type == &kTypeInfo<EdgeSE3Prior> || &type == &kTypeInfo<EdgePosePriorVec> ||
         &type == &kTypeInfo<EdgeSpeedBiasPrior>;
}

Status PriorMover::MoveMarginal(const OrbitMotion& g, EdgeMarginalPrior* prior,
                                const std::vector<AnyVertex>& vertices) {
  std::vector<double> x0(prior->x0().begin(), prior->x0().end());
  std::vector<double> J(prior->jacobian().begin(), prior->jacobian().end());
  const int rows = prior->ResidualDim();
  Eigen::Map<RowMajor> jacobian(J.data(), rows, prior->TangentDim());
  double* origin = x0.data();
  int col = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const VertexOps& ops = *prior->vertex_types()[i];
    const int dim = ops.tangent_dim;
    if (orbit_.Moves(vertices[i])) {
      // x boxminus x0 turns into D (x boxminus x0): exactly, where the scale or the lever is 1 or
      // 0.
      RowMajor D(dim, dim);
      orbit_.Derivative(g, vertices[i], origin, D.data());
      jacobian.middleCols(col, dim) = jacobian.middleCols(col, dim) * D.inverse();
      orbit_.Move(g, vertices[i], origin);
    }
    origin += ops.ambient_dim;
    col += dim;
  }
  auto moved = EdgeMarginalPrior::Create(prior->vertex_types(), x0, prior->r0(), J);
  if (!moved.ok()) return moved.status();
  marginal_.emplace_back(prior, *prior);
  *prior = *moved.value();
  return {};
}

template <class E, class State>
Status PriorMover::MoveAbsolute(const OrbitMotion& g, State&& state, std::vector<Kept<E>>* kept) {
  constexpr int kDim = E::kResidualDim;
  EdgePool* pool = graph_->Pool<E>();
  for (int k = 0; pool != nullptr && k < pool->size(); ++k) {
    if (!pool->Alive(k) || !orbit_.Moves(pool->VertexOf(k, 0))) continue;
    const EdgeHandle<E> handle = *pool->HandleAt(k).template As<E>();
    kept->push_back({handle, pool->At<E>(k), SquareMatrix<kDim>::Identity()});
    if (!pool->HasIdentityInformation(k))
      kept->back().sqrt = SquareMatrix<kDim>(pool->sqrt_information(k));
    // Residuals are turned and scaled in their first three rows; the weight takes that back.
    SquareMatrix<kDim> sqrt = kept->back().sqrt;
    const double scale = kDim == 9 ? 1.0 : g.scale;
    const Matrix3 R = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(g.R);
    sqrt.template leftCols<3>() = (sqrt.template leftCols<3>() * R.transpose() / scale).eval();
    orbit_.Move(g, pool->VertexOf(k, 0), state(&pool->At<E>(k)));
    if (Status s = graph_->SetSqrtInformation(handle, sqrt); !s.ok()) return s;
  }
  return {};
}

Status PriorMover::Move(const OrbitMotion& g, bool absolute) {
  EdgePoolBase* base = graph_->EdgePoolOf(&kTypeInfo<DynamicEdge>);
  auto* pool = static_cast<DynamicEdgePool*>(base);
  for (int k = 0; pool != nullptr && k < pool->size(); ++k) {
    if (!pool->Alive(k)) continue;
    auto* prior = dynamic_cast<EdgeMarginalPrior*>(&pool->At(k));
    if (prior == nullptr) continue;
    const Result<std::vector<AnyVertex>> vertices = graph_->VerticesOf(pool->HandleAt(k));
    const Status status = MoveMarginal(g, prior, vertices.value());
    if (!status.ok()) return status;
  }
  if (!absolute) return {};
  const auto pose = [](auto* edge) { return edge->T_w_b.data; };
  if (Status s = MoveAbsolute(g, pose, &se3_); !s.ok()) return s;
  if (Status s = MoveAbsolute(g, pose, &vec_); !s.ok()) return s;
  return MoveAbsolute(
      g, [](EdgeSpeedBiasPrior* edge) { return edge->prior.Data(); }, &speed_);
}

template <class E>
void PriorMover::PutBack(const std::vector<Kept<E>>& kept) {
  EdgePool* pool = graph_->Pool<E>();
  for (const Kept<E>& one : kept) {
    pool->At<E>(pool->slots().IndexOf(one.handle.slot)) = one.edge;
    (void)graph_->SetSqrtInformation(one.handle, one.sqrt);
  }
}

void PriorMover::TakeBack() {
  for (const auto& [prior, before] : marginal_)
    *prior = before;
  PutBack(se3_);
  PutBack(vec_);
  PutBack(speed_);
}

}  // namespace glissade
