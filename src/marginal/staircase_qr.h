// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

namespace glissade::internal {

/// Householder QR of the first num_going columns of a row-major panel (num_columns and then r in a
/// row) with column pivoting; columns that have nothing left above relative_cut times their own
/// length are taken as zero and appended to *deficient. Returns the number of rows that the others
/// took: these rows come first.
struct QrScratch {
  std::vector<double> reflector, length;
  std::vector<std::int32_t> column_of;
};
int EliminateColumns(int rows, int num_going, int num_columns, double* data, int stride,
                     double relative_cut, QrScratch* scratch, std::vector<std::int32_t>* deficient);

/// QR of rows [A | r] of which each begins at some column (its staircase). Only rows that have
/// begun take part in the elimination of a column, so a triangular block costs nothing by itself:
/// each of its rows joins when its own column comes.
///
/// Fill the rows in ascending order of their beginnings, then Reduce.
class StaircaseQr {
 public:
  /// num_columns: without r, which is column num_columns.
  void Resize(int num_rows, int num_columns);
  [[nodiscard]] int num_rows() const { return num_rows_; }
  [[nodiscard]] int num_columns() const { return num_columns_; }
  [[nodiscard]] int stride() const { return stride_; }
  [[nodiscard]] double* Row(int row) { return data_.data() + Offset(row); }
  [[nodiscard]] const double* Row(int row) const { return data_.data() + Offset(row); }
  void set_begin(int row, int column) { begin_[static_cast<std::size_t>(row)] = column; }

  /// Eliminates the first num_going columns with column pivoting; those that have nothing left
  /// above relative_cut times their own length are treated as zero. Then the other columns, in
  /// order; one that has nothing left above `rounding` times its own length depends on those before
  /// it and gets no row. Returns the number of going columns treated as zero; deficient() names
  /// them.
  int Reduce(int num_going, double relative_cut, double rounding);

  /// After Reduce: the rows of the result, upper trapezoidal over the columns after num_going.
  [[nodiscard]] int result_begin() const { return result_begin_; }
  [[nodiscard]] int result_end() const { return result_end_; }
  /// Squared length of r in what is left over below the result.
  [[nodiscard]] double squared_rest() const { return squared_rest_; }
  [[nodiscard]] const std::vector<std::int32_t>& deficient() const { return deficient_; }

 private:
  [[nodiscard]] std::size_t Offset(int row) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(stride_);
  }

  int num_rows_ = 0, num_columns_ = 0, stride_ = 0;
  int result_begin_ = 0, result_end_ = 0;
  double squared_rest_ = 0.0;
  std::vector<double> data_;
  std::vector<std::int32_t> begin_;
  std::vector<double> length_;  // squared, of the columns
  QrScratch scratch_;
  std::vector<std::int32_t> deficient_;
};

}  // namespace glissade::internal
