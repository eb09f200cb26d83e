// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/ceres.h>

#include <memory>
#include <vector>

#include "glissade/io/viowin.h"

/// \file
/// A window in Ceres as somebody who knows Ceres writes it: analytic Jacobians, fixed sizes, a
/// manifold whose PlusJacobian is [I; 0] so that cost functions hand out tangent Jacobians, an
/// elimination ordering, safety checks off.
namespace glissade::bench {

/// px py pz qx qy qz qw; p <- p + dp, q <- q Exp(dtheta).
class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* x, const double* delta, double* x_plus_delta) const override {
    kVertexOps<VertexPose>.plus(x, delta, x_plus_delta);
    return true;
  }
  bool PlusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 7, 6, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
  bool Minus(const double* y, const double* x, double* y_minus_x) const override {
    kVertexOps<VertexPose>.minus(y, x, y_minus_x);
    return true;
  }
  bool MinusJacobian(const double*, double* jacobian) const override {
    Eigen::Map<Eigen::Matrix<double, 6, 7, Eigen::RowMajor>>(jacobian).setIdentity();
    return true;
  }
};

/// host, target, inverse depth; in units of sigma.
class ReprojectionCost final : public ceres::SizedCostFunction<2, 7, 7, 1> {
 public:
  ReprojectionCost(const ViowinCamera& c, const Pose& T_b_c, double u_host, double v_host, double u,
                   double v)
      : bearing_((u_host - c.cx) / c.fx, (v_host - c.cy) / c.fy, 1.0),
        observed_((u - c.cx) / c.fx, (v - c.cy) / c.fy),
        scale_(c.fx / c.sigma_px, c.fy / c.sigma_px),
        R_b_c_(Eigen::Quaterniond(T_b_c.q()).toRotationMatrix()),
        t_b_c_(T_b_c.p()) {}

  bool Evaluate(double const* const* x, double* r, double** J) const override {
    using Eigen::Map;
    const Map<const Eigen::Vector3d> p_i(x[0]), p_j(x[1]);
    const Eigen::Matrix3d R_i = Map<const Eigen::Quaterniond>(x[0] + 3).toRotationMatrix();
    const Eigen::Matrix3d R_j = Map<const Eigen::Quaterniond>(x[1] + 3).toRotationMatrix();
    const double depth = 1.0 / x[2][0];
    const Eigen::Vector3d ray = R_b_c_ * bearing_;
    const Eigen::Vector3d in_i = ray * depth + t_b_c_;
    const Eigen::Vector3d in_j = R_j.transpose() * (R_i * in_i + p_i - p_j);
    const Eigen::Vector3d in_c = R_b_c_.transpose() * (in_j - t_b_c_);
    const double z = 1.0 / in_c.z();
    r[0] = scale_.x() * (in_c.x() * z - observed_.x());
    r[1] = scale_.y() * (in_c.y() * z - observed_.y());
    if (J == nullptr) return true;

    Eigen::Matrix<double, 2, 3> d_c;
    d_c << scale_.x() * z, 0.0, -scale_.x() * in_c.x() * z * z,  //
        0.0, scale_.y() * z, -scale_.y() * in_c.y() * z * z;
    const Eigen::Matrix<double, 2, 3> d_j = d_c * R_b_c_.transpose();
    const Eigen::Matrix<double, 2, 3> d_w = d_j * R_j.transpose();
    using Block = Eigen::Matrix<double, 2, 7, Eigen::RowMajor>;
    const Eigen::Matrix<double, 2, 3> d_i = d_w * R_i;
    if (J[0] != nullptr) {
      Map<Block> B(J[0]);
      B.leftCols<3>() = d_w;
      B.row(0).segment<3>(3) = in_i.cross(Eigen::Vector3d(d_i.row(0).transpose())).transpose();
      B.row(1).segment<3>(3) = in_i.cross(Eigen::Vector3d(d_i.row(1).transpose())).transpose();
      B.col(6).setZero();
    }
    if (J[1] != nullptr) {
      Map<Block> B(J[1]);
      B.leftCols<3>() = -d_w;
      B.row(0).segment<3>(3) = Eigen::Vector3d(d_j.row(0).transpose()).cross(in_j).transpose();
      B.row(1).segment<3>(3) = Eigen::Vector3d(d_j.row(1).transpose()).cross(in_j).transpose();
      B.col(6).setZero();
    }
    if (J[2] != nullptr) {
      Map<Eigen::Vector2d> B(J[2]);
      B = d_i * ray * (-depth * depth);
    }
    return true;
  }

