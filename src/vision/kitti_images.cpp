// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cmath>
#include <cstdio>
#include <filesystem>

#include "glissade/vision/image.h"
#include "io/csv_reader.h"
#include "io/kitti_poses.h"
#include "vision/image_layouts.h"

namespace glissade::vision {

namespace fs = std::filesystem;

namespace {

using glissade::internal::CsvReader;

/// P0 and P1, 3 x 4 by rows, of rectified cameras: P = K [I | t], t the left camera in this one.
Status ReadCalibration(const std::string& path, bool stereo, ImageRecording* recording) {
  auto reader = CsvReader::Open(path, ' ');
  if (!reader.ok()) return reader.status();
  CsvReader& in = *reader;
  while (in.NextRow() && recording->cameras.size() < (stereo ? 2u : 1u)) {
    const std::string name = "P" + std::to_string(recording->cameras.size()) + ":";
    if (in.Text(0) != name) continue;
    in.ExpectFields(13, name + " and 12 numbers");
    double P[12];
    in.Numbers(1, 12, P, "entry of the projection matrix");
    if (!in.ok()) break;
    if (P[1] != 0.0 || P[4] != 0.0 || P[8] != 0.0 || P[9] != 0.0 || P[10] != 1.0 || P[7] != 0.0 ||
        P[11] != 0.0) {
      in.Fail("the projection is not that of a rectified camera");
      break;
    }
    Camera camera;
    camera.lens = CameraPinhole{P[0], P[5], P[2], P[6]};
    camera.T_b_c.p() = Vector3(-P[3] / P[0], 0.0, 0.0);
    camera.width = camera.height = 1;  // not known before an image is read
    if (const Status s = camera.Validate(); !s.ok()) {
      in.Fail(s.message());
      break;
    }
    recording->cameras.push_back(camera);
  }
  if (!in.ok()) return in.status();
  if (recording->cameras.size() < (stereo ? 2u : 1u)) {
    return {StatusCode::kParseError,
            path + ": there is no P" + std::to_string(recording->cameras.size()) + ":"};
  }
  return {};
}

Status ReadFrames(const fs::path& folder, ImageRecording* recording) {
  const std::string path = (folder / "times.txt").string();
  auto reader = CsvReader::Open(path, ' ');
  if (!reader.ok()) return reader.status();
  CsvReader& in = *reader;
  while (in.NextRow()) {
    in.ExpectFields(1, "a time in seconds");
    const double t = in.Number(0, "time");
    if (in.ok() && !(std::abs(t) < 9e9)) in.Fail("time is beyond what nanoseconds reach");
    if (!in.ok()) break;
    ImageFrame frame;
    frame.stamp_ns = std::llround(1e9 * t);
    if (!recording->frames.empty() && frame.stamp_ns <= recording->frames.back().stamp_ns) {
      in.Fail("time is not later than the one before");
    }
    char name[32];
    for (std::size_t k = 0; k < recording->cameras.size(); ++k) {
      std::string found;
      for (const char* ending : {"png", "jpg"}) {
        std::snprintf(name, sizeof name, "%06zu.%s", recording->frames.size(), ending);
        const fs::path file = folder / ("image_" + std::to_string(k)) / name;
        std::error_code error;
        if (found.empty() && fs::is_regular_file(file, error)) found = file.string();
      }
      if (found.empty()) {
        std::snprintf(name, sizeof name, "%06zu.png", recording->frames.size());
        in.Fail("there is no image " + (folder / ("image_" + std::to_string(k)) / name).string(),
                StatusCode::kIoError);
      }
      frame.files.push_back(found);
    }
    recording->frames.push_back(std::move(frame));
  }
  if (!in.ok()) return in.status();
  if (recording->frames.empty()) return {StatusCode::kParseError, path + ":1: no times"};
  return {};
}

/// 12 numbers a line, T_W_C of the left camera, 3 x 4 by rows.
Status ReadTruth(const fs::path& folder, ImageRecording* recording) {
  const std::string path = (folder / "poses.txt").string();
  std::error_code error;
  if (!fs::exists(path, error)) return {};
  const auto poses = glissade::internal::ReadKittiPoses(path, recording->frames.size());
  if (!poses.ok()) return poses.status();
  for (const Pose& T_w_b : poses.value()) {
    GroundTruthState state;
    state.stamp_ns = recording->frames[recording->ground_truth.size()].stamp_ns;
    state.T_w_b = T_w_b;
    recording->ground_truth.push_back(state);
  }
  return {};
}

}  // namespace

Result<ImageRecording> internal::ReadKittiImages(const std::string& path, int max_cameras) {
  const fs::path folder(path);
  ImageRecording recording;
  recording.layout = "KITTI odometry";
  std::error_code error;
  const bool stereo = max_cameras > 1 && fs::is_directory(folder / "image_1", error);
  if (Status s = ReadCalibration((folder / "calib.txt").string(), stereo, &recording); !s.ok()) {
    return s;
  }
  if (Status s = ReadFrames(folder, &recording); !s.ok()) return s;
  for (std::size_t k = 0; k < recording.cameras.size(); ++k) {
    const auto image = ReadImage(recording.frames[0].files[k]);
    if (!image.ok()) return image.status();
    recording.cameras[k].width = image->width;
    recording.cameras[k].height = image->height;
  }
  if (Status s = ReadTruth(folder, &recording); !s.ok()) return s;
  return recording;
}

}  // namespace glissade::vision
