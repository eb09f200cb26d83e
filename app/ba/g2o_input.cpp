// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/g2o_input.h"

#include <fmt/format.h>

#include <utility>

namespace glissade::app {

Result<G2oInput> LoadG2o(const std::string& file, const Loss& loss, Problem* problem) {
  auto read = ReadG2o(file);
  if (!read.ok()) return read.status();
  G2oInput input;
  input.problem = std::move(read).value();
  auto handles = AddToGraph(input.problem, *problem, {.loss = loss});
  if (!handles.ok()) {
    return Status(handles.status().code(), fmt::format("{}: {}", file, handles.status().message()));
  }
  input.handles = std::move(handles).value();
  return input;
}

std::string WhatIsHeld(const G2oHandles& handles) {
  if (handles.held < 0) return "";
  return fmt::format("vertex {} is held: the file fixes none and has no prior", handles.held);
}

bool IsG2oName(const std::string& path) {
  return path.ends_with(".g2o") || path.ends_with(".g2o.gz") || path.ends_with(".g2o.bz2");
}

}  // namespace glissade::app
