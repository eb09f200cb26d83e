// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "glissade/edges/bal.h"
#include "glissade/edges/reprojection_intrinsics.h"
#include "glissade/io/ply.h"

namespace glissade {

namespace {

constexpr PlyColor kCameraColor = {255, 140, 0};
constexpr PlyColor kUnseen = {128, 128, 128};

/// Blue at 0 px, green at 1, red from 4 on.
PlyColor ColorOf(double error_px) {
  const auto mix = [](double part) {
    return static_cast<std::uint8_t>(std::lround(255.0 * std::clamp(part, 0.0, 1.0)));
  };
  if (error_px < 1.0) return {0, mix(error_px), mix(1.0 - error_px)};
  const double red = (error_px - 1.0) / 3.0;
  return {mix(red), mix(1.0 - red), 0};
}

struct CameraInSpace {
  double R[9];
  double centre[3];
};

CameraInSpace InSpace(const VertexCameraBal& camera) {
  const double* d = camera.data;
  const Matrix3 R = so3::Exp(Vector3(d[0], d[1], d[2]));
  CameraInSpace placed{};
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col) {
      placed.R[3 * row + col] = R(row, col);
      placed.centre[col] -= R(row, col) * d[3 + row];
    }
  }
  return placed;
}

/// T_W_C.
CameraInSpace InSpace(const VertexPose& camera) {
  const Matrix3 R = camera.pose.R();
  CameraInSpace placed{};
  for (int row = 0; row < 3; ++row) {
    for (int col = 0; col < 3; ++col)
      placed.R[3 * row + col] = R(col, row);
    placed.centre[row] = camera.pose.data[row];
  }
  return placed;
}

/// Half the median distance from one camera to the next; 1 where there is none.
double FrustumSize(const std::vector<CameraInSpace>& cameras) {
  std::vector<double> steps;
  for (std::size_t k = 1; k < cameras.size(); ++k) {
    const double* a = cameras[k - 1].centre;
    const double* b = cameras[k].centre;
    steps.push_back(std::hypot(b[0] - a[0], b[1] - a[1], b[2] - a[2]));
  }
  if (steps.empty()) return 1.0;
  const auto middle = steps.begin() + static_cast<std::ptrdiff_t>(steps.size() / 2);
  std::nth_element(steps.begin(), middle, steps.end());
  return *middle > 0.0 ? 0.5 * *middle : 1.0;
}

/// Of each point, by its slot.
class PointErrors {
 public:
  void Add(VertexHandle<VertexPointXYZ> point, const Vector2& r) {
    if (point.slot >= errors_.size()) errors_.resize(2 * std::size_t{point.slot} + 1);
    errors_[point.slot].sum2 += r[0] * r[0] + r[1] * r[1];
    ++errors_[point.slot].count;
  }
  [[nodiscard]] PlyColor Color(VertexHandle<VertexPointXYZ> point) const {
    const Error error = point.slot < errors_.size() ? errors_[point.slot] : Error{};
    return error.count == 0 ? kUnseen : ColorOf(std::sqrt(error.sum2 / error.count));
  }

 private:
  struct Error {
    double sum2 = 0.0;
    int count = 0;
  };
  std::vector<Error> errors_;
};

template <class E>
void AddErrors(const Graph& graph, PointErrors* errors) {
  graph.ForEachEdge<E>([&](EdgeHandle<E>, const E& edge, const EdgeVertexHandles<E>& vertices) {
    const auto& [pose, point, intrinsics] = vertices;
    Vector2 r;
    if (edge.Evaluate(graph.Get(pose), graph.Get(point), graph.Get(intrinsics), r, nullptr, nullptr,
                      nullptr)) {
      errors->Add(point, r);
    }
  });
}

}  // namespace

Result<PlyScene> PlyOfGraph(const Graph& graph) {
  if (graph.NumVertices<VertexCameraBal>() + graph.NumVertices<VertexPointXYZ>() == 0) {
    return Status(StatusCode::kInvalidArgument, "PLY: the graph has no BAL cameras and no points");
  }
  PointErrors errors;
  graph.ForEachEdge<EdgeBal>(
      [&](EdgeHandle<EdgeBal>, const EdgeBal& edge, const EdgeVertexHandles<EdgeBal>& vertices) {
        const auto& [camera, point] = vertices;
        Vector2 r;
        if (edge.Evaluate(graph.Get(camera), graph.Get(point), r, nullptr, nullptr))
          errors.Add(point, r);
      });
  AddErrors<EdgeReprojectionRadial>(graph, &errors);
  AddErrors<EdgeReprojectionRadtan>(graph, &errors);
  AddErrors<EdgeReprojectionFisheye>(graph, &errors);
  PlyScene scene;
  graph.ForEachVertex<VertexPointXYZ>(
      [&](VertexHandle<VertexPointXYZ> handle, const VertexPointXYZ& point) {
        scene.AddPoint(point.data, errors.Color(handle));
      });
  std::vector<CameraInSpace> cameras;
  graph.ForEachVertex<VertexCameraBal>(
      [&](VertexHandle<VertexCameraBal>, const VertexCameraBal& camera) {
        cameras.push_back(InSpace(camera));
      });
  const std::size_t looking_back = cameras.size();
  graph.ForEachVertex<VertexPose>([&](VertexHandle<VertexPose>, const VertexPose& camera) {
    cameras.push_back(InSpace(camera));
  });
  const double size = FrustumSize(cameras);
  for (std::size_t k = 0; k < cameras.size(); ++k)
    scene.AddCamera(cameras[k].R, cameras[k].centre, size, k < looking_back, kCameraColor);
  return scene;
}

}  // namespace glissade
