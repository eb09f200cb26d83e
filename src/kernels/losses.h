// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The losses that have kernels: those of the library. Their second-order term is never positive,
// so that their weight is all there is to them (graph/robust.h).

#ifndef GLISSADE_KERNELS_LOSSES_H_
#define GLISSADE_KERNELS_LOSSES_H_

namespace glissade::kernels {

/// Each with a width per lane; kNone without.
enum class LaneLoss { kNone, kHuber, kCauchy, kTukey };

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_LOSSES_H_
