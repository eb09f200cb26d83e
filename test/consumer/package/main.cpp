// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Links the components.
#include <cstdio>

#include "glissade/linear/instruction_set.h"
#ifdef HAS_IO
#include "glissade/io/bal.h"
#endif

int main() {
  std::printf("%s\n", glissade::InstructionSetName());
#ifdef HAS_IO
  return glissade::ReadBal("/no/such/file").ok() ? 1 : 0;
#else
  return 0;
#endif
}
