// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/lane_weights.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/graph/robust.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/losses/tukey.h"
#include "kernels/kernels.h"

namespace glissade {

namespace {

using internal::Index;

bool IsScaledIdentity(int rows, const double* L) {
  for (int k = 0; k < rows * rows; ++k) {
    if (L[k] != (k % (rows + 1) == 0 ? L[0] : 0.0)) return false;
  }
  return true;
}

/// The kernel of a loss, and its width; kNone where there is no loss, or no kernel of it.
kernels::LaneLoss KernelOf(const Loss& loss, double* width) {
  if (const Huber* huber = loss.As<Huber>()) {
    *width = huber->width;
    return kernels::LaneLoss::kHuber;
  }
  if (const Cauchy* cauchy = loss.As<Cauchy>()) {
    *width = cauchy->width;
    return kernels::LaneLoss::kCauchy;
  }
  if (const Tukey* tukey = loss.As<Tukey>()) {
    *width = tukey->width;
    return kernels::LaneLoss::kTukey;
  }
  return kernels::LaneLoss::kNone;
}

}  // namespace

int FindNotFiniteLane(int lanes, std::int64_t count, const double* x) {
  const double* const end = x + count;
  const double* const found = std::find_if_not(x, end, [](double a) { return std::isfinite(a); });
  return found != end ? static_cast<int>((found - x) % lanes) : -1;
}

void LaneWeights::Scratch::Resize(std::size_t lanes, std::size_t rows) {
  for (auto* array : {&squares, &root, &alpha, &residual})
    array->resize(std::max(array->size(), lanes));
  work.resize(std::max(work.size(), lanes * rows));
}

LaneWeights::Run LaneWeights::Add(const EdgePoolBase& pool, const std::int32_t* edges, int rows,
                                  int count, int lanes) {
  using Whitening = Run::Whitening;
  Run run;
  run.rows = rows;
  run.count = count;
  run.lanes = lanes;
  const int size = rows * rows;
  const double* first = pool.whitening(edges[0]);
  for (int s = 0; s < count; ++s) {
    const double* L = pool.whitening(edges[s]);
    if (first == nullptr && L == nullptr) continue;
    if (first != nullptr && L != nullptr && std::equal(L, L + size, first)) {
      if (run.whitening == Whitening::kIdentity) run.whitening = Whitening::kCommon;
    } else {
      run.whitening = Whitening::kPerLane;
    }
  }
  if (run.whitening == Whitening::kCommon) {
    if (IsScaledIdentity(rows, first)) run.whitening = Whitening::kScaled;
    run.root = Reserve(Index(size), 0.0);
    std::copy_n(first, size, numbers_.begin() + run.root);
  } else if (run.whitening == Whitening::kPerLane) {
    run.root = Reserve(Index(size) * Index(lanes), 0.0);
    double* out = numbers_.data() + run.root;
    for (int s = 0; s < lanes; ++s) {
      const double* L = pool.whitening(edges[s]);
      for (int k = 0; k < size; ++k)
        out[k * lanes + s] = L != nullptr ? L[k] : (k % (rows + 1) == 0 ? 1.0 : 0.0);
    }
  }
  AddLosses(pool, edges, &run);
  return run;
}

bool LaneWeights::DiagonalOf(const Run& run, double* diagonal) const {
  using Whitening = Run::Whitening;
  std::fill_n(diagonal, run.rows, 1.0);
  if (run.whitening == Whitening::kIdentity) return true;
  if (run.whitening == Whitening::kPerLane) return false;
  const double* L = numbers_.data() + run.root;
  for (int k = 0; k < run.rows * run.rows; ++k) {
    if (k % (run.rows + 1) != 0 && L[k] != 0.0) return false;
  }
  for (int i = 0; i < run.rows; ++i)
    diagonal[i] = L[i * (run.rows + 1)];
  return true;
}

void LaneWeights::AddLosses(const EdgePoolBase& pool, const std::int32_t* edges, Run* run) {
  using kernels::LaneLoss;
  for (int s = 0; s < run->count; ++s) {
    double width = 0.0;
    const LaneLoss loss = KernelOf(pool.loss(edges[s]), &width);
    if (loss == LaneLoss::kNone && pool.loss(edges[s]).trivial()) continue;
    run->other_loss =
        loss == LaneLoss::kNone || (run->loss != LaneLoss::kNone && run->loss != loss);
    if (run->other_loss) {
      run->loss = LaneLoss::kNone;
      return;
    }
    run->loss = loss;
  }
  if (run->loss == LaneLoss::kNone) return;
  run->widths = Reserve(Index(run->lanes), std::numeric_limits<double>::infinity());
  for (int s = 0; s < run->count; ++s)
    static_cast<void>(KernelOf(pool.loss(edges[s]), &numbers_[Index(run->widths + s)]));
}

std::int64_t LaneWeights::Reserve(std::size_t count, double value) {
  // Each array begins with a cache line, as all do.
  constexpr std::size_t kLine = kernels::kLaneBlock;
  const std::size_t begin = (numbers_.size() + kLine - 1) / kLine * kLine;
  numbers_.resize(begin, 0.0);
  numbers_.resize(begin + count, value);
  return static_cast<std::int64_t>(begin);
}

int LaneWeights::Weigh(const Run& run, const EdgePoolBase& pool, const std::int32_t* edges,
                       const double* mask, double* r, std::span<const LaneMatrix> J,
                       Scratch* scratch, double* cost, Factors* factors) const {
  using Whitening = Run::Whitening;
  const kernels::KernelTable& kernel = kernels::Kernels();
  *factors = {};
  if (run.whitening == Whitening::kScaled) {
    factors->scale = numbers_[Index(run.root)];
  } else if (run.whitening != Whitening::kIdentity) {
    const double* L = numbers_.data() + run.root;
    const int per_lane = run.whitening == Whitening::kPerLane ? 1 : 0;
    kernel.whiten_lanes(run.rows, 1, run.lanes, L, per_lane, r, scratch->work.data());
    for (const LaneMatrix& matrix : J) {
      kernel.whiten_lanes(run.rows, matrix.cols, run.lanes, L, per_lane, matrix.data,
                          scratch->work.data());
    }
  }
  double* const squares = scratch->squares.data();
  const double sum = kernel.lane_squares(run.rows, run.lanes, factors->scale, mask, r, squares);
  if (!std::isfinite(sum)) {
    // Not the sum alone, which is for who adds up the costs to find.
    const int failed = FindNotFiniteLane(run.lanes, std::int64_t{run.rows} * run.lanes, r);
    if (failed >= 0) return failed;
  }
  factors->weight = mask;
  if (run.other_loss) return WeighOtherLoss(run, pool, edges, mask, r, J, scratch, cost, factors);
  double added = 0.5 * sum;
  if (run.loss != kernels::LaneLoss::kNone) {
    double* const root = scratch->root.data();
    added = kernel.loss_lanes(run.loss, run.lanes, squares, numbers_.data() + run.widths, root);
    if (mask != nullptr) kernel.scale_lanes(1, run.lanes, mask, root);
    factors->weight = root;
  }
  *cost += added;
  return std::isfinite(added) ? -1 : FindNotFiniteLane(run.lanes, run.lanes, squares);
}

int LaneWeights::WeighOtherLoss(const Run& run, const EdgePoolBase& pool, const std::int32_t* edges,
                                const double* mask, double* r, std::span<const LaneMatrix> J,
                                Scratch* scratch, double* cost, Factors* factors) const {
  const kernels::KernelTable& kernel = kernels::Kernels();
  double* const root = scratch->root.data();
  double* const alpha = scratch->alpha.data();
  double* const residual = scratch->residual.data();
  for (auto* array : {root, alpha, residual})
    std::fill_n(array, run.lanes, 0.0);
  bool corrects = false;
  for (int s = 0; s < run.count; ++s) {
    if (mask != nullptr && mask[s] == 0.0) continue;
    const internal::RobustScale robust(pool.loss(edges[s]), scratch->squares[Index(s)]);
    if (!std::isfinite(robust.cost)) return s;
    *cost += robust.cost;
    root[s] = robust.jacobian_scale;
    alpha[s] = robust.alpha_over_s;
    residual[s] = robust.residual_scale;
    corrects = corrects || robust.alpha_over_s != 0.0;
  }
  factors->weight = root;
  if (!corrects) return -1;
  // The second-order term gives r and J different scales.
  for (const LaneMatrix& matrix : J)
    kernel.correct_lanes(run.rows, matrix.cols, run.lanes, r, root, alpha, matrix.data);
  kernel.scale_lanes(run.rows, run.lanes, residual, r);
  factors->weight = mask;
  return -1;
}

}  // namespace glissade
