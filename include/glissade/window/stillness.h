// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>

#include "glissade/base/matrix.h"
#include "glissade/imu/noise.h"
#include "glissade/imu/sample.h"
#include "glissade/window/init_verdict.h"
#include "glissade/window/observation.h"

/// \file
/// Does the body stand still? Tests of the hypothesis that it does, from the IMU and from images.
namespace glissade {

/// What "standing still" means. A machine with its rotors on trembles: its readings scatter by a
/// hundred times the sensor's noise, and yet it goes nowhere. So the hypothesis is about the
/// integrals of the readings: angle and velocity are those of the sensor's noise, of a bias that
/// walks, and of a tremble of at most these sigmas, independent from block to block.
struct StillnessOptions {
  double tremble_angle = 1.0e-3;  ///< sigma, each axis (rad)
  double tremble_speed = 5.0e-3;  ///< sigma, each axis (m/s)
  double block_s = 0.1;           ///< over which readings are integrated
  double min_duration_s = 0.5;
  /// Probability to call a body moving that trembles as hard as this allows.
  double false_alarm = 1.0e-3;

  [[nodiscard]] Status Validate() const;
};

/// What the IMU says. Rate and force are those at the last sample (the biases walk), each axis with
/// the same variance and independent of the others.
struct StillnessTest {
  InitVerdict verdict;              ///< ok: the body stands still, as far as an IMU can tell
  double gyro_chi2 = 0.0;           ///< of the angles that a constant rate leaves
  double accel_chi2 = 0.0;          ///< of the velocities that a constant force leaves
  int dof = 0;                      ///< of each of the two
  double max_chi2 = 0.0;            ///< that standing still may have
  Vector3 rate = Vector3::Zero();   ///< rad/s
  Vector3 force = Vector3::Zero();  ///< specific force, m/s^2
  double rate_variance = 0.0;       ///< (rad/s)^2
  double force_variance = 0.0;      ///< (m/s^2)^2
  double tremble_angle = 0.0;       ///< estimated sigma (rad)
  double tremble_speed = 0.0;       ///< estimated sigma (m/s)
  double duration_s = 0.0;
};

/// Generalised least squares of a constant rate (and force) in the block integrals
///     y_k = rate h_k + e_k,   cov(e) = density^2 diag(h) + walk + tremble^2 D D',
/// D the difference of neighbours, `walk` that of a bias which is known at the end and walks
/// backward; chi2 of what is left against the quantile of chi2 with 3 (blocks - 1) degrees of
/// freedom. A constant velocity without rotation and a constant rate about the vertical are, to an
/// IMU, standing still (with another bias): images tell them apart.
///
/// Refuses, in this order: kInvalidInput, kNotFinite, kTooFewSamples, kImuGap (neighbours further
/// apart than noise.max_gap_ns), kImuSaturated, kMoving. Nothing that is not finite passes.
[[nodiscard]] StillnessTest TestStillness(std::span<const ImuSample> samples, const ImuNoise& noise,
                                          const StillnessOptions& options = {});

/// What images say.
struct ImageStillnessTest {
  InitVerdict verdict;  ///< kTooFewTracks: no opinion
  int tracks = 0;       ///< seen in at least two frames
  int moved = 0;        ///< of those, with a motion over the median of what noise makes
  int max_moved = 0;    ///< that standing still may have
};

/// Of each track in each camera, the slope of its pixels over time: with standing still, its square
/// over its variance (pixel noise and tremble) is chi2 with 2 degrees of freedom, and half of the
/// tracks are over the median. A sign test against that, with room for 30 % of tracks that are
/// wrong; it asks for at least 8 tracks. What is not finite counts as moved.
[[nodiscard]] ImageStillnessTest TestImageStillness(std::span<const WindowCamera> cameras,
                                                    std::span<const FrameObservations> frames,
                                                    const StillnessOptions& options = {});

}  // namespace glissade
