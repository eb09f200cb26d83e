// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "glissade/graph/edge_pool_base.h"
#include "glissade/graph/pools.h"
#include "kernels/losses.h"
#include "linear/aligned.h"

namespace glissade {

/// A matrix of values in lanes: rows of the residual x cols; see kernels.h.
struct LaneMatrix {
  double* data = nullptr;
  int cols = 0;
};

/// Information matrices and losses of runs of edges, as arrays; and what they do to the values of a
/// run, whatever its edges are.
class LaneWeights {
 public:
  /// Those of one run.
  struct Run {
    enum class Whitening : std::uint8_t { kIdentity, kScaled, kCommon, kPerLane };
    Whitening whitening = Whitening::kIdentity;
    kernels::LaneLoss loss = kernels::LaneLoss::kNone;
    bool other_loss = false;  ///< losses that have no kernel, or different ones
    std::int32_t rows = 0;
    std::int32_t count = 0;  ///< lanes with an edge; those after them have zero values
    std::int32_t lanes = 0;
    std::int64_t root = 0;    ///< in numbers_: L, one or an array per entry
    std::int64_t widths = 0;  ///< in numbers_, of the losses
  };
  /// What is still to be multiplied with: J by scale, and then r and J by weight (null: 1).
  struct Factors {
    double scale = 1.0;
    const double* weight = nullptr;
  };
  struct Scratch {
    AlignedDoubles work, squares, root, alpha, residual;
    /// rows: of the largest residual.
    void Resize(std::size_t lanes, std::size_t rows);
  };

  void Clear() { numbers_.clear(); }
  Run Add(const EdgePoolBase& pool, const std::int32_t* edges, int rows, int count, int lanes);
  /// Of a run with one L that is diagonal: writes its diagonal, `rows` numbers; false for others.
  bool DiagonalOf(const Run& run, double* diagonal) const;
  /// Of the losses per lane; null where there are none.
  [[nodiscard]] const double* WidthsOf(const Run& run) const {
    return run.loss != kernels::LaneLoss::kNone ? numbers_.data() + run.widths : nullptr;
  }
  /// Whitens r and adds the run's cost. J are whitened and corrected but for `factors`. mask: null,
  /// or 0 where a lane does not count. Returns the first lane whose cost is not finite, or -1.
  int Weigh(const Run& run, const EdgePoolBase& pool, const std::int32_t* edges, const double* mask,
            double* r, std::span<const LaneMatrix> J, Scratch* scratch, double* cost,
            Factors* factors) const;

 private:
  /// Room in numbers_: where it begins.
  std::int64_t Reserve(std::size_t count, double value);
  void AddLosses(const EdgePoolBase& pool, const std::int32_t* edges, Run* run);
  int WeighOtherLoss(const Run& run, const EdgePoolBase& pool, const std::int32_t* edges,
                     const double* mask, double* r, std::span<const LaneMatrix> J, Scratch* scratch,
                     double* cost, Factors* factors) const;

  AlignedDoubles numbers_;
};

/// The first lane of which one of `count` numbers is not finite, or -1.
int FindNotFiniteLane(int lanes, std::int64_t count, const double* x);

}  // namespace glissade
