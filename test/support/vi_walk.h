// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cmath>
#include <deque>
#include <span>
#include <vector>

#include "common/random_states.h"
#include "glissade/graph/graph.h"

/// \file
/// A visual-inertial window that walks along an endless track, without any absolute prior: frames
/// come and go, nothing but relative measurements in between.
namespace glissade::test {

struct WalkOptions {
  int landmarks_per_frame = 6;
  int track_length = 4;      ///< frames after the host that see a landmark
  double start_noise = 1.0;  ///< of a new frame: times 2 cm and 0.3 degrees, 2 cm/s
  double pixel_noise = 1.0;  ///< sigmas
};

/// Directions that nothing in a visual-inertial problem observes.
enum class GaugeDirection { kX, kY, kZ, kYaw };
inline constexpr GaugeDirection kGaugeDirections[] = {GaugeDirection::kX, GaugeDirection::kY,
                                                      GaugeDirection::kZ, GaugeDirection::kYaw};

/// d(state)/d(gauge) of one vertex at the given state.
inline std::array<double, 9> GaugeVector(const VertexOps& ops, const double* x,
                                         GaugeDirection direction) {
  std::array<double, 9> u{};
  const Vector3 z(0, 0, 1);
  const auto put = [&](int at, const Vector3& v) {
    for (int i = 0; i < 3; ++i)
      u[static_cast<std::size_t>(at + i)] = v[i];
  };
  const bool yaw = direction == GaugeDirection::kYaw;
  if (ops.type == &kTypeInfo<VertexPose>) {
    if (yaw) {
      put(0, z.cross(Vector3(x[0], x[1], x[2])));
      put(3, RotationMatrix(x + 3).transpose() * z);
    } else {
      u[static_cast<std::size_t>(direction)] = 1.0;
    }
  } else if (ops.type == &kTypeInfo<VertexSpeedBias>) {
    if (yaw) put(0, z.cross(Vector3(x[0], x[1], x[2])));
  }
  return u;
}

/// kappa(u) = u'Hu / sum u_k H_kk u_k and u'Hu of all edges of a graph, each linearized as the
/// graph's first estimates say, u at the linearization points.
struct GaugeInformation {
  double information = 0.0;
  double kappa = 0.0;
};
GaugeInformation MeasureGauge(const Graph& graph, GaugeDirection direction);

class ViWalk {
 public:
  explicit ViWalk(std::uint64_t seed, const WalkOptions& options = {});

  Graph& graph() { return *graph_; }
  /// The graph to work on: a Problem of the test's own, or none (an own one).
  void Attach(Graph* graph) { graph_ = graph; }
  void AddFrame();
  [[nodiscard]] int num_frames() const { return static_cast<int>(frames_.size()); }
  /// The oldest frame's pose, speed and biases, and the landmarks it hosts; they are forgotten
  /// here.
  std::vector<AnyVertex> TakeOldest();
  /// Into a buffer that serves again.
  void TakeOldest(std::vector<AnyVertex>* vertices);
  /// All poses, speeds and biases moved by up to these.
  void Shake(double position, double degrees);
  [[nodiscard]] VertexHandle<VertexPose> pose(int k) const {
    return frames_[static_cast<std::size_t>(k)].pose;
  }
  [[nodiscard]] VertexHandle<VertexSpeedBias> speed_bias(int k) const {
    return frames_[static_cast<std::size_t>(k)].speed_bias;
  }

 private:
  struct Landmark {
    VertexHandle<VertexInverseDepth> depth;
    Vector2 uv = Vector2::Zero();
    Vector3 point = Vector3::Zero();
  };
  struct Frame {
    int number = 0;
    Pose pose_true;
    Vector3 v_true = Vector3::Zero();
    VertexHandle<VertexPose> pose;
    VertexHandle<VertexSpeedBias> speed_bias;
    std::vector<Landmark> landmarks;
  };
  void AddImu(const Frame& i, const Frame& j);
  void AddObservations(const Frame& host, const Frame& target);

  WalkOptions options_;
  Random random_;
  Graph own_;
  Graph* graph_ = &own_;
  Pose T_b_c_;
  int next_ = 0;
  std::vector<Frame> frames_, spare_;
};

}  // namespace glissade::test