 private:
  Eigen::Vector3d bearing_;
  Eigen::Vector2d observed_, scale_;
  Eigen::Matrix3d R_b_c_;
  Eigen::Vector3d t_b_c_;
};

/// An edge with analytic tangent Jacobians and its square-root information. Poses get a seventh
/// column of zeros.
template <class E, int... AmbientDims>
class EdgeCost final : public ceres::SizedCostFunction<E::kResidualDim, AmbientDims...> {
 public:
  static constexpr int kRows = E::kResidualDim;
  EdgeCost(const E& edge, const SquareMatrix<kRows>& sqrt_information)
      : edge_(edge), sqrt_information_(sqrt_information) {}

  bool Evaluate(double const* const* x, double* r, double** J) const override {
    return Evaluate(x, r, J, std::make_integer_sequence<int, sizeof...(AmbientDims)>{});
  }

 private:
  template <int... I>
  bool Evaluate(double const* const* x, double* r, double** J,
                std::integer_sequence<int, I...>) const {
    Vector<kRows> e;
    std::tuple<Jacobian<kRows, EdgeVertex<E, I>::kTangentDim>...> d;
    const auto wanted = [&](int i) { return J != nullptr && J[i] != nullptr; };
    if (!edge_.Evaluate(internal::VertexFromData<EdgeVertex<E, I>>(x[I])..., e,
                        (wanted(I) ? &std::get<I>(d) : nullptr)...)) {
      return false;
    }
    Eigen::Map<Vector<kRows>>(r).noalias() = sqrt_information_ * e;
    ((wanted(I) ? Whiten(std::get<I>(d), J[I], EdgeVertex<E, I>::kAmbientDim) : void()), ...);
    return true;
  }
  template <class Block>
  void Whiten(const Block& d, double* J, int ambient) const {
    constexpr int kCols = Block::ColsAtCompileTime;
    Eigen::Map<Eigen::Matrix<double, kRows, Eigen::Dynamic, Eigen::RowMajor>> out(J, kRows,
                                                                                  ambient);
    out.template leftCols<kCols>().noalias() = sqrt_information_ * d;
    if (ambient > kCols) out.rightCols(ambient - kCols).setZero();
  }

  E edge_;
  SquareMatrix<kRows> sqrt_information_;
};

/// A window's Ceres problem with its states. Make() is what a program does for each frame; the cost
/// functions are made once.
class CeresWindow {
 public:
  CeresWindow(const ViowinWindow& window, WindowKind kind) : window_(window), kind_(kind) {
    const bool imu = kind == WindowKind::kVisualInertial;
    for (std::size_t l = 0; l < window.landmarks.size(); ++l) {
      const ViowinLandmark& landmark = window.landmarks[l];
      for (const ViowinObservation& o : landmark.observations) {
        Add(new ReprojectionCost(window.camera, window.T_b_c, landmark.u_host, landmark.v_host, o.u,
                                 o.v),
            {PoseAt(landmark.host), PoseAt(o.frame), DepthAt(l)});
      }
    }
    for (const ViowinPosePrior& p : window.pose_priors) {
      if ((p.use & (imu ? 2 : 1)) == 0) continue;
      const Matrix6 L = Vector6(p.sqrt_information.data()).asDiagonal().toDenseMatrix();
      Add(new EdgeCost<EdgePosePriorVec, 7>({p.T_w_b}, L), {PoseAt(p.frame)});
    }
    if (imu) AddInertial();
    Reset();
  }

  /// Back to the start.
  void Reset() {
    states_.resize(DepthAt(window_.landmarks.size()));
    for (std::size_t k = 0; k < window_.keyframes.size(); ++k) {
      const ViowinKeyframe& f = window_.keyframes[k];
      std::copy_n(f.T_w_b.data, 7, states_.data() + PoseAt(static_cast<int>(k)));
      std::copy_n(f.speed_bias.data, 9, states_.data() + SpeedBiasAt(static_cast<int>(k)));
    }
    for (std::size_t l = 0; l < window_.landmarks.size(); ++l)
      states_[DepthAt(l)] = window_.landmarks[l].rho;
  }

