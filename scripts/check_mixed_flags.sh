#!/usr/bin/env bash
# SPDX-FileCopyrightText: 2026 The glissade authors
# SPDX-License-Identifier: BSD-3-Clause
#
# check_mixed_flags.sh CXX ARCHIVE INCLUDE_DIR EIGEN_DIR WORK_DIR
#
# A program of two units that add the same template edge, one compiled without flags and one for
# AVX-512. What is made from packs must not be merged: each unit keeps its own, the plain one touches
# no wide register, and both give the same numbers.
set -euo pipefail
(($# == 5)) || { echo "usage: $0 CXX ARCHIVE INCLUDE_DIR EIGEN_DIR WORK_DIR" >&2; exit 2; }
[[ $(uname -m) == x86_64 ]] || { echo "skipped: not x86-64" >&2; exit 77; }
cxx=$1 archive=$2
metis='' # where the library was built with it
if (($(nm "$archive" 2>/dev/null | grep -c METIS_NodeND || true) > 0)); then metis=-lmetis; fi
flags=(-std=c++20 -I"$3" -isystem "$4")
wide=(-mavx512f -mavx512dq -mavx512vl -mavx512bw -mavx2 -mfma)
mkdir -p "$5" && cd "$5"

cat > unit.h <<'END'
#include "glissade/problem/problem.h"
struct EdgeRange {
  using Vertices = glissade::VertexList<glissade::VertexPose, glissade::VertexPointXYZ>;
  static constexpr int kResidualDim = 1;
  double measured = 0.0;
  static constexpr auto kLanes = glissade::Fields(&EdgeRange::measured);
  template <class T>
  bool Evaluate(const glissade::View<glissade::VertexPose, T>& pose,
                const glissade::View<glissade::VertexPointXYZ, T>& point, const T& range,
                glissade::Vec<T, 1>& r, glissade::Mat<T, 1, 6>* d_pose,
                glissade::Mat<T, 1, 3>* d_point) const {
    const glissade::Vec<T, 3> x = point.p - pose.p;
    r[0] = x[0] * x[0] + x[1] * x[1] + x[2] * x[2] - range;
    const glissade::Mat<T, 1, 3> d = (T(2.0) * x).Transpose();
    if (d_pose) *d_pose = {{-d[0], -d[1], -d[2], T(0.0), T(0.0), T(0.0)}};
    if (d_point) *d_point = d;
    return true;
  }
};
static double Run() {
  glissade::Problem problem;
  const auto pose = problem.AddVertex(glissade::VertexPose{});
  for (int k = 0; k < 13; ++k) {
    const auto point = problem.AddVertex(glissade::VertexPointXYZ(k + 1.0, 0.5 * k, 2.0));
    if (!problem.AddEdge(EdgeRange{0.1 * k}, {pose, point}).ok()) return -1.0;
  }
  // States and costs alone: Eigen's own matrices must not cross between such units.
  glissade::SolveOptions options;
  options.max_iterations = 3;
  const glissade::SolveSummary& summary = problem.Solve(options);
  if (!summary.ok()) return -2.0;
  double sum = summary.initial_cost + summary.final_cost;
  for (const auto& iteration : summary.iterations)
    sum += iteration.cost + iteration.gradient_max;
  return sum;
}
END
echo '#include "unit.h"
double RunWide() { return Run(); }' > wide.cpp
echo '#include "unit.h"
#include <cmath>
#include <cstdio>
double RunWide();
int main() {
  const double plain = Run();
  const double wide = __builtin_cpu_supports("avx512dq") ? RunWide() : plain;
  std::printf("%.17g %.17g\n", plain, wide);
  return plain > 0.0 && std::abs(plain - wide) < 1e-12 * plain ? 0 : 1;
}' > plain.cpp

for level in -O0 -O2; do
  "$cxx" "${flags[@]}" $level -c plain.cpp -o plain.o
  "$cxx" "${flags[@]}" $level "${wide[@]}" -c wide.cpp -o wide.o
  if nm -C plain.o wide.o | grep -E ' [WVuv] .*(Pack|UnitEvaluator)'; then
    echo "FAIL: what is made from packs is weak, at $level" >&2
    exit 1
  fi
  if objdump -d -C --no-show-raw-insn plain.o | grep -qE '%[yz]mm'; then
    echo "FAIL: the plain unit uses wide registers, at $level" >&2
    exit 1
  fi
  for order in "plain.o wide.o" "wide.o plain.o"; do
    # shellcheck disable=SC2086
    "$cxx" $order "$archive" -lpthread $metis -o program
    for isa in baseline avx512; do
      GLISSADE_ISA=$isa ./program || { echo "FAIL: $order at $level, $isa" >&2; exit 1; }
    done
  done
done
echo "ok: units with different flags keep what is theirs"
