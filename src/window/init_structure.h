// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "glissade/imu/preintegration.h"
#include "window/init_scene.h"

/// \file
/// Structure from motion: locates all frames of a scene. The gyroscope predicts rotations.
namespace glissade::internal {

/// Points from pairs, one frame after the other, a bundle adjustment. V: the first body.
InitVerdict LocateWithStereo(const std::vector<ImuPreintegration>& terms, Scene* scene);

/// Two frames by their essential matrix, the others in what these see, a bundle adjustment. V: the
/// first of the two, its scale the distance between them. gyro_sigma: how wrong the gyroscope may
/// be (rad/s); false_alarm: of the test for a rotation without parallax.
InitVerdict LocateWithOneCamera(const std::vector<ImuPreintegration>& terms, double gyro_sigma,
                                double false_alarm, Scene* scene);

/// Median depth of the points in the cameras that see them.
double MedianDepth(const Scene& scene);

}  // namespace glissade::internal
