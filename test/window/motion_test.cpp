// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Initialisation in motion, in simulation: errors as large as the covariance says, and a refusal
// with the right reason where there is nothing to see.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "glissade/sim/recording.h"
#include "window/motion_input.h"

namespace glissade {
namespace {

using test::MotionErrors;
using test::MotionInput;
using test::SteadyFlight;

Viotracks Flight(std::uint64_t seed) {
  sim::RecordingOptions options;
  options.world.length_m = 6.0;
  options.world.num_points = 160;
  options.world.seed = seed;
  options.seed = seed;
  return sim::MakeRecording(options).value();
}

/// The biases of these simulations.
ImuBiasPrior SimulatedPrior() {
  ImuBiasPrior prior;
  prior.accel_sigma = 0.1;
  prior.gyro_sigma = 0.01;
  return prior;
}

struct Tally {
  int runs = 0, initialized = 0, scale = 0, gravity = 0, velocity = 0;
  double nees = 0.0;
};

Tally FlyAll(bool mono, int seeds) {
  Tally tally;
  for (int seed = 1; seed <= seeds; ++seed) {
    const Viotracks recording = Flight(static_cast<std::uint64_t>(seed));
    MotionInput flight(recording, mono);
    ++tally.runs;
    const std::size_t begin = static_cast<std::size_t>(seed) % 20;
    // As a front end would: with every frame from the tenth on until it succeeds.
    for (std::size_t count = 10; count <= 21; ++count) {
      InitializationInput input = flight.Window(begin, count);
      input.bias_prior = SimulatedPrior();
      InitVerdict verdict;
      const auto state = InitializeInMotion(input, &verdict);
      EXPECT_EQ(state.ok(), verdict.ok());
      if (!state.ok()) continue;
      ++tally.initialized;
      EXPECT_EQ(state->stereo, !mono);
      EXPECT_EQ(state->frames.size(), count);
      const MotionErrors errors(*state, recording.ground_truth);
      // One number, two, three: what 95 % are within.
      tally.scale += std::abs(errors.log_scale) < 2.0 * state->log_scale_sigma ? 1 : 0;
      tally.gravity += errors.gravity < 2.45 * state->gravity_sigma ? 1 : 0;
      tally.velocity += errors.velocity < 2.8 * state->velocity_sigma ? 1 : 0;
      tally.nees += errors.nees;
      break;
    }
  }
  tally.nees /= tally.initialized;
  return tally;
}

/// Of 24 that are right with 95 %, fewer than 20 are within in 0.6 % of all cases. The mean of
/// 24 chi2 with 15 degrees of freedom has a sigma of sqrt(30 / 24) = 1.1.
void ExpectCovered(const Tally& tally) {
  EXPECT_GE(tally.initialized, tally.runs - 1);
  EXPECT_GE(tally.scale, 20);
  EXPECT_GE(tally.gravity, 20);
  EXPECT_GE(tally.velocity, 20);
  EXPECT_GT(tally.nees, 15.0 - 4.0);
  EXPECT_LT(tally.nees, 15.0 + 4.5);
}

TEST(Motion, StereoErrorsAreThoseOfTheCovariance) {
  ExpectCovered(FlyAll(false, 24));
}

TEST(Motion, MonoErrorsAreThoseOfTheCovariance) {
  ExpectCovered(FlyAll(true, 24));
}

TEST(Motion, TheSameInputGivesTheSameBits) {
  const Viotracks recording = Flight(1);
  for (const bool mono : {false, true}) {
    MotionInput flight(recording, mono);
    const auto a = InitializeInMotion(flight.Window(3, 14));
    const auto b = InitializeInMotion(flight.Window(3, 14));
    ASSERT_TRUE(a.ok()) << a.status().message();
    EXPECT_EQ(a->frames.back().pose.pose, b->frames.back().pose.pose);
    EXPECT_EQ(a->covariance, b->covariance);
    EXPECT_GE(a->points.size(), 20u);
    // W: the first body at the origin with yaw 0.
    const Pose& first = a->frames.front().pose.pose;
    EXPECT_LT(first.p().norm(), 1e-9);
    EXPECT_NEAR(std::atan2(first.R()(1, 0), first.R()(0, 0)), 0.0, 0.02);
  }
}

InitVerdict VerdictOf(const InitializationInput& input) {
  InitVerdict verdict;
  const auto state = InitializeInMotion(input, &verdict);
  EXPECT_EQ(state.ok(), verdict.ok());
  EXPECT_EQ(state.status().message(), verdict.message);
  return verdict;
}

/// Where nothing can be known, the reason is the right one, whatever the noise.
TEST(Motion, WhatCannotBeSeenIsRefused) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    SCOPED_TRACE(seed);
    SteadyFlight standing, steady, turning;
    steady.velocity = Vector3(0.1, 0.6, 0.05);
    turning.rate = Vector3(0.0, 0.0, 0.4);
    standing.seed = steady.seed = turning.seed = seed;
    const auto reason = [](const SteadyFlight& flight, bool mono) {
      const Viotracks recording = flight.Record();
      MotionInput input(recording, mono);
      InitializationInput window = input.Window(0, 16);
      window.bias_prior = SimulatedPrior();
      const InitVerdict verdict = VerdictOf(window);
      EXPECT_TRUE(verdict.ok() || verdict.figure != 0.0) << verdict.message;
      return verdict.reason;
    };
    EXPECT_EQ(reason(standing, true), InitReason::kStandingStill);
    EXPECT_EQ(reason(standing, false), InitReason::kStandingStill);
    EXPECT_EQ(reason(steady, true), InitReason::kNoAcceleration);
    EXPECT_EQ(reason(turning, true), InitReason::kRotationOnly);
    // With a known baseline both can be seen.
    EXPECT_EQ(reason(steady, false), InitReason::kOk);
    EXPECT_EQ(reason(turning, false), InitReason::kOk);
  }
}

