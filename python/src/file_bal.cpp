// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "files.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <memory>
#include <string>
#include <vector>

#include "arrays.h"
#include "errors.h"
#include "file_path.h"
#include "glissade/io/bal.h"
#include "glissade/io/ply.h"
#include "handles.h"
#include "problem.h"
#include "unlocked.h"
#include "vertex_values.h"

namespace glissade::python {

namespace {

nb::tuple AddBalProblem(const BalProblem& bal, const Loss& loss) {
  auto problem = std::make_unique<PyProblem>();
  BalHandles handles;
  {
    const Unlocked unlocked;
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

}  // namespace

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
          "write", [](const BalProblem& b, const FilePath& path) { Check(WriteBal(b, path.text)); },
          nb::arg("path"), "Writes text, .gz, .bz2 or (.bbal) binary, by the name.");
  m.def(
      "read_bal",
      [](const FilePath& path) {
        return Unwrap([&] {
          const Unlocked unlocked;
          return ReadBal(path.text);
        }());
      },
      nb::arg("path"), "Reads a BAL file: plain, .gz, .bz2 or binary.");
  constexpr auto kTuple = "tuple[Problem, VertexArray, VertexArray, EdgeArray]";
  problem
      .def_static(
          "from_bal",
          [](const FilePath& path, const Loss& loss) {
            return AddBalProblem(Unwrap([&] {
                                   const Unlocked unlocked;
                                   return ReadBal(path.text);
                                 }()),
                                 loss);
          },
          nb::arg("bal"), nb::arg("loss") = Loss(),
          nb::sig(std::string("def from_bal(bal: str | os.PathLike[str], loss: Loss = ...) -> ")
                      .append(kTuple)
                      .c_str()),
          "A BAL file, or what read_bal() or make_city() gave, as a problem.\n\nReturns the "
          "problem, its cameras, points and edges, in the order of the file.")
      .def_static("from_bal", &AddBalProblem, nb::arg("bal"), nb::arg("loss") = Loss(),
                  nb::sig(std::string("def from_bal(bal: BalProblem, loss: Loss = ...) -> ")
                              .append(kTuple)
                              .c_str()))
      .def(
          "to_bal",
          [](PyProblem& p, const FilePath& path) {
            const BalProblem bal = Unwrap(BalFromGraph(p.read()));
            Check(WriteBal(bal, path.text));
          },
          nb::arg("path"), "Writes a problem of BAL cameras and points.")
      .def(
          "to_ply",
          [](PyProblem& p, const FilePath& path) {
            Check(WritePly(Unwrap(PlyOfGraph(p.read())), path.text));
          },
          nb::arg("path"), "Writes points, coloured by their errors, and cameras for MeshLab.");
}

}  // namespace glissade::python
