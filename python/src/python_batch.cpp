// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "python_batch.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace glissade::python {

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

void PythonBatch::Evaluate(std::span<BatchedEdge> edges) const {
  if (edges.empty()) return;
  const nb::gil_scoped_acquire acquire;
  const Arguments arguments = Gather(edges);
  WriteResiduals(Residual(arguments, edges.size()), edges);
  if (edges[0].jacobians == nullptr) return;
  if (has_jacobian_) {
    WriteJacobians(arguments, edges);
  } else {
    WriteDifferences(arguments, edges);
  }
}

double PythonBatch::CompareJacobians(std::span<BatchedEdge> edges) const {
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

PythonBatch::Arguments PythonBatch::Gather(std::span<const BatchedEdge> edges) const {
  Arguments out;
  const std::size_t n = edges.size();
  for (std::size_t i = 0; i < types_.size(); ++i) {
    const auto dim = static_cast<std::size_t>(types_[i]->ambient_dim);
    std::vector<double> states(n * dim);
    for (std::size_t k = 0; k < n; ++k)
      std::copy_n(edges[k].vertices[i].data, dim, states.data() + k * dim);
    out.push_back(nb::cast(Own(std::move(states), {n, dim})));
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
      out.push_back(data->get());
      continue;
    }
    if (!picked.is_valid()) {
      std::vector<std::int64_t> rows(n);
      for (std::size_t k = 0; k < n; ++k)
        rows[k] = static_cast<std::int64_t>(row(k));
      picked = nb::cast(Own(std::move(rows)));
    }
    out.push_back(data->get()[picked]);
  }
  return out;
}

nb::object PythonBatch::Call(nb::handle function, const Arguments& arguments) {
  nb::object tuple = nb::steal(PyTuple_New(static_cast<Py_ssize_t>(arguments.size())));
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    PyTuple_SetItem(tuple.ptr(), static_cast<Py_ssize_t>(k),
                    nb::object(arguments[k]).release().ptr());
  }
  PyObject* result = PyObject_CallObject(function.ptr(), tuple.ptr());
  if (result == nullptr) throw nb::python_error();
  return nb::steal(result);
}

Doubles PythonBatch::Converted(nb::handle value, const std::string& what,
                               std::initializer_list<std::size_t> shape) const {
  Doubles out(ArrayLike{nb::borrow(value)},
              std::string("what ").append(what).append(" returns").c_str());
  bool fits = out.ndim() == shape.size();
  std::string wanted = "(";
  std::size_t i = 0;
  for (const std::size_t s : shape) {
    fits = fits && out.dim(i++) == s;
    wanted.append(wanted.size() > 1 ? ", " : "").append(std::to_string(s));
  }
  if (!fits) {
    std::string message(what);
    message.append(" must return numbers of the shape ").append(wanted).append("), not ");
    throw nb::value_error(message.append(out.Shape()).c_str());
  }
  return out;
}

std::string PythonBatch::Name(const char* function) const {
  const nb::object type(kind_.get().type().attr("__name__"));
  return std::string(nb::str(type).c_str()).append(".").append(function).append("()");
}

Doubles PythonBatch::Residual(const Arguments& arguments, std::size_t n) const {
  nb::object value = Call(kind_.get().attr("residual"), arguments);
  return Converted(value, Name("residual"), {n, rows_});
}

void PythonBatch::Weigh(const BatchedEdge& edge, const double* in, std::size_t columns,
                        double* out) const {
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

void PythonBatch::WriteResiduals(const Doubles& residual, std::span<BatchedEdge> edges) const {
  for (std::size_t k = 0; k < edges.size(); ++k) {
    Weigh(edges[k], residual.data() + k * rows_, 1, edges[k].residual);
    edges[k].has_value = std::all_of(edges[k].residual, edges[k].residual + rows_,
                                     [](double x) { return std::isfinite(x); });
  }
}

void PythonBatch::WriteJacobians(const Arguments& arguments, std::span<BatchedEdge> edges) const {
  nb::object value = Call(kind_.get().attr("jacobian"), arguments);
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
    const Doubles J =
        Converted(item, Name("jacobian").append("[").append(std::to_string(i)).append("]"),
                  {edges.size(), rows_, dim});
    for (std::size_t k = 0; k < edges.size(); ++k) {
      if (edges[k].jacobians[i] == nullptr) continue;
      Weigh(edges[k], J.data() + k * rows_ * dim, dim, edges[k].jacobians[i]);
    }
  }
}

void PythonBatch::WriteDifferences(const Arguments& at, std::span<BatchedEdge> edges) const {
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
          const double* x = edges[k].vertices[i].data;
          // The cube root of the rounding, of the size of the number where it
          // is a sum.
          const bool is_sum = ops.additive || (ops.type == &kTypeInfo<VertexPose> && c < 3);
          const double size = is_sum ? std::max(1.0, std::abs(x[c])) : 1.0;
          steps[k] = 6e-6 * size;
          std::fill(delta.begin(), delta.end(), 0.0);
          delta[c] = sign * steps[k];
          ops.plus(x, delta.data(), states.data() + k * ambient);
        }
        there[i] = nb::cast(Own(std::move(states), {n, ambient}));
        return Residual(there, n);
      };
      const Doubles ahead = moved(1.0), behind = moved(-1.0);
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

}  // namespace glissade::python
