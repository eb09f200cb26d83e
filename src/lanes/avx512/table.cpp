// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#define GLISSADE_LANES_ISA avx512
#include "lanes/table.h"
