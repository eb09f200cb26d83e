// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Data of the kernels that eliminate one landmark at a time: what a landmark is, and where its part
// of the Schur complement goes, whatever the form that S is stored in.

#ifndef GLISSADE_KERNELS_SCHUR_H_
#define GLISSADE_KERNELS_SCHUR_H_

#include <stdint.h>

namespace glissade::kernels {

/// A landmark of tangent dimension dl (1 to 4) and the `blocks` vertices that see it, ascending.
struct SchurLandmark {
  int32_t blocks;
  int32_t dl;
  const int32_t* vertex;  ///< number of each
  const int32_t* row;     ///< its first scalar in b, x and y; ascends, blocks do not overlap
  const int32_t* dim;     ///< 1 to 16
  const double* w;        ///< W, blocks one after the other, each row-major dim x dl
  const double* inverse;  ///< H_ll^-1, dl x dl
  const double* b;        ///< b_l
};

/// Where S is stored. Block (a, c) of a landmark's vertices, a >= c, lies in block column c:
///   element (r, k) at s[column[v_c] + row_in_column + r + k * stride[v_c]].
/// Vertices that are neighbours in a block column (row_in_column + dim is the next one's) are so in
/// every block column of the landmark.
struct SchurTarget {
  double* s;
  double* b;              ///< right-hand side
  const int64_t* column;  ///< by vertex: offset of its block column
  const int32_t* stride;  ///< by vertex
};

/// row_in_column of one landmark.
struct SchurRows {
  /// null: only diagonal blocks are stored, at row 0 of their columns.
  const int32_t* row;
  /// false: row[a] for every c; true: a packed lower triangle, column by column.
  bool packed;
};

/// Numbers of scratch that schur_update needs for a landmark whose vertices have `rows` scalars.
constexpr int64_t SchurScratch(int64_t rows) {
  return 8 * ((rows + 15) / 8 * 8);
}

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_SCHUR_H_
