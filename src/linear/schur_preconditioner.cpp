// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/schur_preconditioner.h"

#include <algorithm>

#include "glissade/base/index.h"
#include "kernels/kernels.h"

namespace glissade {

namespace {

using internal::Index;

/// Vertices of a cluster at most: of nine scalars each, a factor of 160 kB.
constexpr std::size_t kMaxCluster = 16;
/// Terms of the power series after the first one.
constexpr int kTerms = 3;
/// Clusters that are worth a task of their own.
constexpr std::size_t kClustersPerPart = 64;
constexpr std::size_t kMaxParts = 16;

}  // namespace

void SchurPreconditioner::Plan(const SchurLayout& all_blocks, Preconditioner kind) {
  if (version_ == all_blocks.version && planned_ == kind) return;
  version_ = 0;
  planned_ = kind;
  CutIntoClusters(all_blocks);
  wanted_.clear();
  for (std::size_t k = 0; k < all_blocks.blocks.size(); ++k) {
    const BlockIndex block = all_blocks.blocks[k];
    if (cluster_of_[Index(block.row)] == cluster_of_[Index(block.col)])
      wanted_.push_back(static_cast<std::int32_t>(k));
  }
  version_ = all_blocks.version;
}

// Each cluster grows from the first vertex that is in none by the one that has blocks with the most
// of its members: cameras that see the same landmarks.
void SchurPreconditioner::CutIntoClusters(const SchurLayout& all_blocks) {
  const std::size_t n = all_blocks.num_vertices();
  const std::size_t most = planned_ == Preconditioner::kClusterJacobi ? kMaxCluster : 1;
  clusters_.clear();
  member_.clear();
  cluster_of_.assign(n, -1);
  row_of_.assign(n, 0);
  // Neighbours of each vertex, both ways.
  std::vector<std::int32_t> begin(n + 2, 0), neighbour, links(n, 0), candidates;
  if (most > 1) {
    for (const BlockIndex& block : all_blocks.blocks) {
      ++begin[Index(block.row) + 2];
      ++begin[Index(block.col) + 2];
    }
    for (std::size_t v = 0; v <= n; ++v)
      begin[v + 1] += begin[v];
    neighbour.resize(Index(begin[n + 1]));
    for (const BlockIndex& block : all_blocks.blocks) {
      neighbour[Index(begin[Index(block.row) + 1]++)] = block.col;
      neighbour[Index(begin[Index(block.col) + 1]++)] = block.row;
    }
  }
  std::int64_t factors = 0, scalars = 0;
  for (std::size_t first = 0; first < n; ++first) {
    if (cluster_of_[first] >= 0) continue;
    Cluster cluster;
    cluster.begin = cluster.end = static_cast<std::int32_t>(member_.size());
    cluster.factor = factors;
    cluster.scratch = scalars;
    auto next = static_cast<std::int32_t>(first);
    while (next >= 0) {
      cluster_of_[Index(next)] = static_cast<std::int32_t>(clusters_.size());
      row_of_[Index(next)] = cluster.size;
      cluster.size += all_blocks.Dim(next);
      member_.push_back(next);
      ++cluster.end;
      if (Index(cluster.end - cluster.begin) == most) break;
      for (std::int32_t k = begin[Index(next)]; k < begin[Index(next) + 1]; ++k) {
        const std::int32_t v = neighbour[Index(k)];
        if (cluster_of_[Index(v)] < 0 && links[Index(v)]++ == 0) candidates.push_back(v);
      }
      next = -1;
      for (const std::int32_t v : candidates) {
        if (cluster_of_[Index(v)] >= 0) continue;
        const bool better = next < 0 || links[Index(v)] > links[Index(next)] ||
                            (links[Index(v)] == links[Index(next)] && v < next);
        if (better) next = v;
      }
    }
    for (const std::int32_t v : candidates)
      links[Index(v)] = 0;
    candidates.clear();
    factors += std::int64_t{cluster.size} * cluster.size;
    scalars += cluster.size;
    clusters_.push_back(cluster);
  }
}

template <class F>
void SchurPreconditioner::ForParts(F&& f) const {
  const std::size_t parts =
      std::clamp<std::size_t>(clusters_.size() / kClustersPerPart, 1, kMaxParts);
  const auto run = [&](int part) {
    f(clusters_.size() * Index(part) / parts, clusters_.size() * Index(part + 1) / parts);
  };
  if (threads_ != nullptr) {
    threads_->Run(static_cast<int>(parts), [&](int part) { run(part); });
  } else {
    for (std::size_t part = 0; part < parts; ++part)
      run(static_cast<int>(part));
  }
}

int SchurPreconditioner::Prepare(const SchurOperator& S) {
  kind_ = planned_;
  x_.resize(Index(S.layout().size()));
  if (kind_ == Preconditioner::kJacobi) return FactorDiagonal(S);
  const Cluster& last = clusters_.back();
  factor_.resize(Index(last.factor + std::int64_t{last.size} * last.size));
  if (kind_ == Preconditioner::kPowerSeries) {
    if (FactorPoseBlocks(S)) return -1;
    kind_ = Preconditioner::kBlockJacobi;
  }
  return FactorClusters(S);
}

int SchurPreconditioner::FactorDiagonal(const SchurOperator& S) {
  const SchurLayout& layout = S.layout();
  factor_.resize(Index(layout.size()));
  for (std::size_t k = 0; k < layout.blocks.size(); ++k) {
    if (layout.blocks[k].row != layout.blocks[k].col) continue;
    const std::int64_t offset = layout.offsets[Index(layout.blocks[k].row)];
    const BlockView block = S.Block(k);
    for (int i = 0; i < layout.Dim(layout.blocks[k].row); ++i) {
      const double d = block.data[i + i * block.stride];
      if (!(d > 0.0)) return static_cast<int>(offset) + i;
      factor_[Index(offset + i)] = 1.0 / d;
    }
  }
  return -1;
}

// False where the operator does not have them, or they are not positive definite.
bool SchurPreconditioner::FactorPoseBlocks(const SchurOperator& S) {
  for (const Cluster& cluster : clusters_) {
    double* const factor = factor_.data() + cluster.factor;
    if (!S.PoseDiagonal(member_[Index(cluster.begin)], factor)) return false;
    if (kernels::Kernels().cholesky(cluster.size, factor, cluster.size) != 0) return false;
  }
  return true;
}

int SchurPreconditioner::FactorClusters(const SchurOperator& S) {
  const SchurLayout& layout = S.layout();
  std::fill(factor_.begin(), factor_.end(), 0.0);
  for (std::size_t k = 0; k < layout.blocks.size(); ++k) {
    const BlockIndex at = layout.blocks[k];
    if (cluster_of_[Index(at.row)] != cluster_of_[Index(at.col)]) continue;
    const Cluster& cluster = clusters_[Index(cluster_of_[Index(at.row)])];
    const BlockView block = S.Block(k);
    // Lower triangle: the block or its mirror image.
    const std::int32_t row = row_of_[Index(at.row)], col = row_of_[Index(at.col)];
    double* const factor = factor_.data() + cluster.factor;
    for (int c = 0; c < layout.Dim(at.col); ++c) {
      // Of diagonal blocks the lower triangle counts.
      for (int r = at.row == at.col ? c : 0; r < layout.Dim(at.row); ++r) {
        const std::int32_t i = row + r, j = col + c;
        factor[std::max(i, j) + std::int64_t{std::min(i, j)} * cluster.size] =
            block.data[r + c * block.stride];
      }
    }
  }
  failed_.assign(clusters_.size(), 0);
  ForParts([&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      failed_[c] = kernels::Kernels().cholesky(
          clusters_[c].size, factor_.data() + clusters_[c].factor, clusters_[c].size);
    }
  });
  for (std::size_t c = 0; c < clusters_.size(); ++c) {
    if (failed_[c] == 0) continue;
    const int pivot = failed_[c] - 1;
    for (std::int32_t m = clusters_[c].begin; m < clusters_[c].end; ++m) {
      const std::int32_t v = member_[Index(m)];
      const int row = pivot - row_of_[Index(v)];
      if (row >= 0 && row < layout.Dim(v)) return static_cast<int>(layout.offsets[Index(v)]) + row;
    }
  }
  return -1;
}

