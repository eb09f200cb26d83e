// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <filesystem>
#include <string>

#include "glissade/base/validate.h"
#include "glissade/io/viotracks.h"
#include "io/csv_row.h"
#include "io/ground_truth.h"
#include "io/text_writer.h"

namespace glissade {

namespace {

using internal::TextWriter;
using Row = internal::CsvRow;

Status Refused(const std::string& what) {
  return {StatusCode::kInvalidArgument, "VIOTRACKS: " + what};
}

Status CheckCamera(const ViotracksCamera& c) {
  if (Status s = ValidatePositive(c.fx, "camera fx"); !s.ok()) return s;
  if (Status s = ValidatePositive(c.fy, "camera fy"); !s.ok()) return s;
  if (Status s = ValidatePositive(c.sigma_px, "camera sigma_px"); !s.ok()) return s;
  const double centre[2] = {c.cx, c.cy};
  if (Status s = ValidateFinite(centre, 2, "camera centre"); !s.ok()) return s;
  if (c.width < 1 || c.height < 1 || c.width > 1000000 || c.height > 1000000) {
    return Refused("width and height of a camera must be 1 to 1000000");
  }
  return ValidatePose(c.T_b_c.data, "camera T_B_C");
}

Status CheckFrames(const Viotracks& recording) {
  for (std::size_t k = 0; k < recording.frames.size(); ++k) {
    const ViotracksFrame& frame = recording.frames[k];
    const bool increases = k == 0 ? frame.id >= 0
                                  : frame.id > recording.frames[k - 1].id &&
                                        frame.stamp_ns > recording.frames[k - 1].stamp_ns;
    if (!increases) {
      return Refused("frame " + std::to_string(frame.id) + ": ids and stamps must increase");
    }
  }
  for (const ViotracksObservation& o : recording.tracks) {
    const std::string name = "observation of track " + std::to_string(o.track);
    if (o.track < 0) return Refused(name + ": the number of a track must be >= 0");
    if (o.frame < 0 || static_cast<std::size_t>(o.frame) >= recording.frames.size()) {
      return Refused(name + ": there is no frame at " + std::to_string(o.frame));
    }
    if (o.camera < 0 || static_cast<std::size_t>(o.camera) >= recording.cameras.size()) {
      return Refused(name + ": there is no camera " + std::to_string(o.camera));
    }
    const double uv[2] = {o.u, o.v};
    if (Status s = ValidateFinite(uv, 2, name); !s.ok()) return s;
  }
  return {};
}

std::string Member(const char* name, double x) {
  return "\"" + std::string(name) + "\": " + Row().Number(x).text();
}

std::string CameraJson(const ViotracksCamera& c) {
  const Matrix3 R = c.T_b_c.R();
  Row T;
  for (int i = 0; i < 3; ++i)
    T.Number(R(i, 0)).Number(R(i, 1)).Number(R(i, 2)).Number(c.T_b_c.p()[i]);
  T.Integer(0).Integer(0).Integer(0).Integer(1);
  return "    {" + Member("fx", c.fx) + ", " + Member("fy", c.fy) + ", " + Member("cx", c.cx) +
         ", " + Member("cy", c.cy) + ", \"width\": " + std::to_string(c.width) +
         ", \"height\": " + std::to_string(c.height) + ", " + Member("sigma_px", c.sigma_px) +
         ",\n     \"T_B_C\": [" + T.text() + "]}";
}

/// What a JSON string may hold as it is.
std::string Quoted(const std::string& text) {
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted += '\\';
    quoted += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
  }
  return quoted + "\"";
}

Status WriteCalibration(const Viotracks& recording, const std::string& path) {
  auto writer = TextWriter::Create(path);
  if (!writer.ok()) return writer.status();
  TextWriter& out = writer.value();
  out.Line("{");
  out.Line("  \"origin\": " + Quoted(recording.origin) + ",");
  out.Line("  \"gravity\": [" + Row().Numbers(recording.gravity, 3).text() + "],");
  if (recording.imu_noise) {
    const ImuNoise& noise = *recording.imu_noise;
    out.Line("  \"imu\": {" + Member("rate_hz", recording.imu_rate_hz) + ",");
    out.Line("    " + Member("gyro_noise_density", noise.gyro_noise_density) + ", " +
             Member("accel_noise_density", noise.accel_noise_density) + ",");
    out.Line("    " + Member("gyro_random_walk", noise.gyro_random_walk) + ", " +
             Member("accel_random_walk", noise.accel_random_walk) + "},");
  }
  out.Line("  \"cameras\": [");
  for (std::size_t k = 0; k < recording.cameras.size(); ++k)
    out.Line(CameraJson(recording.cameras[k]) + (k + 1 < recording.cameras.size() ? "," : ""));
  out.Line("  ]");
  out.Line("}");
  return out.Close();
}

template <class List, class MakeRow>
Status WriteTable(const std::string& path, const char* header, const List& rows, MakeRow&& row) {
  auto writer = TextWriter::Create(path);
  if (!writer.ok()) return writer.status();
  writer->Line(header);
  for (const auto& x : rows)
    writer->Line(row(x).text());
  return writer->Close();
}

}  // namespace

