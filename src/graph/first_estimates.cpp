// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/first_estimates.h"

#include <algorithm>
#include <string>

#include "glissade/base/validate.h"
#include "glissade/graph/pools.h"
#include "glissade/lie/pose.h"

namespace glissade {

namespace {

constexpr int kMaxBlended = 16;  ///< numbers of a state with a first estimate

/// x_lin in what moves with the gauge, x in the rest; buffer of kMaxBlended. Returns where it is.
const double* Blend(const VertexOps& ops, const double* x, const double* x_lin, double* buffer) {
  if (x_lin == nullptr || ops.first_estimate_size == 0) return x;
  std::copy_n(x, ops.ambient_dim, buffer);
  std::copy_n(x_lin, ops.first_estimate_size, buffer);
  return buffer;
}

/// Rows of d(residual)/d(poses) from where the poses are to where they were linearized first.
///
/// With the left twist (rho, phi) of T_B_A = T_W_B^-1 T_W_A, in the axes of body B, a point at P_B
/// moves by rho + phi x P_B. Target: rho = -R_B' dp_B, phi = -dtheta_B; so the Jacobian with
/// respect to the target at x tells f = d r/d rho and m = d r/d phi there. Host: phi = R_B' R_A
/// dtheta_A, rho = R_B' dp_A - phi x t, with t = R_B' (p_A - p_B). J_b_at_x may lie in J_a or J_b,
/// one of which may be null.
void MoveRelativePose(int rows, const double* x_b, const double* lin_a, const double* lin_b,
                      const double* J_b_at_x, double* J_a, double* J_b) {
  using RowVector = Eigen::Matrix<double, 1, 3>;
  const Matrix3 R_b_at_x = RotationMatrix(x_b + 3), R_b = RotationMatrix(lin_b + 3);
  const Matrix3 R_b_a = R_b.transpose() * RotationMatrix(lin_a + 3);
  const Vector3 t =
      R_b.transpose() * Vector3(lin_a[0] - lin_b[0], lin_a[1] - lin_b[1], lin_a[2] - lin_b[2]);
  for (int row = 0; row < rows; ++row) {
    const Eigen::Map<const RowVector> J_p(J_b_at_x + 6 * row), J_theta(J_b_at_x + 6 * row + 3);
    const RowVector f = -(J_p * R_b_at_x), m = -J_theta;
    const RowVector f_w = f * R_b.transpose();
    if (J_a != nullptr) {
      Eigen::Map<RowVector>(J_a + 6 * row) = f_w;
      Eigen::Map<RowVector>(J_a + 6 * row + 3) =
          (m - RowVector(t.cross(Vector3(f.transpose())).transpose())) * R_b_a;
    }
    if (J_b != nullptr) {
      Eigen::Map<RowVector>(J_b + 6 * row) = -f_w;
      Eigen::Map<RowVector>(J_b + 6 * row + 3) = -m;
    }
  }
}

/// The same for a pose and a point: P_B = R_B' (X - p_B). J_b: at x when it comes, moved when it
/// goes; J_point may be null.
void MoveRelativePoint(int rows, const double* x_b, const double* lin_b, const double* lin_point,
                       double* J_b, double* J_point) {
  using RowVector = Eigen::Matrix<double, 1, 3>;
  const Matrix3 R_b_at_x = RotationMatrix(x_b + 3), R_b = RotationMatrix(lin_b + 3);
  const Vector3 P = R_b.transpose() * Vector3(lin_point[0] - lin_b[0], lin_point[1] - lin_b[1],
                                              lin_point[2] - lin_b[2]);
  for (int row = 0; row < rows; ++row) {
    const RowVector f = -(Eigen::Map<const RowVector>(J_b + 6 * row) * R_b_at_x);
    const RowVector f_w = f * R_b.transpose();
    if (J_point != nullptr) Eigen::Map<RowVector>(J_point + 3 * row) = f_w;
    Eigen::Map<RowVector>(J_b + 6 * row) = -f_w;
    Eigen::Map<RowVector>(J_b + 6 * row + 3) = Vector3(f.transpose()).cross(P).transpose();
  }
}

/// The same where the pose is held: f = J_point R_B at x tells what J_b does.
void MovePoint(int rows, const double* x_b, const double* lin_b, double* J_point) {
  const Matrix3 turn = RotationMatrix(x_b + 3) * RotationMatrix(lin_b + 3).transpose();
  for (int row = 0; row < rows; ++row) {
    Eigen::Map<Eigen::Matrix<double, 1, 3>> J(J_point + 3 * row);
    J = (J * turn).eval();
  }
}

/// Scratch of a thread: it grows to the largest edge once, so that linearizing again allocates
/// nothing.
template <class T>
T* Scratch(int size) {
  thread_local std::vector<T> scratch;
  if (scratch.size() < static_cast<std::size_t>(size))
    scratch.resize(static_cast<std::size_t>(size));
  return scratch.data();
}

}  // namespace

bool EdgePoolBase::EvaluateAt(int edge, const double* const* states, const double* const* points,
                              double* residual, double* const* jacobians) const {
  const int count = arity(edge);
  const unsigned excluded = traits().no_first_estimate;
  bool moved = false;
  const auto ops_of = [&](int i) -> const VertexOps& { return vertex_pool(edge, i)->ops(); };
  for (int i = 0; i < count; ++i) {
    moved |= points[i] != nullptr && ops_of(i).first_estimate_size > 0 &&
             (i >= kMaxTypedArity || (excluded >> i & 1u) == 0) &&
             !std::equal(points[i], points[i] + ops_of(i).first_estimate_size, states[i]);
  }
  const bool wanted = jacobians != nullptr;
  if (!moved || !wanted) return Evaluate(edge, states, residual, jacobians);

  const FirstEstimateRule rule = traits().first_estimate_rule;
  if (rule == FirstEstimateRule::kWhole) {
    double blended_states[kMaxTypedArity * kMaxBlended];
    const double* blended_pointers[kMaxTypedArity];
    double* buffer = blended_states;
    const double** blended = blended_pointers;
    if (count > kMaxTypedArity) {  // a dynamic edge
      buffer = Scratch<double>(kMaxBlended * count);
      blended = Scratch<const double*>(count);
    }
    for (int i = 0; i < count; ++i) {
      const bool keep = i < kMaxTypedArity && (excluded >> i & 1u) != 0;
      blended[i] =
          Blend(ops_of(i), states[i], keep ? nullptr : points[i], buffer + kMaxBlended * i);
    }
    // The residual that the first writes, the second overwrites.
    return Evaluate(edge, blended, residual, jacobians) &&
           Evaluate(edge, states, residual, nullptr);
  }

  // Vertices 0 and 1; the one that is observed from is the target, or the pose of a pose and a
  // point. Its Jacobian at x says all; it is taken where those asked for will lie, whatever the
  // number of rows, and moved from there.
  if (jacobians[0] == nullptr && jacobians[1] == nullptr) {
    return Evaluate(edge, states, residual, jacobians);
  }
  const int rows = residual_dim(edge);
  const bool is_pose = rule == FirstEstimateRule::kRelativePose;
  const bool point_only = !is_pose && jacobians[0] == nullptr;
  double* at_x[kMaxTypedArity];
  std::copy_n(jacobians, count, at_x);
  if (is_pose) {
    at_x[0] = nullptr;
    at_x[1] = jacobians[1] != nullptr ? jacobians[1] : jacobians[0];
  } else if (!point_only) {
    at_x[1] = nullptr;
  }
  if (!Evaluate(edge, states, residual, at_x)) return false;
  const double* lin[2];
  for (int i = 0; i < 2; ++i)
    lin[i] = points[i] != nullptr ? points[i] : states[i];
  if (is_pose) {
    MoveRelativePose(rows, states[1], lin[0], lin[1], at_x[1], jacobians[0], jacobians[1]);
  } else if (point_only) {
    MovePoint(rows, states[0], lin[0], jacobians[1]);
  } else {
    MoveRelativePoint(rows, states[0], lin[0], lin[1], jacobians[0], jacobians[1]);
  }
  return true;
}

Status Graph::SetFirstEstimates(FirstEstimates mode) {
  switch (mode) {
    case FirstEstimates::kOff:
    case FirstEstimates::kPriorOnly:
    case FirstEstimates::kFull:
      if (mode != first_estimates_) StructureChanged();  // linear edges have no constant H in kOff
      first_estimates_ = mode;
      return {};
  }
  return Refused(
      {StatusCode::kInvalidArgument,
       "SetFirstEstimates: " + std::to_string(static_cast<int>(mode)) + " is no FirstEstimates"});
}

bool Graph::HasFirstEstimate(AnyVertex vertex) const {
  const VertexSite site = Locate(vertex);
  return site.pool != nullptr && site.pool->first_estimates().At(site.index) != nullptr;
}

std::span<const double> Graph::LinearizationPoint(AnyVertex vertex) const {
  const VertexSite site = Locate(vertex);
  if (site.pool == nullptr) return {};
  const double* x = site.pool->first_estimates().At(site.index);
  if (x == nullptr) x = static_cast<const VertexPoolBase*>(site.pool)->Data(site.index);
  return {x, static_cast<std::size_t>(site.pool->ops().ambient_dim)};
}

Status Graph::SetFirstEstimate(AnyVertex vertex, std::span<const double> x_lin) {
  const VertexSite site = Locate(vertex);
  if (site.pool == nullptr) return Refused(UnknownHandle(vertex));
  if (x_lin.size() != static_cast<std::size_t>(site.pool->ops().ambient_dim)) {
    return Refused({StatusCode::kInvalidArgument,
                    "SetFirstEstimate: " + ToString(vertex) + " has another number of coordinates",
                    vertex});
  }
  if (Status status = site.pool->ops().validate(x_lin.data()); !status.ok()) {
    return Refused(
        {status.code(),
         "SetFirstEstimate: linearization point of " + ToString(vertex) + ": " + status.message(),
         vertex});
  }
  EnterFirstEstimate(site, x_lin.data());
  return {};
}

void Graph::EnterFirstEstimate(const VertexSite& site, const double* x_lin) {
  if (site.pool->first_estimates().At(site.index) == nullptr) StructureChanged();
  site.pool->SetFirstEstimate(site.index, x_lin);
}

void Graph::EnterFirstEstimates(const DynamicEdge& edge, std::span<const AnyVertex> vertices) {
  const double* x0 = edge.LinearizationPoint();
  if (x0 == nullptr) return;
  for (const AnyVertex& vertex : vertices) {
    const VertexSite site = Locate(vertex);
    if (site.pool->first_estimates().At(site.index) == nullptr) EnterFirstEstimate(site, x0);
    x0 += site.pool->ops().ambient_dim;
  }
}

AnyEdge Graph::PriorOn(const VertexPoolBase& pool, int index) const {
  const auto* edges = static_cast<const DynamicEdgePool*>(EdgePoolOf(&kTypeInfo<DynamicEdge>));
  AnyEdge oldest;
  if (edges == nullptr) return oldest;
  edges->ForEachEdgeAt(pool, pool.slots().SlotOf(index), [&](int edge) {
    if (edges->At(edge).LinearizationPoint() != nullptr) oldest = edges->HandleAt(edge);
  });
  return oldest;
}

void Graph::DropOrphanedFirstEstimates() {
  for (const auto& pool : vertex_pools_) {
    for (int k = 0; k < pool->size() && !pool->first_estimates().empty(); ++k) {
      if (pool->first_estimates().At(k) != nullptr && !PriorOn(*pool, k)) {
        pool->DropFirstEstimate(k);
      }
    }
  }
}

}  // namespace glissade
