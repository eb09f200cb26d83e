// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "common/data_dir.h"
#include "glissade/io/bal.h"
#include "glissade/io/viotracks.h"
#include "glissade/io/viowin.h"
#include "glissade/problem/problem.h"
#include "glissade/sim/bal_scene.h"
#include "glissade/sim/recording.h"
#include "glissade/sim/windows.h"

// The files in data/ are what the generators make (scripts/make_data.sh): a user has what the
// documentation's commands need, and can make more of it.

namespace glissade::sim {
namespace {

std::string DataFile(const std::string& name) {
  return (test::SourceDir() / "data" / name).string();
}

/// log, sin and cos may differ by a rounding between machines.
void ExpectNear(const double* a, const double* b, int n, double tolerance,
                const std::string& what) {
  for (int i = 0; i < n; ++i)
    EXPECT_NEAR(a[i], b[i], tolerance * (1.0 + std::abs(b[i]))) << what << ", number " << i;
}

void ExpectSame(const ViowinWindow& made, const ViowinWindow& read) {
  ASSERT_EQ(made.keyframes.size(), read.keyframes.size());
  for (std::size_t k = 0; k < read.keyframes.size(); ++k) {
    ExpectNear(made.keyframes[k].T_w_b.data, read.keyframes[k].T_w_b.data, 7, 1e-9, "start");
    ExpectNear(made.keyframes[k].speed_bias.data, read.keyframes[k].speed_bias.data, 9, 1e-9, "v");
    ExpectNear(made.ground_truth[k].T_w_b.data, read.ground_truth[k].T_w_b.data, 7, 1e-9, "truth");
  }
  ASSERT_EQ(made.landmarks.size(), read.landmarks.size());
  for (std::size_t l = 0; l < read.landmarks.size(); ++l) {
    const ViowinLandmark& a = made.landmarks[l];
    const ViowinLandmark& b = read.landmarks[l];
    ASSERT_EQ(a.host, b.host);
    EXPECT_NEAR(a.rho, b.rho, 1e-9);
    EXPECT_NEAR(a.u_host, b.u_host, 1.0 / 255);  // one step of the rounding
    ASSERT_EQ(a.observations.size(), b.observations.size());
    for (std::size_t i = 0; i < b.observations.size(); ++i) {
      EXPECT_EQ(a.observations[i].frame, b.observations[i].frame);
      EXPECT_NEAR(a.observations[i].u, b.observations[i].u, 1.0 / 255);
      EXPECT_NEAR(a.observations[i].v, b.observations[i].v, 1.0 / 255);
    }
  }
  ASSERT_EQ(made.imu.size(), read.imu.size());
  for (std::size_t k = 0; k < read.imu.size(); ++k) {
    ExpectNear(made.imu[k].imu.dp.data(), read.imu[k].imu.dp.data(), 3, 1e-9, "dp");
    ExpectNear(made.imu[k].sqrt_information.data(), read.imu[k].sqrt_information.data(), 225, 1e-5,
               "U");
  }
}

void ExpectFileIsMade(const std::string& name, const WindowMakerOptions& options,
                      std::uint64_t first_seed) {
  const auto windows = ReadViowin(DataFile(name));
  ASSERT_TRUE(windows.ok()) << windows.status().message();
  ASSERT_FALSE(windows->empty());
  for (std::size_t w = 0; w < windows->size(); ++w) {
    const auto made = MakeWindow(options, first_seed + w);
    ASSERT_TRUE(made.ok()) << made.status().message();
    EXPECT_TRUE(made->Validate().ok());
    ExpectSame(*made, (*windows)[w]);
  }
}

TEST(DataFiles, Windows) {
  ExpectFileIsMade("win10.txt.gz", {.num_keyframes = 10}, 101);
}

TEST(DataFiles, WindowForMarginalization) {
  ExpectFileIsMade("win11m.txt.gz", {.num_keyframes = 11, .hosted_by_first = 60}, 111);
  const auto windows = ReadViowin(DataFile("win11m.txt.gz"));
  int hosted = 0;
  for (const ViowinLandmark& landmark : windows->at(0).landmarks)
    hosted += landmark.host == 0;
  EXPECT_GE(hosted, 60);
}

// A window is a sound problem: the noise explains what is left of its cost, and the truth is near.
TEST(DataFiles, SolvedWindowsAreWithinTheirNoise) {
  const auto windows = ReadViowin(DataFile("win10.txt.gz"));
  ASSERT_TRUE(windows.ok()) << windows.status().message();
  for (const ViowinWindow& window : *windows) {
    for (const WindowKind kind : {WindowKind::kVision, WindowKind::kVisualInertial}) {
      Problem problem;
      const auto handles = AddToGraph(window, kind, {}, &problem);
      ASSERT_TRUE(handles.ok()) << handles.status().message();
      const SolveSummary& summary = problem.Solve();
      EXPECT_TRUE(summary.converged()) << summary.BriefReport();
      EXPECT_GT(summary.initial_cost, 10.0 * summary.final_cost);
      // Two rows an observation, less an inverse depth a landmark; hosts have noise too, which no
      // row of theirs takes up: a little more than one half of sigma^2 a degree of freedom.
      double rows = 0.0;
      for (const ViowinLandmark& landmark : window.landmarks)
        rows += 2.0 * static_cast<double>(landmark.observations.size()) - 1.0;
      EXPECT_GT(summary.final_cost, 0.5 * rows * 0.8);
      EXPECT_LT(summary.final_cost, 0.5 * rows * 2.0);
      for (std::size_t k = 0; k < handles->poses.size(); ++k) {
        const Vector3 error =
            problem.Get(handles->poses[k]).pose.p() - window.ground_truth[k].T_w_b.p();
        EXPECT_LT(error.norm(), 0.1) << "window " << window.id << ", keyframe " << k;
      }
    }
  }
}

TEST(DataFiles, Recording) {
  const auto read = ReadViotracks(DataFile("flight"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  const auto made = MakeRecording({});
  ASSERT_TRUE(made.ok()) << made.status().message();
  EXPECT_EQ(made->origin, read->origin);
  ASSERT_EQ(made->imu.size(), read->imu.size());
  for (std::size_t k = 0; k < read->imu.size(); ++k) {
    ExpectNear(made->imu[k].gyro.data(), read->imu[k].gyro.data(), 3, 1.1e-6, "gyroscope");
    ExpectNear(made->imu[k].accel.data(), read->imu[k].accel.data(), 3, 1.1e-5, "accelerometer");
  }
  ASSERT_EQ(made->tracks.size(), read->tracks.size());
  for (std::size_t k = 0; k < read->tracks.size(); ++k) {
    ASSERT_EQ(made->tracks[k].frame, read->tracks[k].frame);
    ASSERT_EQ(made->tracks[k].track, read->tracks[k].track);
    ASSERT_EQ(made->tracks[k].camera, read->tracks[k].camera);
    EXPECT_NEAR(made->tracks[k].u, read->tracks[k].u, 0.011);
    EXPECT_NEAR(made->tracks[k].v, read->tracks[k].v, 0.011);
  }
  ASSERT_EQ(made->ground_truth.size(), read->ground_truth.size());
  for (std::size_t k = 0; k < read->ground_truth.size(); ++k) {
    ExpectNear(made->ground_truth[k].T_w_b.data, read->ground_truth[k].T_w_b.data, 7, 1e-9, "pose");
    ExpectNear(made->ground_truth[k].speed_bias->data, read->ground_truth[k].speed_bias->data, 9,
               1e-9, "speed and biases");
  }
}

TEST(DataFiles, BundleAdjustment) {
  const auto read = ReadBal(DataFile("ring.txt.gz"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  const auto made = MakeBalScene({});
  ASSERT_TRUE(made.ok()) << made.status().message();
  ASSERT_EQ(made->observations.size(), read->observations.size());
  for (std::size_t k = 0; k < read->observations.size(); ++k)
    EXPECT_NEAR(made->observations[k].u, read->observations[k].u, 1.0 / 255);
  ASSERT_EQ(made->cameras.size(), read->cameras.size());
  for (std::size_t k = 0; k < read->cameras.size(); ++k)
    ExpectNear(made->cameras[k].data, read->cameras[k].data, 9, 1e-9, "camera");
  Problem problem;
  ASSERT_TRUE(AddToGraph(*read, problem).ok());
  const SolveSummary& summary = problem.Solve();
  EXPECT_TRUE(summary.converged()) << summary.BriefReport();
  // (3600 rows less 1037 observed unknowns) / 2 times 0.25 px^2.
  EXPECT_NEAR(summary.final_cost, 0.125 * (3600 - 1037), 30.0);
}

TEST(DataFiles, GeneratorsRefuseWhatMakesNoSense) {
  EXPECT_FALSE(MakeWindow({.num_keyframes = 1}, 1).ok());
  EXPECT_FALSE(MakeWindow({.min_track = 5, .max_track = 4}, 1).ok());
  EXPECT_FALSE(MakeWindow({.hosted_by_first = -1}, 1).ok());
  EXPECT_FALSE(MakeWindow({.start_log_depth = std::nan("")}, 1).ok());
  RecordingOptions recording;
  recording.outliers = 1.5;
  EXPECT_FALSE(MakeRecording(recording).ok());
  recording = {};
  recording.frame_rate_hz = 0.0;
  EXPECT_FALSE(MakeRecording(recording).ok());
  EXPECT_FALSE(MakeBalScene({.num_cameras = 2}).ok());
  EXPECT_FALSE(MakeBalScene({.pixel_noise = -1.0}).ok());
}

}  // namespace
}  // namespace glissade::sim
