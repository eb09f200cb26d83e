// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/fill_order.h"

#include <algorithm>
#include <bit>
#include <new>
#include <numeric>

#include <Eigen/OrderingMethods>
#include <Eigen/SparseCore>
#if GLISSADE_HAVE_METIS
#include <metis.h>
#endif

#include "glissade/base/index.h"

namespace glissade {

namespace {

using internal::Index;

/// The exact search takes a time that grows with the square of the number of blocks.
constexpr std::size_t kMaxExact = 400;
/// Below that dissection makes no better orders than minimum degree.
constexpr std::size_t kMinDissection = 2000;

}  // namespace

void FillOrder::Find(const SchurLayout& layout, std::vector<std::int32_t>* order) {
  order->clear();
  if (layout.num_vertices() <= kMaxExact) return MinimumDegree(layout, order);
  ListNeighbours(layout);
  if (layout.num_vertices() >= kMinDissection && Dissect(order)) return;
  ApproximateMinimumDegree(order);
}

// On the elimination graph itself, as bit rows. Ties go to the lower number.
void FillOrder::MinimumDegree(const SchurLayout& layout, std::vector<std::int32_t>* order) {
  const int n = static_cast<int>(layout.num_vertices());
  const std::size_t words = Index((n + 63) / 64);
  adjacency_.assign(Index(n) * words, 0);
  const auto row_of = [&](int block) { return adjacency_.data() + Index(block) * words; };
  const auto set = [](std::uint64_t* row, int bit) {
    row[bit / 64] |= std::uint64_t{1} << (bit % 64);
  };
  for (const BlockIndex& block : layout.blocks) {
    set(row_of(block.row), block.col);
    set(row_of(block.col), block.row);
  }
  const auto for_each = [&](const std::uint64_t* row, auto&& f) {
    for (std::size_t w = 0; w < words; ++w) {
      for (std::uint64_t bits = row[w]; bits != 0; bits &= bits - 1) {
        f(static_cast<int>(w * 64) + std::countr_zero(bits));
      }
    }
  };
  degree_.assign(Index(n), 0);  // in scalars
  is_eliminated_.assign(Index(n), 0);
  for (int i = 0; i < n; ++i) {
    row_of(i)[i / 64] &= ~(std::uint64_t{1} << (i % 64));
    for_each(row_of(i), [&](int j) { degree_[Index(i)] += layout.Dim(j); });
  }
  for (int step = 0; step < n; ++step) {
    int best = -1;
    for (int i = 0; i < n; ++i) {
      if (is_eliminated_[Index(i)] == 0 && (best < 0 || degree_[Index(i)] < degree_[Index(best)]))
        best = i;
    }
    is_eliminated_[Index(best)] = 1;
    order->push_back(best);
    column_.clear();
    const std::uint64_t* eliminated = row_of(best);
    for_each(eliminated, [&](int j) { column_.push_back(j); });
    // The neighbours become a clique without the eliminated block.
    for (const std::int32_t j : column_) {
      std::uint64_t* row = row_of(j);
      for (std::size_t w = 0; w < words; ++w)
        row[w] |= eliminated[w];
      row[j / 64] &= ~(std::uint64_t{1} << (j % 64));
      row[best / 64] &= ~(std::uint64_t{1} << (best % 64));
      degree_[Index(j)] = 0;
      for_each(row, [&](int k) { degree_[Index(j)] += layout.Dim(k); });
    }
  }
}

void FillOrder::ListNeighbours(const SchurLayout& layout) {
  const std::size_t n = layout.num_vertices();
  begin_.assign(n + 2, 0);
  for (const BlockIndex& block : layout.blocks) {
    if (block.row == block.col) continue;
    ++begin_[Index(block.row) + 2];
    ++begin_[Index(block.col) + 2];
  }
  std::partial_sum(begin_.begin(), begin_.end(), begin_.begin());
  neighbour_.resize(Index(begin_[n + 1]));
  for (const BlockIndex& block : layout.blocks) {
    if (block.row == block.col) continue;
    neighbour_[Index(begin_[Index(block.row) + 1]++)] = block.col;
    neighbour_[Index(begin_[Index(block.col) + 1]++)] = block.row;
  }
  begin_.pop_back();
}

void FillOrder::ApproximateMinimumDegree(std::vector<std::int32_t>* order) {
  const auto n = static_cast<int>(begin_.size()) - 1;
  using Pattern = Eigen::SparseMatrix<double, Eigen::ColMajor, int>;
  const std::vector<double> ones(neighbour_.size(), 1.0);
  const Eigen::Map<const Pattern> graph(n, n, static_cast<int>(neighbour_.size()), begin_.data(),
                                        neighbour_.data(), ones.data());
  // The ordering wants the diagonal too.
  Pattern pattern(n, n);
  pattern.setIdentity();
  pattern += graph;
  Eigen::AMDOrdering<int>::PermutationType permutation;
  Eigen::AMDOrdering<int>()(pattern, permutation);
  order->assign(permutation.indices().data(), permutation.indices().data() + n);
}

#if GLISSADE_HAVE_METIS
bool FillOrder::Dissect(std::vector<std::int32_t>* order) {
  static_assert(sizeof(idx_t) == sizeof(std::int32_t));
  auto n = static_cast<idx_t>(begin_.size() - 1);
  order->resize(Index(n));
  degree_.resize(Index(n));  // the inverse order: of no use here
  idx_t options[METIS_NOPTIONS];
  METIS_SetDefaultOptions(options);
  options[METIS_OPTION_SEED] = 1;
  const int result = METIS_NodeND(&n, begin_.data(), neighbour_.data(), nullptr, options,
                                  order->data(), degree_.data());
  if (result == METIS_ERROR_MEMORY) throw std::bad_alloc();
  return result == METIS_OK;
}
#else
bool FillOrder::Dissect(std::vector<std::int32_t>*) {
  return false;
}
#endif

}  // namespace glissade
