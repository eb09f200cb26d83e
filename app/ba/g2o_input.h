// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/io/g2o.h"
#include "glissade/problem/problem.h"

namespace glissade::app {

/// A g2o file that is being solved.
struct G2oInput {
  G2oProblem problem;
  G2oHandles handles;
};

/// Puts a file into an empty graph.
Result<G2oInput> LoadG2o(const std::string& file, const Loss& loss, Problem* problem);

/// "vertex 0 is held: the file fixes none and has no prior"; empty where none is.
std::string WhatIsHeld(const G2oHandles& handles);

/// Whether a name ends as g2o's files do: .g2o, .g2o.gz, .g2o.bz2.
bool IsG2oName(const std::string& path);

}  // namespace glissade::app
