// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/sliding_window.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "glissade/io/replay.h"
#include "glissade/problem/problem.h"
#include "window/window_run.h"

namespace glissade {
namespace {

using test::MakeFlight;
using test::OptionsFor;
using test::RunWindow;
using test::WindowRun;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

TEST(SlidingWindow, FollowsAFlightWithTwoCamerasAndImu) {
  const Viotracks flight = MakeFlight(1);
  SlidingWindow window(OptionsFor(flight));
  double kappa = 0.0;
  const WindowRun run = RunWindow(flight, &window, {}, [&](std::size_t frame, SlidingWindow& w) {
    EXPECT_LE(w.view().frames.size(), 10u);
    if (frame % 10 != 0) return;
    const auto report = w.CheckNullspace();
    ASSERT_TRUE(report.ok()) << report.status().message();
    kappa = std::max(kappa, report->MaxKappa());
  });
  EXPECT_EQ(run.refused_frames, 0);
  EXPECT_LT(run.rms_position_m, 0.10);
  EXPECT_GT(window.total_events()[WindowEvent::kKeyframe], 5);
  EXPECT_GT(window.total_events()[WindowEvent::kLandmarkMarginalized], 20);
  // First estimates everywhere: nobody knows the heading, however often the window slid.
  EXPECT_LT(kappa, 1e-11);
}

TEST(SlidingWindow, FollowsAFlightWithOneCameraAndImu) {
  const Viotracks flight = MakeFlight(2);
  SlidingWindow window(OptionsFor(flight, 1));
  const WindowRun run = RunWindow(flight, &window);
  EXPECT_EQ(run.refused_frames, 0);
  EXPECT_LT(run.rms_position_m, 0.25);
}

TEST(SlidingWindow, FollowsAFlightWithTwoCamerasAlone) {
  Viotracks flight = MakeFlight(3);
  flight.imu_noise.reset();
  flight.imu.clear();
  SlidingWindow window(OptionsFor(flight));
  const WindowRun run = RunWindow(flight, &window);
  EXPECT_EQ(run.refused_frames, 0);
  EXPECT_LT(run.rms_position_m, 0.30);
}

TEST(SlidingWindow, EveryPolicyKeepsTheWindowBoundedAndTheFlightFollowed) {
  const Viotracks flight = MakeFlight(4);
  const std::shared_ptr<WindowPolicy> policies[] = {
      std::make_shared<OkvisPolicy>(3, 5), std::make_shared<TwoWayPolicy>(8),
      std::make_shared<LeastSeenKeyframePolicy>(3, 5), std::make_shared<FixedLagPolicy>(0.8)};
  for (const auto& policy : policies) {
    SlidingWindowOptions options = OptionsFor(flight);
    options.policy = policy;
    SlidingWindow window(options);
    std::size_t most = 0;
    const WindowRun run = RunWindow(flight, &window, {}, [&](std::size_t, SlidingWindow& w) {
      most = std::max(most, w.view().frames.size());
    });
    EXPECT_LE(most, 10u);
    EXPECT_EQ(run.refused_frames, 0);
    EXPECT_LT(run.rms_position_m, 0.15);
  }
}

TEST(SlidingWindow, SameInputSameBits) {
  const Viotracks flight = MakeFlight(5);
  SlidingWindow a(OptionsFor(flight)), b(OptionsFor(flight));
  const WindowRun first = RunWindow(flight, &a), second = RunWindow(flight, &b);
  ASSERT_EQ(first.estimates.size(), second.estimates.size());
  for (std::size_t k = 0; k < first.estimates.size(); ++k) {
    ASSERT_EQ(first.estimates[k].T_w_b, second.estimates[k].T_w_b);
    for (int i = 0; i < 9; ++i)
      ASSERT_EQ(first.estimates[k].speed_bias.data[i], second.estimates[k].speed_bias.data[i]);
  }
}

TEST(SlidingWindow, TheBooksAgreeWithTheGraph) {
  const Viotracks flight = MakeFlight(6);
  SlidingWindow window(OptionsFor(flight));
  RunWindow(flight, &window, {}, [](std::size_t, SlidingWindow& w) {
    const WindowView view = w.view();
    const Problem& problem = w.problem();
    int observations = 0, points = 0;
    for (const WindowLandmark& landmark : view.landmarks) {
      points += landmark.InGraph() ? 1 : 0;
      EXPECT_EQ(landmark.InGraph(), problem.Contains(landmark.point));
      std::int64_t before = -1;
      for (const LandmarkObservation& o : landmark.observations) {
        EXPECT_GE(o.frame, before);
        before = o.frame;
        EXPECT_EQ(landmark.InGraph(), problem.Contains(AnyEdge(o.edge)));
        observations += landmark.InGraph() ? 1 : 0;
      }
    }
    EXPECT_EQ(points, problem.NumVertices<VertexPointXYZ>());
    EXPECT_EQ(observations, problem.NumEdges<EdgeReprojectionXYZ>());
    int counted = 0, states = 0;
    for (const WindowFrame& frame : view.frames) {
      counted += frame.num_observations;
      states += frame.HasSpeedBias() ? 1 : 0;
      EXPECT_TRUE(problem.Contains(frame.pose));
      EXPECT_EQ(problem.Get(frame.pose).pose, frame.T_w_b);
    }
    EXPECT_EQ(counted, observations);
    EXPECT_EQ(states, problem.NumVertices<VertexSpeedBias>());
    EXPECT_EQ(static_cast<int>(view.frames.size()), problem.NumVertices<VertexPose>());
  });
}

TEST(SlidingWindow, TheNewestCovarianceIsSymmetricAndPositive) {
  const Viotracks flight = MakeFlight(7);
  SlidingWindow window(OptionsFor(flight));
  RunWindow(flight, &window, {}, [](std::size_t frame, SlidingWindow& w) {
    if (frame % 20 != 0) return;
    std::vector<double> covariance(15 * 15);
    ASSERT_TRUE(w.NewestCovariance(covariance).ok());
    const Eigen::Map<const Eigen::MatrixXd> P(covariance.data(), 15, 15);
    EXPECT_LT((P - P.transpose()).norm(), 1e-12 * P.norm());
    EXPECT_GT(Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(P).eigenvalues().minCoeff(), 0.0);
    EXPECT_FALSE(w.NewestCovariance(std::span<double>(covariance).first(36)).ok());
  });
}

TEST(SlidingWindow, APredictedStateIsLessCertainThanASolvedOne) {
  const Viotracks flight = MakeFlight(7);
  SlidingWindow window(OptionsFor(flight));
  ViotracksReplay replay(flight);
  int compared = 0;
  while (replay.Next() && compared < 20) {
    ASSERT_TRUE(window.AddImu(replay.imu()).ok());
    ASSERT_TRUE(window.AddFrame(replay.stamp_ns(), replay.observations()).ok());
    if (window.phase() != WindowPhase::kRunning || window.view().frames.size() < 2) {
      ASSERT_TRUE(window.Optimize().ok());
      continue;
    }
    std::vector<double> predicted(15 * 15), solved(15 * 15);
    ASSERT_TRUE(window.Solve({}).ok());
    ASSERT_TRUE(window.NewestCovariance(solved).ok());
    ASSERT_TRUE(window.Slide().ok());
    // The same, in the gauge of the frame that is the oldest now.
    std::vector<double> after(15 * 15);
    ASSERT_TRUE(window.NewestCovariance(after).ok());
    EXPECT_NEAR(after[14 * 15 + 14], solved[14 * 15 + 14], 1e-9 * solved[14 * 15 + 14]);
    ASSERT_TRUE(replay.Next());
    ASSERT_TRUE(window.AddImu(replay.imu()).ok());
    ASSERT_TRUE(window.AddFrame(replay.stamp_ns(), {}).ok());
    ASSERT_TRUE(window.NewestCovariance(predicted).ok());
    // Of the velocity: nobody has seen where it has gone since.
    EXPECT_GT(predicted[6 * 15 + 6], after[6 * 15 + 6]);
    ASSERT_TRUE(window.Optimize().ok());
    ++compared;
  }
  EXPECT_EQ(compared, 20);
}

// A recording of two cameras handed to a window that knows one, with a NaN in each frame besides.
TEST(SlidingWindow, ObservationsThatMakeNoSenseDoNotKeepItFromBeginning) {
  const Viotracks flight = MakeFlight(3);
  SlidingWindowOptions options = OptionsFor(flight);
  options.cameras.resize(1);
  SlidingWindow window(options);
  ViotracksReplay replay(flight);
  std::int64_t of_others = 0;
  for (int frame = 0; frame < 40 && replay.Next(); ++frame) {
    ASSERT_TRUE(window.AddImu(replay.imu()).ok());
    std::vector<FrameObservation> observations(replay.observations().begin(),
                                               replay.observations().end());
    for (const FrameObservation& o : observations)
      of_others += o.camera != 0 ? 1 : 0;
    observations.push_back(observations.front());
    observations.back().u = kNaN;
    ++of_others;
    ASSERT_TRUE(window.AddFrame(replay.stamp_ns(), observations).ok());
    ASSERT_TRUE(window.Optimize().ok());
  }
  EXPECT_EQ(window.phase(), WindowPhase::kRunning);
  EXPECT_EQ(window.total_events()[WindowEvent::kObservationRefused], of_others);
}

TEST(SlidingWindow, ABudgetThatMakesNoSenseIsRefusedAndNothingElse) {
  const Viotracks flight = MakeFlight(3);
  SlidingWindow window(OptionsFor(flight));
  ViotracksReplay replay(flight);
  for (int frame = 0; frame < 40 && replay.Next(); ++frame) {
    ASSERT_TRUE(window.AddImu(replay.imu()).ok());
    ASSERT_TRUE(window.AddFrame(replay.stamp_ns(), replay.observations()).ok());
    if (frame >= 30) {
      EXPECT_EQ(window.Optimize({.max_iterations = -1}).code(), StatusCode::kInvalidArgument);
      EXPECT_EQ(window.Optimize({.max_time_s = kNaN}).code(), StatusCode::kInvalidArgument);
    }
    ASSERT_TRUE(window.Optimize().ok());
  }
  EXPECT_EQ(window.phase(), WindowPhase::kRunning);
  EXPECT_EQ(window.total_events()[WindowEvent::kReset], 0);
  EXPECT_EQ(window.total_events()[WindowEvent::kSolveFailed], 0);
}

TEST(SlidingWindow, OneThatWasMovedFromSaysThatItHasNoCamera) {
  const Viotracks flight = MakeFlight(3);
  SlidingWindow window(OptionsFor(flight));
  SlidingWindow other(std::move(window));
  const SlidingWindow& looked_at = window;
  EXPECT_EQ(looked_at.phase(), WindowPhase::kInitializing);
  EXPECT_TRUE(looked_at.view().frames.empty());
  EXPECT_EQ(window.AddFrame(0, {}).code(), StatusCode::kInvalidArgument);
  EXPECT_FALSE(window.Optimize().ok());
  window = std::move(other);
  EXPECT_TRUE(window.AddFrame(0, {}).ok());
}

TEST(SlidingWindow, ASceneWithoutFeaturesIsBridgedByTheImu) {
  const Viotracks flight = MakeFlight(8);
  SlidingWindow window(OptionsFor(flight));
  const WindowRun run = RunWindow(flight, &window,
                                  [](std::size_t frame, std::int64_t*, std::vector<ImuSample>*,
                                     std::vector<FrameObservation>* observations) {
                                    if (frame >= 40 && frame < 45) observations->clear();
                                    return true;
                                  });
  EXPECT_EQ(window.total_events()[WindowEvent::kFrameWithoutLandmarks], 5);
  EXPECT_LT(run.rms_position_m, 0.3);
}

TEST(SlidingWindow, WhatIsNoObservationIsCountedAndLeftOut) {
  const Viotracks flight = MakeFlight(9);
  SlidingWindow window(OptionsFor(flight));
  RunWindow(
      flight, &window,
      [](std::size_t frame, std::int64_t*, std::vector<ImuSample>*,
         std::vector<FrameObservation>* observations) {
        if (frame != 30) return true;
        const FrameObservation good = observations->front();
        observations->push_back(good);  // twice in one image
        observations->push_back({100000, 0, kNaN, 10.0});
        observations->push_back({100001, 7, 10.0, 10.0});
        observations->push_back({100002, -1, 10.0, 10.0});
        observations->push_back({100003, 1, 10.0, std::numeric_limits<double>::infinity()});
        return true;
      },
      [](std::size_t frame, SlidingWindow& w) {
        EXPECT_EQ(w.recent_events()[WindowEvent::kObservationRefused], frame == 30 ? 5 : 0);
      });
}

TEST(SlidingWindow, FramesThatMakeNoSenseAreRefusedAndChangeNothing) {
  const Viotracks flight = MakeFlight(10);
  SlidingWindow window(OptionsFor(flight));
  RunWindow(flight, &window, {}, [&](std::size_t frame, SlidingWindow& w) {
    if (frame != 20) return;
    const std::int64_t stamp = w.newest().stamp_ns;
    const Pose before = w.newest().T_w_b;
    const auto refuse = [&](std::int64_t t) {
      const Status s = w.AddFrame(t, {});
      EXPECT_EQ(s.code(), StatusCode::kInvalidArgument) << s.message();
      EXPECT_EQ(w.newest().T_w_b, before);
      EXPECT_EQ(w.newest().stamp_ns, stamp);
    };
    refuse(stamp);                                     // again
    refuse(stamp - 100'000'000);                       // out of order
    refuse(stamp + 3'600'000'000'000);                 // an hour ahead
    refuse(stamp + 5'000'000'000);                     // where no IMU sample is yet
    refuse(std::numeric_limits<std::int64_t>::min());  // garbage
    refuse(std::numeric_limits<std::int64_t>::max());
  });
}

TEST(SlidingWindow, OptionsThatMakeNoSenseRefuseEveryCall) {
  const Viotracks flight = MakeFlight(11);
  const auto code = [](const SlidingWindowOptions& options) {
    SlidingWindow window(options);
    const Status s = window.AddFrame(0, {});
    EXPECT_FALSE(s.ok());
    EXPECT_EQ(window.Optimize().code(), s.code());
    EXPECT_EQ(window.Start({}, {}).code(), s.code());
    return s.code();
  };
  SlidingWindowOptions options = OptionsFor(flight);
  options.cameras.clear();
  EXPECT_EQ(code(options), StatusCode::kInvalidArgument);
  options = OptionsFor(flight, 1);
  options.imu_noise.reset();
  EXPECT_EQ(code(options), StatusCode::kInvalidArgument);
  options = OptionsFor(flight);
  options.cameras[1].fx = 0.0;
  EXPECT_EQ(code(options), StatusCode::kNotPositive);
  options = OptionsFor(flight);
  options.max_chi2 = kNaN;
  EXPECT_NE(code(options), StatusCode::kOk);
  options = OptionsFor(flight);
  options.min_observations = 1;
  EXPECT_EQ(code(options), StatusCode::kInvalidArgument);
}

TEST(SlidingWindow, BeginsInMotionByItself) {
  const Viotracks flight = MakeFlight(13);
  for (const std::size_t cameras : {std::size_t{2}, std::size_t{1}}) {
    SlidingWindow window(OptionsFor(flight, cameras));
    ViotracksReplay replay(flight, {.num_cameras = cameras});
    std::int64_t initialized_ns = -1;
    double error = 0.0;
    int frames = 0;
    Pose T_truth_w;  // from the window's world to that of the truth, at the first state
    while (replay.Next()) {
      ASSERT_TRUE(window.AddImu(replay.imu()).ok());
      const Status added = window.AddFrame(replay.stamp_ns(), replay.observations());
      ASSERT_TRUE(added.ok()) << added.message();
      const Status solved = window.Optimize();
      ASSERT_TRUE(solved.ok()) << solved.message();
      if (window.phase() != WindowPhase::kRunning) continue;
      const Pose truth = test::TruthAt(flight, replay.frame()).T_w_b;
      if (initialized_ns < 0) {
        initialized_ns = replay.stamp_ns();
        T_truth_w = truth * window.newest().T_w_b.Inverse();
      }
      error += (T_truth_w * window.newest().T_w_b.p() - truth.p()).squaredNorm();
      ++frames;
    }
    ASSERT_GT(frames, 0) << window.init_verdict().message;
    EXPECT_LT(1e-9 * static_cast<double>(initialized_ns - flight.frames[0].stamp_ns), 4.0);
    // Tilt at the first state is wrong by the accelerometer's bias, and with it all that follows
    // as seen from there: 1 degree at 6 m are 0.1 m.
    EXPECT_LT(std::sqrt(error / frames), cameras == 2 ? 0.3 : 0.6);
  }
}

TEST(SlidingWindow, SaysWhyItDoesNotBegin) {
  const Viotracks flight = MakeFlight(14);
  SlidingWindow window(OptionsFor(flight, 1));
  ViotracksReplay replay(flight);
  while (replay.Next() && replay.frame() < 15) {
    ASSERT_TRUE(window.AddImu(replay.imu()).ok());
    ASSERT_TRUE(window.AddFrame(replay.stamp_ns(), {}).ok());
    ASSERT_TRUE(window.Optimize().ok());
    EXPECT_EQ(window.phase(), WindowPhase::kInitializing);
    EXPECT_FALSE(window.init_verdict().ok());
    EXPECT_FALSE(window.init_verdict().message.empty());
  }
  EXPECT_EQ(window.init_verdict().reason, InitReason::kTooFewTracks);
}

TEST(SlidingWindow, AResetKeepsGoing) {
  const Viotracks flight = MakeFlight(12);
  SlidingWindow window(OptionsFor(flight));
  const WindowRun run = RunWindow(flight, &window, {}, [](std::size_t frame, SlidingWindow& w) {
    if (frame != 60) return;
    const WindowState before = w.newest();
    ASSERT_TRUE(w.Reset().ok());
    EXPECT_EQ(w.newest().T_w_b, before.T_w_b);
    EXPECT_EQ(w.phase(), WindowPhase::kRunning);
    EXPECT_EQ(w.view().frames.size(), 1u);
  });
  EXPECT_EQ(window.total_events()[WindowEvent::kReset], 1);
  EXPECT_LT(run.rms_position_m, 0.2);
}

}  // namespace
}  // namespace glissade
