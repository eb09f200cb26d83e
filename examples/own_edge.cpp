// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// An edge type of one's own: distances from a radio on a robot to beacons, beside built-in types.
#include <glissade/glissade.h>
#include <glissade/testing.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <vector>

using namespace glissade;

/// Ends the program where something was refused: the message says what, and why.
void Check(const Status& status) {
  if (status.ok()) return;
  std::printf("%s\n", status.message().c_str());
  std::exit(1);
}

/// A plain struct. What it must have is checked when it is used: the types of its vertices, the
/// number of rows, and Evaluate with one pointer per Jacobian.
struct EdgeRange {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;

  double measured = 0.0;              ///< m
  Vector3 antenna = Vector3::Zero();  ///< in the body, m

  bool Evaluate(const VertexPose& body, const VertexPointXYZ& beacon, Vector<1>& r,
                Jacobian<1, 6>* d_r_d_body, Jacobian<1, 3>* d_r_d_beacon) const {
    const Vector3 ray = beacon.p() - body.pose * antenna;
    const double distance = ray.norm();
    if (distance < 1e-9) return false;  // no derivative there: the edge has no value
    r[0] = distance - measured;
    const Vector3 direction = ray / distance;
    // A Jacobian that is not asked for is null. The tangent of a pose: [dp, dtheta], p in world
    // axes and theta in body axes.
    if (d_r_d_body) {
      const Vector3 in_body = body.pose.R().transpose() * direction;
      *d_r_d_body << -direction.transpose(), in_body.cross(antenna).transpose();
    }
    if (d_r_d_beacon) *d_r_d_beacon = direction.transpose();
    return true;
  }

  /// Optional: asked once, when the edge is added.
  Status Validate() const { return ValidatePositive(measured, "range"); }
};

/// The same edge for many landmarks: Evaluate is a template over its scalar, and the library
/// computes as many edges at once as a register holds. kLanes: what differs from edge to edge;
/// SameSensor: what does not. See docs/own_edges.md.
struct EdgeRangeInPacks {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;

  double measured = 0.0;
  Vector3 antenna = Vector3::Zero();
  static constexpr auto kLanes = Fields(&EdgeRangeInPacks::measured);
  bool SameSensor(const EdgeRangeInPacks& other) const { return antenna == other.antenna; }

  template <class T>
  bool Evaluate(const View<VertexPose, T>& body, const View<VertexPointXYZ, T>& beacon,
                const T& range, Vec<T, 1>& r, Mat<T, 1, 6>* d_r_d_body,
                Mat<T, 1, 3>* d_r_d_beacon) const {
    using std::sqrt;
    const Vec<T, 3> at = {{T(antenna[0]), T(antenna[1]), T(antenna[2])}};
    const Vec<T, 3> ray = beacon.p - (body.R * at + body.p);
    const T distance = sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
    if (distance < T(1e-9)) return false;
    r[0] = distance - range;
    const Vec<T, 3> direction = (T(1.0) / distance) * ray;
    if (d_r_d_body) {
      d_r_d_body->Set(0, 0, -direction.Transpose());
      d_r_d_body->Set(0, 3, Cross(TransposeTimes(body.R, direction), at));
    }
    if (d_r_d_beacon) *d_r_d_beacon = direction.Transpose();
    return true;
  }
};

/// And without Jacobians: the library finds them, at the price of some time.
struct EdgeRangeOfResidual {
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
  static constexpr int kResidualDim = 1;

  double measured = 0.0;
  Vector3 antenna = Vector3::Zero();
  static constexpr auto kLanes = Fields(&EdgeRangeOfResidual::measured);
  bool SameSensor(const EdgeRangeOfResidual& other) const { return antenna == other.antenna; }

