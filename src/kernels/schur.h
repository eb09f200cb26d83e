// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Data of the kernels that eliminate landmarks of any shape, whatever the form that S is stored in.
//
// With H_ll^-1 = C'C, C lower triangular, and Z = W C', a landmark's part of the Schur complement
// is S -= Z Z', b_s -= Z (C b_l). Landmarks are taken in batches: first Z of all of them, and then
// block after block of S, each with the landmarks that its two vertices have in common. A block is
// then summed up in registers, where landmark after landmark would read and write it for each.

#ifndef GLISSADE_KERNELS_SCHUR_H_
#define GLISSADE_KERNELS_SCHUR_H_

#include <stdint.h>

namespace glissade::kernels {

/// A landmark of tangent dimension dl (1 to 4) and the `blocks` vertices that see it: its slots.
struct SchurLandmark {
  int32_t blocks;
  int32_t dl;
  const int32_t* row;  ///< first scalar of each in x and y; ascends, blocks do not overlap
  const int32_t* dim;
  const double* w;       ///< W, blocks one after the other, each row-major dim x dl
  const double* factor;  ///< C, dl x dl, row-major, with zeros above the diagonal
  const double* b;       ///< b_l
};

/// Two slots of one landmark, by their number in the batch.
struct SlotPair {
  uint16_t row, col;
};

/// A block of S, and the pairs of slots that add to it: element (r, c) is at s[offset + r + c *
/// stride].
struct SchurBlock {
  int64_t offset;
  int32_t stride;
  int32_t rhs;  ///< of a diagonal block: its first scalar of b. Else -1
  int32_t pair_begin, pair_end;
  int32_t col;  ///< the vertex whose block column it is in
  uint16_t rows, cols;
};

/// Z of a batch of landmarks.
struct SchurPanel {
  int32_t dl;
  int32_t dim;               ///< of all slots; 0: they differ
  const double* z;           ///< a slot's block: dim x dl, column-major; 8 numbers more are read
  const int32_t* slot;       ///< by slot: where it begins in z
  const uint16_t* landmark;  ///< by slot: its landmark's number in the batch
  const double* beta;        ///< C b_l of each landmark
  const SlotPair* pairs;
};

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_SCHUR_H_
