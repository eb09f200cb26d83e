// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/io/viowin.h"

/// \file
/// The rules of a VIOWIN window, line by line: the reader asks at each line, so that it can name
/// it; Validate() asks for all.
namespace glissade::internal {

Status CheckCamera(const ViowinCamera& camera);
/// what: "keyframe" or "ground truth".
Status CheckKeyframe(const ViowinKeyframe& keyframe, const char* what);
Status CheckLandmark(const ViowinLandmark& landmark, int num_frames);
Status CheckPosePrior(const ViowinPosePrior& prior, int num_frames);
Status CheckSpeedBiasPrior(const ViowinSpeedBiasPrior& prior, int num_frames);
Status CheckImu(const ViowinImu& imu, int num_frames);
Status CheckPriorSize(std::size_t tangent);
Status CheckMarginalPrior(const ViowinMarginalPrior& prior, int num_frames, int num_landmarks);

int AmbientDim(ViowinMarginalPrior::Kind kind);
int TangentDim(ViowinMarginalPrior::Kind kind);

}  // namespace glissade::internal
