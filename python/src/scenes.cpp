// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include "arrays.h"
#include "errors.h"
#include "glissade/sim/bal_scene.h"
#include "glissade/sim/city.h"
#include "glissade/sim/course_scene.h"
#include "glissade/sim/windows.h"
#include "handles.h"
#include "problem.h"
#include "unlocked.h"

namespace glissade::python {

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
          const Unlocked unlocked;
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

}  // namespace glissade::python
