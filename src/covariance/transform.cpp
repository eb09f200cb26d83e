// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/covariance/transform.h"

#include <Eigen/LU>
#include <algorithm>

#include "glissade/base/index.h"
#include "glissade/gauge/constraint.h"

namespace glissade {

namespace {

using internal::Index;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Dense = Eigen::MatrixXd;

Status Refuse(const char* what, AnyVertex vertex = {}) {
  return {StatusCode::kInvalidArgument, std::string("TransformCovariance: ") + what, vertex};
}

}  // namespace

Result<JointCovariance> TransformCovariance(const JointCovariance& cov, const Gauge& to) {
  if (to.kind != Gauge::Kind::kFixed && to.kind != Gauge::Kind::kPrior) {
    return Refuse("the covariance of a gauge that is fixed or a prior can be given");
  }
  const Orbit& orbit = cov.orbit;
  const int n = orbit.dim();
  const int m = cov.size();
  const std::vector<std::size_t>& at = cov.state_offsets;
  const int anchor = cov.IndexOf(to.anchor);
  if (anchor < 0) return Refuse("the anchor's covariance is not given", to.anchor);
  GaugeConstraint constraint;
  constraint.group = orbit.group();
  std::copy_n(orbit.lever(), 3, constraint.lever);
  constraint.reference.anchor = to.anchor;
  const double* const anchor_state = cov.states.data() + at[Index(anchor)];
  const Pose reference = to.reference.value_or(Pose());
  if (Status s = ValidatePose(reference.data, "gauge reference"); !s.ok()) return s;
  std::copy_n(to.reference ? reference.data : anchor_state, 7, constraint.reference.pose);
  for (const GaugeReference& known : cov.references) {
    if (!to.reference && known.anchor == AnyVertex(to.anchor)) constraint.reference = known;
  }
  int second = -1;
  if (constraint.HasSecond()) {
    const AnyVertex known_second = constraint.reference.second;
    const AnyVertex asked =
        to.second != VertexHandle<VertexPose>() ? AnyVertex(to.second) : known_second;
    for (std::size_t k = 0; k < cov.vertices.size() && second < 0; ++k) {
      const AnyVertex& vertex = cov.vertices[k];
      const bool fits = vertex.type == &kTypeInfo<VertexPose> && orbit.Moves(vertex) &&
                        vertex != AnyVertex(to.anchor);
      if (asked ? vertex == asked : fits) second = static_cast<int>(k);
    }
    if (second < 0 || second == anchor) {
      return Refuse("the covariance of a second pose is needed for the scale", to.anchor);
    }
    const AnyVertex& chosen = cov.vertices[Index(second)];
    constraint.reference.second = chosen;
    if (chosen != known_second &&
        !constraint.SetBaseline(anchor_state, cov.states.data() + at[Index(second)])) {
      return Refuse("the second camera is where the anchor's is", to.second);
    }
  }
  const double* second_state = second < 0 ? nullptr : cov.states.data() + at[Index(second)];
  const OrbitMotion g =
      to.reference ? constraint.MotionTo(anchor_state, second_state) : OrbitMotion();

  // D, and U at g(x).
  JointCovariance out = cov;
  out.gauge = to;
  for (GaugeReference& known : out.references) {
    orbit.Move(g, known.anchor, known.pose);
    known.coordinate *= g.scale;
  }
  std::erase_if(out.references,
                [&](const GaugeReference& known) { return known.anchor == AnyVertex(to.anchor); });
  out.references.push_back(constraint.reference);
  Dense C = Eigen::Map<const Dense>(cov.values.data(), m, m);
  Dense U = Dense::Zero(m, n);
  for (std::size_t k = 0; k < cov.vertices.size(); ++k) {
    const AnyVertex& vertex = cov.vertices[k];
    if (!orbit.Moves(vertex)) continue;
    const int begin = cov.offsets[k];
    const int dim = cov.offsets[k + 1] - begin;
    double* const state = out.states.data() + at[k];
    RowMajor D(dim, dim), rows(dim, n);
    orbit.Derivative(g, vertex, state, D.data());
    C.middleRows(begin, dim) = (D * C.middleRows(begin, dim)).eval();
    C.middleCols(begin, dim) = (C.middleCols(begin, dim) * D.transpose()).eval();
    orbit.Move(g, vertex, state);
    orbit.Directions(vertex, state, rows.data());
    U.middleRows(begin, dim) = rows;
  }

  RowMajor V_anchor(n, 6), V_second = RowMajor::Zero(n, 6);
  double c[Orbit::kMaxDim];
  const double* moved_second = second < 0 ? nullptr : out.states.data() + at[Index(second)];
  constraint.Evaluate(out.states.data() + at[Index(anchor)], moved_second, c, V_anchor.data(),
                      V_second.data());
  const int a = cov.offsets[Index(anchor)];
  const auto apply_V = [&](const Dense& x) {
    Dense product = V_anchor * x.middleRows(a, 6);
    if (second >= 0) product += V_second * x.middleRows(cov.offsets[Index(second)], 6);
    return product;
  };
  const Dense VU = apply_V(U);
  const Eigen::PartialPivLU<Dense> lu(VU);
  const Dense G = U * lu.inverse();
  C -= (G * apply_V(C)).eval();
  const Dense Ct = C.transpose();
  C -= apply_V(Ct).transpose() * G.transpose();
  if (to.kind == Gauge::Kind::kPrior) C += G * G.transpose() / to.weight;
  const Dense symmetric = 0.5 * (C + C.transpose());
  if (!symmetric.allFinite()) {
    return Status(StatusCode::kSingular, "TransformCovariance: the gauge does not hold the scene",
                  to.anchor);
  }
  out.values.assign(symmetric.data(), symmetric.data() + symmetric.size());
  return out;
}

Result<JointCovariance> TransformCovariance(const JointCovariance& cov, const Gauge& from,
                                            const Gauge& to) {
  if (from.kind != cov.gauge.kind || from.anchor != cov.gauge.anchor) {
    return Refuse("the covariance is in another gauge", from.anchor);
  }
  return TransformCovariance(cov, to);
}

}  // namespace glissade
