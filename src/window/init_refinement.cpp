// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "window/init_refinement.h"

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "glissade/edges/imu.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/edges/speed_bias_prior.h"
#include "glissade/imu/imu_factor.h"
#include "glissade/losses/cauchy.h"
#include "glissade/problem/problem.h"
#include "window/upright.h"
#include "window/verdicts.h"

namespace glissade::internal {

namespace {

constexpr double kMaxChi2 = 13.8;  // 0.1 % of chi2 with 2 degrees of freedom

/// The graph of one refinement.
struct Refinement {
  Problem problem;
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<VertexSpeedBias>> speed_biases;
  std::vector<VertexHandle<VertexPointXYZ>> points;  ///< by track
  int observations = 0, num_points = 0;
  Status status;

  Refinement(const InitializationInput& input, const InertialTerms& terms, const Scene& scene,
             const WindowStates& states, const Loss& loss) {
    for (const Pose& T_w_b : states.T_w_b)
      poses.push_back(problem.AddVertex(VertexPose{T_w_b}));
    for (const VertexSpeedBias& speed_bias : states.speed_biases)
      speed_biases.push_back(problem.AddVertex(speed_bias));
    points.resize(scene.tracks.size());
    for (std::size_t j = 0; j < scene.tracks.size(); ++j) {
      const SightedTrack& track = scene.tracks[j];
      if (!track.has_point) continue;
      points[j] = problem.AddVertex(VertexPointXYZ(track.point));
      ++num_points;
      for (const Sight& sight : track.sights) {
        if (sight.bad) continue;
        const RigCamera& camera = scene.cameras[sight.camera];
        EdgeReprojectionXYZ edge;
        edge.uv = sight.xy;
        edge.T_b_c = scene.T_b_r * camera.T_r_c;
        EdgeOptions<EdgeReprojectionXYZ> options;
        options.sqrt_information = camera.whitening;
        options.loss = loss;
        Keep(problem.AddEdge(edge, {poses[sight.frame], points[j]}, options).status());
        ++observations;
      }
    }
    for (std::size_t k = 0; k < terms.terms().size(); ++k) {
      auto factor = MakeImuFactor(terms.terms()[k]);
      Keep(factor.status());
      if (!factor.ok()) return;
      factor->edge.gravity = Vector3(0.0, 0.0, -input.gravity);
      Keep(problem
               .AddEdge(factor->edge,
                        {poses[k], speed_biases[k], poses[k + 1], speed_biases[k + 1]},
                        factor->options)
               .status());
    }
    EdgeSpeedBiasPrior prior;
    prior.prior =
        VertexSpeedBias(Vector3::Zero(), input.bias_prior.mean.ba, input.bias_prior.mean.bg);
    Vector<9> weights = Vector<9>::Zero();
    weights.segment<3>(3).setConstant(1.0 / input.bias_prior.accel_sigma);
    weights.segment<3>(6).setConstant(1.0 / input.bias_prior.gyro_sigma);
    EdgeOptions<EdgeSpeedBiasPrior> options;
    options.sqrt_information = SquareMatrix<9>(weights.asDiagonal());
    Keep(problem.AddEdge(prior, {speed_biases[0]}, options).status());
  }

  void Keep(const Status& s) {
    if (status.ok()) status = s;
  }
  [[nodiscard]] Gauge gauge() const { return Gauge::Fixed{.anchor = poses[0]}; }

  Status Solve(int iterations, double tolerance) {
    if (!status.ok()) return status;
    SolveOptions options;
    options.max_iterations = iterations;
    options.cost_tolerance = tolerance;
    options.gauge = gauge();
    return problem.Solve(options).status;
  }

