// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The library's own edges in packs, compiled once per instruction set as the kernels are, and under
// the same rule: all that such an object has is local to it but its table.

#pragma once

#include "glissade/edges/lane_run.h"

namespace glissade {

struct TypeInfo;

namespace lanes {

/// Of one instruction set; the order is that of dispatch.cpp.
struct Evaluators {
  EvaluateLanes bal;
  EvaluateLanes calibration;
  EvaluateLanes extrinsic;
  EvaluateLanes fisheye;
  EvaluateLanes radial;
  EvaluateLanes radtan;
  EvaluateLanes reprojection;
  EvaluateLanes stereo;
  EvaluateLanes stereo_same;
  EvaluateLanes time_offset;
  EvaluateLanes xyz;
};

/// For the instruction set in use; null where the type is not the library's.
EvaluateLanes EvaluatorOf(const TypeInfo* type);

}  // namespace lanes
}  // namespace glissade
