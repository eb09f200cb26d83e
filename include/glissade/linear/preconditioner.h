// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace glissade {

/// Of conjugate gradients on the reduced system.
enum class Preconditioner {
  kJacobi,       ///< scalar diagonal
  kBlockJacobi,  ///< inverse diagonal blocks, one per vertex
};

}  // namespace glissade
