// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/dynamic_edges.h"

#include <algorithm>

#include "glissade/vertices/pose.h"
#include "support/user_types.h"

namespace glissade::test {

namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Dimension of what LinearEdge reads of a state: its first entries.
int LinearDim(const VertexOps& ops) {
  return ops.type == &kTypeInfo<VertexPose> ? 3 : ops.ambient_dim;
}

}  // namespace

void TangentBasis(const VertexRef& vertex, double* basis) {
  const VertexOps& ops = *vertex.ops;
  const double* x = vertex.data;
  Eigen::Map<RowMajorMatrix> B(basis, ops.ambient_dim, ops.tangent_dim);
  B.setZero();
  if (ops.type == &kTypeInfo<VertexPose>) {
    B.topLeftCorner<3, 3>().setIdentity();
    // d(q exp(d / 2)) / dd: the products of q with i, j and k, halved.
    for (int k = 0; k < 3; ++k) {
      Quaternion unit(0.0, 0.0, 0.0, 0.0);
      unit.coeffs()[k] = 0.5;
      B.col(3 + k).tail<4>() = (Quaternion(x + 3) * unit).coeffs();
    }
  } else if (ops.type == &kTypeInfo<VertexBearing>) {
    B = internal::VertexFromData<VertexBearing>(x).Basis();
  } else if (ops.type == &kTypeInfo<VertexScale>) {
    B(0, 0) = x[0];
  } else {
    B.setIdentity();
  }
}

// ---- SineEdge
// --------------------------------------------------------------------------------------

SineEdge::SineEdge(std::span<const VertexRef> vertices, int rows, GraphRandom* random) : c_(rows) {
  const double scale = 1.0 / std::sqrt(static_cast<double>(vertices.size()));
  for (int k = 0; k < rows; ++k)
    c_[k] = 0.1 * random->Normal();
  for (const VertexRef& vertex : vertices) {
    Eigen::MatrixXd& A = A_.emplace_back(rows, vertex.ops->ambient_dim);
    for (int k = 0; k < rows; ++k) {
      for (int i = 0; i < A.cols(); ++i)
        A(k, i) = scale * random->Normal();
    }
    c_ -= A * Eigen::Map<const Eigen::VectorXd>(vertex.data, A.cols());
  }
}

Status SineEdge::CheckVertices(std::span<const VertexOps* const> vertices) const {
  bool same = vertices.size() == A_.size();
  for (std::size_t i = 0; same && i < A_.size(); ++i)
    same = vertices[i]->ambient_dim == static_cast<int>(A_[i].cols());
  if (same) return {};
  return {StatusCode::kInvalidArgument, "SineEdge: other vertices than it was made for"};
}

bool SineEdge::Evaluate(std::span<const VertexRef> vertices, double* residual,
                        double* const* jacobians) const {
  Eigen::VectorXd u = c_;
  for (std::size_t i = 0; i < A_.size(); ++i)
    u += A_[i] * Eigen::Map<const Eigen::VectorXd>(vertices[i].data, A_[i].cols());
  Eigen::Map<Eigen::VectorXd>(residual, u.size()) = u.array() + 0.5 * u.array().sin();
  const Eigen::VectorXd slope = 1.0 + 0.5 * u.array().cos();
  for (std::size_t i = 0; jacobians != nullptr && i < A_.size(); ++i) {
    if (jacobians[i] == nullptr) continue;
    const VertexOps& ops = *vertices[i].ops;
    RowMajorMatrix basis(ops.ambient_dim, ops.tangent_dim);
    TangentBasis(vertices[i], basis.data());
    Eigen::Map<RowMajorMatrix>(jacobians[i], u.size(), ops.tangent_dim) =
        slope.asDiagonal() * A_[i] * basis;
  }
  return true;
}

// ---- LinearEdge
// ------------------------------------------------------------------------------------

bool LinearEdge::Takes(const VertexOps& ops) {
  return ops.type != &kTypeInfo<VertexBearing> && ops.type != &kTypeInfo<VertexScale>;
}

LinearEdge::LinearEdge(std::span<const VertexRef> vertices, int rows, GraphRandom* random)
    : c_(rows) {
  const double scale = 1.0 / std::sqrt(static_cast<double>(vertices.size()));
  int total = 0;
  for (const VertexRef& vertex : vertices) {
    tangent_dims_.push_back(vertex.ops->tangent_dim);
    total += vertex.ops->tangent_dim;
  }
  J_ = Eigen::MatrixXd::Zero(rows, total);
  int col = 0;
  for (const VertexRef& vertex : vertices) {
    for (int k = 0; k < rows; ++k) {
      for (int i = 0; i < LinearDim(*vertex.ops); ++i)
        J_(k, col + i) = scale * random->Normal();
    }
    col += vertex.ops->tangent_dim;
  }
  c_.setZero();
  c_ = -Residual(vertices);
  for (int k = 0; k < rows; ++k)
    c_[k] += 0.1 * random->Normal();
  H_ = J_.transpose() * J_;
}

Status LinearEdge::CheckVertices(std::span<const VertexOps* const> vertices) const {
  bool same = vertices.size() == tangent_dims_.size();
  for (std::size_t i = 0; same && i < tangent_dims_.size(); ++i)
    same = vertices[i]->tangent_dim == tangent_dims_[i] && Takes(*vertices[i]);
  if (same) return {};
  return {StatusCode::kInvalidArgument, "LinearEdge: other vertices than it was made for"};
}

Eigen::VectorXd LinearEdge::Residual(std::span<const VertexRef> vertices) const {
  Eigen::VectorXd r = c_;
  int col = 0;
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    const int dim = LinearDim(*vertices[i].ops);
    r += J_.middleCols(col, dim) * Eigen::Map<const Eigen::VectorXd>(vertices[i].data, dim);
    col += tangent_dims_[i];
  }
  return r;
}

bool LinearEdge::Evaluate(std::span<const VertexRef> vertices, double* residual,
                          double* const* jacobians) const {
  Eigen::Map<Eigen::VectorXd>(residual, c_.size()) = Residual(vertices);
  int col = 0;
  for (std::size_t i = 0; jacobians != nullptr && i < vertices.size(); ++i) {
    if (jacobians[i] != nullptr) {
      Eigen::Map<RowMajorMatrix>(jacobians[i], c_.size(), tangent_dims_[i]) =
          J_.middleCols(col, tangent_dims_[i]);
    }
    col += tangent_dims_[i];
  }
  return true;
}

bool LinearEdge::LinearizeQuadratic(std::span<const VertexRef> vertices, double* gradient,
                                    double* squared_norm) const {
  const Eigen::VectorXd r = Residual(vertices);
  if (gradient != nullptr) {
    Eigen::Map<Eigen::VectorXd>(gradient, J_.cols()) = J_.transpose() * r;
  }
  *squared_norm = r.squaredNorm();
  return true;
}

}  // namespace glissade::test
