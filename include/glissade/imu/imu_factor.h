// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/base/status.h"
#include "glissade/edges/imu.h"
#include "glissade/graph/edge_options.h"
#include "glissade/imu/preintegration.h"

namespace glissade {

/// An edge with its weight, ready for `graph.AddEdge(factor.edge, {pose_i, speed_bias_i, pose_j,
/// speed_bias_j}, factor.options)`.
struct ImuFactor {
  EdgeImu edge;
  EdgeOptions<EdgeImu> options;  ///< sqrt_information: U, upper triangular
  ImuGapReport gaps;             ///< what the weight allows for
};

namespace internal {
Status SqrtInformation15(const double* covariance, double* sqrt_information);  // row-major
}

/// U, upper triangular, with U' U = covariance^-1 (order of EdgeImu). Factored after scaling to a
/// unit diagonal, so that units do not matter. kNotFinite, or kNotPositive where a pivot of the
/// scaled matrix is under 1e-13; then U is left as it was. Nothing not finite gets out.
template <int = 0>
Status SqrtInformationOf(const SquareMatrix<15>& covariance, SquareMatrix<15>* U) {
  return internal::SqrtInformation15(covariance.data(), U->data());
}

/// The edge of an interval: residual as in Forster et al., Eq. (45) and (48), with the rotation as
/// 2 vec(.). `edge.gravity` is the default; set it if yours differs.
[[nodiscard]] Result<ImuFactor> MakeImuFactor(const ImuPreintegration& preintegration);

/// Where the body is at the end of an interval.
struct ImuPrediction {
  VertexPose pose;
  VertexSpeedBias speed_bias;  ///< biases as at the beginning
};

/// The state at which the residual of the edge is zero: Forster et al., Eq. (38) without noise,
/// with the first-order bias correction, Eq. (44). Finite for finite input.
[[nodiscard]] ImuPrediction Predict(const EdgeImu& edge, const VertexPose& pose_i,
                                    const VertexSpeedBias& speed_bias_i);

}  // namespace glissade
