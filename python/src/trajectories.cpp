// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <string>

#include "arrays.h"
#include "errors.h"
#include "file_path.h"
#include "glissade/eval/absolute_error.h"
#include "glissade/eval/alignment.h"
#include "glissade/eval/association.h"
#include "glissade/eval/relative_error.h"
#include "glissade/io/euroc.h"
#include "glissade/io/trajectory.h"
#include "imu.h"
#include "problem.h"

namespace glissade::python {

namespace {

using eval::Trajectory;

Trajectory TrajectoryFrom(const IndexLike& stamps_ns, const ArrayLike& poses, const char* name) {
  const Integers stamps(stamps_ns, "stamps_ns");
  const Rows rows(poses, 7, name);
  rows.Expect(stamps.size());
  Trajectory out(stamps.size());
  for (std::size_t k = 0; k < out.size(); ++k) {
    out[k].stamp_ns = stamps.data()[k];
    std::copy_n(rows[k], 7, out[k].T_w_b.data);
  }
  return out;
}

nb::tuple ArraysOf(const Trajectory& trajectory) {
  std::vector<std::int64_t> stamps;
  std::vector<double> poses;
  for (const eval::StampedPose& p : trajectory) {
    stamps.push_back(p.stamp_ns);
    poses.insert(poses.end(), p.T_w_b.data, p.T_w_b.data + 7);
  }
  const std::size_t n = stamps.size();
  return nb::make_tuple(Own(std::move(stamps)), Own(std::move(poses), {n, 7}));
}

nb::dict DictOf(const eval::Statistics& s) {
  nb::dict d;
  d["rmse"] = s.rmse;
  d["mean"] = s.mean;
  d["median"] = s.median;
  d["max"] = s.max;
  d["count"] = s.count;
  return d;
}

constexpr const char* kTrajectoryTuple =
    "tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64]]";

}  // namespace

void BindTrajectories(nb::module_& m) {
  m.def(
      "read_trajectory",
      [](const FilePath& path, const FilePath& times, double rate_hz) {
        return ArraysOf(Unwrap(ReadTrajectory(path.text, {times.text, rate_hz})));
      },
      nb::arg("path"), nb::arg("times") = "", nb::arg("rate_hz") = 0.0,
      nb::sig(std::string("def read_trajectory(path: str | os.PathLike[str], times: str | "
                          "os.PathLike[str] = '', rate_hz: float = 0.0) -> ")
                  .append(kTrajectoryTuple)
                  .c_str()),
      "Reads a trajectory: TUM, EuRoC or KITTI, told by content; plain, .gz or .bz2.\n\ntimes: for "
      "KITTI's, which have no stamps, a file with a time [s] for each pose; or rate_hz.\nReturns "
      "stamps_ns (n,) and poses T_world_body (n, 7).");
  nb::enum_<TrajectoryFormat>(m, "TrajectoryFormat", "Of trajectory files.")
      .value("TUM", TrajectoryFormat::kTum)
      .value("EUROC", TrajectoryFormat::kEuroc)
      .value("KITTI", TrajectoryFormat::kKitti);
  m.def(
      "write_trajectory",
      [](const FilePath& path, const IndexLike& stamps, const ArrayLike& poses,
         TrajectoryFormat format, const FilePath& kitti_times) {
        Check(WriteTrajectory(TrajectoryFrom(stamps, poses, "poses"), path.text, format,
                              kitti_times.text));
      },
      nb::arg("path"), nb::arg("stamps_ns"), nb::arg("poses"),
      nb::arg("format") = TrajectoryFormat::kTum, nb::arg("kitti_times") = "",
      nb::sig("def write_trajectory(path: str | os.PathLike[str], stamps_ns: "
              "numpy.typing.ArrayLike, poses: numpy.typing.ArrayLike, format: TrajectoryFormat = "
              "..., kitti_times: str | os.PathLike[str] = '') -> None"),
      "Writes a trajectory that evo and others read.\n\nkitti_times: where the stamps go that "
      "KITTI's format has no place for; '': nowhere.");
  m.def(
      "read_euroc_imu",
      [](const FilePath& path) {
        return ArraysOf(std::span<const ImuSample>(Unwrap(ReadEurocImu(path.text))));
      },
      nb::arg("path"),
      nb::sig("def read_euroc_imu(path: str | os.PathLike[str]) -> "
              "tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64], "
              "numpy.typing.NDArray[numpy.float64]]"),
      "Reads imu0/data.csv: stamps_ns (n,), gyro (n, 3) [rad/s], accel (n, 3) [m/s^2].");
  nb::enum_<eval::AlignmentKind>(m, "AlignmentKind", "What of a world is chosen freely.")
      .value("NONE", eval::AlignmentKind::kNone)
      .value("YAW", eval::AlignmentKind::kYaw, "camera with IMU")
      .value("SE3", eval::AlignmentKind::kSe3, "stereo")
      .value("SIM3", eval::AlignmentKind::kSim3, "one camera");
  m.def(
      "evaluate_trajectory",
      [](const IndexLike& stamps, const ArrayLike& poses, const IndexLike& true_stamps,
         const ArrayLike& true_poses, eval::AlignmentKind kind) {
        auto matched =
            Unwrap(eval::Associate(TrajectoryFrom(stamps, poses, "poses"),
                                   TrajectoryFrom(true_stamps, true_poses, "true_poses")));
        eval::AlignmentOptions options;
        options.kind = kind;
        const eval::Alignment alignment = Unwrap(eval::Align(matched, options));
        eval::ApplyAlignment(alignment, matched.estimate);
        const eval::AbsoluteErrors errors = Unwrap(eval::ComputeAbsoluteErrors(matched));
        nb::dict d;
        d["scale"] = alignment.scale;
        d["translation_m"] = DictOf(errors.translation_m);
        d["rotation_deg"] = DictOf(errors.rotation_deg);
        d["aligned"] = ArraysOf(matched.estimate);
        d["reference"] = ArraysOf(matched.reference);
        return d;
      },
      nb::arg("stamps_ns"), nb::arg("poses"), nb::arg("true_stamps_ns"), nb::arg("true_poses"),
      nb::arg("alignment") = eval::AlignmentKind::kYaw,
      nb::sig("def evaluate_trajectory(stamps_ns: numpy.typing.ArrayLike, poses: "
              "numpy.typing.ArrayLike, true_stamps_ns: numpy.typing.ArrayLike, true_poses: "
              "numpy.typing.ArrayLike, alignment: AlignmentKind = ...) -> dict[str, typing.Any]"),
      "The absolute trajectory error (Sturm et al., IROS 2012) after alignment: 'translation_m' "
      "and 'rotation_deg' with rmse, mean, median, max, count; 'scale'; 'aligned' and 'reference', "
      "trajectories of matched poses.");
}

}  // namespace glissade::python
