// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// \file
/// Checks for the vertex and edge types you write: the ones that glissade's own types must pass.
/// They need no test framework; the library's solvers do not use them.

#include "glissade/testing/check_jacobians.h"      // IWYU pragma: export
#include "glissade/testing/check_vertex_axioms.h"  // IWYU pragma: export
