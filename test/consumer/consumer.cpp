// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <cstdio>

#include "glissade/base/matrix.h"

int main() {
  const glissade::Vector3 v(1, 2, 2);
  std::printf("norm %g\n", v.norm());
  return v.norm() == 3.0 ? 0 : 1;
}
