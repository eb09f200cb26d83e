// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What NormalEquations takes: sizes as Resize(), PlaceFactors(), SchurStorage and SchurBatches will
// make them.

#include <algorithm>

#include "glissade/base/index.h"
#include "glissade/linear/normal_equations.h"
#include "linear/landmark_runs.h"
#include "linear/schur_storage.h"

namespace glissade {

namespace {

using internal::Index;

constexpr std::int64_t kDouble = sizeof(double);

}  // namespace

std::int64_t NormalEquations::MemoryBytes(const Structure& structure) const {
  std::int64_t numbers = structure.landmark_buffer_size();
  for (const LandmarkBlock& landmark : structure.landmarks())
    numbers += landmark.dim * landmark.dim + 1;  // factor and where it begins
  const std::int64_t poses = structure.num_pose_scalars();
  numbers += structure.num_chunks() * (structure.varying_size() + 2 * poses);
  numbers += 3 * (poses + structure.num_landmark_scalars());  // diagonal, b, step
  const std::int64_t group_lanes =
      static_cast<std::int64_t>(structure.groups().landmark_of_lane.size());
  // Landmarks in groups keep no W: what each pose sees of them is nine numbers.
  return kDouble * (numbers + 24 * group_lanes) + runs_->MemoryBytes();
}

std::int64_t NormalEquations::ReducedMemoryBytes(const Structure& structure, SchurForm form,
                                                 int num_threads) {
  const SchurLayout& all = ReducedLayout(structure);
  const std::int64_t n = all.size();
  std::int64_t numbers = 0;
  if (form == SchurForm::kDense) {
    numbers = n * (n + 8);
  } else {
    for (const BlockIndex& block : all.blocks) {
      if (form == SchurForm::kBlocks || block.row == block.col)
        numbers += all.Dim(block.row) * all.Dim(block.col);
    }
  }
  std::int64_t pairs = 0, slots = 0;
  for (const LandmarkBlock& landmark : structure.landmarks()) {
    const std::int64_t count = landmark.slot_end - landmark.slot_begin;
    slots += count;
    pairs +=
        form == SchurForm::kDense || form == SchurForm::kBlocks ? count * (count + 1) / 2 : count;
  }
  // Tables of the blocks, and of the batches: each block of a batch has a few pairs.
  constexpr std::int64_t kPerBlock = 2 * sizeof(BlockIndex) + 8 + 4 + 4;
  constexpr std::int64_t kPerPair = sizeof(kernels::SlotPair) + sizeof(kernels::SchurBlock) / 5;
  std::int64_t bytes = kDouble * (numbers + n) +
                       kPerBlock * static_cast<std::int64_t>(all.blocks.size()) + kPerPair * pairs +
                       6 * slots;
  if (num_threads > 1) bytes += std::int64_t{64} * 256 * 1024;  // batches that are open at a time
  return bytes;
}

}  // namespace glissade
