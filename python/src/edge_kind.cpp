// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
// Edges whose residual is a Python function on all edges that were added together.
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
#include "glissade/edges/edge_batch.h"
#include "glissade/graph/pools.h"

namespace glissade::python {

namespace {

/// A reference that may be let go of by a thread without the interpreter's lock.
class Kept {
 public:
  explicit Kept(nb::object object) : object_(std::move(object)) {}
  ~Kept() {
    const nb::gil_scoped_acquire acquire;
    object_.reset();
  }
  Kept(const Kept&) = delete;
  Kept& operator=(const Kept&) = delete;
  [[nodiscard]] const nb::object& get() const { return object_; }

 private:
  nb::object object_;
};

class PythonBatch;

class PythonEdge final : public DynamicEdge {
 public:
  PythonEdge(std::shared_ptr<const PythonBatch> batch, std::size_t row)
      : batch_(std::move(batch)), row_(row) {}
  [[nodiscard]] std::size_t row() const { return row_; }
  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const> vertices) const override;
  [[nodiscard]] int ResidualDim() const override;
  bool Evaluate(std::span<const VertexRef> vertices, double* residual,
                double* const* jacobians) const override;
  [[nodiscard]] const EdgeBatch* batch() const override;
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override {
    return std::make_unique<PythonEdge>(*this);
  }

 private:
  std::shared_ptr<const PythonBatch> batch_;
  std::size_t row_;  // in the data of the batch
};

class PythonBatch final : public EdgeBatch {
 public:
  PythonBatch(nb::object kind, std::vector<nb::object> data, std::vector<const VertexOps*> types,
              std::size_t rows, std::size_t num_edges, Weights weights)
      : kind_(kind),
        types_(std::move(types)),
        rows_(rows),
        num_edges_(num_edges),
        weights_(std::move(weights)) {
    for (nb::object& array : data)
      data_.push_back(std::make_unique<Kept>(std::move(array)));
    has_jacobian_ = !kind.attr("jacobian").is_none();
  }

  [[nodiscard]] const std::vector<const VertexOps*>& types() const { return types_; }
  [[nodiscard]] std::size_t rows() const { return rows_; }

  void Evaluate(std::span<BatchedEdge> edges) const override {
    if (edges.empty()) return;
    const nb::gil_scoped_acquire acquire;
    const Arguments arguments = Gather(edges);
    WriteResiduals(Residual(arguments), edges);
    if (edges[0].jacobians == nullptr) return;
    if (has_jacobian_) {
      WriteJacobians(arguments, edges);
    } else {
      WriteDifferences(arguments, edges);
    }
  }

  /// Largest |J - differences| / (1 + |differences|) over all edges and numbers.
  [[nodiscard]] double CompareJacobians(std::span<BatchedEdge> edges) const {
    const Arguments arguments = Gather(edges);
    std::size_t columns = 0;
    for (const VertexOps* ops : types_)
      columns += static_cast<std::size_t>(ops->tangent_dim);
    std::vector<double> by_kind(edges.size() * rows_ * columns), by_differences(by_kind.size());
    std::vector<double*> blocks(edges.size() * types_.size());
    const auto point_at = [&](std::vector<double>& all) {
      double* at = all.data();
      for (std::size_t k = 0; k < edges.size(); ++k) {
        for (std::size_t i = 0; i < types_.size(); ++i) {
          blocks[k * types_.size() + i] = at;
          at += rows_ * static_cast<std::size_t>(types_[i]->tangent_dim);
        }
        edges[k].jacobians = blocks.data() + k * types_.size();
      }
    };
    point_at(by_differences);
    WriteDifferences(arguments, edges);
    if (!has_jacobian_) return 0.0;
    point_at(by_kind);
    WriteJacobians(arguments, edges);
    double worst = 0.0;
    for (std::size_t k = 0; k < by_kind.size(); ++k) {
      const double error =
          std::abs(by_kind[k] - by_differences[k]) / (1.0 + std::abs(by_differences[k]));
      if (!(error <= worst)) worst = error;
    }
    return worst;
  }

 private:
  using Matrices = nb::ndarray<nb::numpy, const double, nb::c_contig, nb::device::cpu>;
  struct Arguments {
    std::vector<std::vector<double>> states;
    std::vector<nb::object> arrays;  // the states, then the data
  };

