// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>

#include "glissade/graph/first_estimates.h"

namespace glissade {

/// Where one edge reads its vertices and adds its contributions: a record of 32-bit words, written
/// by the structure analysis, read by the edge pools. For an edge of arity N:
///
///     word 0            dense index of the edge in its pool
///     word 1            index of its free landmark, or kNone
///     word 2 + i        dense index of vertex i in its pool
///     word 2 + N + i    offset of vertex i's part of b_p; kNone: fixed; kLandmark: the landmark
///     word 2 + 2N + i   offset of vertex i's W block in the landmark's record, or kNone
///     word 2 + 3N + p   offset of pair p = i (i + 1) / 2 + j (j <= i) in the H_pp buffer; kNone;
///                       Transposed(offset) where the stored block is (j, i) and not (i, j)
///
/// A landmark's record is [H_ll (dl x dl) | b_l (dl) | W block of slot 0 (d0 x dl) | slot 1 | ...];
/// all blocks are row-major and in the full tangent. Records may take more numbers than a word
/// counts: where each begins in the landmark buffer is in NormalEquationsSink::records.
namespace plan {
inline constexpr std::int32_t kNone = -1;
inline constexpr std::int32_t kLandmark = -2;
constexpr std::int32_t Transposed(std::int32_t offset) {
  return -offset - 2;
}
constexpr int Pair(int i, int j) {
  return i * (i + 1) / 2 + j;
}
constexpr int NumPairs(int arity) {
  return arity * (arity + 1) / 2;
}
constexpr int kEdge = 0;
constexpr int kLandmarkIndex = 1;
constexpr int State(int i) {
  return 2 + i;
}
constexpr int Target(int arity, int i) {
  return 2 + arity + i;
}
constexpr int WBlock(int arity, int i) {
  return 2 + 2 * arity + i;
}
constexpr int HBlock(int arity, int pair) {
  return 2 + 3 * arity + pair;
}
constexpr int NumWords(int arity) {
  return 2 + 3 * arity + NumPairs(arity);
}
}  // namespace plan

/// Where a run of edges adds to: H = J'J, b = -J'r in the Gauss-Newton sense (robust weights
/// included). The buffers of one chunk; no two threads share them.
struct NormalEquationsSink {
  double* h_pp = nullptr;
  double* b_p = nullptr;
  double* landmarks = nullptr;
  const std::int64_t* records = nullptr;  ///< of each landmark: where its record begins
  double cost = 0.0;                      ///< 1/2 sum rho(s)
  FirstEstimates first_estimates = FirstEstimates::kFull;
  int failed_edge = -1;  ///< dense index of the first edge that has no finite value
};

}  // namespace glissade
