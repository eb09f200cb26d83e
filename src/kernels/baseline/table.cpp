// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#define GLISSADE_KERNEL_ISA baseline
#define GLISSADE_KERNEL_ISA_ENUM Isa::kBaseline
#define GLISSADE_KERNEL_WIDTH 2
#include "kernels/impl/table.h"
