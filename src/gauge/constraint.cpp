// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/gauge/constraint.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "glissade/lie/so3.h"

namespace glissade {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Vector3 Load(const double* x) {
  return {x[0], x[1], x[2]};
}

/// b: the second camera's centre seen from the anchor's, in the anchor's axes.
Vector3 Baseline(const double* anchor, const double* second, const double* lever) {
  const Vector3 l = Load(lever);
  const Matrix3 Ra = RotationMatrix(anchor + 3);
  return Ra.transpose() * (Load(second) + RotationMatrix(second + 3) * l - Load(anchor)) - l;
}

Status Refuse(const std::string& what, AnyVertex vertex) {
  return {StatusCode::kInvalidArgument, "gauge: " + what, vertex};
}

}  // namespace

Result<GaugeConstraint> GaugeConstraint::Of(const Gauge& gauge, const Orbit& orbit,
                                            const Graph& graph) {
  GaugeConstraint out;
  out.group = orbit.group();
  std::copy_n(orbit.lever(), 3, out.lever);
  const auto unknown = [&](AnyVertex vertex) {
    return internal::About(graph.UnknownHandle(vertex), "gauge");
  };
  const VertexPose* anchor = graph.Find(gauge.anchor);
  if (anchor == nullptr) return unknown(gauge.anchor);
  if (!orbit.Moves(gauge.anchor)) return Refuse("the anchor is an extrinsic", gauge.anchor);
  const GaugeReference* known = nullptr;
  for (const GaugeReference& reference : graph.gauge_references()) {
    if (reference.anchor == AnyVertex(gauge.anchor)) known = &reference;
  }
  GaugeReference& reference = out.reference;
  reference.anchor = gauge.anchor;
  const double* pose = gauge.reference    ? gauge.reference->data
                       : known != nullptr ? known->pose
                                          : anchor->pose.data;
  if (Status s = ValidatePose(pose, "gauge reference"); !s.ok()) return s;
  std::copy_n(pose, 7, reference.pose);
  if (!out.HasSecond()) return out;

  AnyVertex second = gauge.second;
  if (gauge.second == VertexHandle<VertexPose>() && known != nullptr && known->second) {
    second = known->second;
  } else if (gauge.second == VertexHandle<VertexPose>()) {
    graph.ForEachVertex<VertexPose>([&](VertexHandle<VertexPose> vertex, const VertexPose&) {
      if (!second && vertex != gauge.anchor && orbit.Moves(vertex) &&
          graph.GetFixed(vertex) == Fix::kFree) {
        second = vertex;
      }
    });
  }
  const VertexPose* other =
      graph.Find(second.As<VertexPose>().value_or(VertexHandle<VertexPose>()));
  if (!second) return Refuse("no second camera to hold the scale", gauge.anchor);
  if (other == nullptr) return unknown(second);
  if (other == anchor) return Refuse("anchor and second camera are the same", second);
  reference.second = second;
  if (known != nullptr && known->second == second && !gauge.reference) {
    reference.axis = known->axis;
    reference.coordinate = known->coordinate;
  } else {
    out.SetBaseline(anchor->pose.data, other->pose.data);
  }
  if (!(std::abs(reference.coordinate) > 0.0)) {
    return Refuse("the second camera is where the anchor's is", second);
  }
  return out;
}

bool GaugeConstraint::SetBaseline(const double* anchor, const double* second) {
  const Vector3 b = Baseline(anchor, second, lever);
  b.cwiseAbs().maxCoeff(&reference.axis);
  reference.coordinate = b[reference.axis];
  return std::abs(reference.coordinate) > 0.0;
}

void GaugeConstraint::Evaluate(const double* anchor, const double* second, double* c,
                               double* d_anchor, double* d_second) const {
  const int n = dim();
  const Quaternion q(anchor + 3), q0(reference.pose + 3);
  const Vector3 phi = so3::Log(Quaternion(q * q0.conjugate()));
  const Matrix3 R = RotationMatrix(anchor + 3);
  const bool inertial = group == GaugeGroup::kVisualInertial;
  for (int k = 0; k < 3; ++k)
    c[k] = anchor[k] - reference.pose[k];
  if (inertial) {
    c[3] = phi[2];
  } else {
    std::copy_n(phi.data(), 3, c + 3);
  }
  if (d_anchor != nullptr) {
    Eigen::Map<RowMajor> d(d_anchor, n, 6);
    d.setZero();
    d.topLeftCorner<3, 3>().setIdentity();
    // R Exp(d) R0' = Exp(R d) R R0'.
    const Matrix3 d_phi = so3::JlInverse(phi) * R;
    if (inertial) {
      d.block<1, 3>(3, 3) = d_phi.row(2);
    } else {
      d.block<3, 3>(3, 3) = d_phi;
    }
  }
  if (d_second != nullptr) Eigen::Map<RowMajor>(d_second, n, 6).setZero();
  if (!HasSecond()) return;
  const Vector3 l = Load(lever);
  const Vector3 b = Baseline(anchor, second, lever);
  c[6] = b[reference.axis] - reference.coordinate;
  if (d_anchor != nullptr) {
    Eigen::Map<RowMajor> d(d_anchor, n, 6);
    d.block<1, 3>(6, 0) = -R.col(reference.axis).transpose();
    d.block<1, 3>(6, 3) = so3::Hat(Vector3(b + l)).row(reference.axis);
  }
  if (d_second != nullptr) {
    Eigen::Map<RowMajor> d(d_second, n, 6);
    const Matrix3 turn = R.transpose() * RotationMatrix(second + 3) * so3::Hat(l);
    d.block<1, 3>(6, 0) = R.col(reference.axis).transpose();
    d.block<1, 3>(6, 3) = -turn.row(reference.axis);
  }
}

OrbitMotion GaugeConstraint::MotionTo(const double* anchor, const double* second) const {
  OrbitMotion g;
  const Quaternion q(anchor + 3), q0(reference.pose + 3);
  Quaternion turn;
  if (group == GaugeGroup::kVisualInertial) {
    // The z part of the quaternion of Rz R R0' is 0.
    const Quaternion since(q * q0.conjugate());
    const double half = -std::atan2(since.z(), since.w());
    turn = Quaternion(std::cos(half), 0.0, 0.0, std::sin(half));
  } else {
    turn = q0 * q.conjugate();
    turn.normalize();
  }
  const Matrix3 Rg = RotationMatrix(turn.coeffs().data());
  if (HasSecond()) {
    g.scale = reference.coordinate / Baseline(anchor, second, lever)[reference.axis];
  }
  const Vector3 arm = (g.scale - 1.0) * (RotationMatrix(anchor + 3) * Load(lever));
  const Vector3 t = Load(reference.pose) - Rg * (g.scale * Load(anchor) + arm);
  for (int r = 0; r < 3; ++r) {
    g.t[r] = t[r];
    for (int k = 0; k < 3; ++k)
      g.R[3 * r + k] = Rg(r, k);
  }
  return g;
}

void Remember(const GaugeReference& reference, Graph* graph) {
  for (GaugeReference& known : graph->gauge_references()) {
    if (known.anchor != reference.anchor) continue;
    known = reference;
    return;
  }
  graph->gauge_references().push_back(reference);
}

}  // namespace glissade
