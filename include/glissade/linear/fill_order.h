// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/linear/schur_operator.h"

namespace glissade {

/// In which order a sparse Cholesky factorization should eliminate, so that it makes few blocks
/// that S does not have.
///
/// Up to a few hundred blocks: minimum degree on the elimination graph itself, by scalars, exact;
/// above that approximate minimum degree (Amestoy, Davis and Duff 1996; Eigen's), and nested
/// dissection (Karypis and Kumar 1998; METIS) where the library was built with it and there are
/// thousands. The same order every time.
class FillOrder {
 public:
  /// Writes the blocks in the order of elimination.
  void Find(const SchurLayout& layout, std::vector<std::int32_t>* order);

 private:
  void MinimumDegree(const SchurLayout& layout, std::vector<std::int32_t>* order);
  void ListNeighbours(const SchurLayout& layout);
  void ApproximateMinimumDegree(std::vector<std::int32_t>* order);
  bool Dissect(std::vector<std::int32_t>* order);

  std::vector<std::uint64_t> adjacency_;
  std::vector<std::int32_t> degree_, column_;
  std::vector<std::uint8_t> is_eliminated_;
  std::vector<std::int32_t> begin_, neighbour_;  // of each block, without itself
};

}  // namespace glissade
