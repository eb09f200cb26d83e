// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "glissade/covariance/covariance.h"
#include "glissade/imu/buffer.h"
#include "glissade/imu/preintegration.h"
#include "glissade/problem/problem.h"
#include "glissade/window/sliding_window.h"
#include "window/clock_watch.h"
#include "window/stillness.h"
#include "window/track_table.h"

namespace glissade {

/// The observations of a frame, kept.
struct SeenFrame {
  std::int64_t stamp_ns = 0;
  std::vector<FrameObservation> observations;
};

/// What Slide() makes of a frame.
enum class FrameFate : std::uint8_t { kStays, kMarginalized, kDropped };

/// A camera of a frame where the frame is now.
struct CameraInWorld {
  Pose T_w_c;
  Matrix3 R_c_w;
  Vector2 weight;  ///< 1 / sigma of an observation, in normalized coordinates

  CameraInWorld(const WindowCamera& camera, const Pose& T_w_b)
      : T_w_c(T_w_b * camera.T_b_c),
        R_c_w(T_w_c.R().transpose()),
        weight(camera.fx / camera.sigma_px, camera.fy / camera.sigma_px) {}

  /// r'r in sigmas of an observation of the point X_w; infinite for a point behind the camera and
  /// for one that is not finite.
  [[nodiscard]] double SquareInSigmas(const Vector3& X_w, const LandmarkObservation& o) const {
    const Vector3 x = R_c_w * (X_w - T_w_c.p());
    const double inverse = 1.0 / x[2];
    const double du = weight[0] * (x[0] * inverse - o.uv[0]);
    const double dv = weight[1] * (x[1] * inverse - o.uv[1]);
    const double square = du * du + dv * dv;
    return x[2] > 0.0 && square >= 0.0 ? square : std::numeric_limits<double>::infinity();
  }
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
  std::size_t most_observations = 0;  ///< of a landmark
  std::size_t num_landmarks = 0;
  internal::TrackTable tracks;

  /// Options' own, or what was known when the window began anew.
  ImuBiasPrior bias_prior;
  /// Where it was then; the next first state is put there.
  std::optional<Pose> resume_at;
  internal::ClockWatch imu_clock{10}, frame_clock{3};
  int failed_solves = 0;  ///< in a row

  WindowState newest;
  const SolveSummary* summary = nullptr;  ///< problem's own
  WindowEventCounts total, recent;

  // Storage of the steps.
  /// Of the newest frame as predicted; empty: not trusted.
  std::vector<CameraInWorld> predicted_cameras;
  std::vector<int> seen_by_camera;  ///< features in the newest frame
  ImuInterval interval;
  /// What the images of the last frames showed, for those who ask whether they moved.
  std::vector<SeenFrame> seen;
  std::size_t most_seen = 0;  ///< observations in a frame
  std::vector<FrameObservations> seen_views;
  std::vector<FrameObservation> anchor_seen, newest_seen;
  internal::ImageStillness image_stillness;
  InitVerdict init_verdict;
  double initial_scale_sigma = 0.0;
  std::optional<std::int64_t> attempted_ns;  ///< to begin in motion, last
  std::int64_t anchor_frame = -1;  ///< where the body has stood still since; -1: it does not
  double standing_angle = 0.0;     ///< sigma of a standing body's tremble (rad)
  WindowPlan plan;
  std::vector<TriangulationView> views;
  std::vector<FrameFate> fates;
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
  /// The same for ids in rising order: *at is where the last one was, 0 at first.
  [[nodiscard]] int NextFrameIndex(std::int64_t id, int* at) const {
    const int count = static_cast<int>(frames.size());
    while (*at < count && frames[static_cast<std::size_t>(*at)].id < id)
      ++*at;
    return *at < count && frames[static_cast<std::size_t>(*at)].id == id ? *at : -1;
  }
  void Count(WindowEvent event, std::int64_t times = 1);
  /// Counts a frame that is refused.
  Status Refused(Status why);
  [[nodiscard]] Gauge WindowGauge() const;
  /// The covariance of the oldest pose and the newest state, in WindowGauge().
  [[nodiscard]] Result<JointCovariance> JointOfNewest();

  [[nodiscard]] Pose ResumedWorld(const Pose& first) const;
  /// The first frame, with a prior on what is believed of it.
  Status Start(const WindowState& state, const SquareMatrix<11>& covariance);
  Status Start(const WindowState& state, const InitialSigmas& sigmas);
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
  /// Whether the newest frame was predicted well enough to judge observations by it.
  [[nodiscard]] bool IsPredictionTrusted() const;
  /// Whether an observation is where the landmark is predicted to be in the newest frame, roughly.
  [[nodiscard]] bool IsNearPrediction(const WindowLandmark& landmark,
                                      const LandmarkObservation& observation) const;
  /// Whether the newest state is one that somebody can believe.
  [[nodiscard]] bool IsPlausible() const;
  /// Forgets frames, landmarks and the prior; samples and what was seen stay.
  Status ClearGraph();
  Status AddSample(const ImuSample& sample, bool* clock_was_set);
  /// Refuses a stamp that is not later than the last frame's or too far after it.
  [[nodiscard]] Status CheckFrameStamp(std::int64_t stamp_ns) const;
  /// Asked once of each frame's stamp.
  bool FrameClockWasSet(std::int64_t stamp_ns);

  /// By a camera that there is, and finite.
  [[nodiscard]] bool MakesSense(const FrameObservation& o) const;
  /// Those that make sense.
  void Remember(std::int64_t stamp_ns, std::span<const FrameObservation> observations);
  /// The frames remembered since a stamp.
  std::span<const FrameObservations> SeenSince(std::int64_t stamp_ns);
  /// Whether the body stood still for a while until the stamp, by the IMU and the images; then
  /// standing_angle is how still.
  [[nodiscard]] bool StandsStill(std::int64_t stamp_ns);
  [[nodiscard]] bool StandsWhereItBegan(std::int64_t anchor_id);

  // Of Slide().
  void CompletePlan();
  Status DropObservations();
  Status JoinImuTerms(int first, int last);
};

}  // namespace glissade
