// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Says what is wrong with a visual-inertial recording, before anybody solves with it.
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/version.h"
#include "glissade/io/diagnose.h"
#include "glissade/io/euroc.h"
#include "glissade/io/viotracks.h"

namespace {

using namespace glissade;
namespace fs = std::filesystem;

constexpr const char* kName = "vio_check";

constexpr const char* kDescription =
    R"(Looks through a visual-inertial recording and says what is wrong with it, one line each, worst
first: what, where, how sure, what to do.)";

constexpr const char* kFooter =
    R"(DIR is a VIOTRACKS folder (docs/formats.md), or one of EuRoC (with mav0 or imu0 in it), of which
only the IMU and the stamps of cam0 are looked at.

A line reads:
  ERROR   time_offset  cameras: camera stamps are 102.3 ms late against the IMU
          -0.1023 +- 0.0028 s, 37 sigma. Do: add -0.1023 s to camera stamps (--time-offset -0.1023)
'sigma' is how many standard deviations it is from healthy; findings without were counted. An ERROR
makes an estimator fail, or be wrong without knowing it; a WARNING costs accuracy; 'info' is what
healthy recordings have, too. docs/data_doctor.md says how each is measured.

The time offset is what has to be added to camera stamps to get IMU time.

Examples:
  vio_check data/flight               12 s of simulation
  vio_check data/flight --json - | jq '.findings[].kind'
  vio_check EUROC                     a folder with mav0 in it

Exit code: 0 where nothing is an ERROR; 1 where something is; 2 where the recording cannot be read,
or an option makes no sense; 130 after Ctrl-C.)";

struct Options {
  std::string folder;
  double max_time_offset_s = 0.5;
  std::string json;
};

/// "name: number" of EuRoC's sensor.yaml; 0 where it is not there.
double YamlNumber(const fs::path& path, const std::string& name) {
  std::ifstream in(path);
  for (std::string line; std::getline(in, line);) {
    if (line.rfind(name + ":", 0) != 0) continue;
    std::string word = line.substr(name.size() + 1);
    word = word.substr(0, word.find('#'));
    word.erase(0, word.find_first_not_of(" \t"));
    word.erase(word.find_last_not_of(" \t\r") + 1);
    const auto x = app::ParseNumber(name, word, -1e300, 1e300);
    return x.ok() ? *x : 0.0;
  }
  return 0.0;
}

/// IMU and stamps of the first camera of a folder with imu0 in it.
Result<Viotracks> ReadEuroc(const fs::path& folder) {
  Viotracks data;
  auto imu = ReadEurocImu((folder / "imu0" / "data.csv").string(), Reading::kAsRecorded);
  if (!imu.ok()) return imu.status();
  data.imu = std::move(imu).value();
  const fs::path yaml = folder / "imu0" / "sensor.yaml";
  data.imu_rate_hz = YamlNumber(yaml, "rate_hz");
  if (std::error_code error; fs::exists(yaml, error)) {
    ImuNoise& noise = data.imu_noise.emplace();
    noise.gyro_noise_density = YamlNumber(yaml, "gyroscope_noise_density");
    noise.accel_noise_density = YamlNumber(yaml, "accelerometer_noise_density");
    noise.gyro_random_walk = YamlNumber(yaml, "gyroscope_random_walk");
    noise.accel_random_walk = YamlNumber(yaml, "accelerometer_random_walk");
  }
  const fs::path camera = folder / "cam0" / "data.csv";
  if (std::error_code error; fs::exists(camera, error)) {
    const auto stamps = ReadEurocStamps(camera.string(), Reading::kAsRecorded);
    if (!stamps.ok()) return stamps.status();
    for (const std::int64_t stamp : *stamps)
      data.frames.push_back({static_cast<std::int32_t>(data.frames.size()), stamp});
  }
  return data;
}

Result<Viotracks> ReadFolder(const std::string& name) {
  for (const fs::path& folder : {fs::path(name) / "mav0", fs::path(name)}) {
    std::error_code error;
    if (fs::exists(folder / "imu0" / "data.csv", error)) return ReadEuroc(folder);
  }
  return ReadViotracks(name, Reading::kAsRecorded);
}

std::string LabelOf(DoctorSeverity severity) {
  switch (severity) {
    case DoctorSeverity::kError:
      return "ERROR";
    case DoctorSeverity::kWarning:
      return "WARNING";
    case DoctorSeverity::kInfo:
      break;
  }
  return "info";
}

/// Seconds since the first stamp of the recording.
double SecondsInto(const Viotracks& data, std::int64_t stamp) {
  const std::int64_t origin = !data.imu.empty()      ? data.imu.front().stamp_ns
                              : !data.frames.empty() ? data.frames.front().stamp_ns
                                                     : stamp;
  return stamp >= origin ? SecondsBetween(origin, stamp) : -SecondsBetween(stamp, origin);
}

void PrintFinding(const Viotracks& data, const DoctorFinding& f) {
  std::string line = fmt::format("{:<8}{}  {}", LabelOf(f.severity), ToString(f.kind), f.sensor);
  if (f.stamp_ns) line += fmt::format(" at {:.3f} s", SecondsInto(data, *f.stamp_ns));
  line += fmt::format(": {} [", f.message);
  if (f.estimate && f.sigma) {
    line += fmt::format("{:.5g} +- {:.2g}{}{}, ", *f.estimate, *f.sigma, f.unit.empty() ? "" : " ",
                        f.unit);
  }
  line += f.sigmas ? fmt::format("{:.3g} sigma", *f.sigmas) : std::string("counted");
  app::Print("{}]. Do: {}\n", line, f.advice);
}

