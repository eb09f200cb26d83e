// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The Schur complement of TwistTerms: host by host, and back.

#include <algorithm>

#include "glissade/base/index.h"
#include "linear/free_tangents.h"
#include "linear/twist_terms.h"

namespace glissade {

namespace {
using internal::Index;

// Twist blocks: 6 x 6, column-major with columns of 8.
constexpr int kBlockStride = 8;
constexpr std::size_t kBlockSize = 6 * kBlockStride;

/// From arrays of lanes to what the landmarks have one after the other.
void FromLanes(const LandmarkGroup& group, const double* lanes, double* out) {
  if (group.dim == 1) {
    std::copy_n(lanes, group.lanes, out);
    return;
  }
  for (std::int32_t l = 0; l < group.lanes; ++l, out += group.dim) {
    for (int i = 0; i < group.dim; ++i)
      out[i] = lanes[i * group.lanes + l];
  }
}

void MirrorLower(double* block) {
  for (int c = 0; c < 6; ++c) {
    for (int r = c + 1; r < 6; ++r)
      block[kBlockStride * r + c] = block[kBlockStride * c + r];
  }
}
}  // namespace

const double* TwistTerms::BlockOf(const ChunkBlock& block) const {
  return chunks_[Index(block.chunk)].blocks.data() + kBlockSize * Index(block.index);
}

int TwistTerms::Eliminate(const Structure& structure, const DampingTerm& damping, int chunk) {
  const LandmarkPlan& plan = structure.groups();
  if (plan.empty()) return -1;
  const kernels::KernelTable& kernel = kernels::Kernels();
  Chunk& out = chunks_[Index(chunk)];
  const std::size_t blocks = kBlockSize * Index(blocks_of_chunk_[Index(chunk)]);
  if (out.blocks.size() < blocks) out.blocks.resize(blocks);
  std::fill_n(out.blocks.begin(), blocks, 0.0);
  out.twist_rhs.assign(6 * structure.poses().size(), 0.0);
  for (int g = plan.chunk_begin[Index(chunk)]; g < plan.chunk_begin[Index(chunk) + 1]; ++g) {
    const LandmarkGroup& group = plan.groups[Index(g)];
    const kernels::TwistGroup* lanes = &groups_[Index(g)];
    double* const factor = factor_.data() + h_begin_[Index(g)];
    double* const beta = beta_.data() + group.step_begin;
    // Identity damping: both bounds of the diagonal at 1.
    const bool damps_diagonal = !damping.reduced_only && !damping.identity;
    const int bad = kernel.landmark_pivots(
        lanes, h_.data() + h_begin_[Index(g)], b_.data() + group.step_begin,
        damping.reduced_only ? 0.0 : damping.lambda, damps_diagonal ? damping.min_diagonal : 1.0,
        damps_diagonal ? damping.max_diagonal : 1.0, factor, beta);
    if (bad >= 0) return group.lane_begin + bad;
    // -W W' over [rhs; frames]: the first column holds what goes to the right-hand side.
    const int rows = 1 + 6 * group.num_frames();
    const int stride = (rows + kernels::kPanelRows - 1) / kernels::kPanelRows * kernels::kPanelRows;
    const std::size_t panel = Index(stride) * Index(group.dim * group.lanes);
    const std::size_t square = Index(stride) * Index(stride);
    if (out.panel.size() < panel) out.panel.resize(panel);
    if (out.reduced.size() < square + kBlockStride) out.reduced.resize(square + kBlockStride);
    kernel.twist_panel(lanes, factor, beta, out.panel.data());
    kernel.twist_reduce(lanes, out.panel.data(), out.reduced.data());
    const std::int32_t* map = chunk_map_.data() + group.map_begin;
    kernel.add_twist_blocks(group.num_frames(), map, out.reduced.data() + 1 + stride, stride,
                            out.blocks.data());
    for (int i = 0; i < group.num_frames(); ++i) {
      const std::int32_t block = plan.FrameBlock(group, i);
      if (block < 0) continue;
      for (int k = 0; k < 6; ++k)
        out.twist_rhs[Index(6 * block + k)] += out.reduced[Index(1 + 6 * i + k)];
    }
  }
  return -1;
}

void TwistTerms::ProjectMaps(const Structure& structure, const Graph& graph) {
  projected_maps_ = maps_;
  for (std::size_t k = 0; k < maps_.size(); ++k) {
    const PoseBlock& pose = structure.poses()[k];
    if (pose.free_tangent < 0 || pose.dim != 6) continue;  // twists are of poses
    const FreeTangent& tangent = graph.free_tangents()[Index(pose.free_tangent)];
    double* T = projected_maps_[k].T;
    for (int r = 0; r < 6; ++r) {
      double row[6] = {};
      for (int c = 0; c < tangent.free_dim; ++c) {
        for (int i = 0; i < 6; ++i) {
          row[c] += maps_[k].T[8 * r + i] * tangent.basis[i * tangent.free_dim + c];
        }
      }
      std::copy_n(row, 6, T + 8 * r);
    }
  }
}

/// Adds a block to S, in the tangent.
void TwistTerms::AddMapped(const Structure& structure, const Graph& graph,
                           const LandmarkPlanBlock& block, const double* sum, double* S,
                           std::int64_t stride) const {
  // Blocks are column-major, map_block is row-major: (Tr'B Tc)' = Tc'B'Tr.
  const kernels::KernelTable& kernel = kernels::Kernels();
  const double *Tr = maps_[Index(block.row)].T, *Tc = maps_[Index(block.col)].T;
  const std::int32_t row = structure.poses()[Index(block.row)].free_tangent;
  const std::int32_t col = structure.poses()[Index(block.col)].free_tangent;
  if (row < 0 && col < 0) {
    kernel.map_block(1.0, Tc, sum, kBlockStride, Tr, S, static_cast<int>(stride));
    return;
  }
  double mapped[36] = {};
  kernel.map_block(1.0, Tc, sum, kBlockStride, Tr, mapped, 6);
  for (int k = 0; k < 6; ++k) {
    if (row >= 0) Project(graph.free_tangents()[Index(row)], mapped + 6 * k, 1);
  }
  for (int k = 0; k < 6; ++k) {
    if (col >= 0) Project(graph.free_tangents()[Index(col)], mapped + k, 6);
  }
  for (int c = 0; c < 6; ++c) {
    for (int r = 0; r < 6; ++r)
      S[r + c * stride] += mapped[6 * c + r];
  }
}

void TwistTerms::AddReduced(const Structure& structure, const Graph& graph, ThreadPool* threads,
                            const std::vector<BlockPlace>& places, double* S, double* b_s) {
  const LandmarkPlan& plan = structure.groups();
  if (plan.empty()) return;
  ProjectMaps(structure, graph);
  const int num_chunks = structure.num_chunks();
  const std::size_t num_blocks = plan.blocks.size();
  // Each task takes a part of the blocks: their sum over chunks, in the tangent.
  threads->Run(num_chunks, [&](int task) {
    const std::size_t end = num_blocks * Index(task + 1) / Index(num_chunks);
    for (std::size_t k = num_blocks * Index(task) / Index(num_chunks); k < end; ++k) {
      if (!places[k].stored()) continue;
      double block[kBlockSize];
      const ChunkBlock* from = chunk_blocks_.data() + chunk_blocks_begin_[k];
      const ChunkBlock* const last = chunk_blocks_.data() + chunk_blocks_begin_[k + 1];
      std::copy_n(BlockOf(*from), kBlockSize, block);
      while (++from != last) {
        const double* other = BlockOf(*from);
        for (std::size_t i = 0; i < kBlockSize; ++i)
          block[i] += other[i];
      }
      const std::int32_t row = plan.blocks[k].row, col = plan.blocks[k].col;
      if (row == col) MirrorLower(block);
      AddMapped(structure, graph, plan.blocks[k], block, S + places[k].offset, places[k].stride);
      if (row == col) AddRhs(structure, row, b_s);
    }
  });
}

void TwistTerms::AddRhs(const Structure& structure, std::int32_t block, double* b_s) const {
  double sum[6] = {};
  for (int c = 0; c < structure.num_chunks(); ++c) {
    for (int i = 0; i < 6; ++i)
      sum[i] += chunks_[Index(c)].twist_rhs[Index(6 * block + i)];
  }
  const double* T = projected_maps_[Index(block)].T;
  double* b = b_s + structure.poses()[Index(block)].offset;
  for (int c = 0; c < 6; ++c) {
    double value = 0.0;
    for (int i = 0; i < 6; ++i)
      value += T[8 * i + c] * sum[i];
    b[c] += value;
  }
}

// The twists of a group's frames when going by x: the host's, then those of its targets.
void TwistTerms::FillTwists(const Structure& structure, const double* x, int group,
                            Chunk* chunk) const {
  const LandmarkPlan& plan = structure.groups();
  const LandmarkGroup& g = plan.groups[Index(group)];
  AlignedDoubles& twists = chunk->twists;
  const int num_frames = g.num_frames();
  if (twists.size() < Index(6 * num_frames)) twists.resize(Index(6 * num_frames));
  for (AlignedDoubles* array : {&chunk->product, &chunk->steps}) {
    if (array->size() < Index(g.dim * g.lanes)) array->resize(Index(g.dim * g.lanes));
  }
  for (int k = 0; k < num_frames; ++k) {
    const std::int32_t block = plan.FrameBlock(g, k);
    double* xi = twists.data() + 6 * k;
    std::fill_n(xi, 6, 0.0);
    if (block < 0) continue;
    const double* T = projected_maps_[Index(block)].T;
    const double* d = x + structure.poses()[Index(block)].offset;
    for (int r = 0; r < 6; ++r) {
      for (int c = 0; c < 6; ++c)
        xi[r] += T[8 * r + c] * d[c];
    }
  }
}

void TwistTerms::SubtractProduct(const Structure& structure, const double* x, int index,
                                 double* y) {
  const LandmarkPlan& plan = structure.groups();
  if (plan.empty()) return;
  const kernels::KernelTable& kernel = kernels::Kernels();
  Chunk* chunk = &chunks_[Index(index)];
  for (int g = plan.chunk_begin[Index(index)]; g < plan.chunk_begin[Index(index) + 1]; ++g) {
    const LandmarkGroup& group = plan.groups[Index(g)];
    FillTwists(structure, x, g, chunk);
    const kernels::TwistGroup* lanes = &groups_[Index(g)];
    kernel.twist_transpose_product(lanes, chunk->twists.data(), chunk->product.data());
    // -H_ll^-1 W' x.
    kernel.landmark_steps(lanes, factor_.data() + h_begin_[Index(g)], nullptr,
                          chunk->product.data(), chunk->steps.data());
    const int num_frames = group.num_frames();
    if (chunk->sums.size() < Index(6 * num_frames)) chunk->sums.resize(Index(6 * num_frames));
    kernel.twist_product(lanes, chunk->steps.data(), chunk->sums.data());
    for (int k = 0; k < num_frames; ++k) {
      const std::int32_t block = plan.FrameBlock(group, k);
      if (block < 0) continue;
      const double* T = projected_maps_[Index(block)].T;
      const double* sum = chunk->sums.data() + 6 * k;
      double* out = y + structure.poses()[Index(block)].offset;
      for (int r = 0; r < 6; ++r) {
        for (int c = 0; c < 6; ++c)
          out[c] += T[8 * r + c] * sum[r];
      }
    }
  }
}

// step = H_ll^-1 (b_l - W' dx) for the lanes of a chunk.
void TwistTerms::BackSubstitute(const Structure& structure, const std::vector<double>& dx,
                                int index, double* step) {
  const LandmarkPlan& plan = structure.groups();
  if (plan.empty()) return;
  Chunk* chunk = &chunks_[Index(index)];
  double* const out = step + plan.first_step;
  for (int g = plan.chunk_begin[Index(index)]; g < plan.chunk_begin[Index(index) + 1]; ++g) {
    const LandmarkGroup& group = plan.groups[Index(g)];
    FillTwists(structure, dx.data(), g, chunk);
    const kernels::KernelTable& kernel = kernels::Kernels();
    kernel.twist_transpose_product(&groups_[Index(g)], chunk->twists.data(), chunk->product.data());
    kernel.landmark_steps(&groups_[Index(g)], factor_.data() + h_begin_[Index(g)],
                          b_.data() + group.step_begin, chunk->product.data(), chunk->steps.data());
    FromLanes(group, chunk->steps.data(), out + group.step_begin);
  }
}

void TwistTerms::FillDiagonal(const Structure& structure, double* diagonal, double* b) const {
  const LandmarkPlan& plan = structure.groups();
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    const LandmarkGroup& group = plan.groups[g];
    FromLanes(group, b_.data() + group.step_begin, b + group.step_begin);
    for (int i = 0; i < group.dim; ++i) {
      const double* h = h_.data() + h_begin_[g] + i * (i + 3) / 2 * group.lanes;
      for (std::int32_t l = 0; l < group.lanes; ++l)
        diagonal[group.step_begin + group.dim * l + i] = h[l];
    }
  }
}

