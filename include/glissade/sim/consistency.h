// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <limits>
#include <vector>

#include "glissade/base/matrix.h"
#include "glissade/eval/nees.h"
#include "glissade/vertices/pose.h"

namespace glissade::sim {

/// eval::Nees, and infinity where P is not positive definite: an estimator that claims to know a
/// direction perfectly is not to be called consistent.
template <int = 0>
double NormalizedSquare(const Vector3& e, const Matrix3& P) {
  const auto nees = eval::Nees(e, P);
  return nees.ok() ? *nees : std::numeric_limits<double>::infinity();
}

/// Normalized estimation error squared (NEES; Bar-Shalom et al., "Estimation with Applications to
/// Tracking and Navigation", Sec. 5.4) of poses over many runs, position and rotation apart: three
/// degrees of freedom each, so that the mean of a consistent estimator is 3. By keyframe: of a
/// batch, or by age in a sliding window.
class PoseConsistency {
 public:
  explicit PoseConsistency(std::size_t num_keyframes)
      : position_(num_keyframes, 0.0), rotation_(num_keyframes, 0.0), runs_(num_keyframes, 0) {}

  /// One estimate with its marginal covariance (6 x 6, tangent of VertexPose at the estimate). Both
  /// in a fixed gauge that is right about the truth: in another one the covariance is another.
  void Add(std::size_t keyframe, const VertexPose& estimate, const VertexPose& truth,
           const Matrix6& covariance) {
    double e[6];
    estimate.Minus(truth, e);
    position_[keyframe] += NormalizedSquare({e[0], e[1], e[2]}, covariance.topLeftCorner<3, 3>());
    // Error in the axes of the estimate: Log(q^-1 q_true) = -Log(q_true^-1 q).
    rotation_[keyframe] +=
        NormalizedSquare({e[3], e[4], e[5]}, covariance.bottomRightCorner<3, 3>());
    ++runs_[keyframe];
  }

  /// Mean NEES at a keyframe; 0 where there were no runs.
  [[nodiscard]] double Position(std::size_t keyframe) const { return Mean(position_, keyframe); }
  [[nodiscard]] double Rotation(std::size_t keyframe) const { return Mean(rotation_, keyframe); }
  /// Mean over all keyframes that had runs: leave the anchor out by not adding it.
  [[nodiscard]] double Position() const { return MeanOfAll(position_); }
  [[nodiscard]] double Rotation() const { return MeanOfAll(rotation_); }

 private:
  [[nodiscard]] double Mean(const std::vector<double>& sum, std::size_t k) const {
    return runs_[k] > 0 ? sum[k] / runs_[k] : 0.0;
  }
  [[nodiscard]] double MeanOfAll(const std::vector<double>& sum) const {
    double total = 0.0;
    int n = 0;
    for (std::size_t k = 0; k < sum.size(); ++k) {
      total += sum[k];
      n += runs_[k];
    }
    return n > 0 ? total / n : 0.0;
  }

  std::vector<double> position_, rotation_;
  std::vector<int> runs_;
};

}  // namespace glissade::sim
