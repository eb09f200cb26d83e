// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/dense_reference.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/graph/pools.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/pose.h"

namespace glissade::test {

namespace {

using RowMajorMatrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

/// Basis of the free tangent from the definition in graph/fix.h, not by FreeTangent itself.
Eigen::MatrixXd FreeBasis(const Graph& graph, const VertexPoolBase& pool, int index) {
  const int dim = pool.ops().tangent_dim;
  switch (pool.fix(index)) {
    case Fix::kWhole:
      return Eigen::MatrixXd(dim, 0);
    case Fix::kFree:
      return Eigen::MatrixXd::Identity(dim, dim);
    case Fix::kPosition:
      return Eigen::MatrixXd::Identity(6, 6).rightCols(3);
    case Fix::kBiases:
      return Eigen::MatrixXd::Identity(9, 9).leftCols(3);
    case Fix::kNumbers: {
      const std::uint32_t held = graph.FixedNumbers(pool.HandleAt(index));
      Eigen::MatrixXd basis(dim, 0);
      for (int k = 0; k < dim; ++k) {
        if ((held >> k & 1u) != 0) continue;
        basis.conservativeResize(dim, basis.cols() + 1);
        basis.col(basis.cols() - 1) = Eigen::VectorXd::Unit(dim, k);
      }
      return basis;
    }
    case Fix::kPositionAndYaw:
    case Fix::kCoordinate:
      break;
  }
  for (const FreeTangent& tangent : graph.free_tangents()) {
    if (tangent.vertex != pool.HandleAt(index)) continue;
    // q = Exp(dphi) q0, so dphi = Log(q q0^-1) for the small angles of these tests.
    const Quaternion q(pool.Data(index) + 3), q0(tangent.q0);
    const Vector3 dphi = so3::Log(Quaternion(q * q0.conjugate()));
    Eigen::MatrixXd basis = Eigen::MatrixXd::Zero(6, 2);
    basis.bottomRows(3) = (RotationMatrix(tangent.q0).transpose() * so3::Jr(dphi)).leftCols(2);
    return basis;
  }
  return Eigen::MatrixXd(dim, 0);
}

}  // namespace

DenseReference::DenseReference(const Graph& graph, std::span<const AnyVertex> order) {
  struct Column {
    AnyVertex vertex;
    Eigen::MatrixXd basis;
    int begin;
  };
  std::vector<Column> columns;
  int num_columns = 0;
  for (const AnyVertex& vertex : order) {
    const VertexPoolBase& pool = *graph.PoolOf(vertex.type);
    columns.push_back(
        {vertex, FreeBasis(graph, pool, pool.slots().IndexOf(vertex.slot)), num_columns});
    num_columns += static_cast<int>(columns.back().basis.cols());
  }
  int num_rows = 0;
  for (const auto& pool : graph.edge_pools()) {
    for (int edge = 0; edge < pool->size(); ++edge) {
      if (pool->Alive(edge)) num_rows += pool->residual_dim(edge);
    }
  }
  J = Eigen::MatrixXd::Zero(num_rows, num_columns);
  r = Eigen::VectorXd::Zero(num_rows);

  int row = 0;
  for (const auto& pool : graph.edge_pools()) {
    for (int edge = 0; edge < pool->size(); ++edge) {
      if (!pool->Alive(edge)) continue;
      const int rows = pool->residual_dim(edge), arity = pool->arity(edge);
      std::vector<const double*> states;
      std::vector<RowMajorMatrix> blocks;
      std::vector<double*> block_data;
      for (int i = 0; i < arity; ++i) {
        const VertexPoolBase& vertices = *pool->vertex_pool(edge, i);
        states.push_back(vertices.Data(vertices.slots().IndexOf(pool->VertexOf(edge, i).slot)));
        blocks.emplace_back(rows, vertices.ops().tangent_dim);
      }
      for (RowMajorMatrix& block : blocks)
        block_data.push_back(block.data());
      Eigen::VectorXd residual(rows);
      if (!pool->Evaluate(edge, states.data(), residual.data(), block_data.data())) {
        cost = std::numeric_limits<double>::quiet_NaN();
        return;
      }
      pool->Whiten(edge, residual.data(), block_data.data());

      // Robust correction, written from Triggs et al., Eqs. 9-12: r~'r~ has the gradient of
      // rho(s), J~'J~ its Hessian where rho'' > 0.
      const double s = residual.squaredNorm();
      double rho[3];
      pool->loss(edge).Evaluate(s, rho);
      cost += 0.5 * rho[0];
      double alpha = 0.0;
      if (rho[2] > 0.0 && s > 0.0) alpha = 1.0 - std::sqrt(1.0 + 2.0 * s * rho[2] / rho[1]);
      const double root = std::sqrt(rho[1]);
      for (int i = 0; i < arity; ++i) {
        for (const Column& column : columns) {
          if (column.vertex != pool->VertexOf(edge, i)) continue;
          Eigen::MatrixXd block = blocks[static_cast<std::size_t>(i)] * column.basis;
          if (alpha != 0.0) {
            block -= alpha / s * residual * (residual.transpose() * block).eval();
          }
          J.block(row, column.begin, rows, block.cols()) = root * block;
        }
      }
      r.segment(row, rows) = root / (1.0 - alpha) * residual;
      row += rows;
    }
  }
}

Eigen::VectorXd DampedStep(const Eigen::MatrixXd& J, const Eigen::VectorXd& r,
                           const Eigen::VectorXd& damping) {
  // Columns scaled to unit length: units of the variables must not matter to the reference.
  const Eigen::Index m = J.rows(), n = J.cols();
  Eigen::MatrixXd A(m + n, n);
  A.topRows(m) = J;
  A.bottomRows(n) = damping.cwiseSqrt().asDiagonal();
  Eigen::VectorXd scale = A.colwise().norm();
  for (Eigen::Index i = 0; i < n; ++i)
    scale[i] = scale[i] > 0.0 ? 1.0 / scale[i] : 1.0;
  A = A * scale.asDiagonal();
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(m + n);
  rhs.head(m) = -r;
  return scale.asDiagonal() * Eigen::VectorXd(A.householderQr().solve(rhs));
}

Eigen::VectorXd MarquardtDamping(const Eigen::MatrixXd& J, double lambda, double min_diagonal,
                                 double max_diagonal) {
  return lambda *
         J.colwise().squaredNorm().transpose().cwiseMax(min_diagonal).cwiseMin(max_diagonal);
}

double HessianError(const Eigen::MatrixXd& A, const Eigen::MatrixXd& B) {
  if (A.rows() != B.rows() || A.cols() != B.cols()) {
    return std::numeric_limits<double>::infinity();
  }
  // A variable that hardly matters gets the scale of one a million times less curved than the most.
  const double floor = 1e-6 * std::sqrt(B.diagonal().maxCoeff());
  const Eigen::VectorXd scale = B.diagonal().cwiseMax(0.0).cwiseSqrt().cwiseMax(floor);
  return ((A - B).array() / (scale * scale.transpose()).array()).abs().maxCoeff();
}

double RelativeError(const Eigen::VectorXd& a, const Eigen::VectorXd& b) {
  if (a.size() != b.size()) return std::numeric_limits<double>::infinity();
  const double norm = b.norm();
  return norm > 0.0 ? (a - b).norm() / norm : a.norm();
}

}  // namespace glissade::test
