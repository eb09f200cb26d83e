// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>

#include "glissade/base/out_of_memory.h"
#include "glissade/io/trajectory.h"
#include "io/csv_reader.h"
#include "io/decimal_seconds.h"
#include "io/kitti_poses.h"
#include "io/text_writer.h"

namespace glissade {

namespace {

using eval::StampedPose;
using eval::Trajectory;
using internal::CsvReader;
using internal::TextWriter;

/// Nanoseconds of the n-th at a rate, and nothing where no int64 holds it.
std::optional<std::int64_t> StampAt(double rate_hz, std::size_t n) {
  const double ns = std::round(1e9 * static_cast<double>(n) / rate_hz);
  if (!(ns < 9.2e18)) return {};
  return static_cast<std::int64_t>(ns);
}

Status CheckStamps(const std::string& path, const KittiStamps& stamps) {
  const bool rate = stamps.rate_hz != 0.0;
  if (!stamps.times.empty() && rate)
    return {StatusCode::kInvalidArgument, path + ": stamps from times or from a rate, not both"};
  if (stamps.times.empty() && !rate) {
    return {StatusCode::kInvalidArgument,
            path +
                ": poses of KITTI (12 numbers a line) have no stamps: give a file of times or a "
                "rate"};
  }
  if (rate && !(stamps.rate_hz > 0.0 && stamps.rate_hz <= 1e9))
    return {StatusCode::kInvalidArgument, path + ": a rate is more than 0 and at most 1e9 Hz"};
  return {};
}

Result<Trajectory> Read(const std::string& path, const KittiStamps& stamps) {
  if (Status s = CheckStamps(path, stamps); !s.ok()) return s;
  std::vector<std::int64_t> times;
  if (!stamps.times.empty()) {
    auto read = ReadKittiTimes(stamps.times);
    if (!read.ok()) return read.status();
    times = std::move(read).value();
  }
  const auto poses = internal::ReadKittiPoses(
      path, stamps.times.empty() ? std::numeric_limits<std::size_t>::max() : times.size());
  if (!poses.ok()) return poses.status();
  if (poses->size() < times.size()) {
    return Status(StatusCode::kParseError, path + ": has " + std::to_string(poses->size()) +
                                               " poses, and " + stamps.times + " has " +
                                               std::to_string(times.size()) + " times");
  }
  Trajectory trajectory;
  trajectory.reserve(poses->size());
  for (const Pose& pose : poses.value()) {
    const std::size_t n = trajectory.size();
    const auto stamp = times.empty() ? StampAt(stamps.rate_hz, n) : times[n];
    if (!stamp) {
      return Status(StatusCode::kInvalidArgument, path + ": at this rate pose " +
                                                      std::to_string(n) +
                                                      " is beyond what int64 nanoseconds reach");
    }
    trajectory.push_back({*stamp, pose});
  }
  return trajectory;
}

}  // namespace

Result<std::vector<Pose>> internal::ReadKittiPoses(const std::string& path, std::size_t most) {
  auto reader = CsvReader::Open(path, ' ');
  if (!reader.ok()) return reader.status();
  CsvReader& in = *reader;
  std::vector<Pose> poses;
  while (in.NextRow()) {
    in.ExpectFields(12, "a pose, three rows of rotation and position");
    double T[12];
    in.Numbers(0, 12, T, "entry of a pose");
    if (!in.ok()) break;
    if (poses.size() >= most) {
      in.Fail("more poses than times");
      break;
    }
    Matrix3 R;
    R << T[0], T[1], T[2], T[4], T[5], T[6], T[8], T[9], T[10];
    if (!((R.transpose() * R - Matrix3::Identity()).cwiseAbs().maxCoeff() < 1e-3) ||
        R.determinant() < 0.0) {
      in.Fail("the pose is no rigid motion");
      break;
    }
    poses.emplace_back(R, Vector3(T[3], T[7], T[11]));
  }
  if (!in.ok()) return in.status();
  return poses;
}

Result<std::vector<std::int64_t>> ReadKittiTimes(const std::string& path) {
  return internal::OrOutOfMemory([&]() -> Result<std::vector<std::int64_t>> {
    auto reader = CsvReader::Open(path, ' ');
    if (!reader.ok()) return reader.status();
    CsvReader& in = *reader;
    std::vector<std::int64_t> times;
    while (in.NextRow()) {
      in.ExpectFields(1, "a time in seconds");
      const auto stamp = internal::NanosecondsOf(in.Text(0));
      if (in.ok() && !stamp) in.FailExpected(0, "time", "seconds, that fit int64 nanoseconds");
      if (!in.ok()) break;
      if (!times.empty() && *stamp <= times.back()) {
        in.Fail("time is not later than the one before");
        break;
      }
      times.push_back(*stamp);
    }
    if (!in.ok()) return in.status();
    return times;
  });
}

Result<Trajectory> ReadKittiTrajectory(const std::string& path, const KittiStamps& stamps) {
  return internal::OrOutOfMemory([&] { return Read(path, stamps); });
}

Status WriteKittiTrajectory(std::span<const StampedPose> trajectory, const std::string& path,
                            const std::string& times) {
  return internal::OrOutOfMemory([&]() -> Status {
    if (Status s = eval::ValidateTrajectory(trajectory, "trajectory"); !s.ok()) return s;
    auto poses = TextWriter::Create(path);
    if (!poses.ok()) return poses.status();
    for (const StampedPose& x : trajectory) {
      const Matrix3 R = x.T_w_b.R();
      for (int row = 0; row < 3; ++row)
        poses->Number(R(row, 0)).Number(R(row, 1)).Number(R(row, 2)).Number(x.T_w_b.data[row]);
      poses->EndLine();
    }
    if (times.empty()) return poses->Close();
    auto stamps = TextWriter::Create(times);
    if (!stamps.ok()) return stamps.status();
    for (const StampedPose& x : trajectory)
      stamps->Line(internal::SecondsOf(x.stamp_ns));
    if (Status s = stamps->Close(); !s.ok()) return s;
    return poses->Close();
  });
}

}  // namespace glissade
