// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include "glissade/problem/problem.h"
#include "glissade/sim/consistency.h"
#include "glissade/sim/vi_world.h"

// Monte-Carlo consistency of batch problems: the errors of the poses are as large as their
// covariances say.

namespace glissade::sim {
namespace {

/// Marginal covariances of all poses but the first, whose position and yaw are held, at the present
/// linearization: inverse of the Schur complement, dense.
std::vector<Matrix6> PoseCovariances(Problem* problem, const ViHandles& handles) {
  EXPECT_TRUE(problem->MakeHessian().ok());
  const Eigen::MatrixXd H = problem->Hessian();
  const auto vertices = problem->FreeVertices();
  const auto offsets = problem->FreeOffsets();
  Eigen::Index kept = H.rows();
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    if (vertices[i] == AnyVertex(handles.points[0])) kept = offsets[i];
  }
  Eigen::MatrixXd S = H.topLeftCorner(kept, kept);
  for (Eigen::Index at = kept; at < H.rows(); at += 3) {  // a point does not touch another one
    const Eigen::Matrix3d h = H.block<3, 3>(at, at).inverse();
    const Eigen::MatrixXd W = H.block(0, at, kept, 3);
    S.noalias() -= W * h * W.transpose();
  }
  const Eigen::MatrixXd P = S.llt().solve(Eigen::MatrixXd::Identity(kept, kept));
  std::vector<Matrix6> covariances(handles.poses.size(), Matrix6::Zero());
  for (std::size_t i = 0; i < vertices.size(); ++i) {
    for (std::size_t k = 1; k < handles.poses.size(); ++k) {
      if (vertices[i] == AnyVertex(handles.poses[k])) {
        covariances[k] = P.block<6, 6>(offsets[i], offsets[i]);
      }
    }
  }
  return covariances;
}

/// `assumed_sigma` px in the estimator, 1 px in the data.
PoseConsistency RunMonteCarlo(const ViWorldOptions& world_options, double assumed_sigma, int runs) {
  ViWorldOptions options = world_options;
  options.perturb_first = false;  // the gauge is held at the truth
  options.camera.sigma_px = assumed_sigma;
  const auto world = MakeViWorld(options);
  EXPECT_TRUE(world.ok()) << world.status().message();
  const auto n = static_cast<std::size_t>(options.num_keyframes);
  PoseConsistency nees(n);
  for (int seed = 1; seed <= runs; ++seed) {
    const auto measured = Measure(*world, static_cast<std::uint64_t>(seed));
    EXPECT_TRUE(measured.ok());
    Problem problem;
    const auto handles = AddToGraph(*measured, {}, &problem);
    EXPECT_TRUE(handles.ok());
    EXPECT_TRUE(problem.SetFixed(handles->poses[0], Fix::kPositionAndYaw).ok());
    const SolveSummary& summary = problem.Solve({.cost_tolerance = 1e-10});
    EXPECT_TRUE(summary.converged()) << seed << ": " << summary.BriefReport();
    const auto covariances = PoseCovariances(&problem, *handles);
    for (std::size_t k = 1; k < n; ++k)  // not the anchor
      nees.Add(k, problem.Get(handles->poses[k]), measured->truth.poses[k], covariances[k]);
  }
  return nees;
}

/// A good MAV's IMU and camera.
ViWorldOptions World() {
  ViWorldOptions options;
  options.num_points = 60;
  options.imu_noise = ImuNoise{};
  options.pixel_noise = 1.0;
  options.camera.fx = options.camera.fy = 460.0;
  options.camera.cx = 376.0;
  options.camera.width = 752;
  return options;
}

bool Consistent(const PoseConsistency& nees, std::size_t last, double low, double high) {
  const double means[] = {nees.Position(last), nees.Rotation(last), nees.Position(),
                          nees.Rotation()};
  bool good = true;
  for (const double mean : means)
    good = good && mean >= low && mean <= high;
  std::printf("[ measured ] NEES, last keyframe: position %.4f, rotation %.4f; all: %.4f, %.4f\n",
              means[0], means[1], means[2], means[3]);
  return good;
}

#if defined(NDEBUG) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
constexpr int kRuns = 1000;  // the mean of 1000 with three degrees of freedom has sigma 0.077
constexpr double kLow = 2.85, kHigh = 3.15;
#else
constexpr int kRuns = 60;  // sigma 0.32
constexpr double kLow = 2.0, kHigh = 4.0;
#endif

TEST(Nees, BatchIsConsistent) {
  EXPECT_TRUE(Consistent(RunMonteCarlo(World(), 1.0, kRuns), 9, kLow, kHigh));
}

TEST(Nees, APixelSigmaTooSmallIsFound) {
  const PoseConsistency nees = RunMonteCarlo(World(), 1.0 / 1.3, kRuns);
  EXPECT_FALSE(Consistent(nees, 9, kLow, kHigh));
}

TEST(Nees, OfASingleError) {
  Matrix3 P;
  P << 4, 1, 0, 1, 9, 2, 0, 2, 1;
  const Vector3 e(1, -2, 0.5);
  EXPECT_NEAR(NormalizedSquare(e, P), e.dot(P.inverse() * e), 1e-13);
  EXPECT_TRUE(std::isinf(NormalizedSquare(e, Matrix3::Zero())));
  P = -Matrix3::Identity();
  EXPECT_TRUE(std::isinf(NormalizedSquare(e, P)));
}

}  // namespace
}  // namespace glissade::sim
