// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What NormalEquations makes of H once edges have filled it: partly fixed vertices projected, the
// constant part found, the diagonal, and all of it by its parts.

#include "glissade/linear/hessian.h"

#include <algorithm>

#include "glissade/base/index.h"
#include "glissade/graph/pools.h"
#include "glissade/linear/normal_equations.h"
#include "linear/free_tangents.h"
#include "linear/twist_terms.h"

namespace glissade {

namespace {

using internal::Index;

}  // namespace

void NormalEquations::ProjectFreeTangents(const Structure& structure, Graph* graph) {
  if (graph->free_tangents().empty()) return;
  // P = [E 0]: edges filled full blocks; E' goes over them once per vertex, and the coordinates
  // that are held become unit rows, so that blocks keep their size.
  const auto tangent_of = [&](const PoseBlock& pose) -> const FreeTangent& {
    return graph->free_tangents()[Index(pose.free_tangent)];
  };
  for (const PoseBlockPair& pair : structure.varying_blocks()) {
    const PoseBlock& row = structure.poses()[Index(pair.row)];
    const PoseBlock& col = structure.poses()[Index(pair.col)];
    double* H = h_pp_[0].data() + pair.offset;
    if (row.free_tangent >= 0) {
      for (int c = 0; c < col.dim; ++c)
        Project(tangent_of(row), H + c, col.dim);
    }
    if (col.free_tangent >= 0) {
      for (int r = 0; r < row.dim; ++r)
        Project(tangent_of(col), H + r * col.dim, 1);
    }
  }
  for (const LandmarkBlock& landmark : structure.landmarks()) {
    double* w = landmarks_.data() + landmark.record + landmark.dim * landmark.dim + landmark.dim;
    for (std::int32_t s = landmark.slot_begin; s < landmark.slot_end; ++s) {
      const PoseBlock& pose = structure.poses()[Index(structure.slot_block()[Index(s)])];
      for (int c = 0; pose.free_tangent >= 0 && c < landmark.dim; ++c)
        Project(tangent_of(pose), w + c, landmark.dim);
      w += pose.dim * landmark.dim;
    }
  }
  for (const PoseBlock& pose : structure.poses()) {
    if (pose.free_tangent < 0) continue;
    Project(tangent_of(pose), b_p_[0].data() + pose.offset, 1);
    for (int k = tangent_of(pose).free_dim; k < pose.dim; ++k)
      held_[Index(pose.offset + k)] = 1;
  }
}

// Where the blocks of linear edges' constant H are: the edges' own numbers, or a copy where a
// vertex is partly fixed.
void NormalEquations::FindConstants(const Structure& structure, const Graph& graph) {
  constants_.clear();
  if (structure.constant_blocks().empty()) return;
  const auto& pool =
      static_cast<const DynamicEdgePool&>(*graph.EdgePoolOf(&kTypeInfo<DynamicEdge>));
  const auto rows_of = [&](const ConstantBlock& block) -> const PoseBlock& {
    return structure.poses()[Index(structure.h_blocks()[Index(block.pair)].row)];
  };
  const auto cols_of = [&](const ConstantBlock& block) -> const PoseBlock& {
    return structure.poses()[Index(structure.h_blocks()[Index(block.pair)].col)];
  };
  std::size_t size_of_copies = 0;
  for (const ConstantBlock& block : structure.constant_blocks()) {
    const PoseBlock &row = rows_of(block), &col = cols_of(block);
    if (row.free_tangent >= 0 || col.free_tangent >= 0)
      size_of_copies += Index(row.dim) * Index(col.dim);
  }
  projected_.resize(size_of_copies);
  double* copy = projected_.data();
  for (const ConstantBlock& block : structure.constant_blocks()) {
    const std::int32_t edge = structure.constant_edges()[Index(block.edge)];
    std::int64_t size = 0;
    for (int i = 0; i < pool.arity(edge); ++i)
      size += pool.vertex_pool(edge, i)->ops().tangent_dim;
    // Symmetric, so row-major is column-major.
    BlockView view{pool.At(edge).ConstantHessian() + block.row + block.col * size, size};
    const PoseBlock &row = rows_of(block), &col = cols_of(block);
    if (row.free_tangent >= 0 || col.free_tangent >= 0) {
      for (int c = 0; c < col.dim; ++c)
        std::copy_n(view.data + c * size, row.dim, copy + c * row.dim);
      for (int c = 0; c < col.dim && row.free_tangent >= 0; ++c)
        Project(graph.free_tangents()[Index(row.free_tangent)], copy + c * row.dim, 1);
      for (int r = 0; r < row.dim && col.free_tangent >= 0; ++r)
        Project(graph.free_tangents()[Index(col.free_tangent)], copy + r, row.dim);
      view = {copy, row.dim};
      copy += row.dim * col.dim;
    }
    constants_.push_back(view);
  }
}

Hessian NormalEquations::GetHessian(const Structure& structure) {
  if (constants_.empty()) return {structure, h_pp_[0].data(), landmarks_.data()};
  if (!is_whole_) {
    h_whole_.assign(Index(structure.h_size()), 0.0);
    std::copy(h_pp_[0].begin(), h_pp_[0].end(), h_whole_.begin());
    for (std::size_t k = 0; k < constants_.size(); ++k) {
      const PoseBlockPair& pair = structure.h_blocks()[Index(structure.constant_blocks()[k].pair)];
      const int rows = structure.poses()[Index(pair.row)].dim;
      const int cols = structure.poses()[Index(pair.col)].dim;
      double* H = h_whole_.data() + pair.offset;
      for (int r = 0; r < rows; ++r) {
        for (int c = 0; c < cols; ++c)
          H[r * cols + c] += constants_[k].data[r + c * constants_[k].stride];
      }
    }
    is_whole_ = true;
  }
  return {structure, h_whole_.data(), landmarks_.data()};
}

// diag(H) and b in one vector each.
void NormalEquations::FillDiagonal(const Structure& structure) {
  for (const PoseBlock& pose : structure.poses()) {
    for (int k = 0; k < pose.dim; ++k) {
      const std::size_t scalar = Index(pose.offset + k);
      diagonal_[scalar] = h_pp_[0][Index(pose.h_diagonal + k * pose.dim + k)];
      b_[scalar] = b_p_[0][scalar];
    }
  }
  for (std::size_t k = 0; k < constants_.size(); ++k) {
    const PoseBlockPair& pair = structure.h_blocks()[Index(structure.constant_blocks()[k].pair)];
    if (pair.row != pair.col) continue;
    const PoseBlock& pose = structure.poses()[Index(pair.row)];
    for (int i = 0; i < pose.dim; ++i)
      diagonal_[Index(pose.offset + i)] += constants_[k].data[i * (constants_[k].stride + 1)];
  }
  const std::size_t first = Index(num_poses_scalars_ + structure.groups().first_step);
  twists_->FillDiagonal(structure, diagonal_.data() + first, b_.data() + first);
}

// The same of a chunk's landmarks, as long as their records are in the cache.
void NormalEquations::FillLandmarks(const Structure& structure, int chunk) {
  for (int l = structure.landmark_chunks()[Index(chunk)];
       l < structure.landmark_chunks()[Index(chunk) + 1]; ++l) {
    const LandmarkBlock& landmark = structure.landmarks()[Index(l)];
    const double* record = landmarks_.data() + landmark.record;
    for (int k = 0; k < landmark.dim; ++k) {
      const std::size_t scalar = Index(num_poses_scalars_ + landmark.step + k);
      diagonal_[scalar] = record[k * landmark.dim + k];
      b_[scalar] = record[landmark.dim * landmark.dim + k];
    }
  }
}

}  // namespace glissade
