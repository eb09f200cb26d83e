// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The Schur complement of NormalEquations: landmark by landmark, and back.

#include <algorithm>
#include <cmath>
#include <string>

#include "glissade/linear/normal_equations.h"
#include "kernels/kernels.h"
#include "linear/block_copy.h"
#include "linear/reprojection_terms.h"

namespace glissade {

namespace {

std::size_t Index(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

constexpr int kColumnsPerTask = 64;

}  // namespace

ReducedSystem NormalEquations::reduced() const {
  ReducedSystem system;
  system.size = num_poses_scalars_;
  system.offsets = pose_offsets_;
  system.S = S_[0].data();
  system.stride = stride_;
  system.b = b_s_[0].data();
  system.pattern = reduced_pattern_;
  system.pattern_version = pattern_version_;
  return system;
}

// Blocks of S that H_pp does not write, and so must be cleared.
void NormalEquations::ListBlocksOnlyInReduced(const Structure& structure) {
  const std::size_t n = structure.poses().size();
  in_h_.assign(n * n, 0);
  for (const PoseBlockPair& pair : structure.h_blocks())
    in_h_[Index(pair.row) * n + Index(pair.col)] = 1;
  only_in_reduced_.clear();
  const auto add = [&](std::int32_t row, std::int32_t col) {
    if (in_h_[Index(row) * n + Index(col)] == 0) only_in_reduced_.push_back({row, col});
  };
  for (const BlockIndex& block : reduced_pattern_)
    add(block.row, block.col);
  for (std::size_t row = 0; reduced_pattern_.empty() && row < n; ++row) {
    for (std::size_t col = 0; col <= row; ++col)
      add(static_cast<std::int32_t>(row), static_cast<std::int32_t>(col));
  }
}

void NormalEquations::ClearBlocks(std::span<const BlockIndex> blocks, double* S) const {
  for (const BlockIndex& block : blocks) {
    const std::int32_t row = pose_offsets_[Index(block.row)];
    const std::int32_t rows = pose_offsets_[Index(block.row) + 1] - row;
    for (std::int32_t c = pose_offsets_[Index(block.col)]; c < pose_offsets_[Index(block.col) + 1];
         ++c) {
      std::fill_n(S + row + static_cast<std::ptrdiff_t>(c) * stride_, rows, 0.0);
    }
  }
}

void NormalEquations::ScatterPoseBlocks(const Structure& structure, const DampingTerm& damping) {
  double* S = S_[0].data();
  for (const PoseBlockPair& pair : structure.h_blocks()) {
    const PoseBlock& row = structure.poses()[Index(pair.row)];
    const PoseBlock& col = structure.poses()[Index(pair.col)];
    const double* block = h_pp_[0].data() + pair.offset;
    double* out = S + row.offset + static_cast<std::ptrdiff_t>(col.offset) * stride_;
    internal::CopyRowMajorBlock(row.dim, col.dim, block, out, stride_);
  }
  for (int k = 0; k < num_poses_scalars_; ++k) {
    double& pivot = S[k + static_cast<std::ptrdiff_t>(k) * stride_];
    if (held_[Index(k)] != 0) {
      pivot = 1.0;
      continue;
    }
    const double d =
        damping.identity || damping.reduced_only
            ? 1.0
            : std::clamp(diagonal_[Index(k)], damping.min_diagonal, damping.max_diagonal);
    pivot += damping.lambda * d;
  }
}

bool NormalEquations::EliminateChunk(const Structure& structure, const DampingTerm& damping,
                                     int chunk) {
  const kernels::KernelTable& kernel = kernels::Kernels();
  std::vector<double>& S = S_[Index(chunk)];
  std::vector<double>& b_s = b_s_[Index(chunk)];
  if (chunk == 0) {
    ClearBlocks(only_in_reduced_, S.data());
    ScatterPoseBlocks(structure, damping);
    std::copy(b_p_[0].begin(), b_p_[0].end(), b_s.begin());
  } else {
    if (reduced_pattern_.empty()) {
      std::fill(S.begin(), S.end(), 0.0);
    } else {
      ClearBlocks(reduced_pattern_, S.data());
    }
    std::fill(b_s.begin(), b_s.end(), 0.0);
  }
  double* const y = chunks_[Index(chunk)].y.data();
  for (int l = structure.landmark_chunks()[Index(chunk)];
       l < structure.landmark_chunks()[Index(chunk) + 1]; ++l) {
    const LandmarkBlock& landmark = structure.landmarks()[Index(l)];
    const int dim = landmark.dim;
    const double* H_ll = landmarks_.data() + landmark.record;
    const double* b_l = H_ll + dim * dim;
    const double* W = b_l + dim;
    double* inverse = h_ll_inverse_.data() + inverse_begin_[Index(l)];
    std::copy_n(H_ll, dim * dim, inverse);
    if (!damping.reduced_only) {
      for (int k = 0; k < dim; ++k) {
        const double d = damping.identity ? 1.0
                                          : std::clamp(H_ll[k * dim + k], damping.min_diagonal,
                                                       damping.max_diagonal);
        inverse[k * dim + k] += damping.lambda * d;
      }
    }
    if (kernel.invert_spd_small(dim, inverse) != 0) {
      chunks_[Index(chunk)].failed_landmark = l;
      return false;
    }
    const int m = landmark.slot_end - landmark.slot_begin;
    if (m == 0) continue;
    const std::int32_t* row = structure.slot_row().data() + landmark.slot_begin;
    const std::int32_t* size = structure.slot_dim().data() + landmark.slot_begin;
    int k = 0;
    for (int a = 0; a < m; ++a) {
      for (int r = 0; r < size[a]; ++r, k += dim) {
        double b = 0.0;
        for (int c = 0; c < dim; ++c) {
          double sum = 0.0;
          for (int i = 0; i < dim; ++i)
            sum += W[k + i] * inverse[i * dim + c];
          y[k + c] = sum;
          b += sum * b_l[c];
        }
        b_s[Index(row[a] + r)] -= b;
      }
    }
    kernel.schur_update(m, row, size, dim, y, W, S.data(), stride_);
  }
  return true;
}

void NormalEquations::ReduceChunks(int num_chunks, ThreadPool* threads) {
  if (num_chunks == 1) return;
  for (int c = 1; c < num_chunks; ++c) {
    for (std::size_t k = 0; k < b_s_[0].size(); ++k)
      b_s_[0][k] += b_s_[Index(c)][k];
  }
  const int tasks = (num_poses_scalars_ + kColumnsPerTask - 1) / kColumnsPerTask;
  threads->Run(tasks, [&](int task) {
    const int end = std::min(num_poses_scalars_, (task + 1) * kColumnsPerTask);
    for (int col = task * kColumnsPerTask; col < end; ++col) {
      const std::size_t begin = Index(col) * Index(stride_);
      for (int c = 1; c < num_chunks; ++c) {
        const double* from = S_[Index(c)].data() + begin;
        double* to = S_[0].data() + begin;
        for (int r = col; r < num_poses_scalars_; ++r)
          to[r] += from[r];
      }
    }
  });
}

StepFailure NormalEquations::Eliminate(const Structure& structure, const Graph& graph,
                                       const DampingTerm& damping, ThreadPool* threads) {
  const int num_chunks = structure.num_chunks();
  // Copies of S are for landmarks of the general path; the fused ones bring their own.
  const int num_copies = structure.landmarks().empty() ? 1 : num_chunks;
  if (S_.size() < Index(num_copies)) {
    S_.resize(Index(num_copies));
    b_s_.resize(Index(num_copies));
  }
  for (int c = 0; c < num_chunks; ++c) {
    chunks_[Index(c)].failed_landmark = chunks_[Index(c)].failed_lane = -1;
  }
  for (int c = 0; c < num_copies; ++c) {
    S_[Index(c)].resize(Index(num_poses_scalars_) * Index(stride_));
    b_s_[Index(c)].resize(Index(num_poses_scalars_));
  }
  inverse_begin_.resize(structure.landmarks().size());
  std::int32_t total = 0;
  for (std::size_t l = 0; l < structure.landmarks().size(); ++l) {
    inverse_begin_[l] = total;
    total += structure.landmarks()[l].dim * structure.landmarks()[l].dim;
  }
  h_ll_inverse_.resize(Index(total));

  threads->Run(num_chunks, [&](int chunk) {
    if (chunk < num_copies) EliminateChunk(structure, damping, chunk);
    chunks_[Index(chunk)].failed_lane = reprojections_->Eliminate(structure, damping, chunk);
  });
  for (int c = 0; c < num_chunks; ++c) {
    const int failed = chunks_[Index(c)].failed_landmark;
    const int lane = chunks_[Index(c)].failed_lane;
    if (failed < 0 && lane < 0) continue;
    StepFailure failure;
    failure.code = StatusCode::kSingular;
    failure.what = "has too little information to be eliminated";
    failure.is_landmark = true;
    if (failed >= 0) {
      const LandmarkBlock& landmark = structure.landmarks()[Index(failed)];
      failure.vertex = graph.vertex_pools()[Index(landmark.pool)]->HandleAt(landmark.index);
    } else {
      failure.vertex = graph.Pool<VertexInverseDepth>()->HandleAt(
          structure.reprojections().landmark_of_lane[Index(lane)]);
    }
    return failure;
  }
  ReduceChunks(num_copies, threads);
  reprojections_->AddReduced(structure, graph, threads, S_[0].data(), stride_, b_s_[0].data());
  return {};
}

StepFailure NormalEquations::Solve(const Structure& structure, const Graph& graph,
                                   LinearSolver* solver, ThreadPool* threads,
                                   LinearSolverResult* result) {
  *result = {};
  if (num_poses_scalars_ > 0) {
    *result = solver->Solve(reduced(), step_.data());
    if (!result->ok) {
      StepFailure failure;
      failure.code = StatusCode::kSingular;
      failure.what = "the reduced system is not positive definite";
      const int pivot = result->failed_pivot;
      for (const PoseBlock& pose : structure.poses()) {
        if (pivot >= pose.offset && pivot < pose.offset + pose.dim) {
          failure.vertex = graph.vertex_pools()[Index(pose.pool)]->HandleAt(pose.index);
        }
      }
      return failure;
    }
  } else {
    result->ok = true;
  }
  // dx_l = H_ll^-1 (b_l - W' dx_p), each landmark on its own.
  threads->Run(structure.num_chunks(), [&](int chunk) {
    for (int l = structure.landmark_chunks()[Index(chunk)];
         l < structure.landmark_chunks()[Index(chunk) + 1]; ++l) {
      const LandmarkBlock& landmark = structure.landmarks()[Index(l)];
      const int dim = landmark.dim;
      const double* b_l = landmarks_.data() + landmark.record + dim * dim;
      const double* W = b_l + dim;
      double rhs[4];
      std::copy_n(b_l, dim, rhs);
      for (std::int32_t s = landmark.slot_begin; s < landmark.slot_end; ++s) {
        const double* dx = step_.data() + structure.slot_row()[Index(s)];
        for (int r = 0; r < structure.slot_dim()[Index(s)]; ++r, W += dim) {
          for (int k = 0; k < dim; ++k)
            rhs[k] -= W[k] * dx[r];
        }
      }
      const double* inverse = h_ll_inverse_.data() + inverse_begin_[Index(l)];
      double* dx_l = step_.data() + num_poses_scalars_ + landmark.step;
      for (int r = 0; r < dim; ++r) {
        double sum = 0.0;
        for (int c = 0; c < dim; ++c)
          sum += inverse[r * dim + c] * rhs[c];
        dx_l[r] = sum;
      }
    }
    reprojections_->BackSubstitute(structure, step_, chunk, step_.data() + num_poses_scalars_);
  });
  double poison = 0.0;
  for (const double x : step_)
    poison += 0.0 * x;
  StepFailure failure;
  if (poison != 0.0) {
    failure.code = StatusCode::kNotFinite;
    failure.what = "the step is not finite";
  }
  return failure;
}

}  // namespace glissade
