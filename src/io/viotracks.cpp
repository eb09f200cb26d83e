// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/viotracks.h"
#include "glissade/base/out_of_memory.h"

#include <filesystem>
#include <limits>
#include <map>

#include "io/csv_reader.h"
#include "io/viotracks_calibration.h"

namespace glissade {

namespace {

using internal::CsvReader;

constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();

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
    if (Status s = internal::ReadCalibration(calibration.string(), &data); !s.ok()) return s;
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
