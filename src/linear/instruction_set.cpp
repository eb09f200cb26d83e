// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/instruction_set.h"

#include "kernels/kernels.h"

namespace glissade {

const char* InstructionSetName() {
  return kernels::Kernels().name;
}

Status CheckInstructionSet() {
  const char* note = kernels::IsaSelectionNote();
  if (*note == '\0') return {};
  return {StatusCode::kInvalidArgument, note};
}

}  // namespace glissade
