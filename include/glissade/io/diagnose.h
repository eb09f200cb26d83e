// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "glissade/io/viotracks.h"
#include "glissade/window/data_doctor.h"

namespace glissade {

/// The data doctor on a recording; read it with Reading::kAsRecorded, so that it gets to see what
/// is wrong.
[[nodiscard]] DoctorReport Diagnose(const Viotracks& recording, const DoctorOptions& options = {});

}  // namespace glissade
