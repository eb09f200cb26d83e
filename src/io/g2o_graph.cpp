// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <span>
#include <utility>

#include "glissade/base/out_of_memory.h"
#include "glissade/io/g2o.h"
#include "io/g2o_check.h"

namespace glissade {

namespace {

using internal::G2oIds;

/// Unit quaternions keep their bits: what a graph holds comes back as it was.
Pose Normalized(Pose pose) {
  if (std::abs(pose.q().squaredNorm() - 1.0) > 1e-15) pose.Normalize();
  return pose;
}

template <int N>
SquareMatrix<N> Symmetric(const std::array<double, N*(N + 1) / 2>& triangle) {
  SquareMatrix<N> omega;
  const double* x = triangle.data();
  for (int r = 0; r < N; ++r) {
    for (int c = r; c < N; ++c)
      omega(r, c) = omega(c, r) = *x++;
  }
  return omega;
}

/// B' I B, B = diag(of_translation, of_rotation); exactly symmetric.
Matrix6 Transformed(const std::array<double, 21>& information, const Matrix3& of_translation,
                    const Matrix3& of_rotation) {
  Matrix6 B = Matrix6::Zero();
  B.topLeftCorner<3, 3>() = of_translation;
  B.bottomRightCorner<3, 3>() = of_rotation;
  const Matrix6 omega = B.transpose() * Symmetric<6>(information) * B;
  return 0.5 * (omega + omega.transpose());
}

class Adder {
 public:
  Adder(const G2oProblem& problem, const G2oIds& ids, Graph& graph, const G2oGraphOptions& options,
        G2oHandles* handles)
      : problem_(problem), ids_(ids), graph_(graph), options_(options), handles_(handles) {}

  Status Run() {
    Status status = AddVertices();
    if (status.ok()) status = AddPoseEdges();
    if (status.ok()) status = AddPointEdges();
    if (status.ok()) status = HoldFirst();
    return status;
  }

 private:
  /// Adds the vertices of a list, made by `make`, and fixes those that are fixed.
  template <class V, class List, class Make>
  Status Add(const List& list, std::vector<VertexHandle<V>>* handles, Make make) {
    std::vector<V> values;
    values.reserve(list.size());
    for (const auto& x : list)
      values.push_back(make(x));
    auto added = graph_.AddVertices(std::span<const V>(values));
    if (!added.ok()) return added.status();
    *handles = std::move(added).value();
    for (std::size_t k = 0; k < list.size(); ++k) {
      if (!list[k].fixed) continue;
      if (Status s = graph_.SetFixed((*handles)[k]); !s.ok()) return s;
    }
    return {};
  }
  Status AddVertices() {
    Status status = Add<VertexPose>(problem_.poses, &handles_->poses, [](const G2oPose& x) {
      return VertexPose{Normalized(x.T_w_b)};
    });
    if (!status.ok()) return status;
    status = Add<VertexPose>(problem_.cameras, &handles_->cameras,
                             [](const G2oCamera& x) { return VertexPose{Normalized(x.T_w_c)}; });
    if (!status.ok()) return status;
    return Add<VertexPointXYZ>(problem_.points, &handles_->points, [](const G2oPoint& x) {
      return VertexPointXYZ(x.xyz[0], x.xyz[1], x.xyz[2]);
    });
  }

  template <class E>
  Status AddEdge(const E& edge, const EdgeVertexHandles<E>& vertices,
                 const SquareMatrix<E::kResidualDim>& information,
                 std::vector<EdgeHandle<E>>* handles) {
    const auto added = std::apply(
        [&](const auto&... vertex) {
          return graph_.AddEdge(edge, {vertex...},
                                {.information = information, .loss = options_.loss});
        },
        vertices);
    if (added.ok()) handles->push_back(added.value());
    return added.status();
  }
  Status AddPoseEdges() {
    for (const G2oRelativePose& x : problem_.relative_poses) {
      const Pose T_i_j = Normalized(x.T_i_j);
      const Matrix6 information =
          Transformed(x.information, T_i_j.R().transpose(), 0.5 * Matrix3::Identity());
      Status status = AddEdge(EdgeRelativePose{T_i_j}, {PoseOf(x.from), PoseOf(x.to)}, information,
                              &handles_->relative_poses);
      if (!status.ok()) return status;
    }
    for (const G2oPosePrior& x : problem_.priors) {
      const Pose T_w_s = Normalized(x.T_w_s), T_b_s = OffsetOf(x.offset);
      const Matrix6 information =
          Transformed(x.information, T_w_s.R().transpose(), 0.5 * T_b_s.R().transpose());
      Pose T_w_b(Quaternion(T_w_s.q() * T_b_s.q().conjugate()), Vector3(T_w_s.p()));
      T_w_b.Normalize();
      Status status =
          AddEdge(EdgeSE3Prior{T_w_b}, {PoseOf(x.pose)}, information, &handles_->priors);
      if (!status.ok()) return status;
    }
    return {};
  }
  Status AddPointEdges() {
    for (const G2oPointMeasurement& x : problem_.point_measurements) {
      Status status =
          AddEdge(EdgePosePoint{Vector3(x.xyz[0], x.xyz[1], x.xyz[2]), OffsetOf(x.offset)},
                  {PoseOf(x.pose), PointOf(x.point)}, Symmetric<3>(x.information),
                  &handles_->point_measurements);
      if (!status.ok()) return status;
    }
    for (const G2oProjection& x : problem_.projections) {
      const std::size_t k = ids_.vertices.at(x.camera).index;
      const G2oCamera& camera = problem_.cameras[k];
      EdgeReprojectionXYZOf<CameraPinhole> edge;
      edge.uv = Vector2(x.u, x.v);
      edge.camera = {camera.fx, camera.fy, camera.cx, camera.cy};
      Status status = AddEdge(edge, {handles_->cameras[k], PointOf(x.point)},
                              Symmetric<2>(x.information), &handles_->projections);
      if (!status.ok()) return status;
    }
    return {};
  }

