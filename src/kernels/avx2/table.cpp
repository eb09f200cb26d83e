// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#define GLISSADE_KERNEL_ISA avx2
#define GLISSADE_KERNEL_ISA_ENUM Isa::kAvx2
#define GLISSADE_KERNEL_WIDTH 4
#include "kernels/impl/table.h"
