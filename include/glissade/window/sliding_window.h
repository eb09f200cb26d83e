// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>

#include "glissade/base/status.h"
#include "glissade/imu/sample.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/window/event.h"
#include "glissade/window/options.h"
#include "glissade/window/policy.h"
#include "glissade/window/view.h"

namespace glissade {

class Problem;
struct NullspaceReport;
struct SolveSummary;

enum class WindowPhase : std::uint8_t {
  kInitializing,  ///< no state yet
  kRunning,
};

enum class KeyframeChoice : std::uint8_t { kByRules, kYes, kNo };

/// The newest state.
struct WindowState {
  std::int64_t stamp_ns = 0;
  Pose T_w_b;
  VertexSpeedBias speed_bias;  ///< zero without an IMU
};

/// A sliding-window estimator: frames, IMU samples and tracked features go in, the newest state
/// comes out, at bounded cost.
///
///     SlidingWindow window(options);
///     window.AddImu(samples);                       // up to the frame's stamp
///     if (window.AddFrame(stamp_ns, features).ok()) // predicts, takes landmarks up
///       window.Optimize();                          // solves, takes outliers out, slides
///     if (window.phase() == WindowPhase::kRunning) use(window.newest());
///
/// The world's z axis points up; its origin and heading are those of the first state. Landmarks are
/// points in the world. What happens in a frame is a list of steps, each of which can also be
/// called alone; AddFrame() and Optimize() call them in this order:
///
///     AddFrame: Propagate, Associate, TriangulateTracks, UseStillness, ChooseKeyframe
///     Optimize: Solve, RejectOutliers, ReplaceImuTerms, Slide
///
/// Calls that are refused leave everything as it was. Not for use by two threads at once.
class SlidingWindow {
 public:
  /// Options that make no sense: every call is refused with what options.Validate() says.
  explicit SlidingWindow(SlidingWindowOptions options);
  ~SlidingWindow();
  SlidingWindow(SlidingWindow&&) noexcept;
  SlidingWindow& operator=(SlidingWindow&&) noexcept;

  /// Takes all samples that make sense; the status is that of the first that does not.
  Status AddImu(std::span<const ImuSample> samples);
  /// A frame later than the last one. Single observations that make no sense are left out and
  /// counted. Refused: a stamp that is not later or too far away (kInvalidArgument), one that the
  /// IMU does not reach yet (kInvalidArgument: add samples and call again).
  Status AddFrame(std::int64_t stamp_ns, std::span<const FrameObservation> observations,
                  KeyframeChoice keyframe = KeyframeChoice::kByRules);
  /// Instead of finding the first state in what is measured: begins at this one, for whoever knows
  /// it. The next frame is a later one. Refused once the window runs.
  Status Start(const WindowState& state, const InitialSigmas& sigmas);
  /// Nothing to do, and ok, before the first state is there. Where the state has become one that
  /// nobody can believe, or solves fail again and again, the window begins anew (Reinitialize) and
  /// counts kReset.
  Status Optimize(const WindowBudget& budget = {});

  /// Why there is no first state yet: what was tested last, and by which number.
  [[nodiscard]] const InitVerdict& init_verdict() const;
  /// How well the scale of the first state was known: sigma of its logarithm (0.05: 5 %), of the
  /// frames that it was found from. 0: from rest, from what the caller said, or no state yet.
  [[nodiscard]] double initial_scale_sigma() const;

  // --- What is known -------------------------------------------------------------------------
  [[nodiscard]] WindowPhase phase() const;
  [[nodiscard]] const WindowState& newest() const;
  [[nodiscard]] WindowView view() const;
  [[nodiscard]] const Problem& problem() const;
  /// Of the last solve.
  [[nodiscard]] const SolveSummary& summary() const;
  /// Since the window was made / since the last AddFrame() began.
  [[nodiscard]] const WindowEventCounts& total_events() const;
  [[nodiscard]] const WindowEventCounts& recent_events() const;
  /// The covariance of the newest state, 15 x 15 row-major: pose [dp, dtheta], then speed and
  /// biases (6 x 6 without an IMU), where position and yaw of the window's oldest frame are
  /// certain. Of a state that was solved for, it is what that solve knew, frames included that have
  /// left since, and costs no linearization (CovarianceOfLastSolve); of one that is only predicted,
  /// what the window knows with it.
  Status NewestCovariance(std::span<double> covariance);
  /// How far the window is from knowing what nobody measured (gauge/nullspace.h).
  Result<NullspaceReport> CheckNullspace();

  // --- The steps -----------------------------------------------------------------------------
  /// Predicts the state at the stamp from the IMU, or by constant velocity without one, and adds it
  /// with its IMU term.
  Status Propagate(std::int64_t stamp_ns);
  /// Takes up what the newest frame sees of known landmarks, and notes the rest for later.
  Status Associate(std::span<const FrameObservation> observations);
  /// Makes landmarks of tracks whose point has become known.
  Status TriangulateTracks();
  /// Where the body stands still, by the IMU and the images: says that its velocity is zero and
  /// that it is where it was when that began.
  Status UseStillness();
  /// Makes the newest frame a keyframe or not.
  void ChooseKeyframe(KeyframeChoice choice);
  Status Solve(const WindowBudget& budget);
  /// Takes out observations that do not fit and landmarks that are left with too few.
  Status RejectOutliers();
  /// Integrates IMU terms again whose biases have moved too far for a first-order correction.
  Status ReplaceImuTerms();
  /// Asks the policy what is to leave, and makes it a prior.
  Status Slide();
  /// Begins anew at the newest state: keeps pose, tilt, speed and biases as they are believed, with
  /// widened uncertainty, and forgets landmarks and the prior.
  Status Reset();
  /// Gives up the state and looks for a first one again, as at the beginning, but at the place and
  /// heading of the last state, and with the biases of it as their prior, where those are
  /// believable: three times as uncertain as they were. Nothing to do before the first state.
  void Reinitialize();

 private:
  struct Impl;
  /// Looks for the first state in what came until this stamp; kInitializing is no failure.
  Status TryToStart(std::int64_t stamp_ns);
  Status TryToStartMoving();
  // A window that was moved from is one whose options name no camera: it says so.
  Impl& impl();
  [[nodiscard]] const Impl& impl() const;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glissade
