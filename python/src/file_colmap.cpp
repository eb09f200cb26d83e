// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <string>

#include "arrays.h"
#include "errors.h"
#include "file_path.h"
#include "glissade/io/colmap.h"
#include "glissade/io/colmap_graph.h"
#include "handles.h"
#include "problem.h"

namespace glissade::python {

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
          [](Scene& s, PyProblem& p, const FilePath& folder, bool text) {
            ColmapModel model = s.model;
            Check(UpdateFromGraph(p.read(), s.handles, &model));
            Check(WriteColmap(model, folder.text,
                              text ? ColmapFormat::kText : ColmapFormat::kBinary));
          },
          nb::arg("problem"), nb::arg("folder"), nb::arg("text") = false,
          "Writes the model with what the problem has now.");
  problem.def_static(
      "from_colmap",
      [](const FilePath& folder, bool focal, bool principal, bool distortion, bool fix,
         const Loss& loss) {
        auto scene = std::make_unique<Scene>();
        scene->model = Unwrap(ReadColmap(folder.text));
        auto p = std::make_unique<PyProblem>();
        scene->handles =
            Unwrap(AddToGraph(scene->model, p->write(), {focal, principal, distortion, fix, loss}));
        return nb::make_tuple(nb::cast(std::move(p)), nb::cast(std::move(scene)));
      },
      nb::arg("folder"), nb::kw_only(), nb::arg("free_focal_length") = true,
      nb::arg("free_principal_point") = false, nb::arg("free_distortion") = true,
      nb::arg("fix_first_image") = false, nb::arg("loss") = Loss(),
      nb::sig("def from_colmap(folder: str | os.PathLike[str], *, free_focal_length: bool = True, "
              "free_principal_point: bool = False, free_distortion: bool = True, fix_first_image: "
              "bool = False, loss: Loss = ...) -> tuple[Problem, ColmapScene]"),
      "A COLMAP model, text or binary, as a problem.");
}

}  // namespace glissade::python
