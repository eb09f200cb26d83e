// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/edges/marginal_prior.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "glissade/base/out_of_memory.h"
#include "glissade/base/validate.h"
#include "kernels/kernels.h"

namespace glissade {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstMatrixMap = Eigen::Map<const RowMajor>;

/// Scratch of a thread: it grows to the largest prior once, so that solving again allocates
/// nothing.
double* Scratch(std::size_t n) {
  thread_local std::vector<double> scratch;
  if (scratch.size() < n) scratch.resize(n);
  return scratch.data();
}

}  // namespace

namespace internal {

void MinusJacobian(const VertexOps& ops, const double* x, const double* x0, double* out) {
  if (ops.minus_jacobian != nullptr) return ops.minus_jacobian(x, x0, out);
  const int n = ops.tangent_dim;
  Eigen::Map<RowMajor> D(out, n, n);
  D.setIdentity();
  if (ops.additive) return;
  constexpr double kStep = 1e-3;
  constexpr std::pair<double, double> kStencil[] = {
      {-2.0, 1.0 / 12}, {-1.0, -2.0 / 3}, {1.0, 2.0 / 3}, {2.0, -1.0 / 12}};
  thread_local std::vector<double> scratch;  // grows to the largest type once
  if (scratch.size() < static_cast<std::size_t>(2 * n + ops.ambient_dim)) {
    scratch.resize(static_cast<std::size_t>(2 * n + ops.ambient_dim));
  }
  double *const step = scratch.data(), *const value = step + n, *const moved = value + n;
  std::fill_n(step, n, 0.0);
  for (int c = 0; c < n; ++c) {
    D.col(c).setZero();
    for (const auto& [at, weight] : kStencil) {
      step[c] = at * kStep;
      ops.plus(x, step, moved);
      ops.minus(moved, x0, value);
      D.col(c) += weight * Eigen::Map<const Eigen::VectorXd>(value, n);
    }
    D.col(c) /= kStep;
    step[c] = 0.0;
  }
}

}  // namespace internal

struct EdgeMarginalPrior::Data {
  std::vector<const VertexOps*> types;
  std::vector<double> x0, r0, jacobian, hessian;
  std::vector<std::int32_t> begin;  // first column of each row that is not zero
  int tangent_dim = 0;

  [[nodiscard]] int rows() const { return static_cast<int>(r0.size()); }
  [[nodiscard]] const double* Row(int row) const {
    return jacobian.data() + static_cast<std::size_t>(row) * static_cast<std::size_t>(tangent_dim);
  }
  [[nodiscard]] ConstMatrixMap J() const { return {jacobian.data(), rows(), tangent_dim}; }

  /// H = J'J, and where the rows of J begin: priors are triangular as a rule.
  void Prepare() {
    const int n = tangent_dim;
    begin.resize(r0.size());
    for (int row = 0; row < rows(); ++row) {
      int c = 0;
      while (c < n && Row(row)[c] == 0.0)
        ++c;
      begin[static_cast<std::size_t>(row)] = c;
    }
    hessian.assign(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0.0);
    const auto& add_products = kernels::Kernels().syrk_lower_add;
    constexpr int kRows = 24;
    for (int row = 0; row < rows(); row += kRows) {
      const int count = std::min(kRows, rows() - row);
      const int first = *std::min_element(begin.begin() + row, begin.begin() + row + count);
      // Rows of a row-major matrix are columns of a column-major one.
      add_products(
          n - first, count, Row(row) + first, n,
          hessian.data() + static_cast<std::size_t>(first) * static_cast<std::size_t>(n + 1), n);
    }
    Eigen::Map<Eigen::MatrixXd> H(hessian.data(), n, n);
    H.triangularView<Eigen::StrictlyUpper>() = H.transpose();
  }

