// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/edges/bal.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/reprojection_calibration.h"
#include "glissade/edges/reprojection_extrinsic.h"
#include "glissade/edges/reprojection_intrinsics.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_stereo_same.h"
#include "glissade/edges/reprojection_time_offset.h"
#include "glissade/edges/reprojection_xyz.h"
#include "kernels/kernels.h"
#include "lanes/evaluators.h"

namespace glissade::lanes {

extern const Evaluators glissade_lanes_baseline;
#if GLISSADE_KERNELS_X86
extern const Evaluators glissade_lanes_avx2;
extern const Evaluators glissade_lanes_avx512;
#endif

namespace {
const Evaluators& Table() {
#if GLISSADE_KERNELS_X86
  const kernels::Isa isa = kernels::Kernels().isa;
  if (isa == kernels::Isa::kAvx512) return glissade_lanes_avx512;
  if (isa == kernels::Isa::kAvx2) return glissade_lanes_avx2;
#endif
  return glissade_lanes_baseline;
}
}  // namespace

EvaluateLanes EvaluatorOf(const TypeInfo* type) {
  const Evaluators& table = Table();
  const struct {
    const TypeInfo* type;
    EvaluateLanes evaluate;
  } all[] = {
      {&kTypeInfo<EdgeReprojection>, table.reprojection},
      {&kTypeInfo<EdgeBal>, table.bal},
      {&kTypeInfo<EdgeReprojectionXYZ>, table.xyz},
      {&kTypeInfo<EdgeReprojectionStereo>, table.stereo},
      {&kTypeInfo<EdgeReprojectionStereoSame>, table.stereo_same},
      {&kTypeInfo<EdgeReprojectionExtrinsic>, table.extrinsic},
      {&kTypeInfo<EdgeReprojectionTimeOffset>, table.time_offset},
      {&kTypeInfo<EdgeReprojectionCalibration>, table.calibration},
      {&kTypeInfo<EdgeReprojectionRadial>, table.radial},
      {&kTypeInfo<EdgeReprojectionRadtan>, table.radtan},
      {&kTypeInfo<EdgeReprojectionFisheye>, table.fisheye},
  };
  for (const auto& entry : all) {
    if (entry.type == type) return entry.evaluate;
  }
  return nullptr;
}

}  // namespace glissade::lanes
