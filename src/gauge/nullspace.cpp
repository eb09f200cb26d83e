// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/gauge/nullspace.h"

#include <algorithm>
#include <cmath>

#include "gauge/gauge_breaches.h"
#include "gauge/gauge_vectors.h"
#include "glissade/base/index.h"
#include "glissade/base/out_of_memory.h"
#include "glissade/linear/normal_equations.h"

namespace glissade {

namespace {

using internal::Index;

template <int N>
void AddForms(double factor, const DenseBlock& A, const double* x, const double* y, double* sum) {
  for (int r = 0; r < A.rows; ++r, x += N) {
    double row[N] = {};
    for (int c = 0; c < A.cols; ++c) {
      for (int k = 0; k < N; ++k)
        row[k] += A(r, c) * y[c * N + k];
    }
    for (int k = 0; k < N; ++k)
      sum[k] += factor * x[k] * row[k];
  }
}

/// sum[k] += factor * x_k' A y_k for columns k of x (rows x n) and y (cols x n); all row-major.
void AddForms(double factor, int n, const DenseBlock& A, const double* x, const double* y,
              double* sum) {
  if (n == 4) return AddForms<4>(factor, A, x, y, sum);
  if (n == 6) return AddForms<6>(factor, A, x, y, sum);
  AddForms<7>(factor, A, x, y, sum);
}

struct Forms {
  double total[Orbit::kMaxDim] = {};
  double by_vertex[Orbit::kMaxDim] = {};
};

/// u'Hu and sum_k u_k'H_kk u_k from the blocks.
Forms FormsOf(const Graph& graph, const Structure& structure, NormalEquations* equations,
              const GaugeVectors& vectors) {
  const int n = vectors.dim();
  Forms forms;
  const Hessian H = equations->GetHessian(structure);
  for (std::size_t k = 0; k < H.num_pairs(); ++k) {
    const Hessian::PosePair pair = H.Pair(k);
    const double* x = vectors.Pose(pair.row);
    const double* y = vectors.Pose(pair.col);
    if (x == nullptr || y == nullptr) continue;
    const bool diagonal = pair.row == pair.col;
    AddForms(diagonal ? 1.0 : 2.0, n, pair.H, x, y, diagonal ? forms.by_vertex : forms.total);
  }
  for (std::size_t l = 0; l < H.num_landmarks(); ++l) {
    const Hessian::LandmarkPart landmark = H.Landmark(l);
    const double* u = vectors.Landmark(static_cast<int>(l));
    if (u == nullptr) continue;
    AddForms(1.0, n, landmark.H(), u, u, forms.by_vertex);
    for (int s = 0; s < landmark.num_slots(); ++s) {
      const double* x = vectors.Pose(landmark.pose(s));
      if (x != nullptr) AddForms(2.0, n, landmark.W(s), x, u, forms.total);
    }
  }
  for (int k = 0; k < n; ++k)
    forms.total[k] += forms.by_vertex[k];
  for (int k = vectors.first_of_lanes(); k < n; ++k) {
    forms.total[k] = equations->QuadraticForm(structure, graph, vectors.Whole(structure, k));
    // No two of them share an edge.
    forms.by_vertex[k] += equations->QuadraticForm(structure, graph, vectors.Lanes(structure, k));
  }
  return forms;
}

}  // namespace

double NullspaceReport::MaxKappa() const {
  double largest = 0.0;
  for (const NullspaceDirection& direction : directions)
    largest = std::max(largest, direction.kappa);
  return largest;
}

namespace {

Result<NullspaceReport> Check(const Graph& graph, const Structure& structure,
                              NormalEquations* equations, const NullspaceOptions& options) {
  if (!(options.tolerance >= 0.0) || options.max_edges < 0) {
    return Status(StatusCode::kInvalidArgument,
                  "CheckNullspace: tolerance and max_edges must not be negative");
  }
  if (!structure.IsCurrent(graph) || !equations->IsLinearized(structure)) {
    return Status(StatusCode::kInvalidArgument,
                  "CheckNullspace: there is no linearization of this graph as it is now");
  }
  const Result<Orbit> orbit = Orbit::Of(graph, options.group);
  if (!orbit.ok()) return orbit.status();
  NullspaceReport report;
  report.group = orbit->group();
  const GaugeVectors vectors(graph, structure, equations->point(), orbit.value(), &report.held);
  const Forms forms = FormsOf(graph, structure, equations, vectors);

  const int n = orbit->dim();
  bool observed = false;
  for (int k = 0; k < n; ++k) {
    if (!std::isfinite(forms.total[k]) || !std::isfinite(forms.by_vertex[k])) {
      return Status(StatusCode::kNotFinite, "CheckNullspace: the information is not finite");
    }
    // Rounding can make a small form negative.
    const double information = std::max(0.0, forms.total[k]);
    const double kappa = forms.by_vertex[k] > 0.0 ? information / forms.by_vertex[k] : 0.0;
    report.directions.push_back({GaugeDirectionName(orbit->group(), k), kappa, information});
    observed = observed || kappa > options.tolerance;
  }
  if (observed) {
    GaugeBreaches breaches(graph, equations->point(), orbit.value(), options.tolerance);
    report.num_edges =
        breaches.Find(forms.total, forms.by_vertex, options.max_edges, &report.edges);
  }
  return report;
}

}  // namespace

Result<NullspaceReport> CheckNullspace(const Graph& graph, const Structure& structure,
                                       NormalEquations* equations,
                                       const NullspaceOptions& options) {
  return internal::OrOutOfMemory([&] { return Check(graph, structure, equations, options); });
}

Result<NullspaceReport> CheckNullspace(Graph* graph, const NullspaceOptions& options) {
  return internal::OrOutOfMemory([&]() -> Result<NullspaceReport> {
    Structure structure;
    Status status = structure.Analyze(graph, {.allow_duplicate_observations = true});
    if (!status.ok()) return status;
    NormalEquations equations;
    ThreadPool threads;
    double cost = 0.0;
    status = equations.Linearize(structure, graph, &threads, &cost);
    if (!status.ok()) return status;
    return Check(*graph, structure, &equations, options);
  });
}

}  // namespace glissade
