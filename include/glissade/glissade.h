// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// \file
/// Everything one needs to build and solve a problem, visual or visual-inertial. Modules apart from
/// this (io, sim, bridge, testing) are included by name.

// Before all others, so that what the compiler says of an edge begins with few lines "included
// from".
#include "glissade/edges/diagnostics.h"
//
#include "glissade/covariance/transform.h"
#include "glissade/edges/bal.h"
#include "glissade/edges/imu.h"
#include "glissade/edges/pose_point.h"
#include "glissade/edges/pose_prior_vec.h"
#include "glissade/edges/relative_pose.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/reprojection_calibration.h"
#include "glissade/edges/reprojection_extrinsic.h"
#include "glissade/edges/reprojection_intrinsics.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_stereo_same.h"
#include "glissade/edges/reprojection_time_offset.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/edges/speed_bias_prior.h"
#include "glissade/imu/buffer.h"
#include "glissade/imu/imu_factor.h"
#include "glissade/imu/preintegration.h"
#include "glissade/imu/reintegration.h"
#include "glissade/linear/linear_solver.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/losses/trivial.h"
#include "glissade/losses/tukey.h"
#include "glissade/marginal/schur_complement.h"
#include "glissade/problem/problem.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/vertices/vector.h"
