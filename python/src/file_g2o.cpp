// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <optional>
#include <string>

#include "arrays.h"
#include "errors.h"
#include "file_path.h"
#include "glissade/io/g2o.h"
#include "handles.h"
#include "problem.h"

namespace glissade::python {

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
          [](Scene& s, PyProblem& p, const FilePath& path) {
            G2oProblem content = s.content;
            Check(UpdateFromGraph(p.read(), s.handles, &content));
            Check(WriteG2o(content, path.text));
          },
          nb::arg("problem"), nb::arg("path"), "Writes the file with what the problem has now.");
  problem
      .def_static(
          "from_g2o",
          [](const FilePath& path, bool hold_first, bool keep_other_tags, const Loss& loss) {
            auto scene = std::make_unique<Scene>();
            scene->content = Unwrap(
                ReadG2o(path.text, keep_other_tags ? G2oOtherTags::kKeep : G2oOtherTags::kRefuse));
            auto p = std::make_unique<PyProblem>();
            scene->handles = Unwrap(AddToGraph(scene->content, p->write(), {loss, hold_first}));
            return nb::make_tuple(nb::cast(std::move(p)), nb::cast(std::move(scene)));
          },
          nb::arg("path"), nb::kw_only(), nb::arg("hold_first") = true,
          nb::arg("keep_other_tags") = false, nb::arg("loss") = Loss(),
          nb::sig("def from_g2o(path: str | os.PathLike[str], *, hold_first: bool = True, "
                  "keep_other_tags: bool = False, loss: Loss = ...) -> tuple[Problem, G2oScene]"),
          "A file of g2o: pose graphs in 3-D, landmarks, known cameras.\n\nhold_first: holds the "
          "first pose where nothing is fixed and none has a prior. keep_other_tags: lines that are "
          "not understood are kept for write() instead of refused.")
      .def(
          "to_g2o",
          [](PyProblem& p, const FilePath& path) {
            Check(WriteG2o(Unwrap(G2oFromGraph(p.read())), path.text));
          },
          nb::arg("path"), "Writes a problem of poses, points, relative poses and pose priors.");
}

}  // namespace glissade::python
