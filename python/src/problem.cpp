// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem.h"

#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "errors.h"
#include "for_all.h"
#include "glissade/edges/dynamic.h"
#include "glissade/graph/pools.h"
#include "handles.h"

namespace glissade::python {

namespace {

OutArray Chi2OfEdges(PyProblem& p, const EdgeArray& edges) {
  std::vector<double> chi2(edges.size());
  p.Ask([&](const Problem& problem) {
    // Edges written in Python are asked together.
    const EdgePoolBase* pool = problem.EdgePoolOf(&kTypeInfo<DynamicEdge>);
    std::vector<double> batched;
    if (pool != nullptr && edges.size() > 1) batched = pool->BatchedChi2();
    for (std::size_t k = 0; k < chi2.size(); ++k) {
      double s = NAN;
      if (!batched.empty() && edges[k].type == pool->type() && problem.Contains(edges[k])) {
        s = batched[static_cast<std::size_t>(pool->slots().IndexOf(edges[k].slot))];
      }
      chi2[k] = std::isfinite(s) ? s : Unwrap(problem.Chi2(edges[k]));
    }
  });
  return Own(std::move(chi2), {edges.size()});
}

void BindQueries(nb::class_<PyProblem>& problem) {
  problem.def_prop_ro("num_vertices", [](PyProblem& p) { return p.read().NumVertices(); })
      .def_prop_ro("num_edges", [](PyProblem& p) { return p.read().NumEdges(); })
      .def(
          "vertices", [](PyProblem& p) { return VertexArray(p.read().Vertices()); },
          "All vertices: by type in the order of first use, in order of insertion.")
      .def(
          "edges", [](PyProblem& p) { return EdgeArray(p.read().Edges()); }, "All edges.")
      .def(
          "edges_of",
          [](PyProblem& p, const VertexArray& v) {
            return EdgeArray(Unwrap(p.read().EdgesOf(OnlyOne(v, "vertex"))));
          },
          nb::arg("vertex"), "The edges that touch a vertex.")
      .def(
          "vertices_of",
          [](PyProblem& p, const EdgeArray& e) {
            if (e.size() != 1) throw nb::value_error("one edge is needed");
            return VertexArray(Unwrap(p.read().VerticesOf(e[0])));
          },
          nb::arg("edge"), "The vertices of an edge, in the order of its type.")
      .def(
          "contains",
          [](PyProblem& p, const VertexArray& v) {
            return std::all_of(v.handles.begin(), v.handles.end(),
                               [&](AnyVertex x) { return p.read().Contains(x); });
          },
          nb::arg("vertices"), "Whether all of them are in the problem.")
      .def(
          "remove_vertices",
          [](PyProblem& p, const VertexArray& v, bool with_prior) {
            ExpectKnownOnce(p, v);
            Problem& problem = p.write();
            // One that is refused comes before any that goes.
            std::vector<AnyVertex> order = v.handles;
            std::stable_partition(order.begin(), order.end(),
                                  [&](AnyVertex x) { return problem.HasFirstEstimate(x); });
            for (const AnyVertex& x : order) {
              p.Seen(problem.RemoveVertex(
                  x, with_prior ? PriorOnVertex::kRemove : PriorOnVertex::kRefuse));
            }
          },
          nb::arg("vertices"), nb::arg("with_prior") = false,
          "Removes vertices and their edges. One under a marginal prior is refused unless the "
          "prior may go as well; marginalize() keeps what it knows.")
      .def(
          "remove_edges",
          [](PyProblem& p, const EdgeArray& edges) {
            ExpectKnownOnce(p, edges);
            for (const AnyEdge& e : edges.handles)
              p.Seen(p.write().RemoveEdge(e));
          },
          nb::arg("edges"), "Removes edges.")
      .def("chi2", &Chi2OfEdges, nb::arg("edges"),
           "s = r' Omega r of each edge, without 1/2 and loss: (n,).")
      .def(
          "cost",
          [](PyProblem& p) { return Unwrap(p.Ask([](const Problem& x) { return x.Cost(); })); },
          "1/2 sum rho(s) over all edges: what solve() minimizes.")
      .def(
          "depths",
          [](PyProblem& p, const EdgeArray& edges) {
            std::vector<double> depths;
            for (const AnyEdge& e : edges.handles)
              depths.push_back(Unwrap(p.read().DepthOf(e)));
            const std::size_t n = depths.size();
            return Own(std::move(depths), {n});
          },
          nb::arg("edges"), "Depth [m] of the observed point in the observing camera: (n,).")
      .def(
          "outliers",
          [](PyProblem& p, double max_chi2, double min_depth) {
            return EdgeArray(p.Ask([&](const Problem& x) {
              return x.GetOutlierEdges({max_chi2, min_depth});
            }));
          },
          nb::arg("max_chi2") = OutlierOptions().max_chi2,
          nb::arg("min_depth") = OutlierOptions().min_depth,
          "Observations by the built-in edges with chi2 over max_chi2 (default: 99 % of two "
          "degrees of freedom) or less depth than min_depth [m].")
      .def(
          "clone",
          [](PyProblem& p) { return std::make_unique<PyProblem>(Unwrap(p.read().Clone())); },
          "A deep copy. Handles of this problem are valid in it.")
      .def(
          "__deepcopy__",
          [](PyProblem& p, const nb::dict&) {
            return std::make_unique<PyProblem>(Unwrap(p.read().Clone()));
          },
          nb::arg("memo"),
          nb::sig("def __deepcopy__(self, memo: dict[int, typing.Any]) -> Problem"))
      .def("__repr__", [](PyProblem& p) {
        return std::string("<Problem: ")
            .append(std::to_string(p.read().NumVertices()))
            .append(" vertices, ")
            .append(std::to_string(p.read().NumEdges()))
            .append(" edges>");
      });
}

}  // namespace

Problem& PyProblem::read() {
  if (busy_ && worker_ != std::this_thread::get_id()) {
    throw nb::builtin_exception(nb::exception_type::runtime_error,
                                "another thread is working on this problem");
  }
  return problem_;
}

Problem& PyProblem::write() {
  if (busy_) {
    throw nb::builtin_exception(
        nb::exception_type::runtime_error,
        "the problem is being worked on: it can be read in a callback, not changed");
  }
  return problem_;
}

void PyProblem::Seen(const Status& status) {
  if (status.ok()) return;
  (void)problem_.AcknowledgeRefusal();
  Raise(status);
}

void BindProblem(nb::module_& m) {
  nb::enum_<Fix>(m, "Fix", "What of a vertex is held.")
      .value("FREE", Fix::kFree)
      .value("WHOLE", Fix::kWhole)
      .value("POSITION", Fix::kPosition)
      .value("POSITION_AND_YAW", Fix::kPositionAndYaw, "of a pose")
      .value("BIASES", Fix::kBiases, "both biases; the velocity stays free")
      .value("NUMBERS", Fix::kNumbers, "some numbers: Problem.fix_numbers()");
  auto problem = nb::class_<PyProblem>(
                     m, "Problem",
                     "A factor graph with everything that is needed to solve it.\n\nPoses are "
                     "T_world_body, 7 numbers: position [m], unit quaternion x y z w. SI "
                     "units.\nCalls that are refused raise glissade.Error and change nothing.\nNot "
                     "for use by two threads at once; solves run without the interpreter's lock.")
                     .def(nb::init<>());
  BindVertices(problem);
  BindQueries(problem);
  BindEdges(problem);
  BindImuEdges(problem);
  BindEdgeKinds(m, problem);
  BindSolve(m, problem);
  BindStudy(m, problem);
  BindMarginal(m, problem);
  BindFiles(m, problem);
}

}  // namespace glissade::python
