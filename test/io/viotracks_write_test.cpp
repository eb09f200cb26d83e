// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "glissade/io/viotracks.h"
#include "glissade/lie/so3.h"
#include "temp_file.h"

namespace glissade {
namespace {

Viotracks Recording() {
  Viotracks r;
  r.origin = "a \"test\" \\ of quotes";
  r.cameras.resize(2);
  r.cameras[1].fx = 460.1;
  r.cameras[1].T_b_c = Pose(so3::Exp(Vector3(0.1, -0.2, 0.3)), Vector3(0.1, 1.0 / 3.0, 0));
  r.imu_noise.emplace();
  r.imu_rate_hz = 200.0;
  r.frames = {{.id = 3, .stamp_ns = 1403636579763555584},
              {.id = 7, .stamp_ns = 1403636579863555584}};
  r.imu = {{.stamp_ns = 1403636579758555392, .gyro = {0.1, 1e-17, -3}, .accel = {9.81, 1.0 / 7, 0}},
           {.stamp_ns = 1403636579763555584, .gyro = {0, 0, 0}, .accel = {-1e300, 0, 5e-324}}};
  r.tracks = {{.frame = 0, .track = 5, .camera = 1, .u = 320.25, .v = 0.1},
              {.frame = 1, .track = 5, .camera = 0, .u = -3, .v = 1e9}};
  r.ground_truth = {{.stamp_ns = 1403636579763555584,
                     .T_w_b = Pose(so3::Exp(Vector3(1, 2, 0.5)), Vector3(1, 2, 3)),
                     .speed_bias = VertexSpeedBias({0.1, 0.2, 0.3}, {1, 2, 3}, {4, 5, 6})}};
  return r;
}

TEST(ViotracksWrite, ReadsBackToTheSameBits) {
  const TempFiles files;
  const Viotracks wrote = Recording();
  const Status written = WriteViotracks(wrote, files.Path("flight"));
  ASSERT_TRUE(written.ok()) << written.message();
  const auto read = ReadViotracks(files.Path("flight"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->origin, wrote.origin);
  EXPECT_EQ(read->gravity, wrote.gravity);
  ASSERT_EQ(read->cameras.size(), 2u);
  EXPECT_EQ(read->cameras[1].fx, 460.1);
  EXPECT_LT((read->cameras[1].T_b_c.R() - wrote.cameras[1].T_b_c.R()).norm(), 1e-15);
  EXPECT_EQ(Vector3(read->cameras[1].T_b_c.p()), Vector3(wrote.cameras[1].T_b_c.p()));
  EXPECT_EQ(read->imu_noise->accel_random_walk, wrote.imu_noise->accel_random_walk);
  ASSERT_EQ(read->frames.size(), 2u);
  EXPECT_EQ(read->frames[1].id, 7);
  EXPECT_EQ(read->frames[1].stamp_ns, wrote.frames[1].stamp_ns);
  ASSERT_EQ(read->imu.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(read->imu[k].stamp_ns, wrote.imu[k].stamp_ns);
    EXPECT_EQ(read->imu[k].gyro, wrote.imu[k].gyro);
    EXPECT_EQ(read->imu[k].accel, wrote.imu[k].accel);
  }
  ASSERT_EQ(read->tracks.size(), 2u);
  for (int k = 0; k < 2; ++k) {
    EXPECT_EQ(read->tracks[k].frame, wrote.tracks[k].frame);
    EXPECT_EQ(read->tracks[k].track, wrote.tracks[k].track);
    EXPECT_EQ(read->tracks[k].camera, wrote.tracks[k].camera);
    EXPECT_EQ(read->tracks[k].u, wrote.tracks[k].u);
    EXPECT_EQ(read->tracks[k].v, wrote.tracks[k].v);
  }
  ASSERT_EQ(read->ground_truth.size(), 1u);
  for (int i = 0; i < 7; ++i)
    EXPECT_NEAR(read->ground_truth[0].T_w_b.data[i], wrote.ground_truth[0].T_w_b.data[i], 1e-15);
  for (int i = 0; i < 9; ++i) {
    EXPECT_EQ(read->ground_truth[0].speed_bias->data[i], wrote.ground_truth[0].speed_bias->data[i]);
  }
}

TEST(ViotracksWrite, WithoutImuAndTruth) {
  const TempFiles files;
  Viotracks wrote = Recording();
  wrote.imu_noise.reset();
  wrote.imu.clear();
  wrote.ground_truth.clear();
  ASSERT_TRUE(WriteViotracks(wrote, files.Path("vision")).ok());
  const auto read = ReadViotracks(files.Path("vision"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_FALSE(read->imu_noise.has_value());
  EXPECT_TRUE(read->imu.empty());
  EXPECT_TRUE(read->ground_truth.empty());
}

TEST(ViotracksWrite, RefusesWhatCouldNotBeReadBack) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<std::pair<const char*, std::function<void(Viotracks*)>>> cases = {
      {"frame", [](Viotracks* r) { r->tracks[0].frame = 2; }},
      {"camera", [](Viotracks* r) { r->tracks[0].camera = 2; }},
      {"camera", [](Viotracks* r) { r->tracks[0].camera = -1; }},
      {"track", [](Viotracks* r) { r->tracks[0].track = -1; }},
      {"increase", [](Viotracks* r) { r->frames[1].id = 3; }},
      {"increase", [](Viotracks* r) { r->frames[1].stamp_ns = r->frames[0].stamp_ns; }},
      {"fx", [](Viotracks* r) { r->cameras[0].fx = 0; }},
      {"width", [](Viotracks* r) { r->cameras[0].width = 0; }},
      {"samples", [](Viotracks* r) { r->imu_noise.reset(); }},
      {"track", [=](Viotracks* r) { r->tracks[0].u = nan; }},
      {"gyro", [=](Viotracks* r) { r->imu[0].gyro[0] = nan; }},
      {"gravity", [=](Viotracks* r) { r->gravity[0] = nan; }},
      {"speeds", [](Viotracks* r) {
         r->ground_truth.push_back(r->ground_truth[0]);
         r->ground_truth[1].stamp_ns += 1;
         r->ground_truth[1].speed_bias.reset();
       }}};
  const TempFiles files;
  for (const auto& [says, spoil] : cases) {
    Viotracks recording = Recording();
    spoil(&recording);
    const Status status = WriteViotracks(recording, files.Path("bad"));
    EXPECT_FALSE(status.ok()) << says;
    EXPECT_NE(status.message().find(says), std::string::npos) << status.message();
    EXPECT_EQ(files.Count(), 0) << says;
  }
  EXPECT_EQ(WriteViotracks(Recording(), files.Path("no/such")).code(), StatusCode::kIoError);
}

}  // namespace
}  // namespace glissade
