// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Edges of a run: in packs where their type can, else one by one. First estimates stay in lanes
// where an edge says by which relative pose or point it is blind to the gauge.

#include <algorithm>

#include "glissade/graph/edge_pool_base.h"
#include "glissade/graph/pools.h"
#include "glissade/lie/quaternion.h"
#include "lanes/evaluators.h"

namespace glissade {

namespace {

/// d(residual)/d(pose) of an observer B in lanes, row by row: three numbers by its position and
/// three by its rotation.
struct ObserverLanes {
  const double* J;
  int lanes;
  [[nodiscard]] Vector3 Position(int row, int s) const { return At(6 * row, s); }
  [[nodiscard]] Vector3 Rotation(int row, int s) const { return At(6 * row + 3, s); }

 private:
  [[nodiscard]] Vector3 At(std::ptrdiff_t n, int s) const {
    const double* x = J + n * lanes + s;
    return {x[0], x[lanes], x[2 * lanes]};
  }
};

void Put(const Vector3& x, std::ptrdiff_t n, int lanes, int s, double* J) {
  for (int i = 0; i < 3; ++i)
    J[(n + i) * lanes + s] = x[i];
}

/// From x to x_lin, as for one edge in first_estimates.cpp: with f and m the derivatives of a row
/// by the left twist of the relative pose, in the axes of the observer.
void MoveRelativePoseLanes(int rows, const LaneRun& run, const double* lin_a, const double* lin_b,
                           const double* J_at_x, double* J_a, double* J_b) {
  const Matrix3 R_b_at_x = RotationMatrix(run.states[1] + 3), R_b = RotationMatrix(lin_b + 3);
  const Matrix3 turn = R_b * R_b_at_x.transpose();
  const Matrix3 R_a_b = RotationMatrix(lin_a + 3).transpose() * R_b;
  const Vector3 t =
      R_b.transpose() * Vector3(lin_a[0] - lin_b[0], lin_a[1] - lin_b[1], lin_a[2] - lin_b[2]);
  const ObserverLanes at_x{J_at_x, run.lanes};
  for (int row = 0; row < rows; ++row) {
    for (int s = 0; s < run.count; ++s) {
      const Vector3 J_p = at_x.Position(row, s), m = -at_x.Rotation(row, s);
      const Vector3 f_w = -(turn * J_p);
      if (J_a != nullptr) {
        const Vector3 f = -(R_b_at_x.transpose() * J_p);
        Put(f_w, 6 * row, run.lanes, s, J_a);
        Put(R_a_b * (m - t.cross(f)), 6 * row + 3, run.lanes, s, J_a);
      }
      if (J_b != nullptr) {
        Put(-f_w, 6 * row, run.lanes, s, J_b);
        Put(-m, 6 * row + 3, run.lanes, s, J_b);
      }
    }
  }
}

/// The same for a pose and a point.
template <class PointOfLane>
void MoveRelativePointLanes(int rows, const LaneRun& run, const double* lin_b,
                            PointOfLane&& lin_point, const double* J_at_x, double* J_b,
                            double* J_point) {
  const Matrix3 R_b_at_x = RotationMatrix(run.states[0] + 3), R_b = RotationMatrix(lin_b + 3);
  const ObserverLanes at_x{J_at_x, run.lanes};
  for (int s = 0; s < run.count; ++s) {
    const double* x = lin_point(s);
    const Vector3 P = R_b.transpose() * Vector3(x[0] - lin_b[0], x[1] - lin_b[1], x[2] - lin_b[2]);
    for (int row = 0; row < rows; ++row) {
      const Vector3 f = -(R_b_at_x.transpose() * at_x.Position(row, s));
      const Vector3 f_w = R_b * f;
      if (J_point != nullptr) Put(f_w, 3 * row, run.lanes, s, J_point);
      if (J_b != nullptr) {
        Put(-f_w, 6 * row, run.lanes, s, J_b);
        Put(f.cross(P), 6 * row + 3, run.lanes, s, J_b);
      }
    }
  }
}

}  // namespace

EdgePoolBase::~EdgePoolBase() = default;

std::uint32_t EdgePoolBase::FindOrAddLoss(const Loss& loss) {
  // Graphs have a handful of distinct losses; the last one added is the likeliest.
  for (std::size_t k = losses_.size(); k-- > 0;) {
    if (losses_[k] == loss) return static_cast<std::uint32_t>(k);
  }
  losses_.push_back(loss);
  return static_cast<std::uint32_t>(losses_.size() - 1);
}

EvaluateLanes EdgePoolBase::LibraryEvaluator(const TypeInfo* type) {
  return lanes::EvaluatorOf(type);
}

int EdgePoolBase::EvaluateRun(const LaneRun& run, const LaneValues& values,
                              FirstEstimates first_estimates) const {
  const EvaluateLanes evaluate = evaluate_lanes_;
  if (evaluate == nullptr) return EvaluateOneByOne(run, values);
  if (first_estimates != FirstEstimates::kFull || values.J == nullptr || !HasMoved(run)) {
    return evaluate(edges(), run, values);
  }
  if (traits().first_estimate_rule == FirstEstimateRule::kWhole)
    return EvaluateOneByOne(run, values);
  return EvaluateRelative(run, values, evaluate);
}

bool EdgePoolBase::HasMoved(const LaneRun& run) const {
  const unsigned excluded = traits().no_first_estimate;
  for (int i = 0; i < fixed_arity(); ++i) {
    const int size = vertex_pool(0, i)->ops().first_estimate_size;
    if (size == 0 || (excluded >> i & 1u) != 0) continue;
    const auto moved = [&](const double* x, const double* x_lin) {
      return x_lin != nullptr && !std::equal(x_lin, x_lin + size, x);
    };
    if (i != run.landmark) {
      if (moved(run.states[i], run.points[i])) return true;
      continue;
    }
    for (int s = 0; s < run.count; ++s) {
      if (moved(run.landmark_states[s], run.landmark_points[s])) return true;
    }
  }
  return false;
}

int EdgePoolBase::EvaluateRelative(const LaneRun& run, const LaneValues& values,
                                   EvaluateLanes evaluate) const {
  const bool is_pose = traits().first_estimate_rule == FirstEstimateRule::kRelativePose;
  const int observer = is_pose ? 1 : 0;
  double* at_x[kMaxTypedArity];
  std::copy_n(values.J, fixed_arity(), at_x);
  at_x[observer] = run.work;
  at_x[1 - observer] = nullptr;
  LaneValues values_at_x = values;
  values_at_x.J = at_x;
  const int failed = evaluate(edges(), run, values_at_x);
  if (failed >= 0) return failed;
  const auto lin = [&](int i) { return run.points[i] != nullptr ? run.points[i] : run.states[i]; };
  if (is_pose) {
    MoveRelativePoseLanes(residual_dim(0), run, lin(0), lin(1), run.work, values.J[0], values.J[1]);
    return -1;
  }
  const auto point = [&](int s) {
    if (run.landmark != 1) return lin(1);
    return run.landmark_points[s] != nullptr ? run.landmark_points[s] : run.landmark_states[s];
  };
  MoveRelativePointLanes(residual_dim(0), run, lin(0), point, run.work, values.J[0], values.J[1]);
  return -1;
}

int EdgePoolBase::EvaluateOneByOne(const LaneRun& run, const LaneValues& values) const {
  const int count = fixed_arity(), rows = residual_dim(0);
  const double *states[kMaxTypedArity], *points[kMaxTypedArity];
  double* J[kMaxTypedArity];
  int sizes[kMaxTypedArity];
  double* next = run.work + rows;
  for (int i = 0; i < count; ++i) {
    states[i] = run.states[i];
    points[i] = run.points[i];
    sizes[i] = rows * vertex_pool(0, i)->ops().tangent_dim;
    J[i] = values.J != nullptr && values.J[i] != nullptr ? next : nullptr;
    next += sizes[i];
  }
  const bool keeps = HasMoved(run);
  double* const* wanted = values.J != nullptr ? J : nullptr;
  for (int s = 0; s < run.count; ++s) {
    states[run.landmark] = run.landmark_states[s];
    points[run.landmark] = run.landmark_points[s];
    const bool ok = keeps ? EvaluateAt(run.edges[s], states, points, run.work, wanted)
                          : Evaluate(run.edges[s], states, run.work, wanted);
    if (!ok) return s;
    for (int k = 0; k < rows; ++k)
      values.r[k * run.lanes + s] = run.work[k];
    for (int i = 0; i < count; ++i) {
      for (int k = 0; J[i] != nullptr && k < sizes[i]; ++k)
        values.J[i][k * run.lanes + s] = J[i][k];
    }
  }
  return -1;
}

}  // namespace glissade
