// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Defines the evaluators of one instruction set: included once by each src/lanes/<isa>/table.cpp.

#pragma once

#include "glissade/edges/bal.h"
#include "glissade/edges/evaluate_in_packs.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/reprojection_calibration.h"
#include "glissade/edges/reprojection_extrinsic.h"
#include "glissade/edges/reprojection_intrinsics.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_stereo_same.h"
#include "glissade/edges/reprojection_time_offset.h"
#include "glissade/edges/reprojection_xyz.h"
#include "lanes/evaluators.h"

#define GLISSADE_CONCAT_(a, b) a##b
#define GLISSADE_CONCAT(a, b) GLISSADE_CONCAT_(a, b)
#define GLISSADE_LANES_TABLE GLISSADE_CONCAT(glissade_lanes_, GLISSADE_LANES_ISA)

namespace glissade::lanes {

extern const Evaluators GLISSADE_LANES_TABLE;

namespace {
template <class E>
constexpr EvaluateLanes kEvaluate = &internal::PackEvaluator<E, internal::ThisUnit>::Evaluate;
}  // namespace

const Evaluators GLISSADE_LANES_TABLE = {
    .bal = kEvaluate<EdgeBal>,
    .calibration = kEvaluate<EdgeReprojectionCalibration>,
    .extrinsic = kEvaluate<EdgeReprojectionExtrinsic>,
    .fisheye = kEvaluate<EdgeReprojectionFisheye>,
    .radial = kEvaluate<EdgeReprojectionRadial>,
    .radtan = kEvaluate<EdgeReprojectionRadtan>,
    .reprojection = kEvaluate<EdgeReprojection>,
    .stereo = kEvaluate<EdgeReprojectionStereo>,
    .stereo_same = kEvaluate<EdgeReprojectionStereoSame>,
    .time_offset = kEvaluate<EdgeReprojectionTimeOffset>,
    .xyz = kEvaluate<EdgeReprojectionXYZ>,
};

}  // namespace glissade::lanes