void SchurPreconditioner::SolveClusters(const SchurLayout& layout, const double* r, double* z) {
  ForParts([&](std::size_t begin, std::size_t end) {
    for (std::size_t c = begin; c < end; ++c) {
      const Cluster& cluster = clusters_[c];
      double* const x = x_.data() + cluster.scratch;
      for (std::int32_t m = cluster.begin; m < cluster.end; ++m) {
        const std::int32_t v = member_[Index(m)];
        std::copy_n(r + layout.offsets[Index(v)], layout.Dim(v), x + row_of_[Index(v)]);
      }
      kernels::Kernels().cholesky_solve(cluster.size, factor_.data() + cluster.factor, cluster.size,
                                        x);
      for (std::int32_t m = cluster.begin; m < cluster.end; ++m) {
        const std::int32_t v = member_[Index(m)];
        std::copy_n(x + row_of_[Index(v)], layout.Dim(v), z + layout.offsets[Index(v)]);
      }
    }
  });
}

void SchurPreconditioner::Apply(const SchurOperator& S, const double* r, double* z) {
  const SchurLayout& layout = S.layout();
  if (kind_ == Preconditioner::kJacobi) {
    for (std::size_t k = 0; k < factor_.size(); ++k)
      z[k] = factor_[k] * r[k];
    return;
  }
  SolveClusters(layout, r, z);
  if (kind_ != Preconditioner::kPowerSeries) return;
  // The next term is (I - H_pp^-1 S) times the one before it.
  const std::size_t n = Index(layout.size());
  term_.assign(z, z + n);
  product_.resize(n);
  for (int term = 0; term < kTerms; ++term) {
    S.Multiply(term_.data(), product_.data());
    SolveClusters(layout, product_.data(), product_.data());
    for (std::size_t k = 0; k < n; ++k) {
      term_[k] -= product_[k];
      z[k] += term_[k];
    }
  }
}

}  // namespace glissade
