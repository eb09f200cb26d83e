// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <vector>

#include "glissade/linear/normal_equations.h"
#include "kernels/schur.h"

namespace glissade {

/// What lambda multiplies at one diagonal entry of H.
inline double DampingOf(const DampingTerm& damping, double diagonal) {
  return damping.identity || damping.reduced_only
             ? 1.0
             : std::clamp(diagonal, damping.min_diagonal, damping.max_diagonal);
}

/// A landmark as the kernels take it; factor: C of its damped H_ll^-1 = C'C.
inline kernels::SchurLandmark LandmarkOf(const Structure& structure, const LandmarkBlock& landmark,
                                         const std::vector<double>& records, const double* factor) {
  const double* b_l = records.data() + landmark.record + landmark.dim * landmark.dim;
  return {landmark.slot_end - landmark.slot_begin,
          landmark.dim,
          structure.slot_row().data() + landmark.slot_begin,
          structure.slot_dim().data() + landmark.slot_begin,
          b_l + landmark.dim,
          factor,
          b_l};
}

}  // namespace glissade