  /// The rows of the batch that are asked for, in the order of the edges.
  Arguments Gather(std::span<const BatchedEdge> edges) const {
    Arguments out;
    const std::size_t n = edges.size();
    for (std::size_t i = 0; i < types_.size(); ++i) {
      const auto dim = static_cast<std::size_t>(types_[i]->ambient_dim);
      std::vector<double> states(n * dim);
      for (std::size_t k = 0; k < n; ++k)
        std::copy_n(edges[k].vertices[i].data, dim, states.data() + k * dim);
      out.states.push_back(states);  // differences start from them, whatever residual() does
      out.arrays.push_back(nb::cast(Own(std::move(states), {n, dim})));
    }
    const auto row = [&](std::size_t k) {
      return static_cast<const PythonEdge*>(edges[k].edge)->row();
    };
    bool all = n == num_edges_;
    for (std::size_t k = 0; all && k < n; ++k)
      all = row(k) == k;
    nb::object picked;
    for (const auto& data : data_) {
      if (all) {
        out.arrays.push_back(data->get());
        continue;
      }
      if (!picked.is_valid()) {
        std::vector<std::int64_t> rows(n);
        for (std::size_t k = 0; k < n; ++k)
          rows[k] = static_cast<std::int64_t>(row(k));
        picked = nb::cast(Own(std::move(rows)));
      }
      out.arrays.push_back(data->get()[picked]);
    }
    return out;
  }

  static nb::object Call(nb::handle function, const std::vector<nb::object>& arrays) {
    nb::object arguments = nb::steal(PyTuple_New(static_cast<Py_ssize_t>(arrays.size())));
    for (std::size_t k = 0; k < arrays.size(); ++k) {
      PyTuple_SetItem(arguments.ptr(), static_cast<Py_ssize_t>(k),
                      nb::object(arrays[k]).release().ptr());
    }
    PyObject* result = PyObject_CallObject(function.ptr(), arguments.ptr());
    if (result == nullptr) throw nb::python_error();
    return nb::steal(result);
  }

  [[nodiscard]] ArrayLike Converted(nb::handle value, const std::string& what,
                                    std::initializer_list<std::size_t> shape) const {
    ArrayLike out;
    bool fits = nb::try_cast(value, out) && out.ndim() == shape.size();
    std::string wanted = "(";
    std::size_t i = 0;
    for (const std::size_t s : shape) {
      fits = fits && out.dim(i++) == s;
      wanted.append(wanted.size() > 1 ? ", " : "").append(std::to_string(s));
    }
    if (!fits) {
      std::string message(what);
      message.append(" must return numbers of the shape ").append(wanted).append(")");
      if (nb::hasattr(value, "shape")) {
        message.append(", not ").append(nb::str(nb::object(value.attr("shape"))).c_str());
      }
      throw nb::value_error(message.c_str());
    }
    return out;
  }
  [[nodiscard]] std::string Name(const char* function) const {
    const nb::object type(kind_.get().type().attr("__name__"));
    return std::string(nb::str(type).c_str()).append(".").append(function).append("()");
  }

  [[nodiscard]] ArrayLike Residual(const Arguments& arguments) const {
    nb::object value = Call(kind_.get().attr("residual"), arguments.arrays);
    const std::size_t n =
        arguments.states.empty()
            ? 0
            : arguments.states[0].size() / static_cast<std::size_t>(types_[0]->ambient_dim);
    return Converted(value, Name("residual"), {n, rows_});
  }

  /// out <- L in of edge k, in: rows_ x columns.
  void Weigh(const BatchedEdge& edge, const double* in, std::size_t columns, double* out) const {
    if (weights_.is_identity()) {
      std::copy_n(in, rows_ * columns, out);
      return;
    }
    const double* L = weights_.Of(static_cast<const PythonEdge*>(edge.edge)->row());
    for (std::size_t r = 0; r < rows_; ++r) {
      for (std::size_t c = 0; c < columns; ++c) {
        double sum = 0.0;
        for (std::size_t k = 0; k < rows_; ++k)
          sum += L[r * rows_ + k] * in[k * columns + c];
        out[r * columns + c] = sum;
      }
    }
  }

  void WriteResiduals(const ArrayLike& residual, std::span<BatchedEdge> edges) const {
    for (std::size_t k = 0; k < edges.size(); ++k) {
      Weigh(edges[k], residual.data() + k * rows_, 1, edges[k].residual);
      edges[k].has_value = std::all_of(edges[k].residual, edges[k].residual + rows_,
                                       [](double x) { return std::isfinite(x); });
    }
  }

  void WriteJacobians(const Arguments& arguments, std::span<BatchedEdge> edges) const {
    nb::object value = Call(kind_.get().attr("jacobian"), arguments.arrays);
    if (types_.size() == 1 && nb::hasattr(value, "shape")) value = nb::make_tuple(value);
    if (!PySequence_Check(value.ptr()) || nb::len(value) != types_.size()) {
      throw nb::value_error(Name("jacobian")
                                .append(" must return ")
                                .append(std::to_string(types_.size()))
                                .append(" arrays, one for each vertex")
                                .c_str());
    }
    for (std::size_t i = 0; i < types_.size(); ++i) {
      const auto dim = static_cast<std::size_t>(types_[i]->tangent_dim);
      nb::object item = value[i];
      const ArrayLike J =
          Converted(item, Name("jacobian").append("[").append(std::to_string(i)).append("]"),
                    {edges.size(), rows_, dim});
      for (std::size_t k = 0; k < edges.size(); ++k) {
        if (edges[k].jacobians[i] == nullptr) continue;
        Weigh(edges[k], J.data() + k * rows_ * dim, dim, edges[k].jacobians[i]);
      }
    }
  }