  /// States and points back to where they came from; what does not fit is marked.
  void Read(Scene* scene, WindowStates* states) const {
    for (std::size_t k = 0; k < poses.size(); ++k) {
      states->T_w_b[k] = problem.Get(poses[k]).pose;
      states->speed_biases[k] = problem.Get(speed_biases[k]);
      scene->poses[k] = states->T_w_b[k] * scene->T_b_r;
    }
    for (std::size_t j = 0; j < points.size(); ++j) {
      SightedTrack& track = scene->tracks[j];
      if (!track.has_point) continue;
      track.point = problem.Get(points[j]).p();
      std::size_t good = 0;
      for (Sight& sight : track.sights) {
        const RigCamera& camera = scene->cameras[sight.camera];
        const Pose T_w_c = scene->poses[sight.frame] * camera.T_r_c;
        const Vector3 c = T_w_c.Inverse() * track.point;
        const Vector2 r = camera.whitening * (Vector2(c[0] / c[2], c[1] / c[2]) - sight.xy);
        sight.bad = !(c[2] > 0.0 && r.squaredNorm() < kMaxChi2);
        if (!sight.bad) ++good;
      }
      // A point without depth has nothing to say of the scale, and its block cannot be inverted.
      track.has_point = good >= 2 && IsDetermined(*scene, track);
    }
  }
};

/// Sigma of the logarithm of s that minimizes sum |s dp_k - truth|^2 over the positions about their
/// mean: d log s = sum dp_k' d p_k / sum |dp_k|^2.
double LogScaleSigma(const JointCovariance& joint, const std::vector<Pose>& T_w_b) {
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Pose& pose : T_w_b)
    mean += pose.p() / static_cast<double>(T_w_b.size());
  Eigen::VectorXd w = Eigen::VectorXd::Zero(joint.size());
  double squares = 0.0;
  for (std::size_t k = 0; k < T_w_b.size(); ++k) {
    const Eigen::Vector3d d = T_w_b[k].p() - mean;
    w.segment<3>(joint.offsets[k]) = d;
    squares += d.squaredNorm();
  }
  const Eigen::Map<const Eigen::MatrixXd> C(joint.values.data(), joint.size(), joint.size());
  return std::sqrt(std::max(0.0, w.dot(C * w))) / squares;
}

double LargestSigma(const Eigen::Matrix3d& C) {
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(C, Eigen::EigenvaluesOnly);
  return std::sqrt(std::max(0.0, eigen.eigenvalues()[2]));
}

/// Covariance and the figures that are drawn from it.
Status FillCovariance(Refinement* refined, const WindowStates& states, MotionState* result) {
  Covariance covariance;
  CovarianceOptions options;
  options.gauge = refined->gauge();
  if (Status s = covariance.Compute(&refined->problem, options); !s.ok()) return s;
  std::vector<AnyVertex> vertices(refined->poses.begin(), refined->poses.end());
  vertices.push_back(refined->speed_biases.back());
  const auto joint = covariance.Joint(vertices);
  if (!joint.ok()) return joint.status();
  const Eigen::Map<const Eigen::MatrixXd> C(joint->values.data(), joint->size(), joint->size());
  result->covariance = C.bottomRightCorner<15, 15>();
  result->log_scale_sigma = LogScaleSigma(*joint, states.T_w_b);
  result->velocity_sigma = LargestSigma(C.block<3, 3>(joint->size() - 9, joint->size() - 9));
  // Tilt: the rotation about axes across the vertical.
  const Eigen::Vector3d up = states.T_w_b.back().R().transpose() * Vector3::UnitZ();
  const Eigen::Matrix3d across = Eigen::Matrix3d::Identity() - up * up.transpose();
  result->gravity_sigma =
      LargestSigma(across * C.block<3, 3>(joint->size() - 12, joint->size() - 12) * across);
  return {};
}

}  // namespace

WindowStates TakeToWorld(const Alignment& alignment, const Vector3& bg, Scene* scene) {
  WindowStates states;
  const Pose T_r_b = scene->T_b_r.Inverse();
  std::vector<Pose> T_v_b;  // metric
  for (const Pose& T_v_r : scene->poses) {
    Pose scaled = T_v_r;
    scaled.p() *= alignment.scale;
    T_v_b.push_back(scaled * T_r_b);
  }
  const Matrix3 R_v_b0 = T_v_b[0].R();
  const Vector3 up = R_v_b0.transpose() * (-alignment.gravity.normalized());
  const Pose T_w_v = Pose(UprightWithoutYaw(up), Vector3::Zero()) * T_v_b[0].Inverse();
  for (std::size_t k = 0; k < T_v_b.size(); ++k) {
    states.T_w_b.push_back(T_w_v * T_v_b[k]);
    scene->poses[k] = states.T_w_b.back() * scene->T_b_r;
    states.speed_biases.emplace_back(Vector3(T_w_v.R() * alignment.velocities[k]), alignment.ba,
                                     bg);
  }
  for (SightedTrack& track : scene->tracks) {
    if (track.has_point) track.point = T_w_v * Vector3(alignment.scale * track.point);
  }
  return states;
}

