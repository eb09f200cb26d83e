// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/edges/marginal_prior.h"

#include <Eigen/Core>
#include <string>
#include <utility>
#include <vector>

#include "glissade/base/validate.h"
#include "glissade/lie/so3.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

namespace glissade {

namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using ConstMatrixMap = Eigen::Map<const RowMajor>;
using ConstVectorMap = Eigen::Map<const Eigen::VectorXd>;
using VectorMap = Eigen::Map<Eigen::VectorXd>;

/// Scratch of a thread: it grows to the largest prior once, so that solving again allocates
/// nothing.
double* Scratch(std::size_t n) {
  thread_local std::vector<double> scratch;
  if (scratch.size() < n) scratch.resize(n);
  return scratch.data();
}

}  // namespace

namespace internal {

bool IsAdditive(const VertexOps& ops) {
  return ops.type == &kTypeInfo<VertexSpeedBias> || ops.type == &kTypeInfo<VertexInverseDepth> ||
         ops.type == &kTypeInfo<VertexPointXYZ> || ops.type == &kTypeInfo<VertexCameraBal>;
}

void MinusJacobian(const VertexOps& ops, const double* x, const double* x0, double* out) {
  const int n = ops.tangent_dim;
  Eigen::Map<RowMajor> D(out, n, n);
  D.setIdentity();
  if (IsAdditive(ops)) return;
  if (ops.type == &kTypeInfo<VertexPose>) {
    double delta[6];
    ops.minus(x, x0, delta);
    D.bottomRightCorner<3, 3>() = so3::JrInverse(Vector3(delta[3], delta[4], delta[5]));
    return;
  }
  constexpr double kStep = 1e-3;
  constexpr std::pair<double, double> kStencil[] = {
      {-2.0, 1.0 / 12}, {-1.0, -2.0 / 3}, {1.0, 2.0 / 3}, {2.0, -1.0 / 12}};
  Eigen::VectorXd step(n), moved(ops.ambient_dim), value(n), sum(n);
  for (int c = 0; c < n; ++c) {
    sum.setZero();
    for (const auto& [at, weight] : kStencil) {
      step.setZero();
      step[c] = at * kStep;
      ops.plus(x, step.data(), moved.data());
      ops.minus(moved.data(), x0, value.data());
      sum += weight * value;
    }
    D.col(c) = sum / kStep;
  }
}

}  // namespace internal

struct EdgeMarginalPrior::Data {
  std::vector<const VertexOps*> types;
  std::vector<double> x0, r0, jacobian, hessian;
  int tangent_dim = 0;

  [[nodiscard]] int rows() const { return static_cast<int>(r0.size()); }
  [[nodiscard]] ConstMatrixMap J() const { return {jacobian.data(), rows(), tangent_dim}; }

  /// dx = x boxminus x0 and r = r0 + J dx.
  void Residual(std::span<const VertexRef> vertices, double* dx, double* r) const {
    const double* origin = x0.data();
    double* delta = dx;
    for (std::size_t i = 0; i < types.size(); ++i) {
      types[i]->minus(vertices[i].data, origin, delta);
      origin += types[i]->ambient_dim;
      delta += types[i]->tangent_dim;
    }
    VectorMap residual(r, rows());
    residual = ConstVectorMap(r0.data(), rows());
    residual.noalias() += J() * ConstVectorMap(dx, tangent_dim);
  }
};

Result<std::unique_ptr<EdgeMarginalPrior>> EdgeMarginalPrior::Create(
    std::span<const VertexOps* const> vertices, std::span<const double> x0,
    std::span<const double> r0, std::span<const double> jacobian) {
  const auto invalid = [](const char* what) {
    return Status(StatusCode::kInvalidArgument, std::string("EdgeMarginalPrior: ") + what);
  };
  auto data = std::make_shared<Data>();
  std::size_t ambient = 0;
  for (const VertexOps* ops : vertices) {
    if (ops == nullptr) return invalid("a vertex type is null");
    ambient += static_cast<std::size_t>(ops->ambient_dim);
    data->tangent_dim += ops->tangent_dim;
  }
  if (vertices.empty()) return invalid("no vertices");
  if (r0.empty()) return invalid("no rows");
  if (x0.size() != ambient) return invalid("size of x0 does not match the vertices");
  if (jacobian.size() != r0.size() * static_cast<std::size_t>(data->tangent_dim)) {
    return invalid("size of J does not match r0 and the vertices");
  }
  const auto finite = [](std::span<const double> x, const char* what) {
    return ValidateFinite(x.data(), static_cast<int>(x.size()), what);
  };
  if (Status s = finite(x0, "EdgeMarginalPrior x0"); !s.ok()) return s;
  if (Status s = finite(r0, "EdgeMarginalPrior r0"); !s.ok()) return s;
  if (Status s = finite(jacobian, "EdgeMarginalPrior J"); !s.ok()) return s;

  data->types.assign(vertices.begin(), vertices.end());
  data->x0.assign(x0.begin(), x0.end());
  data->r0.assign(r0.begin(), r0.end());
  data->jacobian.assign(jacobian.begin(), jacobian.end());
  const int n = data->tangent_dim;
  data->hessian.resize(static_cast<std::size_t>(n) * static_cast<std::size_t>(n));
  Eigen::Map<RowMajor> H(data->hessian.data(), n, n);
  H.noalias() = data->J().transpose() * data->J();
  if (Status s = finite(data->hessian, "EdgeMarginalPrior J'J"); !s.ok()) return s;
  return std::unique_ptr<EdgeMarginalPrior>(new EdgeMarginalPrior(std::move(data)));
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
  double* const dx = Scratch(static_cast<std::size_t>(n) + data_->r0.size());
  double* const r = dx + n;
  data_->Residual(vertices, dx, r);
  const ConstVectorMap residual(r, data_->rows());
  *squared_norm = residual.squaredNorm();
  if (gradient != nullptr) VectorMap(gradient, n).noalias() = data_->J().transpose() * residual;
  return true;
}

const double* EdgeMarginalPrior::LinearizationPoint() const {
  return data_->x0.data();
}

std::unique_ptr<DynamicEdge> EdgeMarginalPrior::Clone() const {
  return std::unique_ptr<DynamicEdge>(new EdgeMarginalPrior(data_));
}

}  // namespace glissade