void PrintFacts(const DoctorFacts& f) {
  app::Print("{:.1f} s", f.duration_s);
  if (f.imu_rate_hz > 0.0) {
    app::Print("; IMU {:.5g} Hz, jitter {:.2g} ms, |f| {:.4g} m/s^2 at its quietest", f.imu_rate_hz,
               1e3 * f.imu_jitter_s, f.quiet_accel);
  }
  if (f.frame_rate_hz > 0.0) {
    app::Print("; frames {:.4g} Hz, jitter {:.2g} ms", f.frame_rate_hz, 1e3 * f.frame_jitter_s);
  }
  if (f.tracks_per_frame > 0.0) {
    app::Print("; {:.0f} features a frame, tracks of {:.0f} frames, {:.2g} % off, {:.2g} sigma_px",
               f.tracks_per_frame, f.median_track_length, 100.0 * f.outlier_share, f.pixel_noise);
  }
  if (f.time_offset_s && f.time_offset_sigma_s) {
    app::Print("; time offset {:.1f} +- {:.1f} ms", 1e3 * *f.time_offset_s,
               1e3 * *f.time_offset_sigma_s);
  }
  app::Print("\n");
}

nlohmann::ordered_json Optional(const std::optional<double>& x) {
  return x ? nlohmann::ordered_json(*x) : nlohmann::ordered_json(nullptr);
}

nlohmann::ordered_json Optional(const std::optional<Vector3>& x) {
  if (!x) return nullptr;
  return {(*x)[0], (*x)[1], (*x)[2]};
}

nlohmann::ordered_json ToJson(const Options& o, const DoctorReport& report) {
  nlohmann::ordered_json json = app::JsonHeader(kName, o.folder);
  json["worst"] = ToString(report.Worst());
  json["findings"] = nlohmann::ordered_json::array();
  for (const DoctorFinding& f : report.findings) {
    nlohmann::ordered_json finding = {
        {"kind", ToString(f.kind)}, {"severity", ToString(f.severity)}, {"sensor", f.sensor}};
    finding["stamp_ns"] = nullptr;
    if (f.stamp_ns) finding["stamp_ns"] = *f.stamp_ns;
    finding["count"] = f.count;
    finding["sigmas"] = Optional(f.sigmas);
    finding["estimate"] = Optional(f.estimate);
    finding["sigma"] = Optional(f.sigma);
    finding["unit"] = f.unit;
    finding["message"] = f.message;
    finding["advice"] = f.advice;
    json["findings"].push_back(finding);
  }
  const DoctorFacts& f = report.facts;
  json["facts"] = {{"duration_s", f.duration_s},
                   {"imu_rate_hz", f.imu_rate_hz},
                   {"imu_jitter_s", f.imu_jitter_s},
                   {"imu_longest_s", f.imu_longest_s},
                   {"frame_rate_hz", f.frame_rate_hz},
                   {"frame_jitter_s", f.frame_jitter_s},
                   {"frame_longest_s", f.frame_longest_s},
                   {"imu_coverage", f.imu_coverage},
                   {"mean_accel_mps2", {f.mean_accel[0], f.mean_accel[1], f.mean_accel[2]}},
                   {"quiet_accel_mps2", f.quiet_accel},
                   {"gyro_noise_density", f.gyro_noise_density},
                   {"accel_noise_density", f.accel_noise_density},
                   {"tracks_per_frame", f.tracks_per_frame},
                   {"median_track_length", f.median_track_length},
                   {"length_histogram", f.length_histogram},
                   {"outlier_share", f.outlier_share},
                   {"pixel_noise", f.pixel_noise},
                   {"frame_pairs", f.frame_pairs}};
  json["facts"]["time_offset_s"] = Optional(f.time_offset_s);
  json["facts"]["time_offset_sigma_s"] = Optional(f.time_offset_sigma_s);
  json["facts"]["extrinsic_error_rad"] = Optional(f.extrinsic_error);
  json["facts"]["gyro_bias_radps"] = Optional(f.gyro_bias);
  return json;
}

app::Outcome Run(const Options& o) {
  const auto data = ReadFolder(o.folder);
  if (!data.ok()) return app::BadInput(data.status());
  const DoctorReport report = Diagnose(*data, {.max_time_offset_s = o.max_time_offset_s});
  for (const DoctorFinding& f : report.findings)
    PrintFinding(*data, f);
  if (report.findings.empty()) app::Print("nothing was found\n");
  PrintFacts(report.facts);
  if (!o.json.empty()) {
    if (Status s = app::WriteJson(o.json, ToJson(o, report), 2); !s.ok()) return app::Failed(s);
  }
  if (report.Worst() != DoctorSeverity::kError) return {};
  return {app::kExitFailed, fmt::format("{}: not fit to be solved as it is", o.folder)};
}

}  // namespace

int main(int argc, char** argv) {
  app::Program program(kName, kDescription, kFooter);
  Options options;
  CLI::App& cli = program.cli();
  cli.add_option("DIR", options.folder, "Folder of the recording")->required();
  app::AddNumber(cli, "--max-time-offset", &options.max_time_offset_s, 0.0, 10.0,
                 "Look for a time offset of at most so much either way (s; default 0.5)");
  program.AddJson(&options.json);
  return program.Run(argc, argv, [&] { return Run(options); });
}