  Status HoldFirst() {
    const auto fixed = [](const auto& list) {
      return std::any_of(list.begin(), list.end(), [](const auto& x) { return x.fixed; });
    };
    if (!options_.hold_first || !problem_.priors.empty() || fixed(problem_.poses) ||
        fixed(problem_.cameras) || fixed(problem_.points)) {
      return {};
    }
    if (!problem_.poses.empty()) {
      handles_->held = problem_.poses[0].id;
      return graph_.SetFixed(handles_->poses[0]);
    }
    if (problem_.cameras.empty()) return {};
    handles_->held = problem_.cameras[0].id;
    return graph_.SetFixed(handles_->cameras[0]);
  }

  [[nodiscard]] VertexHandle<VertexPose> PoseOf(std::int64_t id) const {
    return handles_->poses[ids_.vertices.at(id).index];
  }
  [[nodiscard]] VertexHandle<VertexPointXYZ> PointOf(std::int64_t id) const {
    return handles_->points[ids_.vertices.at(id).index];
  }
  [[nodiscard]] Pose OffsetOf(std::int64_t id) const {
    return Normalized(problem_.offsets[ids_.offsets.at(id).index].T_b_s);
  }

  const G2oProblem& problem_;
  const G2oIds& ids_;
  Graph& graph_;
  const G2oGraphOptions& options_;
  G2oHandles* handles_;
};

/// What our edges cannot say.
Status CheckEdges(const G2oProblem& problem, const G2oIds& ids) {
  for (const G2oPosePrior& x : problem.priors) {
    const double* p = problem.offsets[ids.offsets.at(x.offset).index].T_b_s.data;
    if (p[0] == 0.0 && p[1] == 0.0 && p[2] == 0.0) continue;
    return {StatusCode::kInvalidArgument,
            "g2o problem: EDGE_SE3_PRIOR of vertex " + std::to_string(x.pose) +
                ": its sensor, PARAMS_SE3OFFSET " + std::to_string(x.offset) +
                ", is not at the body's origin, and no edge of ours measures that"};
  }
  for (const G2oCamera& x : problem.cameras) {
    const CameraPinhole camera{x.fx, x.fy, x.cx, x.cy};
    if (Status s = camera.Validate(); !s.ok()) {
      return {s.code(), "g2o problem: VERTEX_CAM " + std::to_string(x.id) + ": " + s.message()};
    }
  }
  return {};
}

template <class V>
Status CheckHandles(const Graph& graph, const std::vector<VertexHandle<V>>& handles,
                    std::size_t size) {
  if (handles.size() != size)
    return {StatusCode::kInvalidArgument, "UpdateFromGraph: the handles are of another problem"};
  for (const auto& handle : handles) {
    if (!graph.Contains(handle)) return graph.UnknownHandle(handle);
  }
  return {};
}

/// With the sign of the quaternion that is there.
void Take(const Pose& from, Pose* to) {
  const double sign = from.q().coeffs().dot(to->q().coeffs()) < 0.0 ? -1.0 : 1.0;
  *to = from;
  for (int k = 3; k < 7; ++k)
    to->data[k] *= sign;
}

}  // namespace

Result<G2oHandles> AddToGraph(const G2oProblem& problem, Graph& graph,
                              const G2oGraphOptions& options) {
  return internal::OrOutOfMemory([&]() -> Result<G2oHandles> {
    // Whatever could be refused below is refused here.
    G2oIds ids;
    if (Status s = internal::CheckG2o(problem, "", nullptr, &ids); !s.ok()) return s;
    if (Status s = options.loss.Validate(); !s.ok()) return s;
    if (Status s = CheckEdges(problem, ids); !s.ok()) return s;
    G2oHandles handles;
    const Status added = internal::OrOutOfMemory(
        [&] { return Adder(problem, ids, graph, options, &handles).Run(); });
    if (added.ok()) return handles;
    for (const AnyVertex vertex : handles.poses)
      graph.RemoveVertex(vertex);
    for (const AnyVertex vertex : handles.cameras)
      graph.RemoveVertex(vertex);
    for (const AnyVertex vertex : handles.points)
      graph.RemoveVertex(vertex);
    return added;
  });
}

Status UpdateFromGraph(const Graph& graph, const G2oHandles& handles, G2oProblem* problem) {
  Status status = CheckHandles(graph, handles.poses, problem->poses.size());
  if (!status.ok()) return status;
  status = CheckHandles(graph, handles.cameras, problem->cameras.size());
  if (!status.ok()) return status;
  status = CheckHandles(graph, handles.points, problem->points.size());
  if (!status.ok()) return status;
  const auto stays = [&](const auto& vertex) { return vertex.fixed || vertex.id == handles.held; };
  for (std::size_t k = 0; k < handles.poses.size(); ++k) {
    G2oPose& x = problem->poses[k];
    if (!stays(x)) Take(graph.Get(handles.poses[k]).pose, &x.T_w_b);
  }
  for (std::size_t k = 0; k < handles.cameras.size(); ++k) {
    G2oCamera& x = problem->cameras[k];
    if (!stays(x)) Take(graph.Get(handles.cameras[k]).pose, &x.T_w_c);
  }
  for (std::size_t k = 0; k < handles.points.size(); ++k) {
    G2oPoint& x = problem->points[k];
    if (!stays(x)) std::copy_n(graph.Get(handles.points[k]).data, 3, x.xyz);
  }
  return {};
}

}  // namespace glissade
