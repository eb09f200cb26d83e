// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marginal/square_root_form.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/base/index.h"

namespace glissade::internal {

namespace {

using internal::Index;

/// Rows that are merged into the triangle at a time: with it they fit the first-level cache.
constexpr int kBatch = 96;

}  // namespace

Status SquareRootForm::Run(MarginalSystem* system, const MarginalizeOptions& options,
                           MarginalReport* report, std::vector<double>* r0,
                           std::vector<double>* jacobian) {
  // Column lengths are known to rounding times the number of operations on them.
  const int columns = system->going_dim() + system->staying_dim();
  rounding_ = 16.0 * (columns + 16) * std::numeric_limits<double>::epsilon();
  const double cut = options.relative_cut > 0.0 ? std::sqrt(options.relative_cut) : rounding_;
  squared_rest_ = 0.0;
  if (Status status = EliminateLandmarks(system, cut, report); !status.ok()) return status;
  if (Status status = LinearizeOthers(system); !status.ok()) return status;
  StackRows(*system);
  const int lost = stack_.Reduce(system->going_dim(), cut, rounding_);
  report->rank_deficiency += lost;
  for (const std::int32_t column : stack_.deficient()) {
    for (const std::int32_t k : system->dense_order()) {
      const MarginalVariable& v = system->variable(k);
      if (column < v.column || column >= v.column + v.dim) continue;
      const AnyVertex vertex = v.pool->HandleAt(v.index);
      if (std::find(report->deficient.begin(), report->deficient.end(), vertex) ==
          report->deficient.end()) {
        report->deficient.push_back(vertex);
      }
    }
  }
  report->constant_cost = 0.5 * (squared_rest_ + stack_.squared_rest());

  const int rows = stack_.result_end() - stack_.result_begin(), dim = system->staying_dim();
  r0->reserve(Index(dim));  // whatever the rank, which varies
  r0->resize(Index(rows));
  jacobian->reserve(Index(dim) * Index(dim));
  jacobian->resize(Index(rows) * Index(dim));
  for (int row = 0; row < rows; ++row) {
    const double* from = stack_.Row(stack_.result_begin() + row);
    std::copy_n(from + system->going_dim(), dim, jacobian->data() + Index(row) * Index(dim));
    (*r0)[Index(row)] = from[columns];
  }
  return {};
}

void SquareRootForm::FindLandmarkColumns(const MarginalSystem& system) {
  landmark_parts_.clear();
  local_column_.assign(system.variables().size(), -1);
  for (int l = 0; l < system.num_landmarks(); ++l) {
    for (const MarginalEdge& edge : system.EdgesOf(l)) {
      for (int i = 0; i < edge.arity; ++i) {
        const MarginalVariable& v = system.VertexOf(edge, i);
        const auto k = static_cast<std::int32_t>(&v - system.variables().data());
        const bool dense =
            v.kind == MarginalVariable::Kind::kGoes || v.kind == MarginalVariable::Kind::kStays;
        if (!dense || local_column_[Index(k)] >= 0) continue;
        local_column_[Index(k)] = 0;
        landmark_parts_.push_back({k, 0});
      }
    }
  }
  std::sort(landmark_parts_.begin(), landmark_parts_.end(),
            [&](const RowPanel::Part& a, const RowPanel::Part& b) {
              return system.variable(a.variable).column < system.variable(b.variable).column;
            });
  landmark_columns_ = 0;
  for (RowPanel::Part& part : landmark_parts_) {
    part.column = local_column_[Index(part.variable)] = landmark_columns_;
    landmark_columns_ += system.variable(part.variable).dim;
  }
}

Status SquareRootForm::EliminateLandmarks(MarginalSystem* system, double cut,
                                          MarginalReport* report) {
  FindLandmarkColumns(*system);
  triangle_rows_ = waiting_rows_ = 0;
  const int stride = (landmark_columns_ + 1 + 7) / 8 * 8;
  for (int l = 0; l < system->num_landmarks(); ++l) {
    RowPanel& panel = landmark_panel_;
    if (Status status = system->Linearize(system->EdgesOf(l), &panel); !status.ok()) return status;
    deficient_.clear();
    const int used = EliminateColumns(panel.rows, panel.landmark_dim, panel.columns - 1,
                                      panel.data.data(), panel.stride, cut, &scratch_, &deficient_);
    // A landmark without any edge has no rows: it takes nothing with it either.
    if (!deficient_.empty() || (panel.rows == 0 && panel.landmark_dim == 0)) {
      const MarginalVariable& v = system->variable(system->landmark_variable(l));
      report->rank_deficiency += panel.rows == 0 ? v.dim : static_cast<int>(deficient_.size());
      report->deficient.push_back(v.pool->HandleAt(v.index));
    }
    // Its other rows wait, spread to the columns of all landmarks' poses.
    if (waiting_rows_ > 0 && waiting_rows_ + panel.rows - used > kBatch) Compress();
    const std::size_t needed = Index(waiting_rows_ + panel.rows - used);
    if (waiting_.size() < needed * Index(stride)) waiting_.resize(needed * Index(stride));
    if (waiting_begin_.size() < needed) waiting_begin_.resize(needed);
    const std::int32_t begin =
        panel.parts.empty() ? landmark_columns_ : local_column_[Index(panel.parts[0].variable)];
    for (int row = used; row < panel.rows; ++row) {
      const double* from = panel.Row(row);
      double* to = waiting_.data() + Index(waiting_rows_) * Index(stride);
      std::fill_n(to, stride, 0.0);
      for (const RowPanel::Part& part : panel.parts) {
        std::copy_n(from + part.column, system->variable(part.variable).dim,
                    to + local_column_[Index(part.variable)]);
      }
      to[landmark_columns_] = from[panel.columns - 1];
      waiting_begin_[Index(waiting_rows_++)] = begin;
    }
  }
  Compress();
  return {};
}

// The waiting rows go into the triangle.
void SquareRootForm::Compress() {
  if (waiting_rows_ == 0) return;
  const int rows = waiting_rows_ + triangle_rows_;
  batch_.Resize(rows, landmark_columns_);
  const auto stride = Index(batch_.stride());
  count_.assign(Index(landmark_columns_) + 2, 0);
  for (int row = 0; row < waiting_rows_; ++row)
    ++count_[Index(waiting_begin_[Index(row)]) + 1];
  // Row k of the triangle begins no earlier than at column k.
  for (int row = 0; row < triangle_rows_; ++row)
    ++count_[Index(row) + 1];
  for (std::size_t c = 1; c < count_.size(); ++c)
    count_[c] += count_[c - 1];
  const auto put = [&](int begin, const double* from) {
    const int to = count_[Index(begin)]++;
    std::copy_n(from, stride, batch_.Row(to));
    batch_.set_begin(to, begin);
  };
  for (int row = 0; row < waiting_rows_; ++row)
    put(waiting_begin_[Index(row)], waiting_.data() + Index(row) * stride);
  for (int row = 0; row < triangle_rows_; ++row)
    put(row, triangle_.data() + Index(row) * stride);
  batch_.Reduce(0, 0.0, rounding_);
  squared_rest_ += batch_.squared_rest();
  triangle_rows_ = batch_.result_end();
  triangle_.reserve(Index(landmark_columns_ + 1) * stride);  // whatever its rank, which varies
  triangle_.assign(batch_.Row(0), batch_.Row(triangle_rows_));
  waiting_rows_ = 0;
}

Status SquareRootForm::LinearizeOthers(MarginalSystem* system) {
  num_others_ = 0;
  for (const MarginalEdge& edge : system->OtherEdges()) {
    if (other_panels_.size() == Index(num_others_)) other_panels_.emplace_back();
    RowPanel& panel = other_panels_[Index(num_others_++)];
    if (Status status = system->Linearize({&edge, 1}, &panel); !status.ok()) return status;
  }
  return {};
}

void SquareRootForm::AddSource(const RowPanel& panel, const MarginalSystem& system) {
  const std::int32_t end = system.going_dim() + system.staying_dim();
  for (int row = 0; row < panel.rows; ++row) {
    Source source;
    source.row = panel.data.data() + Index(row) * Index(panel.stride);
    source.parts = panel.parts.data();
    source.num_parts = static_cast<std::int32_t>(panel.parts.size());
    source.residual = panel.columns - 1;
    source.begin = end;
    int c = 0;
    while (c < source.residual && source.row[c] == 0.0)
      ++c;
    for (const RowPanel::Part& part : panel.parts) {
      const MarginalVariable& v = system.variable(part.variable);
      if (c >= part.column && c < part.column + v.dim) source.begin = v.column + c - part.column;
    }
    sources_.push_back(source);
  }
}

void SquareRootForm::StackRows(const MarginalSystem& system) {
  const int columns = system.going_dim() + system.staying_dim();
  sources_.clear();
  sources_.reserve(Index(landmark_columns_) + 1);
  const int stride = (landmark_columns_ + 1 + 7) / 8 * 8;
  for (int row = 0; row < triangle_rows_; ++row) {
    Source source;
    source.row = triangle_.data() + Index(row) * Index(stride);
    source.parts = landmark_parts_.data();
    source.num_parts = static_cast<std::int32_t>(landmark_parts_.size());
    source.residual = landmark_columns_;
    source.begin = columns;
    for (const RowPanel::Part& part : landmark_parts_) {
      const MarginalVariable& v = system.variable(part.variable);
      if (row >= part.column && row < part.column + v.dim) {
        source.begin = v.column + row - part.column;
      }
    }
    sources_.push_back(source);
  }
  for (int k = 0; k < num_others_; ++k)
    AddSource(other_panels_[Index(k)], system);

  stack_.Resize(static_cast<int>(sources_.size()), columns);
  count_.assign(Index(columns) + 2, 0);
  for (Source& source : sources_) {
    if (source.begin < system.going_dim()) source.begin = 0;  // pivoting mixes these columns
    ++count_[Index(source.begin) + 1];
  }
  for (std::size_t c = 1; c < count_.size(); ++c)
    count_[c] += count_[c - 1];
  for (const Source& source : sources_) {
    const int to = count_[Index(source.begin)]++;
    double* row = stack_.Row(to);
    for (std::int32_t p = 0; p < source.num_parts; ++p) {
      const MarginalVariable& v = system.variable(source.parts[p].variable);
      std::copy_n(source.row + source.parts[p].column, v.dim, row + v.column);
    }
    row[columns] = source.row[source.residual];
    stack_.set_begin(to, source.begin);
  }
}

}  // namespace glissade::internal