  template <class T>
  bool Evaluate(const View<VertexPose, T>& body, const View<VertexPointXYZ, T>& beacon,
                const T& range, Vec<T, 1>& r) const {
    using std::sqrt;
    const Vec<T, 3> at = {{T(antenna[0]), T(antenna[1]), T(antenna[2])}};
    const Vec<T, 3> ray = beacon.p - (body.R * at + body.p);
    const T distance = sqrt(ray[0] * ray[0] + ray[1] * ray[1] + ray[2] * ray[2]);
    if (distance < T(1e-9)) return false;
    r[0] = distance - range;
    return true;
  }
};

/// Are the derivatives right? The same check that the library's own edges have to pass.
template <class E>
bool CheckEdge(const char* name) {
  const E example{2.0, Vector3(0.3, -0.1, 0.2)};
  const JacobianCheck check =
      CheckJacobians(example, VertexPose{Pose(so3::Exp(Vector3(0.2, -0.4, 0.9)), Vector3(1, 2, 3))},
                     VertexPointXYZ(Vector3(-2, 0.5, 4)));
  std::printf("Jacobians, %s: %s (worst relative error %.1e)\n", name, check.ok ? "ok" : "WRONG",
              check.worst_error);
  if (!check.ok) std::printf("%s\n", check.message.c_str());
  return check.ok;
}

int main() {
  if (!CheckEdge<EdgeRange>("one at a time") || !CheckEdge<EdgeRangeInPacks>("in packs") ||
      !CheckEdge<EdgeRangeOfResidual>("found by the library")) {
    return 1;
  }

  // A robot drives a curve between four beacons whose places are known; it knows each of its moves
  // roughly (EdgeRelativePose) and its distance to the beacons to a centimetre.
  const std::vector<Vector3> beacons = {{0, 0, 0.5}, {6, 0, 2.5}, {6, 6, 0.8}, {0, 6, 3.0}};
  const Vector3 antenna(0.0, 0.1, 0.8);
  std::vector<Pose> truth;
  for (int k = 0; k < 12; ++k) {
    const double a = 0.25 * k;
    truth.emplace_back(so3::Exp(Vector3(0, 0, a)),
                       Vector3(3 + 2 * std::sin(a), 3 - 2 * std::cos(a), 0.3));
  }

  Problem problem;
  std::vector<VertexHandle<VertexPointXYZ>> points;
  for (const Vector3& beacon : beacons) {
    points.push_back(problem.AddVertex(VertexPointXYZ(beacon)));
    Check(problem.SetFixed(points.back()));
  }
  std::vector<VertexHandle<VertexPose>> poses;
  for (std::size_t k = 0; k < truth.size(); ++k) {
    Pose start = truth[k];
    start.p() += Vector3(0.3 * std::cos(3.0 * k), 0.3 * std::sin(5.0 * k), 0.1);
    poses.push_back(problem.AddVertex(VertexPose{start}));
    if (k > 0) {
      EdgeRelativePose move;
      move.T_i_j = truth[k - 1].Inverse() * truth[k];
      Check(problem
                .AddEdge(move, {poses[k - 1], poses[k]},
                         {.sqrt_information = SquareMatrix<6>(20.0 * SquareMatrix<6>::Identity())})
                .status());
    }
    for (std::size_t j = 0; j < beacons.size(); ++j) {
      const double noise = 0.01 * std::sin(7.0 * k + 3.0 * j);
      const EdgeRange range{(beacons[j] - truth[k] * antenna).norm() + noise, antenna};
      // 1 / sigma; a loss that does not let a wrong range pull far.
      Check(problem
                .AddEdge(range, {poses[k], points[j]},
                         {.sqrt_information = SquareMatrix<1>::Constant(100.0), .loss = Huber{2.0}})
                .status());
    }
  }

  const SolveSummary& summary = problem.Solve();
  std::printf("%s\n", summary.BriefReport().c_str());
  double worst = 0.0;
  for (std::size_t k = 0; k < truth.size(); ++k)
    worst = std::max(worst, (problem.Get(poses[k]).pose.p() - truth[k].p()).norm());
  std::printf("largest error of a position: %.1f mm\n", 1e3 * worst);
  return summary.converged() && worst < 0.05 ? 0 : 1;
}
