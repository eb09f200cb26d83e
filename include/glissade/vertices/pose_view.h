// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/vertices/view.h"

namespace glissade::internal {

/// A fixed transform as edges use it.
template <class T>
View<VertexPose, T> ViewOf(const Pose& T_a_b) {
  return Broadcast<T>(View<VertexPose, double>::Of(T_a_b.data));
}

}  // namespace glissade::internal
