// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/normal_equations.h"
#include "linear/reprojection_terms.h"

namespace glissade {

namespace {

std::size_t Index(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

/// x'A y, A row-major.
double Bilinear(const double* x, int rows, const double* A, int cols, const double* y) {
  double sum = 0.0;
  for (int r = 0; r < rows; ++r) {
    double row = 0.0;
    for (int c = 0; c < cols; ++c)
      row += A[r * cols + c] * y[c];
    sum += x[r] * row;
  }
  return sum;
}

}  // namespace

double NormalEquations::QuadraticForm(const Structure& structure, const Graph& graph,
                                      const std::vector<double>& d) {
  double sum = reprojections_->QuadraticForm(structure, graph, d);
  for (const PoseBlockPair& pair : structure.h_blocks()) {
    const PoseBlock& row = structure.poses()[Index(pair.row)];
    const PoseBlock& col = structure.poses()[Index(pair.col)];
    const double value = Bilinear(d.data() + row.offset, row.dim, h_pp_[0].data() + pair.offset,
                                  col.dim, d.data() + col.offset);
    sum += pair.row == pair.col ? value : 2.0 * value;
  }
  for (const LandmarkBlock& landmark : structure.landmarks()) {
    const int dim = landmark.dim;
    const double* record = landmarks_.data() + landmark.record;
    const double* dl = d.data() + num_poses_scalars_ + landmark.step;
    sum += Bilinear(dl, dim, record, dim, dl);
    const double* W = record + dim * dim + dim;
    for (std::int32_t s = landmark.slot_begin; s < landmark.slot_end; ++s) {
      const int rows = structure.slot_dim()[Index(s)];
      sum += 2.0 * Bilinear(d.data() + structure.slot_row()[Index(s)], rows, W, dim, dl);
      W += rows * dim;
    }
  }
  return sum;
}

double NormalEquations::ModelDecrease(const Structure& structure, const Graph& graph,
                                      const std::vector<double>& d) {
  double sum = 0.0;
  for (std::size_t k = 0; k < d.size(); ++k)
    sum += b_[k] * d[k];
  return sum - 0.5 * QuadraticForm(structure, graph, d);
}

}  // namespace glissade