/// With a baseline but without acceleration, gravity is known as well as the accelerometer is.
TEST(Motion, StereoAtConstantVelocityAsGoodAsTheAccelerometer) {
  SteadyFlight steady;
  steady.velocity = Vector3(0.1, 0.6, 0.05);
  const Viotracks recording = steady.Record();
  MotionInput input(recording, false);
  InitializationInput window = input.Window(0, 12);
  window.bias_prior.accel_sigma = 0.1;
  const auto state = InitializeInMotion(window);
  ASSERT_TRUE(state.ok()) << state.status().message();
  EXPECT_NEAR(state->gravity_sigma, 0.1 / 9.81, 0.002);
  window.bias_prior.accel_sigma = 1.0;
  const InitVerdict verdict = VerdictOf(window);
  EXPECT_EQ(verdict.reason, InitReason::kNoAcceleration);
  EXPECT_NEAR(verdict.figure, 1.0 / 9.81, 0.02);
  EXPECT_EQ(verdict.limit, window.limits.gravity_sigma);
}

TEST(Motion, BadInputIsNamed) {
  const Viotracks recording = Flight(2);
  MotionInput flight(recording, false);
  const InitializationInput good = flight.Window(0, 10);
  ASSERT_TRUE(VerdictOf(good).ok()) << VerdictOf(good).message;

  InitializationInput bad = good;
  bad.frames = good.frames.first(3);
  EXPECT_EQ(VerdictOf(bad).reason, InitReason::kTooFewFrames);
  bad = good;
  bad.imu = good.imu.first(50);
  EXPECT_EQ(VerdictOf(bad).reason, InitReason::kTooFewSamples);
  bad.imu = {};
  EXPECT_EQ(VerdictOf(bad).reason, InitReason::kTooFewSamples);
  bad = good;
  bad.cameras = {};
  EXPECT_EQ(VerdictOf(bad).reason, InitReason::kInvalidInput);
  bad = good;
  bad.cameras = good.cameras.first(1);  // observations of a second camera
  EXPECT_EQ(VerdictOf(bad).reason, InitReason::kInvalidInput);
  bad = good;
  bad.bias_prior.accel_sigma = std::nan("");
  EXPECT_EQ(VerdictOf(bad).reason, InitReason::kInvalidInput);

  std::vector<ImuSample> imu(good.imu.begin(), good.imu.end());
  imu[40].gyro[1] = std::numeric_limits<double>::infinity();
  bad = good;
  bad.imu = imu;
  EXPECT_EQ(VerdictOf(bad).reason, InitReason::kNotFinite);
  EXPECT_EQ(VerdictOf(bad).figure, 40.0);
  imu.assign(good.imu.begin(), good.imu.end());
  imu.erase(imu.begin() + 60, imu.begin() + 80);
  bad.imu = imu;
  EXPECT_EQ(VerdictOf(bad).reason, InitReason::kImuGap);
  EXPECT_NEAR(VerdictOf(bad).figure, 0.105, 1e-6);
}

TEST(Motion, FewTracksAndPixelsThatAreNone) {
  const Viotracks recording = Flight(2);
  MotionInput flight(recording, false);
  // A tenth of the pixels are NaN: left out.
  int count = 0;
  for (auto& frame : flight.seen) {
    for (FrameObservation& o : frame) {
      if (++count % 10 == 0) o.u = std::nan("");
    }
  }
  EXPECT_TRUE(VerdictOf(flight.Window(0, 12)).ok()) << VerdictOf(flight.Window(0, 12)).message;
  for (auto& frame : flight.seen) {
    std::erase_if(frame, [](const FrameObservation& o) { return o.track > 6; });
  }
  EXPECT_EQ(VerdictOf(flight.Window(0, 12)).reason, InitReason::kTooFewTracks);
  for (auto& frame : flight.seen)
    frame.clear();
  EXPECT_EQ(VerdictOf(flight.Window(0, 12)).reason, InitReason::kTooFewTracks);
}

}  // namespace
}  // namespace glissade
