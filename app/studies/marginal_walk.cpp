// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "studies/marginal_walk.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "common/interrupt.h"
#include "glissade/covariance/covariance.h"
#include "glissade/gauge/nullspace.h"
#include "glissade/lie/so3.h"

namespace glissade::app {

namespace {

/// Rotation about the vertical that takes one pose to the other (rad).
double YawBetween(const Pose& from, const Pose& to) {
  return so3::Log(Matrix3(to.R() * from.R().transpose()))[2];
}

/// `pose` seen from `from`, which keeps its position and yaw: turned about the vertical and moved.
Pose Relative(const Pose& from, const Pose& pose, const Pose& truth_of_from) {
  const Matrix3 Rz = so3::Exp(Vector3(0, 0, YawBetween(from, truth_of_from)));
  return Pose(Quaternion(Matrix3(Rz * pose.R())),
              Vector3(Rz * (pose.p() - from.p()) + truth_of_from.p()));
}

class Walker {
 public:
  Walker(const sim::ViProblem& data, const WalkOptions& options)
      : data_(data), options_(options), window_(&data, options.front_end, &problem_) {
    problem_.SetFirstEstimates(options.mode);
  }

  Status Run(std::vector<WalkFrame>* frames) {
    for (std::size_t k = 0; k < data_.stamps_ns.size() && !Interrupted(); ++k) {
      if (Status s = window_.AddKeyframe(); !s.ok()) return s;
      if (window_.size() < options_.window) continue;
      WalkFrame frame;
      frame.keyframe = static_cast<int>(k);
      // The first time it is a batch, begun from afar.
      if (Status s = Solve(window_.size() == options_.window, &frame); !s.ok()) return s;
      if (Interrupted()) break;
      if (window_.size() == options_.window) continue;
      if (Status s = Judge(&frame); !s.ok()) return s;
      if (Status s = Marginalize(&frame); !s.ok()) return s;
      frames->push_back(frame);
    }
    return {};
  }

 private:
  [[nodiscard]] Pose Estimate(const sim::ViWindow::Keyframe& k) const {
    return problem_.Get(k.pose).pose;
  }
  [[nodiscard]] const Pose& Truth(const sim::ViWindow::Keyframe& k) const {
    return data_.truth.poses[k.number].pose;
  }

  Status Solve(bool first, WalkFrame* frame) {
    constexpr int kAttempts = 5;
    SolveOptions solve = options_.solve;
    if (first) solve.max_iterations = std::max(solve.max_iterations, 100);
    if (options_.fixed_gauge) solve.gauge = Gauge::Fixed{window_.keyframes().front().pose};
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const SolveSummary& summary = problem_.Solve(solve);
      if (!summary.ok()) return summary.status;
      frame->cost = summary.final_cost;
      frame->iterations += summary.accepted_steps + summary.rejected_steps;
      frame->rejected += summary.rejected_steps;
      frame->solve_ms += 1e3 * summary.time.total_s;
      const auto removed = window_.RemovePointsBehind();
      if (!removed.ok()) return removed.status();
      frame->removed_points += removed.value();
      if (removed.value() == 0) break;
    }
    return {};
  }

  /// In the gauge of the oldest keyframe, without points whose distance nothing tells.
  Result<JointCovariance> CovarianceOfNewest() {
    constexpr int kAttempts = 20;
    Problem clone = problem_.Clone();
    for (const auto& point : window_.PointsSeenOnce()) {
      if (Status s = clone.RemoveVertex(point); !s.ok()) return s;
    }
    Covariance covariance;
    Status status;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      status =
          covariance.Compute(&clone, {.gauge = Gauge::Fixed{window_.keyframes().front().pose}});
      if (status.ok()) return covariance.Joint({window_.keyframes().back().pose});
      if (status.code() != StatusCode::kSingular) break;
      const std::vector<AnyVertex> uninformed = covariance.Uninformed();
      for (const AnyVertex& vertex : uninformed) {
        if (vertex.type != &kTypeInfo<VertexPointXYZ>) return status;
        if (Status s = clone.RemoveVertex(vertex); !s.ok()) return s;
      }
    }
    return status;
  }

  Status Judge(WalkFrame* frame) {
    const auto &oldest = window_.keyframes().front(), &second = window_.keyframes()[1],
               &newest = window_.keyframes().back();
    const auto covariance = CovarianceOfNewest();
    if (!covariance.ok()) return covariance.status();
    const Eigen::MatrixXd P = covariance->Block(newest.pose);
    const Pose truth = Relative(Truth(oldest), Truth(newest), Estimate(oldest));
    const Pose estimate = Estimate(newest);
    const Vector3 e = estimate.p() - truth.p();
    frame->nees_position = e.dot(P.topLeftCorner<3, 3>().inverse() * e) / 3.0;
    const double yaw = YawBetween(truth, estimate);
    const Vector3 z = estimate.R().transpose() * Vector3(0, 0, 1);
    frame->nees_yaw = yaw * yaw / z.dot(P.bottomRightCorner<3, 3>() * z);

    if (way_.empty()) way_.push_back(Truth(oldest));
    way_.push_back(Relative(Estimate(oldest), Estimate(second), way_.back()));
    frame->drift_m = (way_.back().p() - Truth(second).p()).norm();
    const std::span<const double> first = problem_.LinearizationPoint(oldest.pose);
    VertexPose x_lin;
    std::copy_n(first.data(), 7, x_lin.Data());
    frame->yaw_since_linearized = YawBetween(x_lin.pose, Estimate(oldest));
    return {};
  }

  Status Marginalize(WalkFrame* frame) {
    const auto done = problem_.Marginalize(window_.TakeOldest());
    if (!done.ok()) return done.status();
    const auto report = CheckNullspace(&problem_);
    if (!report.ok()) return report.status();
    for (const NullspaceDirection& direction : report->directions) {
      if (direction.name == "yaw") {
        frame->kappa_yaw = direction.kappa;
        frame->yaw_information = direction.information;
      } else {
        frame->kappa_position = std::max(frame->kappa_position, direction.kappa);
      }
    }
    return {};
  }

  const sim::ViProblem& data_;
  const WalkOptions& options_;
  Problem problem_;
  sim::ViWindow window_;
  std::vector<Pose> way_;
};

}  // namespace

Result<std::vector<WalkFrame>> WalkWindow(const sim::ViProblem& data, const WalkOptions& options) {
  std::vector<WalkFrame> frames;
  if (Status s = Walker(data, options).Run(&frames); !s.ok()) return s;
  return frames;
}

}  // namespace glissade::app
