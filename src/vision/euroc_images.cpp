// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <limits>
#include <map>

#include "io/csv_reader.h"
#include "vision/image_layouts.h"
#include "vision/sensor_yaml.h"

namespace glissade::vision {

namespace fs = std::filesystem;

namespace {

using glissade::internal::CsvReader;

std::string CameraName(int k) {
  return std::string("cam").append(std::to_string(k));
}

/// Stamps and files of camera k into `frames`.
Status ReadImageList(const fs::path& folder, int k, std::map<std::int64_t, ImageFrame>* frames) {
  auto reader = CsvReader::Open((folder / "data.csv").string());
  if (!reader.ok()) return reader.status();
  CsvReader& in = *reader;
  std::optional<std::int64_t> last;
  constexpr auto kLimits = std::numeric_limits<std::int64_t>();
  while (in.NextRow()) {
    in.ExpectFields(2, "timestamp_ns, file name");
    const std::int64_t stamp = in.Integer(0, kLimits.min() / 2, kLimits.max() / 2, "timestamp_ns");
    const std::string file = (folder / "data" / std::string(in.Text(1))).string();
    if (in.ok() && last && stamp <= *last) {
      in.Fail("timestamp " + std::to_string(stamp) + " is not later than " + std::to_string(*last));
    }
    std::error_code error;
    if (in.ok() && !fs::is_regular_file(file, error)) {
      in.Fail("there is no image " + file, StatusCode::kIoError);
    }
    if (!in.ok()) break;
    last = stamp;
    ImageFrame& frame = (*frames)[stamp];
    frame.stamp_ns = stamp;
    frame.files.resize(std::max(frame.files.size(), static_cast<std::size_t>(k) + 1));
    frame.files[static_cast<std::size_t>(k)] = file;
  }
  return in.status();
}

Result<Camera> ReadCamera(const fs::path& mav, int k) {
  const fs::path sensor = mav / CameraName(k) / "sensor.yaml";
  const fs::path kalibr = mav.parent_path() / "dso" / "camchain.yaml";
  std::error_code error;
  if (!fs::exists(sensor, error) && fs::exists(kalibr, error)) {
    return internal::ReadKalibrCamera(kalibr.string(), k);
  }
  return internal::ReadCameraYaml(sensor.string());
}

Status ReadImu(const fs::path& mav, ImageRecording* recording) {
  const fs::path sensor = mav / "imu0" / "sensor.yaml";
  const fs::path kalibr = mav.parent_path() / "dso" / "imu_config.yaml";
  std::error_code error;
  const bool by_kalibr = !fs::exists(sensor, error) && fs::exists(kalibr, error);
  const auto imu = internal::ReadImuYaml((by_kalibr ? kalibr : sensor).string());
  if (!imu.ok()) return imu.status();
  recording->imu_noise = imu->noise;
  recording->imu_rate_hz = imu->rate_hz;
  // The order of time is for whoever takes the samples to judge.
  auto samples = ReadEurocImu((mav / "imu0" / "data.csv").string());
  if (!samples.ok()) return samples.status();
  recording->imu = std::move(samples).value();
  return {};
}

}  // namespace

Result<ImageRecording> internal::ReadEurocImages(const std::string& folder, int max_cameras) {
  std::error_code error;
  fs::path mav = fs::weakly_canonical(fs::path(folder), error);
  if (error) mav = folder;
  ImageRecording recording;
  recording.layout = "EuRoC";
  std::map<std::int64_t, ImageFrame> frames;
  for (int k = 0; k < max_cameras; ++k) {
    const fs::path camera_folder = mav / CameraName(k);
    if (k > 0 && !fs::is_directory(camera_folder, error)) break;
    const auto camera = ReadCamera(mav, k);
    if (!camera.ok()) return camera.status();
    recording.cameras.push_back(*camera);
    if (Status s = ReadImageList(camera_folder, k, &frames); !s.ok()) return s;
  }
  std::size_t seen_by_all = 0, seen_by_first = 0;
  for (auto& [stamp, frame] : frames) {
    frame.files.resize(recording.cameras.size());
    seen_by_first += frame.files.front().empty() ? 0 : 1;
    seen_by_all += frame.files.front().empty() || frame.files.back().empty() ? 0 : 1;
    recording.frames.push_back(std::move(frame));
  }
  if (recording.frames.empty()) {
    return Status(StatusCode::kParseError, (mav / "cam0/data.csv").string() + ":1: no frames");
  }
  if (10 * seen_by_all < seen_by_first || seen_by_first == 0) {
    const std::string list = (mav / "cam1/data.csv").string();
    return Status(StatusCode::kParseError,
                  list + ":1: of " + std::to_string(seen_by_first) + " frames of cam0 only " +
                      std::to_string(seen_by_all) + " have the same stamp in cam1");
  }
  if (fs::is_directory(mav / "imu0", error)) {
    if (Status s = ReadImu(mav, &recording); !s.ok()) return s;
  }
  for (const char* name : {"state_groundtruth_estimate0", "mocap0"}) {
    const fs::path truth = mav / name / "data.csv";
    if (!fs::exists(truth, error)) continue;
    auto states = ReadEurocGroundTruth(truth.string());
    if (!states.ok()) return states.status();
    recording.ground_truth = std::move(states).value();
    break;
  }
  return recording;
}

std::string EurocImagePath(const std::string& folder, int camera, std::int64_t stamp_ns,
                           const std::string& ending) {
  return (fs::path(folder) / "mav0" / CameraName(camera) / "data" /
          std::to_string(stamp_ns).append(".").append(ending))
      .string();
}

}  // namespace glissade::vision