Status Viotracks::Validate() const {
  if (Status s = ValidateFinite(gravity.data(), 3, "gravity"); !s.ok()) return s;
  for (const ViotracksCamera& camera : cameras) {
    if (Status s = CheckCamera(camera); !s.ok()) return s;
  }
  if (imu_noise) {
    if (Status s = imu_noise->Validate(); !s.ok()) return s;
    if (Status s = ValidatePositive(imu_rate_hz, "IMU rate_hz"); !s.ok()) return s;
  } else if (!imu.empty()) {
    return Refused("IMU samples without an IMU");
  }
  for (const ImuSample& sample : imu) {
    if (Status s = ValidateFinite(sample.gyro.data(), 3, "gyroscope"); !s.ok()) return s;
    if (Status s = ValidateFinite(sample.accel.data(), 3, "accelerometer"); !s.ok()) return s;
  }
  if (Status s = CheckFrames(*this); !s.ok()) return s;
  return internal::CheckGroundTruth(ground_truth);
}

Status WriteViotracks(const Viotracks& recording, const std::string& folder) {
  if (Status s = recording.Validate(); !s.ok()) return s;
  const std::filesystem::path to(folder);
  std::error_code error;
  std::filesystem::create_directory(to, error);
  if (error) return {StatusCode::kIoError, folder + ": cannot be made: " + error.message()};
  if (Status s = WriteCalibration(recording, (to / "calibration.json").string()); !s.ok()) return s;
  if (Status s = WriteTable(
          (to / "frames.csv.gz").string(), "# frame_id, timestamp_ns", recording.frames,
          [](const ViotracksFrame& f) { return Row().Integer(f.id).Integer(f.stamp_ns); });
      !s.ok()) {
    return s;
  }
  if (Status s = WriteTable((to / "tracks.csv.gz").string(), "# frame_id, track_id, camera, u, v",
                            recording.tracks,
                            [&](const ViotracksObservation& o) {
                              const auto frame = static_cast<std::size_t>(o.frame);
                              return Row()
                                  .Integer(recording.frames[frame].id)
                                  .Integer(o.track)
                                  .Integer(o.camera)
                                  .Number(o.u)
                                  .Number(o.v);
                            });
      !s.ok()) {
    return s;
  }
  if (recording.imu_noise) {
    if (Status s =
            WriteTable((to / "imu.csv.gz").string(),
                       "# timestamp_ns, wx, wy, wz [rad/s], ax, ay, az [m/s^2]", recording.imu,
                       [](const ImuSample& sample) {
                         return Row()
                             .Integer(sample.stamp_ns)
                             .Numbers(sample.gyro, 3)
                             .Numbers(sample.accel, 3);
                       });
        !s.ok()) {
      return s;
    }
  }
  // What an earlier recording has left in the folder is no part of this one.
  for (const char* name : {"frames.csv", "tracks.csv", "imu.csv", "groundtruth.csv"})
    std::filesystem::remove(to / name, error);
  if (!recording.imu_noise) std::filesystem::remove(to / "imu.csv.gz", error);
  if (recording.ground_truth.empty()) {
    std::filesystem::remove(to / "groundtruth.csv.gz", error);
    return {};
  }
  return WriteEurocGroundTruth(recording.ground_truth, (to / "groundtruth.csv.gz").string());
}

}  // namespace glissade
