// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/base/thread_pool.h"
#include "glissade/linear/preconditioner.h"
#include "glissade/linear/schur_operator.h"

namespace glissade {

/// z = M^-1 r for conjugate gradients on S, M symmetric and positive definite: block diagonal, in
/// blocks of clusters of vertices (of one in kJacobi, kBlockJacobi and kPowerSeries).
class SchurPreconditioner {
 public:
  /// Cuts the vertices into clusters; once per layout and kind.
  void Plan(const SchurLayout& all_blocks, Preconditioner kind);
  /// Blocks of all_blocks within clusters, ascending.
  [[nodiscard]] std::span<const std::int32_t> wanted() const { return wanted_; }
  /// What there is since Prepare().
  [[nodiscard]] Preconditioner kind() const { return kind_; }
  void UseThreads(ThreadPool* threads) { threads_ = threads; }

  /// Factors the blocks. Returns the scalar pivot that is not positive, or -1.
  int Prepare(const SchurOperator& S);
  void Apply(const SchurOperator& S, const double* r, double* z);

 private:
  struct Cluster {
    std::int32_t begin = 0, end = 0;  // in member_
    std::int32_t size = 0;            // scalars
    std::int64_t factor = 0;          // offset in factor_
    std::int64_t scratch = 0;         // in x_
  };
  void CutIntoClusters(const SchurLayout& all_blocks);
  int FactorDiagonal(const SchurOperator& S);
  bool FactorPoseBlocks(const SchurOperator& S);
  int FactorClusters(const SchurOperator& S);
  void SolveClusters(const SchurLayout& layout, const double* r, double* z);
  template <class F>
  void ForParts(F&& f) const;

  Preconditioner planned_ = Preconditioner::kBlockJacobi, kind_ = Preconditioner::kBlockJacobi;
  std::uint64_t version_ = 0;
  ThreadPool* threads_ = nullptr;
  std::vector<std::int32_t> wanted_;
  std::vector<Cluster> clusters_;
  std::vector<std::int32_t> member_;      // vertices, cluster by cluster
  std::vector<std::int32_t> cluster_of_;  // by vertex
  std::vector<std::int32_t> row_of_;      // by vertex: first row in its cluster
  std::vector<double> factor_, x_, term_, product_;
  std::vector<int> failed_;
};

}  // namespace glissade
