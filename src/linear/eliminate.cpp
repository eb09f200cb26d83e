// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The Schur complement of NormalEquations: landmark by landmark, and back.

#include <algorithm>
#include <cmath>
#include <string>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/linear/normal_equations.h"
#include "kernels/kernels.h"
#include "linear/block_copy.h"
#include "linear/landmark_view.h"
#include "linear/schur_storage.h"
#include "linear/twist_terms.h"

namespace glissade {

namespace {

using internal::Index;

constexpr int kTasksPerThread = 4;

}  // namespace

const SchurLayout& NormalEquations::ReducedLayout(const Structure& structure) {
  return schur_->AllBlocks(structure);
}

const SchurOperator& NormalEquations::reduced() {
  // Bound here, not in Eliminate(): these equations may have been moved since.
  SchurStorage::Owner owner;
  owner.self = this;
  owner.multiply = [](void* self, const double* x, double* y) {
    static_cast<NormalEquations*>(self)->MultiplyReduced(x, y);
  };
  owner.pose_block = [](void* self, std::int32_t vertex, double* block) {
    return static_cast<NormalEquations*>(self)->PoseDiagonal(vertex, block);
  };
  owner.threads = threads_;
  schur_->SetOwner(owner);
  return *schur_;
}

const std::vector<double>& NormalEquations::reduced_rhs() const {
  return schur_->rhs();
}

SchurForm NormalEquations::reduced_form() const {
  return schur_->form();
}

double NormalEquations::DampingAt(std::size_t scalar) const {
  return damping_.lambda * DampingOf(damping_, eliminated_diagonal_[scalar]);
}

StepFailure NormalEquations::CannotEliminate(const AnyVertex& landmark) {
  StepFailure failure;
  failure.code = StatusCode::kSingular;
  failure.what = "has too little information to be eliminated";
  failure.is_landmark = true;
  failure.vertex = landmark;
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

// Factors, Z and beta of a batch of landmarks: each record is read once.
void NormalEquations::FillPanel(const Structure& structure, const DampingTerm& damping,
                                std::size_t batch, Panel* panel) {
  const kernels::KernelTable& kernel = kernels::Kernels();
  const SchurBatches& batches = schur_->batches();
  // A vector that begins at the last number is read and written whole.
  constexpr std::size_t kSpare = 8;
  panel->failed_landmark = -1;
  panel->z.resize(std::max(panel->z.size(), batches.max_z_size() + kSpare));
  panel->beta.resize(std::max(panel->beta.size(), batches.max_beta_size()));
  double *z = panel->z.data(), *beta = panel->beta.data();
  for (std::int32_t l = batches[batch].landmark_begin; l < batches[batch].landmark_end; ++l) {
    const LandmarkBlock& block = structure.landmarks()[Index(l)];
    const int dim = block.dim;
    const double* H_ll = landmarks_.data() + block.record;
    double* factor = h_ll_factor_.data() + factor_begin_[Index(l)];
    std::copy_n(H_ll, dim * dim, factor);
    for (int k = 0; k < dim && !damping.reduced_only; ++k)
      factor[k * dim + k] += damping.lambda * DampingOf(damping, H_ll[k * dim + k]);
    if (kernel.inverse_factor(dim, factor) != 0) {
      panel->failed_landmark = l;
      return;
    }
    const kernels::SchurLandmark landmark = LandmarkOf(structure, block, landmarks_, factor);
    kernel.schur_panel(&landmark, z, beta);
    for (std::int32_t s = block.slot_begin; s < block.slot_end; ++s)
      z += structure.slot_dim()[Index(s)] * dim;
    beta += dim;
  }
}

// S -= W H_ll^-1 W', and what belongs to it of b_s; returns a landmark that cannot be eliminated,
// or -1. Tasks own block columns, so that nothing is summed up afterwards; batches come in the same
// order whatever the columns, so that cutting the work differently changes no bit. One thread takes
// a batch while its Z is in the cache.
int NormalEquations::ReduceLandmarks(const Structure& structure, const DampingTerm& damping,
                                     ThreadPool* threads) {
  constexpr std::size_t kPanels = 64;
  const SchurBatches& batches = schur_->batches();
  const bool alone = threads->num_threads() == 1;
  const std::size_t at_once = std::min(batches.size(), alone ? std::size_t{1} : kPanels);
  if (panels_.size() < at_once) panels_.resize(at_once);
  const auto all = static_cast<std::int32_t>(structure.poses().size());
  for (std::size_t first = 0; first < batches.size(); first += at_once) {
    const std::size_t count = std::min(at_once, batches.size() - first);
    threads->Run(static_cast<int>(count), [&](int k) {
      FillPanel(structure, damping, first + Index(k), &panels_[Index(k)]);
    });
    for (std::size_t k = 0; k < count; ++k) {
      if (panels_[k].failed_landmark >= 0) return panels_[k].failed_landmark;
    }
    const auto reduce = [&](std::int32_t begin, std::int32_t end) {
      for (std::size_t k = 0; k < count; ++k) {
        const Panel& panel = panels_[k];
        const kernels::SchurPanel view =
            batches.Panel(first + k, panel.z.data(), panel.beta.data());
        const auto [from, to] = batches.Blocks(first + k, begin, end);
        kernels::Kernels().schur_blocks(&view, to - from, from, schur_->data(),
                                        schur_->rhs().data());
      }
    };
    if (alone) {
      reduce(0, all);
      continue;
    }
    // Landmarks that come one after the other are seen by the same few vertices: the columns are
    // cut anew for each set of batches.
    batches.CutColumns(first, count, all, kTasksPerThread * threads->num_threads(), &batch_cuts_);
    threads->Run(static_cast<int>(batch_cuts_.size()) - 1,
                 [&](int task) { reduce(batch_cuts_[Index(task)], batch_cuts_[Index(task) + 1]); });
  }
  return -1;
}

void NormalEquations::PlaceFactors(const Structure& structure) {
  if (factors_of_ == structure.analysis()) return;
  factors_of_ = structure.analysis();
  factor_begin_.clear();
  std::int64_t total = 0;
  for (const LandmarkBlock& landmark : structure.landmarks()) {
    factor_begin_.push_back(total);
    total += landmark.dim * landmark.dim;
  }
  h_ll_factor_.resize(Index(total));
}

StepFailure NormalEquations::Eliminate(const Structure& structure, const Graph& graph,
                                       const DampingTerm& damping, SchurForm form,
                                       ThreadPool* threads, std::span<const std::int32_t> wanted) {
  schur_->LayOut(structure, form, wanted);
  eliminated_ = &structure;
  threads_ = threads;
  damping_ = damping;
  eliminated_diagonal_.assign(diagonal_.begin(), diagonal_.begin() + num_poses_scalars_);
  PlaceFactors(structure);

  threads->Run(structure.num_chunks(), [&](int chunk) {
    chunks_[Index(chunk)].failed_lane = twists_->Eliminate(structure, damping, chunk);
  });
  for (int c = 0; c < structure.num_chunks(); ++c) {
    const int lane = chunks_[Index(c)].failed_lane;
    if (lane < 0) continue;
    const LandmarkPlan& plan = structure.groups();
    return CannotEliminate(graph.vertex_pools()[Index(plan.PoolOfLane(lane))]->HandleAt(
        plan.landmark_of_lane[Index(lane)]));
  }

  const int threads_used = !structure.landmarks().empty() ? threads->num_threads() : 1;
  const std::vector<std::int32_t>& cuts =
      schur_->CutColumns(threads_used == 1 ? 1 : kTasksPerThread * threads_used);
  threads->Run(static_cast<int>(cuts.size()) - 1, [&](int task) {
    StartColumns(structure, damping, cuts[Index(task)], cuts[Index(task) + 1]);
  });
  if (const int failed = ReduceLandmarks(structure, damping, threads); failed >= 0) {
    const LandmarkBlock& landmark = structure.landmarks()[Index(failed)];
    return CannotEliminate(graph.vertex_pools()[Index(landmark.pool)]->HandleAt(landmark.index));
  }
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
          LandmarkOf(structure, block, landmarks_, h_ll_factor_.data() + factor_begin_[Index(l)]);
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
