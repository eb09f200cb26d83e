// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "window/init_alignment.h"
#include "window/init_scene.h"

namespace glissade::internal {

/// All states and points of a window in W, to be refined.
struct WindowStates {
  std::vector<Pose> T_w_b;
  std::vector<VertexSpeedBias> speed_biases;
};

/// From V to W: scaled, gravity down, the first body at the origin with yaw 0. The poses and points
/// of the scene are moved along.
WindowStates TakeToWorld(const Alignment& alignment, const Vector3& bg, Scene* scene);

/// One joint least squares over reprojections, IMU factors and the prior of the biases: once with a
/// robust loss, then, with IMU terms of the biases found and without what does not fit, as it is.
/// Fills the state with its covariance and figures, which the caller judges. `vision` is the scene
/// before it was taken to W: it tells how well the same observations fit without an IMU.
InitVerdict RefineJointly(const InitializationInput& input, Scene vision, InertialTerms* terms,
                          Scene* scene, WindowStates* states, MotionState* result);

}  // namespace glissade::internal
