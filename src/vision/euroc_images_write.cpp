// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>
#include <filesystem>
#include <span>
#include <vector>

#include "glissade/vision/image_recording.h"
#include "io/text_writer.h"

namespace glissade::vision {

namespace fs = std::filesystem;

namespace {

using glissade::internal::TextWriter;

std::string Digits(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string Join(const std::vector<double>& numbers) {
  std::string out = "[";
  for (const double x : numbers)
    out.append(out.size() > 1 ? ", " : "").append(Digits(x));
  return out.append("]");
}

void WriteT_BS(const Pose& T, TextWriter* out) {
  const Matrix3 R = T.q().toRotationMatrix();
  std::vector<double> numbers;
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      numbers.push_back(R(r, c));
    numbers.push_back(T.p()[r]);
  }
  numbers.insert(numbers.end(), {0.0, 0.0, 0.0, 1.0});
  out->Line("T_BS:\n  cols: 4\n  rows: 4");
  out->Line("  data: " + Join(numbers));
}

Status WriteCameraYaml(const Camera& camera, double rate_hz, const std::string& path) {
  auto out = TextWriter::Create(path);
  if (!out.ok()) return out.status();
  out->Line("sensor_type: camera");
  WriteT_BS(camera.T_b_c, &*out);
  const CameraPinhole& f = camera.pinhole();
  out->Line("rate_hz: " + Digits(rate_hz));
  out->Line("resolution: " +
            Join({static_cast<double>(camera.width), static_cast<double>(camera.height)}));
  out->Line("camera_model: pinhole");
  out->Line("intrinsics: " + Join({f.fx, f.fy, f.cx, f.cy}));
  const char* model = "none";
  std::vector<double> d;
  if (const auto* radtan = std::get_if<CameraRadtan>(&camera.lens)) {
    model = "radial-tangential";
    d = {radtan->k1, radtan->k2, radtan->p1, radtan->p2, radtan->k3};
  } else if (const auto* fisheye = std::get_if<CameraKannalaBrandt>(&camera.lens)) {
    model = "equidistant";
    d = {fisheye->k1, fisheye->k2, fisheye->k3, fisheye->k4};
  }
  out->Line(std::string("distortion_model: ").append(model));
  out->Line("distortion_coefficients: " + Join(d));
  return out->Close();
}

Status WriteImu(const ImageRecording& recording, const fs::path& folder) {
  auto yaml = TextWriter::Create((folder / "sensor.yaml").string());
  if (!yaml.ok()) return yaml.status();
  const ImuNoise& noise = *recording.imu_noise;
  yaml->Line("sensor_type: imu");
  WriteT_BS(Pose(), &*yaml);
  yaml->Line("rate_hz: " + Digits(recording.imu_rate_hz));
  yaml->Line("gyroscope_noise_density: " + Digits(noise.gyro_noise_density));
  yaml->Line("gyroscope_random_walk: " + Digits(noise.gyro_random_walk));
  yaml->Line("accelerometer_noise_density: " + Digits(noise.accel_noise_density));
  yaml->Line("accelerometer_random_walk: " + Digits(noise.accel_random_walk));
  if (Status s = yaml->Close(); !s.ok()) return s;

  auto csv = TextWriter::Create((folder / "data.csv").string());
  if (!csv.ok()) return csv.status();
  csv->Line("#timestamp [ns],w_x [rad s^-1],w_y,w_z,a_x [m s^-2],a_y,a_z");
  for (const ImuSample& sample : recording.imu) {
    std::string line = std::to_string(sample.stamp_ns);
    for (const Vector3* v : {&sample.gyro, &sample.accel})
      for (int k = 0; k < 3; ++k)
        line.append(",").append(Digits((*v)[k]));
    csv->Line(line);
  }
  return csv->Close();
}

Status WriteCamera(const ImageRecording& recording, std::size_t k, double rate_hz,
                   const fs::path& folder) {
  if (Status s = WriteCameraYaml(recording.cameras[k], rate_hz, (folder / "sensor.yaml").string());
      !s.ok()) {
    return s;
  }
  auto csv = TextWriter::Create((folder / "data.csv").string());
  if (!csv.ok()) return csv.status();
  csv->Line("#timestamp [ns],filename");
  for (const ImageFrame& frame : recording.frames) {
    if (frame.files.size() <= k || frame.files[k].empty()) continue;
    csv->Line(std::to_string(frame.stamp_ns)
                  .append(",")
                  .append(fs::path(frame.files[k]).filename().string()));
  }
  return csv->Close();
}

Status Check(const ImageRecording& recording) {
  const auto refused = [](const char* why) { return Status(StatusCode::kInvalidArgument, why); };
  if (recording.cameras.empty() || recording.cameras.size() > 2) {
    return refused("a recording has one or two cameras");
  }
  for (const Camera& camera : recording.cameras)
    if (Status s = camera.Validate(); !s.ok()) return s;
  if (recording.frames.empty()) return refused("a recording has frames");
  for (std::size_t k = 1; k < recording.frames.size(); ++k) {
    if (recording.frames[k].stamp_ns <= recording.frames[k - 1].stamp_ns) {
      return refused("stamps of frames must increase");
    }
  }
  if (recording.imu_noise) {
    if (Status s = recording.imu_noise->Validate(); !s.ok()) return s;
    if (!(recording.imu_rate_hz > 0.0 && recording.imu_rate_hz < 1e9))
      return refused("the rate of the IMU must be > 0");
  }
  for (const ImuSample& sample : recording.imu) {
    if (!sample.gyro.allFinite() || !sample.accel.allFinite()) {
      return refused("an IMU sample is not finite");
    }
  }
  return {};
}

}  // namespace

Status WriteEurocRecording(const ImageRecording& recording, const std::string& folder) {
  if (Status s = Check(recording); !s.ok()) return s;
  const auto& frames = recording.frames;
  const double seconds = SecondsBetween(frames.front().stamp_ns, frames.back().stamp_ns);
  const double rate_hz = frames.size() > 1 ? static_cast<double>(frames.size() - 1) / seconds : 1.0;
  const fs::path mav = fs::path(folder) / "mav0";
  const auto make = [](const fs::path& path) -> Status {
    std::error_code error;
    fs::create_directories(path, error);
    if (!error) return {};
    return {StatusCode::kIoError, path.string() + ": cannot be made: " + error.message()};
  };
  for (std::size_t k = 0; k < recording.cameras.size(); ++k) {
    const fs::path camera = mav / ("cam" + std::to_string(k));
    if (Status s = make(camera / "data"); !s.ok()) return s;
    if (Status s = WriteCamera(recording, k, rate_hz, camera); !s.ok()) return s;
  }
  if (recording.imu_noise) {
    if (Status s = make(mav / "imu0"); !s.ok()) return s;
    if (Status s = WriteImu(recording, mav / "imu0"); !s.ok()) return s;
  }
  if (recording.ground_truth.empty()) return {};
  const fs::path truth = mav / "state_groundtruth_estimate0";
  if (Status s = make(truth); !s.ok()) return s;
  return WriteEurocGroundTruth(recording.ground_truth, (truth / "data.csv").string());
}

}  // namespace glissade::vision
