// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
// Adding edges whose residual is written in Python, and checking their
// Jacobians.
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>

#include "add_edges.h"
#include "arrays.h"
#include "glissade/graph/pools.h"
#include "python_batch.h"

namespace glissade::python {

namespace {

/// residual_dim of what must be an object with residual() and jacobian.
int ResidualDimOf(const nb::object& kind) {
  if (PyType_Check(kind.ptr())) {
    throw nb::type_error("the kind must be an object, not its class: write Kind()");
  }
  for (const char* name : {"residual", "jacobian", "residual_dim"}) {
    if (!nb::hasattr(kind, name)) {
      throw nb::type_error("the kind must be an object of a class derived from glissade.EdgeKind");
    }
  }
  const nb::object dim = kind.attr("residual_dim");
  constexpr long kMost = 1000;
  const long rows = PyLong_Check(dim.ptr()) ? PyLong_AsLong(dim.ptr()) : 0;
  if (rows < 1 || rows > kMost) {
    PyErr_Clear();
    throw nb::value_error("residual_dim must be an integer from 1 to 1000");
  }
  return static_cast<int>(rows);
}

EdgeArray AddPythonEdges(PyProblem& p, nb::object kind, const nb::object& vertices_given,
                         const nb::args& data, const std::optional<ArrayLike>& sqrt_information,
                         const std::optional<ArrayLike>& information, const Loss& loss) {
  Problem& problem = p.write();
  std::vector<VertexArray> vertices;
  if (VertexArray alone; nb::try_cast(vertices_given, alone)) {
    vertices.push_back(alone);  // edges on one vertex each
  } else if (!nb::try_cast(vertices_given, vertices)) {
    throw nb::type_error("vertices must be a list of VertexArrays, one for each vertex of an edge");
  }
  if (vertices.empty()) throw nb::value_error("an edge needs a vertex");
  const int rows = ResidualDimOf(kind);
  std::vector<NamedVertices> named;
  for (const VertexArray& v : vertices)
    named.push_back({&v, "vertices"});
  std::vector<nb::object> arrays;
  std::size_t rows_of_data = 0;
  nb::object numpy = nb::module_::import_("numpy");
  for (nb::handle item : data) {
    // A copy that nobody writes to: the residual is a function of it.
    arrays.push_back(numpy.attr("array")(item));
    arrays.back().attr("flags").attr("writeable") = false;
    if (nb::cast<int>(arrays.back().attr("ndim")) == 0) {
      throw nb::value_error("data must be arrays with a row for each edge");
    }
    rows_of_data = std::max(rows_of_data, nb::len(arrays.back()));
  }
  const std::size_t n = NumEdges(named, rows_of_data);
  for (const nb::object& array : arrays) {
    if (nb::len(array) != n) {
      throw nb::value_error(std::string("data must have ")
                                .append(std::to_string(n))
                                .append(" rows, one for each edge")
                                .c_str());
    }
  }
  std::vector<const VertexOps*> types;
  for (const VertexArray& v : vertices) {
    for (const AnyVertex& vertex : v.handles) {
      if (!problem.Contains(vertex)) Raise(problem.UnknownHandle(vertex));
      if (vertex.type != v[0].type) WrongType({&v, "vertices of one place"}, v[0].type->name);
    }
    if (v.size() == 0) return {};
    types.push_back(&problem.PoolOf(v[0].type)->ops());
  }
  Weights weights(sqrt_information, information, static_cast<std::size_t>(rows), n);
  if (!weights.is_finite()) {
    Raise(Status(StatusCode::kNotFinite, "the weight of an edge is not finite"));
  }
  if (!weights.is_identity() && !weights.is_sqrt()) {
    std::vector<double> sqrt;
    const auto r = static_cast<std::size_t>(rows);
    for (std::size_t k = 0; k < (weights.same_for_all() ? 1 : n); ++k) {
      sqrt.resize((k + 1) * r * r);
      if (!internal::SqrtOfInformation(rows, weights.Of(k), sqrt.data() + k * r * r)) {
        Raise(Status(StatusCode::kNotPositive,
                     "information is not symmetric and positive semi-definite"));
      }
    }
    weights.SetSqrt(std::move(sqrt));
  }
  const auto batch =
      std::make_shared<const PythonBatch>(std::move(kind), std::move(arrays), std::move(types),
                                          static_cast<std::size_t>(rows), n, std::move(weights));
  EdgeArray added;
  added.handles.reserve(n);
  std::vector<AnyVertex> of_edge(vertices.size());
  for (std::size_t k = 0; k < n; ++k) {
    for (std::size_t i = 0; i < vertices.size(); ++i)
      of_edge[i] = vertices[i].ForEach(k);
    const auto edge = problem.AddEdge(std::make_unique<PythonEdge>(batch, k), of_edge, loss);
    if (!edge.ok()) {
      for (const AnyEdge& e : added.handles)
        (void)problem.RemoveEdge(e);
      p.Seen(edge.status());
    }
    added.handles.push_back(AnyEdge(edge.value()));
  }
  return added;
}

double CheckJacobian(PyProblem& p, const EdgeArray& edges) {
  const Problem& problem = p.read();
  std::vector<std::vector<VertexRef>> refs(edges.size());
  std::vector<BatchedEdge> batched(edges.size());
  const PythonBatch* batch = nullptr;
  for (std::size_t k = 0; k < edges.size(); ++k) {
    const auto typed = edges[k].As<DynamicEdge>();
    const auto vertices = Unwrap(problem.VerticesOf(edges[k]));
    const auto* pool =
        typed ? static_cast<const DynamicEdgePool*>(problem.EdgePoolOf(edges[k].type)) : nullptr;
    const auto* edge =
        pool == nullptr
            ? nullptr
            : dynamic_cast<const PythonEdge*>(&pool->At(pool->slots().IndexOf(edges[k].slot)));
    if (edge == nullptr) throw nb::value_error("an edge that was not added by add_edges()");
    const auto* its = static_cast<const PythonBatch*>(edge->batch());
    if (batch != nullptr && its != batch) throw nb::value_error("the edges of one add_edges()");
    batch = its;
    for (const AnyVertex& v : vertices) {
      const VertexPoolBase* of = problem.PoolOf(v.type);
      refs[k].push_back({&of->ops(), of->Data(of->slots().IndexOf(v.slot))});
    }
    batched[k].edge = edge;
    batched[k].vertices = refs[k];
  }
  if (batch == nullptr) return 0.0;
  return p.Ask([&](const Problem&) { return batch->CompareJacobians(batched); });
}

}  // namespace

void BindEdgeKinds(nb::module_&, nb::class_<PyProblem>& problem) {
  problem
      .def("add_edges", &AddPythonEdges, nb::arg("kind"), nb::arg("vertices"), nb::arg("data"),
           nb::arg("sqrt_information") = nb::none(), nb::arg("information") = nb::none(),
           nb::arg("loss") = Loss(),
           nb::sig("def add_edges(self, kind: glissade._edge_kind.EdgeKind, vertices: VertexArray "
                   "| collections.abc.Sequence[VertexArray], *data: numpy.typing.ArrayLike, "
                   "sqrt_information: numpy.typing.ArrayLike | None = None, information: "
                   "numpy.typing.ArrayLike | None = None, loss: Loss = ...) -> EdgeArray"),
           "Adds edges whose residual is written in Python (glissade.EdgeKind).\n\nvertices: an "
           "array for each vertex of an edge. data: arrays with a row for each edge, handed to "
           "residual() and jacobian() after the states. All edges of one call are evaluated "
           "together.")
      .def("check_jacobian", &CheckJacobian, nb::arg("edges"),
           "The largest |J - differences| / (1 + |differences|) of edges that one add_edges() "
           "added, at the present values; about 1e-9 where jacobian() is right.");
}

}  // namespace glissade::python