  /// dx = x boxminus x0 and r = r0 + J dx.
  void Residual(std::span<const VertexRef> vertices, double* dx, double* r) const {
    const double* origin = x0.data();
    double* delta = dx;
    for (std::size_t i = 0; i < types.size(); ++i) {
      types[i]->minus(vertices[i].data, origin, delta);
      origin += types[i]->ambient_dim;
      delta += types[i]->tangent_dim;
    }
    const auto& dot = kernels::Kernels().dot;
    for (int row = 0; row < rows(); ++row) {
      const int first = begin[static_cast<std::size_t>(row)];
      r[row] = r0[static_cast<std::size_t>(row)] +
               dot(tangent_dim - first, Row(row) + first, dx + first);
    }
  }
};

Status EdgeMarginalPrior::Check(std::span<const VertexOps* const> vertices,
                                std::span<const double> x0, std::span<const double> r0,
                                std::span<const double> jacobian) {
  const auto invalid = [](const char* what) {
    return Status(StatusCode::kInvalidArgument, std::string("EdgeMarginalPrior: ") + what);
  };
  std::size_t ambient = 0, tangent = 0;
  for (const VertexOps* ops : vertices) {
    if (ops == nullptr) return invalid("a vertex type is null");
    ambient += static_cast<std::size_t>(ops->ambient_dim);
    tangent += static_cast<std::size_t>(ops->tangent_dim);
  }
  if (vertices.empty()) return invalid("no vertices");
  if (r0.empty()) return invalid("no rows");
  if (x0.size() != ambient) return invalid("size of x0 does not match the vertices");
  if (jacobian.size() != r0.size() * tangent) {
    return invalid("size of J does not match r0 and the vertices");
  }
  const auto not_finite = [](std::span<const double> x) {
    return !internal::AllFinite(x.data(), static_cast<int>(x.size()));
  };
  const auto refuse = [](const char* what) {
    return Status(StatusCode::kNotFinite,
                  std::string("EdgeMarginalPrior ") + what + " is not finite");
  };
  const double* x = x0.data();
  for (const VertexOps* ops : vertices) {
    if (Status s = ops->validate(x); !s.ok()) {
      return {s.code(), "EdgeMarginalPrior x0: " + s.message()};
    }
    x += ops->ambient_dim;
  }
  if (not_finite(r0)) return refuse("r0");
  if (not_finite(jacobian)) return refuse("J");
  // J'J is finite where its trace is (Cauchy-Schwarz).
  double trace = 0.0;
  for (std::size_t row = 0; row < r0.size(); ++row) {
    const double* J = jacobian.data() + row * tangent;
    trace += kernels::Kernels().dot(static_cast<int>(tangent), J, J);
  }
  if (!std::isfinite(trace)) return refuse("J'J");
  return {};
}

Result<std::unique_ptr<EdgeMarginalPrior>> EdgeMarginalPrior::Create(
    std::span<const VertexOps* const> vertices, std::span<const double> x0,
    std::span<const double> r0, std::span<const double> jacobian) {
  return internal::OrOutOfMemory([&]() -> Result<std::unique_ptr<EdgeMarginalPrior>> {
    std::unique_ptr<EdgeMarginalPrior> edge(new EdgeMarginalPrior(std::make_shared<Data>()));
    if (Status s = edge->Assign(vertices, x0, r0, jacobian); !s.ok()) return s;
    return edge;
  });
}

Status EdgeMarginalPrior::Assign(std::span<const VertexOps* const> vertices,
                                 std::span<const double> x0, std::span<const double> r0,
                                 std::span<const double> jacobian) {
  return internal::OrOutOfMemory([&]() -> Status {
    if (Status s = Check(vertices, x0, r0, jacobian); !s.ok()) return s;
    const std::shared_ptr<Data> data = data_.use_count() > 1 ? std::make_shared<Data>() : data_;
    // Rank and so rows may differ from prior to prior: room for full rank at once. This is all that
    // can run out of memory, before the first change.
    const std::size_t dim = jacobian.size() / r0.size(), most = std::max(dim, r0.size());
    data->types.reserve(vertices.size());
    data->x0.reserve(x0.size());
    data->r0.reserve(most);
    data->begin.reserve(most);
    data->jacobian.reserve(most * dim);
    data->hessian.reserve(dim * dim);
    data->types.assign(vertices.begin(), vertices.end());
    data->x0.assign(x0.begin(), x0.end());
    data->r0.assign(r0.begin(), r0.end());
    data->jacobian.assign(jacobian.begin(), jacobian.end());
    data->tangent_dim = static_cast<int>(dim);
    data->Prepare();
    data_ = data;
    return {};
  });
}

