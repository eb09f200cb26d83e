// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
// Recordings with feature tracks, and their way through a window.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <string>
#include <vector>

#include "arrays.h"
#include "errors.h"
#include "file_path.h"
#include "glissade/io/replay.h"
#include "imu.h"
#include "problem.h"
#include "window.h"

namespace glissade::python {

void BindViotracks(nb::module_& m) {
  nb::class_<Viotracks>(m, "Viotracks", "A recording with feature tracks (read_viotracks).")
      .def_ro("origin", &Viotracks::origin)
      .def_prop_ro("cameras", [](const Viotracks& r) { return WindowCameras(r); })
      .def_prop_ro("imu_noise", [](const Viotracks& r) { return r.imu_noise; })
      .def_prop_ro(
          "gravity", [](const Viotracks& r) { return r.gravity.norm(); }, "m/s^2")
      .def_prop_ro(
          "imu", [](const Viotracks& r) { return ArraysOf(r.imu); },
          nb::sig("def imu(self) -> tuple[numpy.typing.NDArray[numpy.int64], "
                  "numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]"),
          "stamps_ns, gyro, accel")
      .def_prop_ro("frame_stamps_ns",
                   [](const Viotracks& r) {
                     std::vector<std::int64_t> stamps;
                     for (const ViotracksFrame& f : r.frames)
                       stamps.push_back(f.stamp_ns);
                     return Own(std::move(stamps));
                   })
      .def_prop_ro(
          "ground_truth",
          [](const Viotracks& r) {
            std::vector<std::int64_t> stamps;
            std::vector<double> poses;
            for (const GroundTruthState& s : r.ground_truth) {
              stamps.push_back(s.stamp_ns);
              poses.insert(poses.end(), s.T_w_b.data, s.T_w_b.data + 7);
            }
            const std::size_t n = stamps.size();
            return nb::make_tuple(Own(std::move(stamps)), Own(std::move(poses), {n, 7}));
          },
          nb::sig("def ground_truth(self) -> tuple[numpy.typing.NDArray[numpy.int64], "
                  "numpy.typing.NDArray[numpy.float64]]"),
          "stamps_ns, poses (n, 7)")
      .def(
          "observations",
          [](const Viotracks& r, std::int64_t frame) {
            std::vector<std::int64_t> tracks, cameras;
            std::vector<double> uv;
            for (const ViotracksObservation& o : r.tracks) {
              if (o.frame != frame) continue;
              tracks.push_back(o.track);
              cameras.push_back(o.camera);
              uv.push_back(o.u);
              uv.push_back(o.v);
            }
            const std::size_t n = tracks.size();
            return nb::make_tuple(Own(std::move(tracks)), Own(std::move(uv), {n, 2}),
                                  Own(std::move(cameras)));
          },
          nb::arg("frame"),
          nb::sig("def observations(self, frame: int) -> tuple[numpy.typing.NDArray[numpy.int64], "
                  "numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.int64]]"),
          "What frame k shows: tracks, uv (n, 2) [px], cameras.")
      .def(
          "options",
          [](const Viotracks& r, std::size_t num_cameras) {
            SlidingWindowOptions options;
            options.cameras = WindowCameras(r, num_cameras);
            options.imu_noise = r.imu_noise;
            options.gravity = r.gravity.norm();
            return options;
          },
          nb::arg("num_cameras") = 1000, "Options of a SlidingWindow for this recording.");
  m.def(
      "read_viotracks", [](const FilePath& folder) { return Unwrap(ReadViotracks(folder.text)); },
      nb::arg("folder"), "Reads a VIOTRACKS folder.");
  m.def(
      "replay",
      [](const Viotracks& recording, PyWindow& window, nb::object callback) {
        ViotracksReplay replay(recording);
        std::vector<std::int64_t> stamps;
        std::vector<double> poses;
        while (replay.Next()) {
          const Status status = window.Work([&](SlidingWindow& w) {
            (void)w.AddImu(replay.imu());
            if (!w.AddFrame(replay.stamp_ns(), replay.observations()).ok()) return Status();
            return w.Optimize();
          });
          if (PyErr_CheckSignals() != 0) throw nb::python_error();
          Check(status);
          SlidingWindow& w = window.get();
          if (w.phase() != WindowPhase::kRunning) continue;
          stamps.push_back(w.newest().stamp_ns);
          poses.insert(poses.end(), w.newest().T_w_b.data, w.newest().T_w_b.data + 7);
          if (!callback.is_none() && SaysStop(callback(nb::cast(w.newest())))) break;
        }
        const std::size_t n = stamps.size();
        return nb::make_tuple(Own(std::move(stamps)), Own(std::move(poses), {n, 7}));
      },
      nb::arg("recording"), nb::arg("window"), nb::arg("callback") = nb::none(),
      nb::sig("def replay(recording: Viotracks, window: SlidingWindow, callback: "
              "collections.abc.Callable[[WindowState], bool | None] | None = None) -> "
              "tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64]]"),
      "Hands a recording to a window in the order of time.\n\nReturns the newest state after every "
      "frame: stamps_ns (n,), poses (n, 7). callback: called with each, stops by returning False.");
}

}  // namespace glissade::python
