// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/linear/normal_equations.h"
#include "linear/twist_terms.h"

namespace glissade {

namespace {

/// x'A y.
double Bilinear(const double* x, const DenseBlock& A, const double* y) {
  double sum = 0.0;
  for (int r = 0; r < A.rows; ++r) {
    double row = 0.0;
    for (int c = 0; c < A.cols; ++c)
      row += A(r, c) * y[c];
    sum += x[r] * row;
  }
  return sum;
}

}  // namespace

double NormalEquations::QuadraticForm(const Structure& structure, const Graph& graph,
                                      const std::vector<double>& d) {
  double sum = twists_->QuadraticForm(structure, graph, d);
  const Hessian H = GetHessian(structure);
  for (std::size_t k = 0; k < H.num_pairs(); ++k) {
    const Hessian::PosePair pair = H.Pair(k);
    const double value =
        Bilinear(d.data() + H.offset(pair.row), pair.H, d.data() + H.offset(pair.col));
    sum += pair.row == pair.col ? value : 2.0 * value;
  }
  for (std::size_t l = 0; l < H.num_landmarks(); ++l) {
    const Hessian::LandmarkPart landmark = H.Landmark(l);
    const double* dl = d.data() + num_poses_scalars_ + structure.landmarks()[l].step;
    sum += Bilinear(dl, landmark.H(), dl);
    for (int s = 0; s < landmark.num_slots(); ++s)
      sum += 2.0 * Bilinear(d.data() + landmark.row(s), landmark.W(s), dl);
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
