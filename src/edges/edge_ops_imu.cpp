// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What the library knows of its own edges at run time: compiled here, and nowhere else.

#include "glissade/edges/imu.h"
#include "glissade/edges/speed_bias_prior.h"

namespace glissade {

template struct internal::EdgeOpsOf<EdgeImu>;
template struct internal::EdgeOpsOf<EdgeSpeedBiasPrior>;

}  // namespace glissade
