// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The Schur complement of NormalEquations: landmark by landmark, and back.

#include <algorithm>
#include <cmath>
#include <string>

#include "glissade/linear/normal_equations.h"
#include "kernels/kernels.h"
#include "linear/block_copy.h"
#include "linear/landmark_view.h"
#include "linear/schur_storage.h"
#include "linear/twist_terms.h"

namespace glissade {

namespace {

std::size_t Index(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

constexpr int kTasksPerThread = 4;

}  // namespace

const SchurLayout& NormalEquations::ReducedLayout(const Structure& structure) {
  return schur_->AllBlocks(structure);
}

const SchurOperator& NormalEquations::reduced() {
  // Bound here, not in Eliminate(): these equations may have been moved since.
  schur_->SetProduct([](void* self, const double* x,
                        double* y) { static_cast<NormalEquations*>(self)->MultiplyReduced(x, y); },
                     this);
  return *schur_;
}

const std::vector<double>& NormalEquations::reduced_rhs() const {
  return schur_->rhs();
}

void NormalEquations::InvertLandmarks(const Structure& structure, const DampingTerm& damping,
                                      int chunk) {
  chunks_[Index(chunk)].failed_landmark = -1;
  for (int l = structure.landmark_chunks()[Index(chunk)];
       l < structure.landmark_chunks()[Index(chunk) + 1]; ++l) {
    const LandmarkBlock& landmark = structure.landmarks()[Index(l)];
    const int dim = landmark.dim;
    const double* H_ll = landmarks_.data() + landmark.record;
    double* inverse = h_ll_inverse_.data() + inverse_begin_[Index(l)];
    std::copy_n(H_ll, dim * dim, inverse);
    for (int k = 0; k < dim && !damping.reduced_only; ++k)
      inverse[k * dim + k] += damping.lambda * DampingOf(damping, H_ll[k * dim + k]);
    if (kernels::Kernels().invert_spd_small(dim, inverse) != 0) {
      chunks_[Index(chunk)].failed_landmark = l;
      return;
    }
  }
}

StepFailure NormalEquations::CheckLandmarks(const Structure& structure, const Graph& graph) const {
  StepFailure failure;
  for (int c = 0; c < structure.num_chunks(); ++c) {
    const int failed = chunks_[Index(c)].failed_landmark;
    const int lane = chunks_[Index(c)].failed_lane;
    if (failed < 0 && lane < 0) continue;
    failure.code = StatusCode::kSingular;
    failure.what = "has too little information to be eliminated";
    failure.is_landmark = true;
    if (failed >= 0) {
      const LandmarkBlock& landmark = structure.landmarks()[Index(failed)];
      failure.vertex = graph.vertex_pools()[Index(landmark.pool)]->HandleAt(landmark.index);
    } else {
      failure.vertex = graph.Pool<VertexInverseDepth>()->HandleAt(
          structure.groups().landmark_of_lane[Index(lane)]);
    }
    break;
  }
  return failure;
}

// What S and b_s are before landmarks: H_pp, damping and unit rows; zero where H_pp has no block.
// The constant H of linear edges comes from where the edges keep it, not by way of H_pp.
void NormalEquations::StartColumns(const Structure& structure, const DampingTerm& damping,
                                   std::int32_t begin, std::int32_t end) {
  double* const S = schur_->data();
  const std::vector<PoseBlock>& poses = structure.poses();
  for (std::int32_t c = begin; c < end; ++c) {
    const PoseBlock& col = poses[Index(c)];
    for (std::size_t k = schur_->ColumnBegin(c); k < schur_->ColumnBegin(c + 1); ++k) {
      const BlockPlace place = schur_->Place(k);
      if (!place.stored()) continue;
      const int rows = poses[Index(structure.reduced_pattern()[k].row)].dim;
      double* out = S + place.offset;
      const std::int32_t varying = schur_->VaryingBlock(k);
      std::int32_t constant = schur_->FirstConstant(k);
      if (varying >= 0) {
        const PoseBlockPair& pair = structure.varying_blocks()[Index(varying)];
        internal::CopyRowMajorBlock(rows, col.dim, h_pp_[0].data() + pair.offset, out,
                                    place.stride);
      } else if (constant >= 0) {
        const BlockView& from = constants_[Index(constant)];
        internal::CopyBlock<internal::BlockCopy::kSet>(rows, col.dim, from.data, from.stride, out,
                                                       place.stride);
        constant = schur_->NextConstant(constant);
      } else {
        for (int i = 0; i < col.dim; ++i)
          std::fill_n(out + std::ptrdiff_t{i} * place.stride, rows, 0.0);
      }
      for (; constant >= 0; constant = schur_->NextConstant(constant)) {
        const BlockView& from = constants_[Index(constant)];
        internal::CopyBlock<internal::BlockCopy::kAdd>(rows, col.dim, from.data, from.stride, out,
                                                       place.stride);
      }
    }
    // The diagonal block is the first of its column.
    const BlockPlace place = schur_->Place(schur_->ColumnBegin(c));
    for (int i = 0; i < col.dim; ++i) {
      const std::size_t scalar = Index(col.offset + i);
      double& pivot = S[place.offset + std::ptrdiff_t{i} * (place.stride + 1)];
      pivot =
          held_[scalar] != 0 ? 1.0 : pivot + damping.lambda * DampingOf(damping, diagonal_[scalar]);
    }
    std::copy_n(b_p_[0].data() + col.offset, col.dim, schur_->rhs().data() + col.offset);
  }
}

// Block columns [begin, end) of S -= W H_ll^-1 W', and what belongs to them of b_s. Landmarks come
// in the same order whatever the range is, so that cutting the work differently changes no bit.
void NormalEquations::ReduceColumns(const Structure& structure, std::int32_t begin,
                                    std::int32_t end, double* scratch) {
  const kernels::KernelTable& kernel = kernels::Kernels();
  const kernels::SchurTarget target = schur_->Target();
  const bool whole = begin == 0 && Index(end) == structure.poses().size();
  for (std::size_t l = 0; l < structure.landmarks().size(); ++l) {
    const LandmarkBlock& block = structure.landmarks()[l];
    const std::int32_t* first = structure.slot_block().data() + block.slot_begin;
    const std::int32_t* last = structure.slot_block().data() + block.slot_end;
    if (first == last || first[0] >= end || last[-1] < begin) continue;
    const auto from = whole ? first : std::lower_bound(first, last, begin);
    const auto to = whole ? last : std::lower_bound(from, last, end);
    const kernels::SchurLandmark landmark =
        LandmarkOf(structure, block, landmarks_, h_ll_inverse_.data() + inverse_begin_[l]);
    kernel.schur_update(&landmark, schur_->RowsOf(structure, l), static_cast<int>(from - first),
                        static_cast<int>(to - first), &target, scratch);
  }
}

StepFailure NormalEquations::Eliminate(const Structure& structure, const Graph& graph,
                                       const DampingTerm& damping, SchurForm form,
                                       ThreadPool* threads) {
  schur_->LayOut(structure, form);
  eliminated_ = &structure;
  threads_ = threads;
  damping_ = damping;
  const std::size_t num_landmarks = structure.landmarks().size();
  inverse_begin_.resize(num_landmarks);
  std::int64_t total = 0;
  for (std::size_t l = 0; l < num_landmarks; ++l) {
    inverse_begin_[l] = total;
    total += structure.landmarks()[l].dim * structure.landmarks()[l].dim;
  }
  h_ll_inverse_.resize(Index(total));

  threads->Run(structure.num_chunks(), [&](int chunk) {
    InvertLandmarks(structure, damping, chunk);
    chunks_[Index(chunk)].failed_lane = twists_->Eliminate(structure, damping, chunk);
  });
  if (StepFailure failure = CheckLandmarks(structure, graph); !failure.ok()) return failure;

  // Tasks own block columns: nothing is summed up afterwards, and one thread takes them all at
  // once.
  const int threads_used = num_landmarks > 0 ? threads->num_threads() : 1;
  const std::vector<std::int32_t>& cuts =
      schur_->CutColumns(structure, threads_used == 1 ? 1 : kTasksPerThread * threads_used);
  const int num_tasks = static_cast<int>(cuts.size()) - 1;
  scratch_.resize(std::max(scratch_.size(), Index(num_tasks)));
  threads->Run(num_tasks, [&](int task) {
    std::vector<double>& scratch = scratch_[Index(task)];
    scratch.resize(Index(kernels::SchurScratch(structure.max_w_size())));
    StartColumns(structure, damping, cuts[Index(task)], cuts[Index(task) + 1]);
    ReduceColumns(structure, cuts[Index(task)], cuts[Index(task) + 1], scratch.data());
  });
  twists_->AddReduced(structure, graph, threads, schur_->group_places(), schur_->data(),
                      schur_->rhs().data());
  return {};
}

StepFailure NormalEquations::Solve(const Structure& structure, const Graph& graph,
                                   LinearSolver* solver, const SolveRequest& request,
                                   ThreadPool* threads, LinearSolverResult* result) {
  *result = {};
  if (num_poses_scalars_ > 0) {
    const SchurOperator& S = reduced();
    *result = solver->Prepare(S);
    if (result->ok) *result = solver->Solve(S, schur_->rhs().data(), step_.data(), request);
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
      const LandmarkBlock& block = structure.landmarks()[Index(l)];
      const kernels::SchurLandmark landmark =
          LandmarkOf(structure, block, landmarks_, h_ll_inverse_.data() + inverse_begin_[Index(l)]);
      kernels::Kernels().landmark_step(&landmark, step_.data(),
                                       step_.data() + num_poses_scalars_ + block.step);
    }
    twists_->BackSubstitute(structure, step_, chunk, step_.data() + num_poses_scalars_);
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
