// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Clocks that jump, samples that lie, states that nobody can believe: the window says so and goes
// on, or begins anew where it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "glissade/io/replay.h"
#include "glissade/window/sliding_window.h"
#include "window/clock_watch.h"
#include "window/window_run.h"

namespace glissade {
namespace {

using internal::ClockWatch;
using test::MakeFlight;
using test::OptionsFor;
using test::TruthAt;

constexpr std::int64_t kSecond = 1'000'000'000;

struct Outcome {
  int refused = 0;
  std::vector<std::size_t> frames;  ///< those that have an estimate
  std::vector<Pose> errors;         ///< estimate * truth^-1 at each of them
};

/// What comes in at a frame, for a test to spoil.
struct Input {
  std::int64_t stamp_ns = 0;
  std::vector<ImuSample> imu;
  std::vector<FrameObservation> observations;
};

/// A window that begins by itself.
Outcome Fly(const Viotracks& flight, SlidingWindow* window,
            const std::function<void(std::size_t frame, Input* input)>& spoil) {
  Outcome outcome;
  ViotracksReplay replay(flight);
  while (replay.Next()) {
    Input input{replay.stamp_ns(),
                {replay.imu().begin(), replay.imu().end()},
                {replay.observations().begin(), replay.observations().end()}};
    spoil(replay.frame(), &input);
    static_cast<void>(window->AddImu(input.imu));
    if (!window->AddFrame(input.stamp_ns, input.observations).ok()) {
      ++outcome.refused;
      continue;
    }
    const Status solved = window->Optimize();
    EXPECT_TRUE(solved.ok()) << "frame " << replay.frame() << ": " << solved.message();
    if (window->phase() != WindowPhase::kRunning) continue;
    outcome.frames.push_back(replay.frame());
    outcome.errors.push_back(window->newest().T_w_b *
                             TruthAt(flight, replay.frame()).T_w_b.Inverse());
  }
  return outcome;
}

/// How far the way from one estimate to a later one is off.
double Drift(const Outcome& outcome, std::size_t from, std::size_t to) {
  return (outcome.errors[from].Inverse() * outcome.errors[to]).p().norm();
}

TEST(ClockWatch, TellsAWrongStampFromAClockThatWasSet) {
  using Verdict = ClockWatch::Verdict;
  ClockWatch watch(3);
  EXPECT_EQ(watch.Judge(101, 100, 10), Verdict::kGoesOn);
  EXPECT_EQ(watch.Judge(200, 100, 10), Verdict::kJumped);
  EXPECT_EQ(watch.Judge(201, 100, 10), Verdict::kJumped);
  EXPECT_EQ(watch.Judge(102, 100, 10), Verdict::kGoesOn);  // to and fro
  EXPECT_EQ(watch.Judge(200, 100, 10), Verdict::kJumped);
  EXPECT_EQ(watch.Judge(300, 100, 10), Verdict::kJumped);  // elsewhere
  EXPECT_EQ(watch.Judge(301, 100, 10), Verdict::kJumped);
  EXPECT_EQ(watch.Judge(301, 100, 10), Verdict::kJumped);  // the same again is no clock
  EXPECT_EQ(watch.Judge(302, 100, 10), Verdict::kJumped);
  EXPECT_EQ(watch.Judge(303, 100, 10), Verdict::kWasSet);
  EXPECT_EQ(watch.Judge(50, 100, 10), Verdict::kJumped);  // back
  EXPECT_EQ(watch.Judge(51, 100, 10), Verdict::kJumped);
  EXPECT_EQ(watch.Judge(52, 100, 10), Verdict::kWasSet);
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  EXPECT_EQ(watch.Judge(kLeast, kMost, 10), Verdict::kJumped);
  EXPECT_EQ(watch.Judge(kMost, kLeast, 10), Verdict::kJumped);
}

TEST(WindowFaults, OneSampleFromTheFutureDoesNotEndTheImu) {
  const Viotracks flight = MakeFlight(31);
  SlidingWindow window(OptionsFor(flight));
  const Outcome outcome = Fly(flight, &window, [](std::size_t frame, Input* input) {
    if (frame != 60) return;
    ImuSample wrong = input->imu.back();
    wrong.stamp_ns += 3600 * kSecond;
    input->imu.insert(input->imu.begin(), wrong);
  });
  EXPECT_EQ(window.total_events()[WindowEvent::kImuSampleRefused], 1);
  EXPECT_EQ(outcome.refused, 0);
  EXPECT_EQ(window.total_events()[WindowEvent::kReset], 0);
  EXPECT_LT(Drift(outcome, 0, outcome.frames.size() - 1), 0.3);
}

TEST(WindowFaults, AClockThatIsSetBeginsAnewWhereItWas) {
  const Viotracks flight = MakeFlight(32);
  for (const std::int64_t shift : {3600 * kSecond, -1000 * kSecond}) {
    SlidingWindow window(OptionsFor(flight));
    const Outcome outcome = Fly(flight, &window, [&](std::size_t frame, Input* input) {
      if (frame < 60) return;
      input->stamp_ns += shift;
      for (ImuSample& sample : input->imu)
        sample.stamp_ns += shift;
    });
    EXPECT_EQ(window.total_events()[WindowEvent::kReset], 1) << shift;
    EXPECT_EQ(window.total_events()[WindowEvent::kInitialized], 2);
    EXPECT_EQ(window.phase(), WindowPhase::kRunning);
    ASSERT_GT(outcome.frames.size(), 60u);
    // It flies on for the time that a first state takes; where it is then, it cannot know.
    std::size_t anew = 1;
    while (anew < outcome.frames.size() && outcome.frames[anew] == outcome.frames[anew - 1] + 1)
      ++anew;
    ASSERT_LT(anew, outcome.frames.size());
    EXPECT_LE(outcome.frames[anew] - outcome.frames[anew - 1], 30u);
    const Pose before = outcome.errors[anew - 1] * TruthAt(flight, outcome.frames[anew - 1]).T_w_b;
    const Pose after = outcome.errors[anew] * TruthAt(flight, outcome.frames[anew]).T_w_b;
    EXPECT_LT((after.p() - before.p()).norm(), 5.0) << "far from where it was";
    EXPECT_LT(Drift(outcome, anew, outcome.frames.size() - 1), 0.5);
  }
}

TEST(WindowFaults, AFirstStampThatIsWrongDoesNotEndAnything) {
  const Viotracks flight = MakeFlight(33);
  SlidingWindow window(OptionsFor(flight));
  const Outcome outcome = Fly(flight, &window, [](std::size_t frame, Input* input) {
    if (frame != 0) return;
    input->stamp_ns += 86400 * kSecond;
    ASSERT_FALSE(input->imu.empty());
    input->imu.front().stamp_ns += 86400 * kSecond;
  });
  EXPECT_EQ(window.phase(), WindowPhase::kRunning) << window.init_verdict().message;
  EXPECT_LT(outcome.frames.front(), 40u);
}

TEST(WindowFaults, ReadingsAtTheEndOfTheirRangeAreCounted) {
  const Viotracks flight = MakeFlight(34);
  SlidingWindowOptions options = OptionsFor(flight);
  double most = 0.0;
  for (const ImuSample& sample : flight.imu)
    most = std::max(most, sample.accel.cwiseAbs().maxCoeff());
  options.imu.accel_range = 0.99 * most;
  SlidingWindow window(options);
  Fly(flight, &window, [](std::size_t, Input*) {});
  std::int64_t at_the_end = 0;
  for (const ImuSample& sample : flight.imu)
    at_the_end += sample.accel.cwiseAbs().maxCoeff() >= options.imu.accel_range ? 1 : 0;
  EXPECT_GT(at_the_end, 0);
  EXPECT_EQ(window.total_events()[WindowEvent::kImuSaturated], at_the_end);
  options.imu.accel_range = -1.0;
  EXPECT_FALSE(SlidingWindow(options).AddImu({}).ok());
}

TEST(WindowFaults, ALostCameraIsSaid) {
  const Viotracks flight = MakeFlight(35);
  SlidingWindow window(OptionsFor(flight));
  const Outcome outcome = Fly(flight, &window, [](std::size_t frame, Input* input) {
    if (frame < 60 || frame >= 70) return;
    std::erase_if(input->observations, [](const FrameObservation& o) { return o.camera == 1; });
  });
  EXPECT_EQ(window.total_events()[WindowEvent::kCameraWithoutFeatures], 10);
  EXPECT_EQ(window.total_events()[WindowEvent::kFrameRefused], 0);
  EXPECT_LT(Drift(outcome, 0, outcome.frames.size() - 1), 0.3);
}

TEST(WindowFaults, AStateThatNobodyBelievesIsGivenUp) {
  const Viotracks flight = MakeFlight(36);
  SlidingWindowOptions options = OptionsFor(flight);
  options.max_speed = 0.2;  // the flight is faster: so it begins again and again
  SlidingWindow window(options);
  const Outcome outcome = Fly(flight, &window, [](std::size_t, Input*) {});
  EXPECT_GT(window.total_events()[WindowEvent::kReset], 0);
  for (const Pose& error : outcome.errors)
    EXPECT_TRUE(error.p().allFinite());
}

TEST(WindowFaults, BeginsAnewWhenAskedAndGoesOnWhereItWas) {
  const Viotracks flight = MakeFlight(37);
  SlidingWindow window(OptionsFor(flight));
  WindowState given_up;
  const Outcome outcome = Fly(flight, &window, [&](std::size_t frame, Input*) {
    if (frame != 60) return;
    given_up = window.newest();
    window.Reinitialize();
    EXPECT_EQ(window.phase(), WindowPhase::kInitializing);
    EXPECT_EQ(window.view().frames.size(), 0u);
    window.Reinitialize();  // nothing to do
  });
  EXPECT_EQ(window.total_events()[WindowEvent::kReset], 1);
  EXPECT_EQ(window.total_events()[WindowEvent::kInitialized], 2);
  std::size_t anew = 0;
  while (outcome.frames[anew] < 60)
    ++anew;
  // Its bias is known from before: the first state stands on it.
  EXPECT_LE(outcome.frames[anew], 85u);
  EXPECT_LT(Drift(outcome, anew, outcome.frames.size() - 1), 0.3);
}

}  // namespace
}  // namespace glissade
