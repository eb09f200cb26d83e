// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marginal/schur_form.h"

#include <algorithm>
#include <string>

#include "glissade/base/index.h"
#include "kernels/kernels.h"
#include "marginal/information_root.h"

namespace glissade::internal {

namespace {

using internal::Index;

Status Indefinite() {
  return {StatusCode::kNotPositive,
          "Marginalize: the information matrix is not positive semi-definite to rounding; the "
          "square-root form has no such limit"};
}

}  // namespace

Status SchurForm::Run(MarginalSystem* system, const MarginalizeOptions& options,
                      MarginalReport* report, std::vector<double>* r0,
                      std::vector<double>* jacobian) {
  const int going = system->going_dim(), staying = system->staying_dim();
  const int size = going + staying + 1;
  stride_ = (size + 7) / 8 * 8;
  A_.assign(Index(stride_) * Index(size), 0.0);
  for (int l = 0; l < system->num_landmarks(); ++l) {
    if (Status s = system->Linearize(system->EdgesOf(l), &panel_); !s.ok()) return s;
    const int dim = panel_.landmark_dim;
    products_.assign(Index(panel_.stride) * Index(panel_.stride), 0.0);
    // A row-major panel of rows is a column-major one of columns: products = panel' panel.
    kernels::Kernels().syrk_lower_add(panel_.columns, panel_.rows, panel_.data.data(),
                                      panel_.stride, products_.data(), panel_.stride);
    const int rank = EliminateLeading(panel_.columns, dim, products_.data(), panel_.stride,
                                      options.relative_cut, &scratch_, nullptr);
    if (rank < 0) return Indefinite();
    const MarginalVariable& v = system->variable(system->landmark_variable(l));
    if (rank < v.dim) {
      report->rank_deficiency += v.dim - rank;
      report->deficient.push_back(v.pool->HandleAt(v.index));
    }
    AddProducts(*system, panel_);
  }
  for (const MarginalEdge& edge : system->OtherEdges()) {
    if (MarginalSystem::AsPrior(edge) != nullptr && system->IsUnmoved(edge)) {
      AddPrior(*system, edge);
      continue;
    }
    if (Status s = system->Linearize({&edge, 1}, &panel_); !s.ok()) return s;
    products_.assign(Index(panel_.stride) * Index(panel_.stride), 0.0);
    kernels::Kernels().syrk_lower_add(panel_.columns, panel_.rows, panel_.data.data(),
                                      panel_.stride, products_.data(), panel_.stride);
    AddProducts(*system, panel_);
  }

  weak_.assign(Index(going), 0);
  const int rank = EliminateLeading(size, going, A_.data(), stride_, options.relative_cut,
                                    &scratch_, weak_.data());
  if (rank < 0) return Indefinite();
  report->rank_deficiency += going - rank;
  for (const std::int32_t k : system->dense_order()) {
    const MarginalVariable& v = system->variable(k);
    if (v.kind != MarginalVariable::Kind::kGoes) continue;
    const auto begin = weak_.begin() + v.column;
    if (std::find(begin, begin + v.dim, 1) != begin + v.dim) {
      report->deficient.push_back(v.pool->HandleAt(v.index));
    }
  }
  const double* reduced = A_.data() + Index(going) * Index(stride_) + Index(going);
  double constant = 0.0;
  const int rows =
      options.root == InformationRoot::kEigen
          ? EigenRoot(staying, reduced, stride_, options.relative_cut, r0, jacobian, &constant)
          : CholeskyRoot(staying, reduced, stride_, options.relative_cut, &scratch_, r0, jacobian,
                         &constant);
  if (rows < 0) return Indefinite();
  report->constant_cost = 0.5 * std::max(constant, 0.0);
  return {};
}

void SchurForm::AddProducts(const MarginalSystem& system, const RowPanel& panel) {
  column_of_.assign(Index(panel.columns), 0);
  for (const RowPanel::Part& part : panel.parts) {
    const MarginalVariable& v = system.variable(part.variable);
    for (int c = 0; c < v.dim; ++c)
      column_of_[Index(part.column + c)] = v.column + c;
  }
  column_of_[Index(panel.columns - 1)] = system.going_dim() + system.staying_dim();
  // Parts are in the order of their columns, so a lower triangle goes to a lower triangle.
  for (int c = panel.landmark_dim; c < panel.columns; ++c) {
    const double* from = products_.data() + Index(c) * Index(panel.stride);
    double* to = A_.data() + Index(column_of_[Index(c)]) * Index(stride_);
    for (int r = c; r < panel.columns; ++r)
      to[column_of_[Index(r)]] += from[r];
  }
}

void SchurForm::AddPrior(const MarginalSystem& system, const MarginalEdge& edge) {
  const EdgeMarginalPrior& prior = *MarginalSystem::AsPrior(edge);
  const int n = prior.TangentDim(), last = system.going_dim() + system.staying_dim();
  column_of_.clear();
  for (int i = 0; i < edge.arity; ++i) {
    const MarginalVariable& v = system.VertexOf(edge, i);
    for (int c = 0; c < v.dim; ++c)
      column_of_.push_back(v.column + c);
  }
  const double* H = prior.ConstantHessian();
  for (int r = 0; r < n; ++r) {
    for (int c = 0; c <= r; ++c) {
      const std::int32_t row = column_of_[Index(r)], col = column_of_[Index(c)];
      A_[Index(std::min(row, col)) * Index(stride_) + Index(std::max(row, col))] +=
          H[Index(r) * Index(n) + Index(c)];
    }
  }
  const std::span<const double> J = prior.jacobian(), r0 = prior.r0();
  double c = 0.0;
  products_.assign(Index(n), 0.0);
  for (std::size_t row = 0; row < r0.size(); ++row) {
    kernels::Kernels().axpy(n, r0[row], J.data() + row * Index(n), products_.data());
    c += r0[row] * r0[row];
  }
  for (int k = 0; k < n; ++k)
    A_[Index(column_of_[Index(k)]) * Index(stride_) + Index(last)] += products_[Index(k)];
  A_[Index(last) * Index(stride_) + Index(last)] += c;
}

}  // namespace glissade::internal