std::span<const VertexOps* const> EdgeMarginalPrior::vertex_types() const {
  return data_->types;
}
std::span<const double> EdgeMarginalPrior::x0() const {
  return data_->x0;
}
std::span<const double> EdgeMarginalPrior::r0() const {
  return data_->r0;
}
std::span<const double> EdgeMarginalPrior::jacobian() const {
  return data_->jacobian;
}
int EdgeMarginalPrior::TangentDim() const {
  return data_->tangent_dim;
}
int EdgeMarginalPrior::ResidualDim() const {
  return data_->rows();
}
const double* EdgeMarginalPrior::ConstantHessian() const {
  return data_->hessian.data();
}

Status EdgeMarginalPrior::CheckVertices(std::span<const VertexOps* const> vertices) const {
  if (vertices.size() != data_->types.size()) {
    return {StatusCode::kInvalidArgument,
            "EdgeMarginalPrior: made for " + std::to_string(data_->types.size()) +
                " vertices, given " + std::to_string(vertices.size())};
  }
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i]->type != data_->types[i]->type) {
      return {StatusCode::kInvalidArgument, "EdgeMarginalPrior: vertex " + std::to_string(i) +
                                                " must be a " +
                                                std::string(data_->types[i]->type->name)};
    }
  }
  return {};
}

bool EdgeMarginalPrior::Evaluate(std::span<const VertexRef> vertices, double* residual,
                                 double* const* jacobians) const {
  const int rows = data_->rows();
  data_->Residual(vertices, Scratch(static_cast<std::size_t>(data_->tangent_dim)), residual);
  const double* origin = data_->x0.data();
  int col = 0;
  for (std::size_t i = 0; jacobians != nullptr && i < data_->types.size(); ++i) {
    const VertexOps& ops = *data_->types[i];
    if (jacobians[i] != nullptr) {
      const int n = ops.tangent_dim;
      // After what Residual() used of the scratch: nothing of that is needed any more.
      double* const D = Scratch(static_cast<std::size_t>(n * n));
      internal::MinusJacobian(ops, vertices[i].data, origin, D);
      Eigen::Map<RowMajor>(jacobians[i], rows, n) =
          data_->J().middleCols(col, n).lazyProduct(ConstMatrixMap(D, n, n));
    }
    col += ops.tangent_dim;
    origin += ops.ambient_dim;
  }
  return true;
}

bool EdgeMarginalPrior::LinearizeQuadratic(std::span<const VertexRef> vertices, double* gradient,
                                           double* squared_norm) const {
  const int n = data_->tangent_dim;
  double* const dx = Scratch(static_cast<std::size_t>(n) + data_->r0.capacity());
  double* const r = dx + n;
  data_->Residual(vertices, dx, r);
  const kernels::KernelTable& k = kernels::Kernels();
  *squared_norm = k.dot(data_->rows(), r, r);
  if (gradient == nullptr) return true;
  std::fill_n(gradient, n, 0.0);
  for (int row = 0; row < data_->rows(); ++row) {
    const int first = data_->begin[static_cast<std::size_t>(row)];
    k.axpy(n - first, r[row], data_->Row(row) + first, gradient + first);
  }
  return true;
}

const double* EdgeMarginalPrior::LinearizationPoint() const {
  return data_->x0.data();
}

std::unique_ptr<DynamicEdge> EdgeMarginalPrior::Clone() const {
  return std::unique_ptr<DynamicEdge>(new EdgeMarginalPrior(data_));
}

}  // namespace glissade
