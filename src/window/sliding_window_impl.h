// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/covariance/covariance.h"
#include "glissade/imu/buffer.h"
#include "glissade/imu/preintegration.h"
#include "glissade/problem/problem.h"
#include "glissade/window/sliding_window.h"
#include "window/track_table.h"

namespace glissade {

/// The observations of a frame, kept.
struct SeenFrame {
  std::int64_t stamp_ns = 0;
  std::vector<FrameObservation> observations;
};

struct CameraInWorld {
  Pose T_w_c;
  Matrix3 R_c_w;
};

/// What the steps of a window share. Frames are few and stand in the order of time; landmarks are
/// found by their track.
struct SlidingWindow::Impl {
  explicit Impl(SlidingWindowOptions o);

  SlidingWindowOptions options;
  Status options_status;
  WindowPhase phase = WindowPhase::kInitializing;
  Problem problem;
  ImuBuffer imu;

  std::vector<WindowFrame> frames;
  /// What the IMU term that leads to each frame was made of; same order as frames.
  std::vector<ImuPreintegration> preintegrations;
  std::int64_t next_frame_id = 0;
  std::int64_t last_stamp_ns = 0;  ///< of the last frame taken, also before the first state

  /// The first num_landmarks are in use; the rest keep their storage for those to come.
  std::vector<WindowLandmark> landmarks;
  std::size_t num_landmarks = 0;
  internal::TrackTable tracks;

  WindowState newest;
  const SolveSummary* summary = nullptr;  ///< problem's own
  WindowEventCounts total, recent;

  // Storage of the steps.
  ImuInterval interval;
  /// What the images of the last frames showed, for those who ask whether they moved.
  std::vector<SeenFrame> seen;
  std::vector<FrameObservations> seen_views;
  InitVerdict init_verdict;
  std::int64_t anchor_frame = -1;  ///< where the body has stood still since; -1: it does not
  WindowPlan plan;
  std::vector<TriangulationView> views;
  std::vector<AnyVertex> leaving;
  std::vector<CameraInWorld> cameras_in_world;  // [frame * cameras + camera]
  Covariance covariance;

  [[nodiscard]] bool HasImu() const { return options.imu_noise.has_value(); }
  [[nodiscard]] Vector3 Gravity() const { return Vector3(0.0, 0.0, -options.gravity); }
  [[nodiscard]] std::span<WindowLandmark> Landmarks() {
    return std::span<WindowLandmark>(landmarks).first(num_landmarks);
  }
  /// -1 where the frame has left.
  [[nodiscard]] int FrameIndex(std::int64_t id) const;
  void Count(WindowEvent event, std::int64_t times = 1);
  [[nodiscard]] Gauge WindowGauge() const;

  /// The first frame, with a prior on what is believed of it.
  Status Start(const WindowState& state, const SquareMatrix<11>& covariance);
  /// A first state at the stamp, if the body stands still.
  Status TryToStartStanding(std::int64_t stamp_ns);
  /// The same, tied to the last frame by the IMU between them.
  Status AppendFrameByImu(std::int64_t stamp_ns, const Pose& T_w_b,
                          const VertexSpeedBias& speed_bias,
                          const ImuPreintegration& preintegration);
  /// Adds a frame at a state; without a term that ties it to others.
  Status AppendFrame(std::int64_t stamp_ns, const Pose& T_w_b, const VertexSpeedBias& speed_bias);
  /// Integrates from one stamp to another into *preintegration, counting gaps and saturation.
  Status Integrate(std::int64_t begin_ns, std::int64_t end_ns, const ImuBias& bias,
                   ImuPreintegration* preintegration);
  /// Samples that no step will ask for again.
  void ForgetSamples();
  Status AddImuTerm(const ImuPreintegration& preintegration, WindowFrame* from, WindowFrame* to);

  /// The landmark of a track; a new one where there is none.
  WindowLandmark& LandmarkOf(std::int64_t track);
  /// The last one takes its place.
  void ForgetLandmark(std::size_t index);
  /// Takes a landmark out of the graph without a trace; it may be triangulated again.
  Status RemoveFromGraph(WindowLandmark* landmark);
  Status AddObservationEdge(WindowLandmark* landmark, LandmarkObservation* observation);
  void UpdateCamerasInWorld();
  [[nodiscard]] const CameraInWorld& CameraOf(int frame, int camera) const {
    return cameras_in_world[static_cast<std::size_t>(frame) * options.cameras.size() +
                            static_cast<std::size_t>(camera)];
  }
  void ReadStates();

  void Remember(std::int64_t stamp_ns, std::span<const FrameObservation> observations);
  /// The frames remembered since a stamp.
  std::span<const FrameObservations> SeenSince(std::int64_t stamp_ns);
  /// Whether the body stood still for a while until the stamp, by the IMU and the images.
  [[nodiscard]] bool StandsStill(std::int64_t stamp_ns);

  // Of Slide().
  void CompletePlan();
  Status DropObservationsOf(const std::vector<bool>& leaves);
  Status JoinImuTerms(int frame);
};

}  // namespace glissade
