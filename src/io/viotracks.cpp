// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/viotracks.h"
#include "glissade/base/out_of_memory.h"

#include <cmath>
#include <filesystem>
#include <limits>
#include <map>

#include "glissade/base/validate.h"
#include "io/csv_reader.h"
#include "io/json_value.h"

namespace glissade {

namespace {

using internal::CsvReader;
using internal::JsonValue;
using Kind = JsonValue::Kind;

constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();

/// Takes numbers out of a JSON tree; the first thing that is missing or wrong is kept.
class Calibration {
 public:
  explicit Calibration(std::string path) : path_(std::move(path)) {}

  [[nodiscard]] const Status& status() const { return status_; }

  void Fail(const JsonValue& where, const std::string& message) {
    if (!status_.ok()) return;
    status_ =
        Status(StatusCode::kParseError, path_ + ":" + std::to_string(where.line) + ": " + message);
  }
  const JsonValue* Member(const JsonValue& object, const char* name, Kind kind) {
    const JsonValue* value = object.Find(name);
    if (value != nullptr && value->kind == kind) return value;
    const std::string expected =
        "expected '" + std::string(name) + "' (" + std::string(ToString(kind)) + ")";
    if (value == nullptr) {
      Fail(object, expected + ", found none");
    } else {
      Fail(*value, expected + ", found " + std::string(ToString(value->kind)));
    }
    return nullptr;
  }
  double Number(const JsonValue& object, const char* name) {
    const JsonValue* value = Member(object, name, Kind::kNumber);
    return value != nullptr ? value->number : 0.0;
  }
  double Positive(const JsonValue& object, const char* name) {
    const JsonValue* value = Member(object, name, Kind::kNumber);
    if (value == nullptr) return 0.0;
    if (!(value->number > 0.0)) Fail(*value, "'" + std::string(name) + "' must be > 0");
    return value->number;
  }
  int Size(const JsonValue& object, const char* name) {
    const double x = Positive(object, name);
    if (x > 1e6 || x != std::floor(x)) {
      Fail(object, "'" + std::string(name) + "' must be a whole number of pixels");
      return 0;
    }
    return static_cast<int>(x);
  }
  void Numbers(const JsonValue& object, const char* name, std::size_t n, double* to) {
    const JsonValue* value = Member(object, name, Kind::kArray);
    if (value == nullptr) return;
    bool good = value->items.size() == n;
    for (const JsonValue& item : value->items)
      good = good && item.kind == Kind::kNumber;
    if (!good) {
      Fail(*value, "'" + std::string(name) + "' must be " + std::to_string(n) + " numbers");
      return;
    }
    for (std::size_t i = 0; i < n; ++i)
      to[i] = value->items[i].number;
  }
  /// A rigid transform, 16 numbers row-major.
  Pose Transform(const JsonValue& object, const char* name) {
    double T[16] = {};
    Numbers(object, name, 16, T);
    if (!status_.ok()) return {};
    Matrix3 R;
    R << T[0], T[1], T[2], T[4], T[5], T[6], T[8], T[9], T[10];
    const double off = (R * R.transpose() - Matrix3::Identity()).norm();
    const bool rigid = off < 1e-6 && R.row(0).cross(R.row(1)).dot(R.row(2)) > 0.0 && T[12] == 0.0 &&
                       T[13] == 0.0 && T[14] == 0.0 && T[15] == 1.0;
    if (!rigid) {
      Fail(object, "'" + std::string(name) + "' is no rigid transform");
      return {};
    }
    return Pose(R, Vector3(T[3], T[7], T[11]));
  }

