// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <memory>
#include <optional>
#include <string>

#include "arrays.h"
#include "errors.h"
#include "glissade/io/bal.h"
#include "glissade/io/colmap.h"
#include "glissade/io/colmap_graph.h"
#include "glissade/io/g2o.h"
#include "glissade/io/ply.h"
#include "glissade/io/viowin.h"
#include "glissade/sim/bal_scene.h"
#include "glissade/sim/city.h"
#include "glissade/sim/course_scene.h"
#include "glissade/sim/windows.h"
#include "handles.h"
#include "problem.h"

namespace glissade::python {

namespace {

/// Rows of the numbers of vertices.
template <class V>
OutArray ValuesOf(const std::vector<V>& vertices) {
  std::vector<double> values;
  values.reserve(vertices.size() * V::kAmbientDim);
  for (const V& v : vertices)
    values.insert(values.end(), v.Data(), v.Data() + V::kAmbientDim);
  return Own(std::move(values), {vertices.size(), static_cast<std::size_t>(V::kAmbientDim)});
}

nb::tuple AddBalProblem(const BalProblem& bal, const Loss& loss) {
  auto problem = std::make_unique<PyProblem>();
  BalHandles handles;
  {
    const nb::gil_scoped_release release;
    auto added = AddToGraph(bal, problem->write(), loss);
    if (added.ok())
      handles = std::move(added).value();
    else {
      const nb::gil_scoped_acquire acquire;
      Raise(added.status());
    }
  }
  return nb::make_tuple(nb::cast(std::move(problem)), ArrayOf<AnyVertex>(handles.cameras),
                        ArrayOf<AnyVertex>(handles.points), ArrayOf<AnyEdge>(handles.edges));
}

void BindBal(nb::module_& m, nb::class_<PyProblem>& problem) {
  nb::class_<BalProblem>(m, "BalProblem", "The content of a BAL file (read_bal).")
      .def_prop_ro(
          "cameras", [](const BalProblem& b) { return ValuesOf(b.cameras); },
          "(n, 9): rotation vector, translation, f, k1, k2")
      .def_prop_ro(
          "points", [](const BalProblem& b) { return ValuesOf(b.points); }, "(m, 3)")
      .def_prop_ro(
          "camera_indices",
          [](const BalProblem& b) {
            std::vector<std::int64_t> out;
            out.reserve(b.observations.size());
            for (const BalObservation& o : b.observations)
              out.push_back(o.camera);
            return Own(std::move(out));
          },
          "of each observation")
      .def_prop_ro(
          "point_indices",
          [](const BalProblem& b) {
            std::vector<std::int64_t> out;
            out.reserve(b.observations.size());
            for (const BalObservation& o : b.observations)
              out.push_back(o.point);
            return Own(std::move(out));
          },
          "of each observation")
      .def_prop_ro(
          "uv",
          [](const BalProblem& b) {
            std::vector<double> out;
            out.reserve(2 * b.observations.size());
            for (const BalObservation& o : b.observations) {
              out.push_back(o.u);
              out.push_back(o.v);
            }
            return Own(std::move(out), {b.observations.size(), 2});
          },
          "(k, 2) [px] from the image centre, y up")
      .def(
          "write", [](const BalProblem& b, const std::string& path) { Check(WriteBal(b, path)); },
          nb::arg("path"), "Writes text, .gz, .bz2 or (.bbal) binary, by the name.");
  m.def(
      "read_bal",
      [](const std::string& path) {
        return Unwrap([&] {
          const nb::gil_scoped_release release;
          return ReadBal(path);
        }());
      },
      nb::arg("path"), "Reads a BAL file: plain, .gz, .bz2 or binary.");
  constexpr auto kTuple = "tuple[Problem, VertexArray, VertexArray, EdgeArray]";
  problem
      .def_static(
          "from_bal",
          [](const std::string& path, const Loss& loss) {
            return AddBalProblem(Unwrap([&] {
                                   const nb::gil_scoped_release release;
                                   return ReadBal(path);
                                 }()),
                                 loss);
          },
          nb::arg("bal"), nb::arg("loss") = Loss(),
          nb::sig(
              std::string("def from_bal(bal: str, loss: Loss = ...) -> ").append(kTuple).c_str()),
          "A BAL file, or what read_bal() or make_city() gave, as a problem.\n\nReturns the "
          "problem, its cameras, points and edges, in the order of the file.")
      .def_static("from_bal", &AddBalProblem, nb::arg("bal"), nb::arg("loss") = Loss(),
                  nb::sig(std::string("def from_bal(bal: BalProblem, loss: Loss = ...) -> ")
                              .append(kTuple)
                              .c_str()))
      .def(
          "to_bal",
          [](PyProblem& p, const std::string& path) {
            const BalProblem bal = Unwrap(BalFromGraph(p.read()));
            Check(WriteBal(bal, path));
          },
          nb::arg("path"), "Writes a problem of BAL cameras and points.")
      .def(
          "to_ply",
          [](PyProblem& p, const std::string& path) {
            Check(WritePly(Unwrap(PlyOfGraph(p.read())), path));
          },
          nb::arg("path"), "Writes points, coloured by their errors, and cameras for MeshLab.");
}

void BindColmap(nb::module_& m, nb::class_<PyProblem>& problem) {
  struct Scene {
    ColmapModel model;
    ColmapHandles handles;
  };
  nb::class_<Scene>(m, "ColmapScene", "A COLMAP model and where it went in a problem.")
      .def_prop_ro(
          "images",
          [](const Scene& s) {
            VertexArray out;
            for (const auto& h : s.handles.images) {
              if (AnyVertex(h)) out.handles.push_back(h);
            }
            return out;
          },
          "Poses T_world_camera of the images that take part")
      .def_prop_ro(
          "cameras",
          [](const Scene& s) {
            VertexArray out;
            for (const AnyVertex& h : s.handles.cameras) {
              if (h) out.handles.push_back(h);
            }
            return out;
          },
          "Intrinsics, as vectors")
      .def_prop_ro("points",
                   [](const Scene& s) {
                     VertexArray out;
                     for (const auto& h : s.handles.points) {
                       if (AnyVertex(h)) out.handles.push_back(h);
                     }
                     return out;
                   })
      .def_prop_ro("num_observations", [](const Scene& s) { return s.handles.num_observations; })
      .def(
          "write",
          [](Scene& s, PyProblem& p, const std::string& folder, bool text) {
            ColmapModel model = s.model;
            Check(UpdateFromGraph(p.read(), s.handles, &model));
            Check(WriteColmap(model, folder, text ? ColmapFormat::kText : ColmapFormat::kBinary));
          },
          nb::arg("problem"), nb::arg("folder"), nb::arg("text") = false,
          "Writes the model with what the problem has now.");
  problem.def_static(
      "from_colmap",
      [](const std::string& folder, bool focal, bool principal, bool distortion, bool fix,
         const Loss& loss) {
        auto scene = std::make_unique<Scene>();
        scene->model = Unwrap(ReadColmap(folder));
        auto p = std::make_unique<PyProblem>();
        scene->handles =
            Unwrap(AddToGraph(scene->model, p->write(), {focal, principal, distortion, fix, loss}));
        return nb::make_tuple(nb::cast(std::move(p)), nb::cast(std::move(scene)));
      },
      nb::arg("folder"), nb::kw_only(), nb::arg("free_focal_length") = true,
      nb::arg("free_principal_point") = false, nb::arg("free_distortion") = true,
      nb::arg("fix_first_image") = false, nb::arg("loss") = Loss(),
      nb::sig("def from_colmap(folder: str, *, free_focal_length: bool = True, "
              "free_principal_point: bool = False, free_distortion: bool = True, fix_first_image: "
              "bool = False, loss: Loss = ...) -> tuple[Problem, ColmapScene]"),
      "A COLMAP model, text or binary, as a problem.");
}

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
      "read_viowin", [](const std::string& path) { return Unwrap(ReadViowin(path)); },
      nb::arg("path"), "Reads all windows of a VIOWIN file.");
  m.def(
      "write_viowin",
      [](const std::vector<ViowinWindow>& windows, const std::string& path) {
        Check(WriteViowin(windows, path));
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

void BindG2o(nb::module_& m, nb::class_<PyProblem>& problem) {
  struct Scene {
    G2oProblem content;
    G2oHandles handles;
  };
  nb::class_<Scene>(m, "G2oScene", "A file of g2o and where it went in a problem.")
      .def_prop_ro("poses", [](const Scene& s) { return ArrayOf<AnyVertex>(s.handles.poses); })
      .def_prop_ro("points", [](const Scene& s) { return ArrayOf<AnyVertex>(s.handles.points); })
      .def_prop_ro(
          "cameras", [](const Scene& s) { return ArrayOf<AnyVertex>(s.handles.cameras); },
          "Poses T_world_camera of VERTEX_CAM")
      .def_prop_ro("relative_poses",
                   [](const Scene& s) { return ArrayOf<AnyEdge>(s.handles.relative_poses); })
      .def_prop_ro(
          "held",
          [](const Scene& s) -> std::optional<std::int64_t> {
            if (s.handles.held < 0) return std::nullopt;
            return s.handles.held;
          },
          "id of the vertex that is held since nothing else is; None where something is")
      .def(
          "write",
          [](Scene& s, PyProblem& p, const std::string& path) {
            G2oProblem content = s.content;
            Check(UpdateFromGraph(p.read(), s.handles, &content));
            Check(WriteG2o(content, path));
          },
          nb::arg("problem"), nb::arg("path"), "Writes the file with what the problem has now.");
  problem
      .def_static(
          "from_g2o",
          [](const std::string& path, bool hold_first, bool keep_other_tags, const Loss& loss) {
            auto scene = std::make_unique<Scene>();
            scene->content = Unwrap(
                ReadG2o(path, keep_other_tags ? G2oOtherTags::kKeep : G2oOtherTags::kRefuse));
            auto p = std::make_unique<PyProblem>();
            scene->handles = Unwrap(AddToGraph(scene->content, p->write(), {loss, hold_first}));
            return nb::make_tuple(nb::cast(std::move(p)), nb::cast(std::move(scene)));
          },
          nb::arg("path"), nb::kw_only(), nb::arg("hold_first") = true,
          nb::arg("keep_other_tags") = false, nb::arg("loss") = Loss(),
          nb::sig("def from_g2o(path: str, *, hold_first: bool = True, keep_other_tags: bool "
                  "= False, loss: Loss = ...) -> tuple[Problem, G2oScene]"),
          "A file of g2o: pose graphs in 3-D, landmarks, known cameras.\n\nhold_first: holds "
          "the first pose where nothing is fixed and none has a prior. keep_other_tags: lines "
          "that are not understood are kept for write() instead of refused.")
      .def(
          "to_g2o",
          [](PyProblem& p, const std::string& path) {
            Check(WriteG2o(Unwrap(G2oFromGraph(p.read())), path));
          },
          nb::arg("path"), "Writes a problem of poses, points, relative poses and pose priors.");
}

void BindScenes(nb::module_& m, nb::class_<PyProblem>& problem) {
  m.def(
      "make_window",
      [](int num_keyframes, int landmarks_per_keyframe, std::uint64_t seed) {
        sim::WindowMakerOptions options;
        options.num_keyframes = num_keyframes;
        options.landmarks_per_keyframe = landmarks_per_keyframe;
        return Unwrap(sim::MakeWindow(options, seed));
      },
      nb::arg("num_keyframes") = 10, nb::arg("landmarks_per_keyframe") = 25, nb::arg("seed") = 1,
      "A simulated visual-inertial window, the same for the same seed.");
  m.def(
      "make_ring",
      [](int num_cameras, int num_points, double pixel_noise, std::uint64_t seed) {
        sim::BalSceneOptions options;
        options.num_cameras = num_cameras;
        options.num_points = num_points;
        options.pixel_noise = pixel_noise;
        options.seed = seed;
        return Unwrap(sim::MakeBalScene(options));
      },
      nb::arg("num_cameras") = 16, nb::arg("num_points") = 300, nb::arg("pixel_noise") = 0.5,
      nb::arg("seed") = 1, "Cameras on a ring around a cloud of points.");
  m.def(
      "make_city",
      [](int num_cameras, double pixel_noise, double outlier_share, std::uint64_t seed) {
        sim::CityOptions options;
        options.num_cameras = num_cameras;
        options.pixel_noise = pixel_noise;
        options.outlier_share = outlier_share;
        options.seed = seed;
        return Unwrap([&] {
          const nb::gil_scoped_release release;
          return sim::MakeCity(options);
        }());
      },
      nb::arg("num_cameras") = 200, nb::arg("pixel_noise") = 0.5, nb::arg("outlier_share") = 0.0,
      nb::arg("seed") = 1, "A car's images of a city: 20 to 20 000 cameras.");
  nb::class_<CourseHandles>(m, "CourseHandles", "Where the course's scene went.")
      .def_prop_ro("poses", [](const CourseHandles& h) { return ArrayOf<AnyVertex>(h.poses); })
      .def_prop_ro("depths", [](const CourseHandles& h) { return ArrayOf<AnyVertex>(h.points); })
      .def_prop_ro("reprojections",
                   [](const CourseHandles& h) { return ArrayOf<AnyEdge>(h.edges); })
      .def_prop_ro("priors", [](const CourseHandles& h) { return ArrayOf<AnyEdge>(h.priors); });
  problem.def(
      "add_course_scene",
      [](PyProblem& p, int fix_poses, double prior_weight, int num_priors) {
        return p.Seen(
            AddToGraph(MakeCourseScene(), p.write(), {fix_poses, prior_weight, num_priors}));
      },
      nb::arg("fix_poses") = 0, nb::arg("prior_weight") = 0.0, nb::arg("num_priors") = 2,
      "The scene of testMonoBA: 3 poses on a circle, 20 points.");
}

}  // namespace

void BindFiles(nb::module_& m, nb::class_<PyProblem>& problem) {
  BindBal(m, problem);
  BindColmap(m, problem);
  BindViowin(m, problem);
  BindG2o(m, problem);
  BindScenes(m, problem);
}

}  // namespace glissade::python
