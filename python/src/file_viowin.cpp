// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <string>
#include <vector>

#include "arrays.h"
#include "errors.h"
#include "file_path.h"
#include "glissade/io/viowin.h"
#include "handles.h"
#include "problem.h"
#include "vertex_values.h"

namespace glissade::python {

void BindViowin(nb::module_& m, nb::class_<PyProblem>& problem) {
  nb::class_<WindowHandles>(m, "WindowHandles", "Where a window went in a problem.")
      .def_prop_ro("poses", [](const WindowHandles& h) { return ArrayOf<AnyVertex>(h.poses); })
      .def_prop_ro("speed_biases",
                   [](const WindowHandles& h) { return ArrayOf<AnyVertex>(h.speed_biases); })
      .def_prop_ro("depths", [](const WindowHandles& h) { return ArrayOf<AnyVertex>(h.depths); })
      .def_prop_ro("reprojections",
                   [](const WindowHandles& h) { return ArrayOf<AnyEdge>(h.reprojections); });
  const auto keyframes = [](const std::vector<ViowinKeyframe>& all) {
    std::vector<double> poses;
    for (const ViowinKeyframe& k : all)
      poses.insert(poses.end(), k.T_w_b.data, k.T_w_b.data + 7);
    return Own(std::move(poses), {all.size(), 7});
  };
  nb::class_<ViowinWindow>(m, "ViowinWindow", "One window of a VIOWIN file (read_viowin).")
      .def_ro("id", &ViowinWindow::id)
      .def_prop_ro(
          "poses", [keyframes](const ViowinWindow& w) { return keyframes(w.keyframes); },
          "where a solve begins, (n, 7)")
      .def_prop_ro(
          "true_poses", [keyframes](const ViowinWindow& w) { return keyframes(w.ground_truth); },
          "(n, 7)")
      .def_prop_ro("stamps_s",
                   [](const ViowinWindow& w) {
                     std::vector<double> stamps;
                     for (const ViowinKeyframe& k : w.keyframes)
                       stamps.push_back(k.stamp);
                     const std::size_t n = stamps.size();
                     return Own(std::move(stamps), {n});
                   })
      .def_prop_ro(
          "speed_biases",
          [](const ViowinWindow& w) {
            std::vector<VertexSpeedBias> all;
            for (const ViowinKeyframe& k : w.keyframes)
              all.push_back(k.speed_bias);
            return ValuesOf(all);
          },
          "(n, 9)")
      .def_prop_ro(
          "inverse_depths",
          [](const ViowinWindow& w) {
            std::vector<double> rho;
            for (const ViowinLandmark& l : w.landmarks)
              rho.push_back(l.rho);
            const std::size_t n = rho.size();
            return Own(std::move(rho), {n});
          },
          "where a solve begins, (m,) [1/m]")
      .def_prop_ro("T_body_camera",
                   [](const ViowinWindow& w) {
                     return Own(std::vector<double>(w.T_b_c.data, w.T_b_c.data + 7), {7});
                   })
      .def_prop_ro(
          "camera",
          [](const ViowinWindow& w) {
            return Own({w.camera.fx, w.camera.fy, w.camera.cx, w.camera.cy, w.camera.sigma_px},
                       {5});
          },
          "fx, fy, cx, cy, sigma [px]")
      .def(
          "observations",
          [](const ViowinWindow& w) {
            std::vector<std::int64_t> landmark, host, target;
            std::vector<double> uv_host, uv_target;
            const auto& c = w.camera;
            for (std::size_t l = 0; l < w.landmarks.size(); ++l) {
              const ViowinLandmark& from = w.landmarks[l];
              for (const ViowinObservation& o : from.observations) {
                landmark.push_back(static_cast<std::int64_t>(l));
                host.push_back(from.host);
                target.push_back(o.frame);
                uv_host.push_back((from.u_host - c.cx) / c.fx);
                uv_host.push_back((from.v_host - c.cy) / c.fy);
                uv_target.push_back((o.u - c.cx) / c.fx);
                uv_target.push_back((o.v - c.cy) / c.fy);
              }
            }
            const std::size_t n = landmark.size();
            return nb::make_tuple(Own(std::move(landmark)), Own(std::move(host)),
                                  Own(std::move(target)), Own(std::move(uv_host), {n, 2}),
                                  Own(std::move(uv_target), {n, 2}));
          },
          nb::sig("def observations(self) -> tuple[numpy.typing.NDArray[numpy.int64], "
                  "numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.int64], "
                  "numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]"),
          "landmark, host, target (k,), uv_host, uv_target (k, 2) normalized: what "
          "add_reprojections() takes.");
  m.def(
      "read_viowin", [](const FilePath& path) { return Unwrap(ReadViowin(path.text)); },
      nb::arg("path"), "Reads all windows of a VIOWIN file.");
  m.def(
      "write_viowin",
      [](const std::vector<ViowinWindow>& windows, const FilePath& path) {
        Check(WriteViowin(windows, path.text));
      },
      nb::arg("windows"), nb::arg("path"), "Writes windows, compressed by the name.");
  problem.def(
      "add_window",
      [](PyProblem& p, const ViowinWindow& window, bool visual_inertial, const Loss& loss) {
        const auto kind = visual_inertial ? WindowKind::kVisualInertial : WindowKind::kVision;
        return p.Seen(AddToGraph(window, kind, {loss}, &p.write()));
      },
      nb::arg("window"), nb::arg("visual_inertial") = true, nb::arg("loss") = Loss(),
      "Adds a window of a VIOWIN file: all of it, or the vision-only problem.");
}

}  // namespace glissade::python