  /// By central differences in the tangent, the residual of all edges at once.
  void WriteDifferences(const Arguments& at, std::span<BatchedEdge> edges) const {
    const std::size_t n = edges.size();
    std::vector<double> column(rows_), weighed(rows_);
    for (std::size_t i = 0; i < types_.size(); ++i) {
      const VertexOps& ops = *types_[i];
      const auto ambient = static_cast<std::size_t>(ops.ambient_dim);
      const auto dim = static_cast<std::size_t>(ops.tangent_dim);
      std::vector<double> steps(n);
      std::vector<double> delta(dim);
      for (std::size_t c = 0; c < dim; ++c) {
        const auto moved = [&](double sign) {
          Arguments there = at;
          std::vector<double> states(n * ambient);
          for (std::size_t k = 0; k < n; ++k) {
            const double* x = at.states[i].data() + k * ambient;
            // The cube root of the rounding, of the size of the number where it is a sum.
            const double size = ops.additive ? std::max(1.0, std::abs(x[c])) : 1.0;
            steps[k] = 6e-6 * size;
            std::fill(delta.begin(), delta.end(), 0.0);
            delta[c] = sign * steps[k];
            ops.plus(x, delta.data(), states.data() + k * ambient);
          }
          there.arrays[i] = nb::cast(Own(std::move(states), {n, ambient}));
          return Residual(there);
        };
        const ArrayLike ahead = moved(1.0), behind = moved(-1.0);
        for (std::size_t k = 0; k < n; ++k) {
          if (edges[k].jacobians[i] == nullptr) continue;
          for (std::size_t r = 0; r < rows_; ++r)
            column[r] =
                (ahead.data()[k * rows_ + r] - behind.data()[k * rows_ + r]) / (2.0 * steps[k]);
          Weigh(edges[k], column.data(), 1, weighed.data());
          for (std::size_t r = 0; r < rows_; ++r)
            edges[k].jacobians[i][r * dim + c] = weighed[r];
        }
      }
    }
  }

  Kept kind_;
  std::vector<std::unique_ptr<Kept>> data_;
  std::vector<const VertexOps*> types_;
  std::size_t rows_, num_edges_;
  Weights weights_;
  bool has_jacobian_ = false;
};

Status PythonEdge::CheckVertices(std::span<const VertexOps* const>) const {
  return {};
}
int PythonEdge::ResidualDim() const {
  return static_cast<int>(batch_->rows());
}
const EdgeBatch* PythonEdge::batch() const {
  return batch_.get();
}

bool PythonEdge::Evaluate(std::span<const VertexRef> vertices, double* residual,
                          double* const* jacobians) const {
  BatchedEdge edge{this, vertices, residual, jacobians, false};
  // Some pointers may be null, which WriteJacobians knows.
  batch_->Evaluate({&edge, 1});
  return edge.has_value;
}

EdgeArray AddPythonEdges(PyProblem& p, nb::object kind, const std::vector<VertexArray>& vertices,
                         const nb::args& data, const std::optional<ArrayLike>& sqrt_information,
                         const std::optional<ArrayLike>& information, const Loss& loss) {
  Problem& problem = p.write();
  if (vertices.empty()) throw nb::value_error("an edge needs a vertex");
  if (!nb::hasattr(kind, "residual") || !nb::hasattr(kind, "jacobian") ||
      !nb::hasattr(kind, "residual_dim")) {
    throw nb::type_error("the kind must be an object of a class derived from glissade.EdgeKind");
  }
  const int rows = nb::cast<int>(kind.attr("residual_dim"));
  if (rows < 1) throw nb::value_error("residual_dim must be 1 or more");
  std::vector<NamedVertices> named;
  for (const VertexArray& v : vertices)
    named.push_back({&v, "vertices"});
  std::vector<nb::object> arrays;
  std::size_t rows_of_data = 0;
  nb::object numpy = nb::module_::import_("numpy");
  for (nb::handle item : data) {
    arrays.push_back(numpy.attr("asarray")(item));
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
  return batch == nullptr ? 0.0 : batch->CompareJacobians(batched);
}

}  // namespace

void BindEdgeKinds(nb::module_&, nb::class_<PyProblem>& problem) {
  problem
      .def("add_edges", &AddPythonEdges, nb::arg("kind"), nb::arg("vertices"), nb::arg("data"),
           nb::arg("sqrt_information") = nb::none(), nb::arg("information") = nb::none(),
           nb::arg("loss") = Loss(),
           nb::sig("def add_edges(self, kind: glissade._edge_kind.EdgeKind, vertices: "
                   "collections.abc.Sequence[VertexArray], *data: numpy.typing.ArrayLike, "
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
