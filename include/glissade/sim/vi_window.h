// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "glissade/sim/vi_problem.h"

namespace glissade::sim {

/// What a front end has to know before there is an estimate to go on from.
struct ViWindowOptions {
  /// Keyframes that begin at the problem's start, as an initialization would leave them; later ones
  /// begin where the IMU puts them from the estimate of the one before.
  int initial_keyframes = 7;
  /// A track ends after so many keyframes: the same point is then seen as a new one. Together with
  /// the oldest keyframe all points go whose track began there, so a window of at least this length
  /// loses no more than what it has used up.
  int track_length = 5;
  /// Sigmas of the calibration of the biases (m/s^2, rad/s), which is a prior on the first
  /// keyframe. Its error is drawn from `seed`.
  double accel_bias_sigma = 0.05;
  double gyro_bias_sigma = 0.005;
  std::uint64_t seed = 1;
};

/// The keyframes of a simulated flight one by one into a graph, and out of it: the part of a
/// sliding window that is not estimation. All that is new begins relative to the present estimate,
/// never in the world frame of the truth: nothing ties the window to it.
class ViWindow {
 public:
  struct Point {
    VertexHandle<VertexPointXYZ> vertex;
    std::vector<EdgeHandle<EdgeReprojectionXYZ>> observations;
  };
  struct Keyframe {
    std::size_t number = 0;  ///< in the problem
    VertexHandle<VertexPose> pose;
    VertexHandle<VertexSpeedBias> speed_bias;
    std::vector<Point> points;  ///< whose track begins here
  };

  /// The problem needs its truth; both must outlive this. The graph is empty.
  ViWindow(const ViProblem* problem, const ViWindowOptions& options, Graph* graph);

  /// The next keyframe with its IMU term and what it sees. kInvalidArgument after the last one;
  /// else what the graph refuses.
  Status AddKeyframe();
  /// Oldest first.
  [[nodiscard]] const std::vector<Keyframe>& keyframes() const { return keyframes_; }
  [[nodiscard]] int size() const { return static_cast<int>(keyframes_.size()); }
  /// The oldest keyframe, its speed and biases, and the points that begin there: what is to be
  /// marginalized. It is forgotten here.
  std::vector<AnyVertex> TakeOldest();
  /// Removes points that the estimate has behind a camera which sees them (a point with little
  /// parallax can go through infinity in a solve, and does not come back). Returns how many.
  Result<int> RemovePointsBehind();
  /// Points that are seen once only, whose distance nothing tells yet. A covariance needs a clone
  /// of the graph without them.
  [[nodiscard]] std::vector<VertexHandle<VertexPointXYZ>> PointsSeenOnce() const;

 private:
  Status AddFirst(const Keyframe& frame);
  Status AddObservations(const VertexPose& start, Keyframe* frame);
  /// The point that is being tracked, null where none is.
  Point* Tracked(std::size_t point);

  const ViProblem& problem_;
  ViWindowOptions options_;
  Graph& graph_;
  std::size_t next_ = 0;
  std::vector<Keyframe> keyframes_;
  std::vector<std::vector<const ViObservation*>> observations_;  // by keyframe
  struct Track {
    std::size_t keyframe = 0, index = 0;  // where it began, and which of the points there
  };
  std::vector<std::optional<Track>> tracks_;  // by point
};

}  // namespace glissade::sim
