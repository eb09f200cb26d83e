// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "marginal/staircase_qr.h"

#include <algorithm>
#include <cmath>

#include "glissade/base/index.h"
#include "kernels/kernels.h"

namespace glissade::internal {

namespace {
using internal::Index;
}  // namespace

void StaircaseQr::Resize(int num_rows, int num_columns) {
  num_rows_ = num_rows;
  num_columns_ = num_columns;
  stride_ = (num_columns + 1 + 7) / 8 * 8;
  // Ranks vary from one system of a size to the next, by rounding: by a row a column at the most.
  if (Index(num_rows) > begin_.capacity()) begin_.reserve(Index(num_rows + num_columns));
  if (Index(num_rows) * Index(stride_) > data_.capacity()) {
    data_.reserve(Index(num_rows + num_columns) * Index(stride_));
  }
  data_.assign(Index(num_rows) * Index(stride_), 0.0);
  begin_.assign(Index(num_rows), 0);
  if (scratch_.reflector.size() <= Index(num_rows)) {
    scratch_.reflector.resize(Index(num_rows + num_columns) + 1);
  }
}

int EliminateColumns(int rows, int num_going, int num_columns, double* data, int stride,
                     double relative_cut, QrScratch* scratch,
                     std::vector<std::int32_t>* deficient) {
  scratch->column_of.resize(Index(num_going));
  scratch->length.resize(Index(num_going));
  scratch->reflector.resize(std::max(scratch->reflector.size(), Index(rows) + 1));
  const auto squared = [&](int first_row, int c) {
    double sum = 0.0;
    for (int row = first_row; row < rows; ++row) {
      const double x = data[Index(row) * Index(stride) + Index(c)];
      sum += x * x;
    }
    return sum;
  };
  for (int c = 0; c < num_going; ++c) {
    scratch->column_of[Index(c)] = c;
    scratch->length[Index(c)] = squared(0, c);
  }
  const auto& reflect = kernels::Kernels().householder_column;
  const double cut = relative_cut * relative_cut;
  int pivot = 0;
  for (int c = 0; c < num_going; ++c) {
    // The column with the largest part of its length left.
    int best = -1;
    double best_part = cut;
    for (int k = c; k < num_going; ++k) {
      const double whole = scratch->length[Index(k)];
      const double part = whole > 0.0 ? squared(pivot, k) / whole : 0.0;
      if (part > best_part) {
        best = k;
        best_part = part;
      }
    }
    double* const from = data + Index(pivot) * Index(stride);
    if (best < 0) {
      for (int k = c; k < num_going; ++k) {
        deficient->push_back(scratch->column_of[Index(k)]);
        for (int row = 0; row < rows - pivot; ++row)
          from[Index(row) * Index(stride) + Index(k)] = 0.0;
      }
      break;
    }
    if (best != c) {
      for (int row = 0; row < rows - pivot; ++row) {
        double* const x = from + Index(row) * Index(stride);
        std::swap(x[c], x[best]);
      }
      std::swap(scratch->column_of[Index(c)], scratch->column_of[Index(best)]);
      std::swap(scratch->length[Index(c)], scratch->length[Index(best)]);
    }
    reflect(rows - pivot, c, num_columns + 1, from, stride, scratch->reflector.data());
    ++pivot;
  }
  return pivot;
}

int StaircaseQr::Reduce(int num_going, double relative_cut, double rounding) {
  deficient_.clear();
  length_.assign(Index(num_columns_), 0.0);
  for (int row = 0; row < num_rows_; ++row) {
    const double* const x = Row(row);
    for (int c = begin_[Index(row)]; c < num_columns_; ++c)
      length_[Index(c)] += x[c] * x[c];
  }
  int begun = 0;
  while (begun < num_rows_ && begin_[Index(begun)] < num_going)
    ++begun;
  result_begin_ = EliminateColumns(begun, num_going, num_columns_, data_.data(), stride_,
                                   relative_cut, &scratch_, &deficient_);
  const auto& reflect = kernels::Kernels().householder_column;
  const double rounding_squared = rounding * rounding;
  int pivot = result_begin_, active = pivot;
  for (int c = num_going; c < num_columns_; ++c) {
    while (active < num_rows_ && begin_[Index(active)] <= c)
      ++active;
    if (active == pivot) continue;
    // Reflections keep the length of a column, so what is left of it says whether it depends on the
    // columns before it. Then it has no row of its own, and what stands there is an error.
    const double left = reflect(active - pivot, c, num_columns_ + 1, Row(pivot), stride_,
                                scratch_.reflector.data());
    if (left * left <= rounding_squared * length_[Index(c)]) {
      Row(pivot)[c] = 0.0;
    } else {
      ++pivot;
    }
  }
  result_end_ = pivot;
  squared_rest_ = 0.0;
  for (int row = pivot; row < num_rows_; ++row)
    squared_rest_ += Row(row)[num_columns_] * Row(row)[num_columns_];
  return static_cast<int>(deficient_.size());
}

}  // namespace glissade::internal
