// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// \file
/// A graph and how it keeps what it is given: for the modules below. Who builds and solves graphs
/// needs graph.h alone, which is half as much to compile.

#include "glissade/graph/dynamic_edge_pool.h"  // IWYU pragma: export
#include "glissade/graph/edge_pool.h"          // IWYU pragma: export
#include "glissade/graph/graph.h"              // IWYU pragma: export
#include "glissade/graph/hold.h"               // IWYU pragma: export
#include "glissade/graph/vertex_pool.h"        // IWYU pragma: export
