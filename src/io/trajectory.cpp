// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/trajectory.h"

#include <cmath>
#include <string>
#include <vector>

#include "glissade/base/out_of_memory.h"
#include "glissade/io/euroc.h"
#include "io/csv_reader.h"
#include "io/csv_row.h"
#include "io/decimal_seconds.h"
#include "io/text_writer.h"

namespace glissade {

namespace {

using eval::StampedPose;
using eval::Trajectory;
using internal::CsvReader;

std::int64_t Stamp(CsvReader& in) {
  const auto stamp = internal::NanosecondsOf(in.Text(0));
  if (stamp) return *stamp;
  in.FailExpected(0, "stamp", "seconds, that fit int64 nanoseconds");
  return 0;
}

Pose ReadPose(CsvReader& in) {
  Pose pose;
  in.Numbers(1, 3, pose.data, "position");
  in.Numbers(4, 4, pose.data + 3, "quaternion");
  const double norm = pose.q().coeffs().stableNorm();
  if (in.ok() && !(std::abs(norm - 1.0) < 1e-3)) {
    in.Fail("quaternion has norm " + std::to_string(norm) + ", not 1");
  }
  pose.Normalize();
  return pose;
}

Result<Trajectory> ReadTum(const std::string& path) {
  auto reader = CsvReader::Open(path, ' ');
  if (!reader.ok()) return reader.status();
  CsvReader& in = reader.value();
  Trajectory trajectory;
  while (in.NextRow()) {
    in.ExpectFields(8, "stamp px py pz qx qy qz qw");
    if (!in.ok()) break;
    const StampedPose x{Stamp(in), ReadPose(in)};
    if (in.ok() && !trajectory.empty() && x.stamp_ns <= trajectory.back().stamp_ns) {
      in.Fail("stamp " + internal::SecondsOf(x.stamp_ns) + " is not later than " +
              internal::SecondsOf(trajectory.back().stamp_ns));
    }
    trajectory.push_back(x);
  }
  if (!in.ok()) return in.status();
  return trajectory;
}

}  // namespace

Result<Trajectory> ReadTumTrajectory(const std::string& path) {
  return internal::OrOutOfMemory([&] { return ReadTum(path); });
}

Status WriteTumTrajectory(std::span<const StampedPose> trajectory, const std::string& path) {
  if (Status s = eval::ValidateTrajectory(trajectory, "trajectory"); !s.ok()) return s;
  auto writer = internal::TextWriter::Create(path);
  if (!writer.ok()) return writer.status();
  writer->Line("# stamp px py pz qx qy qz qw");
  for (const StampedPose& x : trajectory) {
    writer->Line(internal::CsvRow(" ")
                     .Word(internal::SecondsOf(x.stamp_ns))
                     .Numbers(x.T_w_b.data, 7)
                     .text());
  }
  return writer->Close();
}

Result<Trajectory> ReadEurocTrajectory(const std::string& path) {
  const auto states = ReadEurocGroundTruth(path);
  if (!states.ok()) return states.status();
  return internal::OrOutOfMemory([&]() -> Result<Trajectory> {
    Trajectory trajectory;
    for (const GroundTruthState& state : *states)
      trajectory.push_back({state.stamp_ns, state.T_w_b});
    return trajectory;
  });
}

Status WriteEurocTrajectory(std::span<const StampedPose> trajectory, const std::string& path) {
  if (Status s = eval::ValidateTrajectory(trajectory, "trajectory"); !s.ok()) return s;
  return internal::OrOutOfMemory([&] {
    std::vector<GroundTruthState> states;
    for (const StampedPose& x : trajectory)
      states.push_back({.stamp_ns = x.stamp_ns, .T_w_b = x.T_w_b, .speed_bias = {}});
    return WriteEurocGroundTruth(states, path);
  });
}

Result<TrajectoryFormat> FindTrajectoryFormat(const std::string& path) {
  return internal::OrOutOfMemory([&]() -> Result<TrajectoryFormat> {
    auto reader = CsvReader::Open(path, ' ');
    if (!reader.ok()) return reader.status();
    const bool some = reader->NextRow();
    if (!reader->ok()) return reader->status();
    if (some && reader->row().find(',') != std::string_view::npos) return TrajectoryFormat::kEuroc;
    return reader->num_fields() == 12 ? TrajectoryFormat::kKitti : TrajectoryFormat::kTum;
  });
}

Result<Trajectory> ReadTrajectory(const std::string& path, const KittiStamps& stamps) {
  const auto format = FindTrajectoryFormat(path);
  if (!format.ok()) return format.status();
  switch (format.value()) {
    case TrajectoryFormat::kEuroc:
      return ReadEurocTrajectory(path);
    case TrajectoryFormat::kKitti:
      return ReadKittiTrajectory(path, stamps);
    case TrajectoryFormat::kTum:
      break;
  }
  return ReadTumTrajectory(path);
}

Status WriteTrajectory(std::span<const StampedPose> trajectory, const std::string& path,
                       TrajectoryFormat format, const std::string& kitti_times) {
  switch (format) {
    case TrajectoryFormat::kTum:
      return WriteTumTrajectory(trajectory, path);
    case TrajectoryFormat::kEuroc:
      return WriteEurocTrajectory(trajectory, path);
    case TrajectoryFormat::kKitti:
      return WriteKittiTrajectory(trajectory, path, kitti_times);
  }
  return {StatusCode::kInvalidArgument, path + ": there is no such format of a trajectory"};
}

}  // namespace glissade