  void Make() {
    ceres::Problem::Options options;
    options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
    options.disable_all_safety_checks = true;
    problem_ = std::make_unique<ceres::Problem>(options);
    ordering_ = std::make_shared<ceres::ParameterBlockOrdering>();
    for (std::size_t l = 0; l < window_.landmarks.size(); ++l) {
      problem_->AddParameterBlock(&states_[DepthAt(l)], 1);
      ordering_->AddElementToGroup(&states_[DepthAt(l)], 0);
    }
    for (std::size_t k = 0; k < window_.keyframes.size(); ++k) {
      double* pose = &states_[PoseAt(static_cast<int>(k))];
      problem_->AddParameterBlock(pose, 7, &manifold_);
      ordering_->AddElementToGroup(pose, 1);
      if (kind_ == WindowKind::kVision) continue;
      double* speed_bias = &states_[SpeedBiasAt(static_cast<int>(k))];
      problem_->AddParameterBlock(speed_bias, 9);
      ordering_->AddElementToGroup(speed_bias, 1);
    }
    for (const Term& term : terms_) {
      double* blocks[4];
      for (std::size_t i = 0; i < term.states.size(); ++i)
        blocks[i] = &states_[term.states[i]];
      problem_->AddResidualBlock(term.cost.get(), nullptr, blocks,
                                 static_cast<int>(term.states.size()));
    }
  }

  /// A Ceres solve may change the ordering it is given: each gets its own.
  std::shared_ptr<ceres::ParameterBlockOrdering> Ordering() const {
    return std::make_shared<ceres::ParameterBlockOrdering>(*ordering_);
  }
  ceres::Problem* problem() { return problem_.get(); }

  /// No output, all tolerances off: exactly `steps` linear solves.
  static ceres::Solver::Options Options(int steps) {
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_SCHUR;
    options.trust_region_strategy_type = ceres::LEVENBERG_MARQUARDT;
    options.max_num_iterations = steps;
    options.function_tolerance = options.gradient_tolerance = options.parameter_tolerance = 0.0;
    options.min_trust_region_radius = 1e-300;
    options.num_threads = 1;
    options.logging_type = ceres::SILENT;
    return options;
  }

 private:
  struct Term {
    std::unique_ptr<ceres::CostFunction> cost;
    std::vector<std::size_t> states;
  };

  std::size_t PoseAt(int k) const { return 16 * static_cast<std::size_t>(k); }
  std::size_t SpeedBiasAt(int k) const { return PoseAt(k) + 7; }
  std::size_t DepthAt(std::size_t l) const { return 16 * window_.keyframes.size() + l; }
  void Add(ceres::CostFunction* cost, std::vector<std::size_t> states) {
    terms_.push_back({std::unique_ptr<ceres::CostFunction>(cost), std::move(states)});
  }
  void AddInertial() {
    for (const ViowinSpeedBiasPrior& p : window_.speed_bias_priors) {
      const SquareMatrix<9> L = Vector<9>(p.sqrt_information.data()).asDiagonal().toDenseMatrix();
      Add(new EdgeCost<EdgeSpeedBiasPrior, 9>({p.prior}, L), {SpeedBiasAt(p.frame)});
    }
    for (const ViowinImu& t : window_.imu) {
      Add(new EdgeCost<EdgeImu, 7, 9, 7, 9>({t.imu, window_.gravity}, t.sqrt_information),
          {PoseAt(t.i), SpeedBiasAt(t.i), PoseAt(t.j), SpeedBiasAt(t.j)});
    }
  }

  const ViowinWindow& window_;
  WindowKind kind_;
  std::vector<Term> terms_;
  std::vector<double> states_;  // per frame 7 + 9, then the depths
  PoseManifold manifold_;
  std::unique_ptr<ceres::Problem> problem_;
  std::shared_ptr<ceres::ParameterBlockOrdering> ordering_;
};

}  // namespace glissade::bench