 private:
  std::string path_;
  Status status_;
};

Status ReadCalibration(const std::string& path, Viotracks* data) {
  const auto json = internal::ReadJson(path);
  if (!json.ok()) return json.status();
  Calibration in(path);
  if (json->kind != Kind::kObject) {
    in.Fail(*json, "expected an object");
    return in.status();
  }
  if (const JsonValue* origin = json->Find("origin"); origin != nullptr) {
    data->origin = origin->string;
  }
  in.Numbers(*json, "gravity", 3, data->gravity.data());
  const JsonValue* cameras = in.Member(*json, "cameras", Kind::kArray);
  if (!in.status().ok()) return in.status();
  for (const JsonValue& item : cameras->items) {
    if (item.kind != Kind::kObject) {
      in.Fail(item, "expected a camera (object)");
      break;
    }
    ViotracksCamera& c = data->cameras.emplace_back();
    c.fx = in.Positive(item, "fx");
    c.fy = in.Positive(item, "fy");
    c.cx = in.Number(item, "cx");
    c.cy = in.Number(item, "cy");
    c.width = in.Size(item, "width");
    c.height = in.Size(item, "height");
    c.sigma_px = in.Positive(item, "sigma_px");
    c.T_b_c = in.Transform(item, "T_B_C");
  }
  if (const JsonValue* imu = json->Find("imu"); imu != nullptr && imu->kind != Kind::kNull) {
    ImuNoise& noise = data->imu_noise.emplace();
    data->imu_rate_hz = in.Positive(*imu, "rate_hz");
    noise.gyro_noise_density = in.Positive(*imu, "gyro_noise_density");
    noise.accel_noise_density = in.Positive(*imu, "accel_noise_density");
    noise.gyro_random_walk = in.Positive(*imu, "gyro_random_walk");
    noise.accel_random_walk = in.Positive(*imu, "accel_random_walk");
  }
  return in.status();
}

/// NAME.csv or NAME.csv.gz; empty where neither is there.
std::string Table(const std::string& folder, const std::string& name) {
  std::error_code error;
  const std::string plain = (std::filesystem::path(folder) / (name + ".csv")).string();
  if (std::filesystem::exists(plain, error)) return plain;
  if (std::filesystem::exists(plain + ".gz", error)) return plain + ".gz";
  return {};
}

Status Missing(const std::string& folder, const char* name) {
  return {StatusCode::kIoError,
          folder + ": there is no " + name + ".csv and no " + name + ".csv.gz"};
}

/// Fills `index`: id -> place in frames.
Status ReadFrames(const std::string& path, Reading reading, Viotracks* data,
                  std::map<std::int64_t, std::int32_t>* index) {
  auto reader = CsvReader::Open(path);
  if (!reader.ok()) return reader.status();
  CsvReader& in = reader.value();
  while (in.NextRow()) {
    in.ExpectFields(2, "frame_id, timestamp_ns");
    ViotracksFrame frame;
    frame.id = static_cast<std::int32_t>(in.Integer(0, 0, kMost, "frame_id"));
    frame.stamp_ns = in.Integer(1, std::numeric_limits<std::int64_t>::min(),
                                std::numeric_limits<std::int64_t>::max(), "timestamp_ns");
    if (!in.ok()) break;
    if (reading == Reading::kChecked && !data->frames.empty() &&
        (frame.id <= data->frames.back().id || frame.stamp_ns <= data->frames.back().stamp_ns)) {
      in.Fail("frame " + std::to_string(frame.id) + ": ids and timestamps must increase");
      break;
    }
    index->emplace(frame.id, static_cast<std::int32_t>(data->frames.size()));
    data->frames.push_back(frame);
  }
  return in.status();
}

Status ReadTracks(const std::string& path, const std::map<std::int64_t, std::int32_t>& index,
                  Reading reading, Viotracks* data) {
  auto reader = CsvReader::Open(path);
  if (!reader.ok()) return reader.status();
  CsvReader& in = reader.value();
  if (reading == Reading::kAsRecorded) in.AllowNonFinite();
  const auto last_camera =
      reading == Reading::kAsRecorded ? kMost : static_cast<std::int64_t>(data->cameras.size()) - 1;
  while (in.NextRow()) {
    in.ExpectFields(5, "frame_id, track_id, camera, u, v");
    ViotracksObservation o;
    const std::int64_t id = in.Integer(0, 0, kMost, "frame_id");
    const auto frame = index.find(id);
    if (in.ok() && frame == index.end()) {
      in.Fail("there is no frame " + std::to_string(id));
    }
    if (!in.ok()) break;
    o.frame = frame->second;
    o.track = static_cast<std::int32_t>(in.Integer(1, 0, kMost, "track_id"));
    o.camera = static_cast<std::int32_t>(in.Integer(2, 0, last_camera, "camera"));
    o.u = in.Number(3, "u");
    o.v = in.Number(4, "v");
    data->tracks.push_back(o);
  }
  return in.status();
}

}  // namespace

Result<Viotracks> ReadViotracks(const std::string& folder, Reading reading) {
  return internal::OrOutOfMemory([&]() -> Result<Viotracks> {
    Viotracks data;
    const auto calibration = std::filesystem::path(folder) / "calibration.json";
    if (Status s = ReadCalibration(calibration.string(), &data); !s.ok()) return s;
    const std::string frames = Table(folder, "frames");
    if (frames.empty()) return Missing(folder, "frames");
    std::map<std::int64_t, std::int32_t> index;
    if (Status s = ReadFrames(frames, reading, &data, &index); !s.ok()) return s;
    const std::string tracks = Table(folder, "tracks");
    if (tracks.empty()) return Missing(folder, "tracks");
    if (Status s = ReadTracks(tracks, index, reading, &data); !s.ok()) return s;
    if (const std::string imu = Table(folder, "imu"); !imu.empty()) {
      auto samples = ReadEurocImu(imu, reading);
      if (!samples.ok()) return samples.status();
      data.imu = std::move(samples).value();
    } else if (data.imu_noise && reading == Reading::kChecked) {
      return Missing(folder, "imu");
    }
    if (reading == Reading::kAsRecorded) return data;
    if (const std::string truth = Table(folder, "groundtruth"); !truth.empty()) {
      auto states = ReadEurocGroundTruth(truth);
      if (!states.ok()) return states.status();
      data.ground_truth = std::move(states).value();
    }
    return data;
  });
}

}  // namespace glissade
