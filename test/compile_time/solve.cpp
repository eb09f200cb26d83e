// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The least that solves: built-in types, no header but the ones it names.
#include <glissade/problem/problem.h>
#include <glissade/vertices/pose.h>

int main() {
  glissade::Problem problem;
  const auto pose = problem.AddVertex(glissade::VertexPose{});
  return problem.SetFixed(pose).ok() && problem.Solve().ok() ? 0 : 1;
}