InitVerdict RefineJointly(const InitializationInput& input, Scene vision, InertialTerms* terms,
                          Scene* scene, WindowStates* states, MotionState* result) {
  const auto failed = [](const Status& s) {
    return InitVerdict{InitReason::kNotConverged, 0.0, 0.0, s.message()};
  };
  {
    Refinement robust(input, *terms, *scene, *states, Cauchy{2.0});
    if (Status s = robust.Solve(30, 1e-4); !s.ok()) return failed(s);
    robust.Read(scene, states);
  }
  const VertexSpeedBias& newest = states->speed_biases.back();
  if (Status s = terms->Integrate({.ba = newest.ba(), .bg = newest.bg()}); !s.ok()) {
    return failed(s);
  }
  Refinement last(input, *terms, *scene, *states, Loss());
  if (last.num_points < kMinTracks) {
    return Refusal(InitReason::kNotConverged, last.num_points, kMinTracks,
                   "number of tracks that fit", "");
  }
  if (Status s = last.Solve(50, 1e-7); !s.ok()) return failed(s);
  const auto chi2 = last.problem.Chi2();
  if (!chi2.ok()) return failed(chi2.status());
  const int frames = static_cast<int>(states->T_w_b.size());
  const int rows = 2 * last.observations + 15 * (frames - 1) + 6;
  const int unknowns = 15 * frames - 4 + 3 * last.num_points;
  result->chi2_per_dof = *chi2 / std::max(1, rows - unknowns);
  for (std::size_t j = 0; j < vision.tracks.size(); ++j) {
    vision.tracks[j].has_point = scene->tracks[j].has_point;
    for (std::size_t k = 0; k < vision.tracks[j].sights.size(); ++k)
      vision.tracks[j].sights[k].bad = scene->tracks[j].sights[k].bad;
  }
  // What the IMU adds: 15 rows an interval, a prior of 6; 9 numbers a frame, and less gauge.
  const double vision_chi2 = VisionChi2(vision);
  const int vision_gauge = scene->stereo ? 6 : 7;
  const int vision_dof = 2 * last.observations - 6 * frames + vision_gauge - 3 * last.num_points;
  const double per_dof = std::max(1.0, vision_chi2 / std::max(1, vision_dof));
  const int imu_dof = std::max(1, rows - unknowns - vision_dof);
  result->imu_chi2_per_dof = (*chi2 - vision_chi2) / (per_dof * imu_dof);
  result->imu_dof = imu_dof;
  result->observations = last.observations;
  result->stereo = scene->stereo;
  for (std::size_t k = 0; k < states->T_w_b.size(); ++k) {
    states->T_w_b[k] = last.problem.Get(last.poses[k]).pose;
    states->speed_biases[k] = last.problem.Get(last.speed_biases[k]);
    result->frames.push_back({.stamp_ns = input.frames[k].stamp_ns,
                              .pose = {states->T_w_b[k]},
                              .speed_bias = states->speed_biases[k]});
  }
  for (std::size_t j = 0; j < scene->tracks.size(); ++j) {
    const SightedTrack& track = scene->tracks[j];
    for (const Sight& sight : track.sights)
      result->outliers += sight.bad ? 1 : 0;
    if (!track.has_point) continue;
    result->points.push_back({.track = track.id, .p_w = last.problem.Get(last.points[j]).p()});
  }
  if (Status s = FillCovariance(&last, *states, result); !s.ok()) {
    return Refusal(
        s.code() == StatusCode::kSingular ? InitReason::kNoAcceleration : InitReason::kNotConverged,
        std::numeric_limits<double>::infinity(), 0.0, "the covariance", "");
  }
  return {};
}

}  // namespace glissade::internal
