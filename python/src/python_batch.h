// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <cstddef>
#include <initializer_list>
#include <memory>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "arrays.h"
#include "glissade/edges/dynamic.h"
#include "glissade/edges/edge_batch.h"
#include "glissade/vertices/pose.h"
#include "weights.h"

/// \file
/// Edges whose residual is a Python function on all edges that were added
/// together.
namespace glissade::python {

namespace nb = nanobind;

/// A reference that may be let go of by a thread without the interpreter's
/// lock.
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

  void Evaluate(std::span<BatchedEdge> edges) const override;

  /// Largest |J - differences| / (1 + |differences|) over all edges and
  /// numbers.
  [[nodiscard]] double CompareJacobians(std::span<BatchedEdge> edges) const;

 private:
  /// The states, then the data.
  using Arguments = std::vector<nb::object>;

  /// The rows of the batch that are asked for, in the order of the edges.
  Arguments Gather(std::span<const BatchedEdge> edges) const;

  static nb::object Call(nb::handle function, const Arguments& arguments);

  [[nodiscard]] Doubles Converted(nb::handle value, const std::string& what,
                                  std::initializer_list<std::size_t> shape) const;
  [[nodiscard]] std::string Name(const char* function) const;

  /// (n, rows_) of n edges.
  [[nodiscard]] Doubles Residual(const Arguments& arguments, std::size_t n) const;

  /// out <- L in of edge k, in: rows_ x columns.
  void Weigh(const BatchedEdge& edge, const double* in, std::size_t columns, double* out) const;

  void WriteResiduals(const Doubles& residual, std::span<BatchedEdge> edges) const;

  void WriteJacobians(const Arguments& arguments, std::span<BatchedEdge> edges) const;

  /// By central differences in the tangent, the residual of all edges at once.
  void WriteDifferences(const Arguments& at, std::span<BatchedEdge> edges) const;

  Kept kind_;
  std::vector<std::unique_ptr<Kept>> data_;
  std::vector<const VertexOps*> types_;
  std::size_t rows_, num_edges_;
  Weights weights_;
  bool has_jacobian_ = false;
};

}  // namespace glissade::python
