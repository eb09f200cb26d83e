// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/image_recording.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "common/data_dir.h"
#include "glissade/vision/image.h"
#include "io/temp_file.h"
#include "vision/painted_wall.h"

namespace glissade::vision {
namespace {

namespace fs = std::filesystem;

ImageRecording MakeRecording(const std::string& folder, int frames) {
  ImageRecording recording;
  Camera left = test::SmallCamera(), right = left;
  right.lens = CameraKannalaBrandt{left.pinhole(), 0.01, -0.002, 0.001, 0.0};
  right.T_b_c = Pose(Quaternion(0.5, -0.5, 0.5, -0.5), Vector3(0.11, 0.01, -0.02));
  recording.cameras = {left, right};
  for (int k = 0; k < frames; ++k) {
    const std::int64_t stamp = 1'000'000'000 + 50'000'000LL * k;
    recording.frames.push_back(
        {stamp, {EurocImagePath(folder, 0, stamp), EurocImagePath(folder, 1, stamp)}});
  }
  recording.imu_noise.emplace();
  recording.imu_rate_hz = 200.0;
  for (int k = 0; k < 10; ++k) {
    ImuSample& s = recording.imu.emplace_back();
    s.stamp_ns = 1'000'000'000 + 5'000'000LL * k;
    s.gyro = Vector3(0.1 * k, 1.0 / 3.0, -0.2);
    s.accel = Vector3(0.0, 9.81, 0.1 * k);
  }
  GroundTruthState& truth = recording.ground_truth.emplace_back();
  truth.stamp_ns = 1'000'000'000;
  truth.T_w_b.p() = Vector3(1.0, 2.0, 3.0);
  return recording;
}

/// As it lies on the disk.
std::string MakeFolder(const TempFiles& files, int frames = 3) {
  const std::string folder = files.Path("flight");
  const ImageRecording recording = MakeRecording(folder, frames);
  EXPECT_TRUE(WriteEurocRecording(recording, folder).ok());
  const Image image = test::SeeWall(test::SmallCamera(), Pose());
  for (const ImageFrame& frame : recording.frames)
    for (const std::string& file : frame.files)
      EXPECT_TRUE(WriteImage(image.view(), file).ok());
  return folder;
}

void Replace(const fs::path& file, const std::string& from, const std::string& to) {
  std::ifstream in(file);
  std::stringstream text;
  text << in.rdbuf();
  std::string content = text.str();
  const std::size_t at = content.find(from);
  ASSERT_NE(at, std::string::npos) << from << " in " << content;
  content.replace(at, from.size(), to);
  std::ofstream(file) << content;
}

TEST(ImageRecording, EurocIsReadBackAsItWasWritten) {
  const TempFiles files;
  const std::string folder = MakeFolder(files);
  const ImageRecording wrote = MakeRecording(folder, 3);
  for (const std::string& path : {folder, folder + "/mav0"}) {
    const auto read = ReadImageRecording(path);
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(read->layout, "EuRoC");
    ASSERT_EQ(read->cameras.size(), 2u);
    for (std::size_t k = 0; k < 2; ++k) {
      EXPECT_EQ(read->cameras[k].lens, wrote.cameras[k].lens);
      EXPECT_EQ(read->cameras[k].width, 240);
      const Pose off = read->cameras[k].T_b_c.Inverse() * wrote.cameras[k].T_b_c;
      EXPECT_LT(off.p().norm(), 1e-12);
      EXPECT_LT(Quaternion(off.q()).vec().norm(), 1e-12);
    }
    ASSERT_EQ(read->frames.size(), 3u);
    EXPECT_EQ(read->frames[2].stamp_ns, wrote.frames[2].stamp_ns);
    ASSERT_EQ(read->imu.size(), 10u);
    EXPECT_EQ(read->imu[3].gyro, wrote.imu[3].gyro);
    EXPECT_EQ(read->imu_noise->accel_random_walk, wrote.imu_noise->accel_random_walk);
    ASSERT_EQ(read->ground_truth.size(), 1u);
    EXPECT_EQ(read->ground_truth[0].T_w_b, wrote.ground_truth[0].T_w_b);
  }
}

TEST(ImageRecording, WhatIsWrongIsNamedByFileAndLine) {
  struct Case {
    const char* file;
    const char* from;
    const char* to;
    const char* expected;
    StatusCode code;
  };
  const Case cases[] = {
      {"cam0/data.csv", "1050000000.png", "nothing.png", "data.csv:3: there is no image",
       StatusCode::kIoError},
      {"cam1/data.csv", "1050000000,", "900000000,", "data.csv:3: timestamp",
       StatusCode::kParseError},
      {"cam0/data.csv", "1050000000,", "soon,", "data.csv:3: ", StatusCode::kParseError},
      {"cam0/sensor.yaml", "radial-tangential", "ds", "sensor.yaml:10: distortion_model ds",
       StatusCode::kParseError},
      {"cam0/sensor.yaml", "pinhole", "omni", "sensor.yaml:8: camera_model omni",
       StatusCode::kParseError},
      {"cam0/sensor.yaml", "intrinsics:", "intrinsic:", "there is no intrinsics",
       StatusCode::kParseError},
      {"cam0/sensor.yaml", "intrinsics: [180", "intrinsics: [nan", "sensor.yaml:9: intrinsics",
       StatusCode::kParseError},
      {"cam0/sensor.yaml", "resolution: [240", "resolution: [0", "sensor.yaml:7: resolution",
       StatusCode::kParseError},
      {"cam0/sensor.yaml", "[1,", "[2,", "sensor.yaml:3: T_BS is no rigid motion",
       StatusCode::kParseError},
      {"imu0/sensor.yaml", "rate_hz: 200", "rate_hz: -1", "sensor.yaml", StatusCode::kParseError},
      {"imu0/sensor.yaml", "gyroscope_noise_density: ", "gyroscope_noise_density: -", "sensor.yaml",
       StatusCode::kParseError},
      {"imu0/data.csv", "1015000000,", "1015000000,x", "data.csv:5", StatusCode::kParseError},
  };
  const TempFiles files;
  for (const Case& c : cases) {
    const std::string folder = MakeFolder(files);
    Replace(fs::path(folder) / "mav0" / c.file, c.from, c.to);
    const auto read = ReadImageRecording(folder);
    ASSERT_FALSE(read.ok()) << c.file << " " << c.to;
    EXPECT_EQ(read.status().code(), c.code) << read.status().message();
    EXPECT_NE(read.status().message().find(c.expected), std::string::npos)
        << read.status().message();
    fs::remove_all(folder);
  }
}

TEST(ImageRecording, AnIncompleteFolderIsNoRecording) {
  const TempFiles files;
  EXPECT_EQ(ReadImageRecording(files.Path("none")).status().code(), StatusCode::kIoError);
  fs::create_directories(files.Path("empty"));
  EXPECT_EQ(ReadImageRecording(files.Path("empty")).status().code(), StatusCode::kIoError);
  for (const char* missing : {"cam0/sensor.yaml", "cam0/data.csv", "cam1/data.csv", "imu0/data.csv",
                              "imu0/sensor.yaml"}) {
    const std::string folder = MakeFolder(files);
    fs::remove(fs::path(folder) / "mav0" / missing);
    const auto read = ReadImageRecording(folder);
    ASSERT_FALSE(read.ok()) << missing;
    EXPECT_NE(read.status().message().find(missing), std::string::npos) << read.status().message();
    fs::remove_all(folder);
  }
}

TEST(ImageRecording, ACameraMayMissAFrame) {
  const TempFiles files;
  const std::string folder = MakeFolder(files);
  Replace(fs::path(folder) / "mav0/cam1/data.csv", "1050000000,1050000000.png\n", "");
  const auto read = ReadImageRecording(folder);
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->frames.size(), 3u);
  EXPECT_TRUE(read->frames[1].files[1].empty());
  EXPECT_FALSE(read->frames[1].files[0].empty());
}

TEST(ImageRecording, KalibrSpeaksForTumVi) {
  const TempFiles files;
  const std::string folder = MakeFolder(files);
  const fs::path root(folder);
  fs::remove(root / "mav0/cam0/sensor.yaml");
  fs::remove(root / "mav0/imu0/sensor.yaml");
  fs::create_directories(root / "dso");
  std::ofstream(root / "dso/camchain.yaml")
      << "cam0:\n  T_cam_imu:\n  - [0.0, -1.0, 0.0, 0.5]\n  - [1.0, 0.0, 0.0, 0.0]\n"
         "  - [0.0, 0.0, 1.0, 0.0]\n  - [0.0, 0.0, 0.0, 1.0]\n  camera_model: pinhole\n"
         "  distortion_coeffs: [0.003, 0.0007, -0.002, 0.0002]\n"
         "  distortion_model: equidistant\n  intrinsics: [190.9, 190.9, 120.0, 90.0]\n"
         "  resolution: [240, 180]\n";
  std::ofstream(root / "dso/imu_config.yaml")
      << "accelerometer_noise_density: 0.0028\naccelerometer_random_walk: 0.00086\n"
         "gyroscope_noise_density: 0.00016\ngyroscope_random_walk: 0.000022\nupdate_rate: 200.0\n";
  const auto read = ReadImageRecording(folder);
  ASSERT_TRUE(read.ok()) << read.status().message();
  const auto* lens = std::get_if<CameraKannalaBrandt>(&read->cameras[0].lens);
  ASSERT_NE(lens, nullptr);
  EXPECT_EQ(lens->k3, -0.002);
  // T_cam_imu is the other way round: C = (0.5, 0, 0) - R B.
  EXPECT_LT((read->cameras[0].T_b_c * Vector3(0.5, 0.0, 0.0)).norm(), 1e-12);
  EXPECT_EQ(read->imu_noise->gyro_noise_density, 0.00016);
}

TEST(ImageRecording, Kitti) {
  const TempFiles files;
  const fs::path root(files.Path("kitti"));
  fs::create_directories(root / "image_0");
  fs::create_directories(root / "image_1");
  const Image image = test::SeeWall(test::SmallCamera(), Pose());
  for (const char* folder : {"image_0", "image_1"})
    for (const char* name : {"000000.png", "000001.png"})
      ASSERT_TRUE(WriteImage(image.view(), (root / folder / name).string()).ok());
  std::ofstream(root / "calib.txt") << "P0: 700 0 120 0 0 700 90 0 0 0 1 0\n"
                                       "P1: 700 0 120 -378 0 700 90 0 0 0 1 0\n";
  std::ofstream(root / "times.txt") << "0.000000e+00\n1.036224e-01\n";
  std::ofstream(root / "poses.txt") << "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 0.5 0 1 0 0 0 0 1 2\n";
  const auto read = ReadImageRecording(root.string());
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ(read->cameras[0].width, 240);
  EXPECT_NEAR(read->cameras[1].T_b_c.p()[0], 0.54, 1e-12);
  EXPECT_FALSE(read->imu_noise.has_value());
  EXPECT_EQ(read->frames[1].stamp_ns, 103'622'400);
  EXPECT_EQ(read->ground_truth[1].T_w_b.p()[2], 2.0);

  fs::remove(root / "image_1/000001.png");
  const auto missing = ReadImageRecording(root.string());
  EXPECT_EQ(missing.status().code(), StatusCode::kIoError);
  EXPECT_NE(missing.status().message().find("times.txt:2: there is no image"), std::string::npos);
}

TEST(ImageRecording, WritesNothingThatMakesNoSense) {
  const TempFiles files;
  ImageRecording recording = MakeRecording(files.Path("x"), 2);
  recording.frames[1].stamp_ns = recording.frames[0].stamp_ns;
  EXPECT_EQ(WriteEurocRecording(recording, files.Path("x")).code(), StatusCode::kInvalidArgument);
  recording = MakeRecording(files.Path("x"), 2);
  recording.cameras.clear();
  EXPECT_EQ(WriteEurocRecording(recording, files.Path("x")).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(files.Count(), 0);
}

TEST(ImageRecording, RealRecordings) {
  const fs::path images = glissade::test::DataDir() / "images";
  if (!fs::exists(images)) GTEST_SKIP() << images << " is not there";
  const auto euroc = ReadImageRecording((images / "euroc_mh05_cut").string());
  ASSERT_TRUE(euroc.ok()) << euroc.status().message();
  EXPECT_EQ(euroc->frames.size(), 400u);
  EXPECT_NE(std::get_if<CameraRadtan>(&euroc->cameras[0].lens), nullptr);
  EXPECT_EQ(euroc->imu_rate_hz, 200.0);
  const auto kitti = ReadImageRecording((images / "kitti_cut1").string());
  ASSERT_TRUE(kitti.ok()) << kitti.status().message();
  EXPECT_EQ(kitti->frames.size(), 51u);
  EXPECT_EQ(kitti->cameras[1].width, 1226);
  EXPECT_NEAR(kitti->cameras[1].T_b_c.p()[0], 0.5372, 1e-4);
}

}  // namespace
}  // namespace glissade::vision