double TwistTerms::QuadraticForm(const Structure& structure, const Graph& graph,
                                 const std::vector<double>& d) {
  const LandmarkPlan& plan = structure.groups();
  if (plan.empty()) return 0.0;
  ProjectMaps(structure, graph);
  const double* dl = d.data() + structure.num_pose_scalars() + plan.first_step;
  double sum = 0.0;
  Chunk* chunk = &chunks_.front();
  for (std::size_t g = 0; g < plan.groups.size(); ++g) {
    const LandmarkGroup& group = plan.groups[g];
    FillTwists(structure, d.data(), static_cast<int>(g), chunk);
    kernels::Kernels().twist_transpose_product(&groups_[g], chunk->twists.data(),
                                               chunk->product.data());
    const double* x = dl + group.step_begin;
    const double* H = h_.data() + h_begin_[g];
    for (std::int32_t l = 0; l < group.used; ++l, x += group.dim) {
      for (int i = 0, term = 0; i < group.dim; ++i) {
        sum += 2.0 * x[i] * chunk->product[Index(i * group.lanes + l)];
        for (int j = 0; j <= i; ++j, ++term)
          sum += (i == j ? 1.0 : 2.0) * x[i] * x[j] * H[term * group.lanes + l];
      }
    }
  }
  return sum;
}

}  // namespace glissade
