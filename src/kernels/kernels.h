// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The hot loops of the library on raw double*, compiled once per instruction set.
//
// Each table is built from the same source (src/kernels/impl) with the flags of its instruction
// set. Everything in there has internal linkage: with inline functions shared between objects built
// for different instruction sets the linker would be free to pick the AVX-512 copy for everybody.
//
// All kernels are deterministic (same input and same table: same bits), allocate nothing, touch no
// global state and ask for no alignment beyond that of double. 64-byte aligned columns are faster.
//
// Matrices are column-major with a leading dimension, symmetric ones are given by their lower
// triangle; the strictly upper triangle is neither read nor written unless stated otherwise.

#ifndef GLISSADE_KERNELS_KERNELS_H_
#define GLISSADE_KERNELS_KERNELS_H_

#include <stdint.h>

#include "kernels/losses.h"
#include "kernels/points.h"
#include "kernels/schur.h"
#include "kernels/twists.h"
#include "kernels/two_view.h"

namespace glissade::kernels {

/// How many of the n columns that are still to be eliminated the factorizations below take at a
/// time, before they update what is right of them.
constexpr int kWidePanel = 192;
constexpr int CholeskyPanelColumns(int n) {
  return n < kWidePanel ? n : n < 1024 ? 96 : kWidePanel;
}
/// syrk_lower_sub sums up the products of so many columns of W at a time.
constexpr int kUpdateDepth = 96;
/// First columns of parts of syrk_packed_sub are multiples of kColumnBlock; packed W has n numbers
/// a column, rounded up to a multiple of kPackedRows.
constexpr int kColumnBlock = 8;
constexpr int kPackedRows = 24;

enum class Isa { kBaseline = 0, kAvx2 = 1, kAvx512 = 2 };

/// Function pointers of one instruction set.
struct KernelTable {
  Isa isa;
  const char* name;  ///< "baseline", "avx2" or "avx512": what GLISSADE_ISA is compared with.
  int width;         ///< doubles per vector register

  // ---- Dense symmetric factorization and solves -------------------------------------------------

  /// A = L L' in place, lower triangle, n >= 0, lda >= n.
  /// Returns 0, or 1 + index of the first pivot that is not > 0 (NaN counts as such); the lower
  /// triangle is then partly overwritten.
  int (*cholesky)(int n, double* a, int lda);

  /// x <- (L L')^-1 x with the factor of `cholesky`.
  void (*cholesky_solve)(int n, const double* l, int lda, double* x);
  /// x <- L^-1 x.
  void (*forward_solve)(int n, const double* l, int lda, double* x);

  /// One front of a multifrontal factorization. Eliminates the first nb of n columns: on return
  /// they hold [L11; L21], and the trailing lower triangle A22 - L21 L21'. Returns as cholesky.
  int (*cholesky_partial)(int n, int nb, double* a, int lda);
  /// Its first nb columns alone: those right of them are not updated. cholesky_partial is this for
  /// CholeskyPanelColumns() at a time, each followed by syrk_lower_sub.
  int (*cholesky_panel)(int n, int nb, double* a, int lda);
  /// x1 <- L11^-1 x1, x2 <- x2 - L21 x1, with x = [x1 (nb); x2 (n - nb)].
  void (*forward_solve_partial)(int n, int nb, const double* l, int lda, double* x);
  /// x1 <- L11^-T (x1 - L21' x2).
  void (*backward_solve_partial)(int n, int nb, const double* l, int lda, double* x);

  /// forward_solve for the nrhs columns of B (n x nrhs, column-major, ldb >= n).
  void (*forward_solve_many)(int n, const double* l, int lda, int nrhs, double* b, int ldb);

  // ---- Products ---------------------------------------------------------------------------------

  /// y = A x, A symmetric by its lower triangle. x and y must not overlap.
  void (*symv_lower)(int n, const double* a, int lda, const double* x, double* y);
  /// y += the part of A x that the first `columns` columns of the lower triangle make, their
  /// mirror image included.
  void (*symv_lower_columns)(int n, int columns, const double* a, int lda, const double* x,
                             double* y);
  /// x'y.
  double (*dot)(int n, const double* x, const double* y);
  /// y += alpha x.
  void (*axpy)(int n, double alpha, const double* x, double* y);

  /// S -= W W' (lower triangle of S, n x n). W is n x k, column-major.
  void (*syrk_lower_sub)(int n, int k, const double* w, int ldw, double* s, int lds);
  /// W as syrk_packed_sub takes it.
  void (*pack_rows)(int n, int k, const double* w, int ldw, double* packed);
  /// Columns [begin, end) of syrk_lower_sub, to the bit, for large n.
  void (*syrk_packed_sub)(int n, int k, const double* packed, double* s, int lds, int begin,
                          int end);
  /// S += W W'.
  void (*syrk_lower_add)(int n, int k, const double* w, int ldw, double* s, int lds);
  /// S = -W W', S not read; k > 0.
  void (*syrk_lower_set_negative)(int n, int k, const double* w, int ldw, double* s, int lds);

  /// out = L A. L is rows x rows, row-major (leading zeros of its rows cost nothing); A and out
  /// have rows of `stride` numbers, a multiple of 8. They must not overlap.
  void (*left_multiply)(int rows, const double* l, const double* a, double* out, int stride);

  // ---- Square-root marginalization ----------------------------------------------------------

  /// Householder reflection that makes column `col` of a row-major panel zero below its first row,
  /// applied to columns [col, cols). Rows have `stride` numbers, a multiple of 8 and >= cols. What
  /// lies before col must be zero, and what lies between cols and stride is reflected too. v:
  /// scratch of `rows` numbers. Returns the new first number of the column; nothing is done where
  /// the column is zero below it.
  double (*householder_column)(int rows, int col, int cols, double* a, int stride, double* v);

  // ---- Landmark elimination ---------------------------------------------------------------------

  /// Z = W C' of one landmark: block after block, each column-major; beta = C b_l.
  /// 16 numbers behind W may be read, 8 behind z overwritten.
  void (*schur_panel)(const SchurLandmark* landmark, double* z, double* beta);
  /// S -= Z Z' and b -= Z beta in `count` blocks, of diagonal ones whole.
  void (*schur_blocks)(const SchurPanel* panel, int64_t count, const SchurBlock* blocks, double* s,
                       double* b);
  /// y -= W H_ll^-1 W' x.
  void (*schur_multiply)(const SchurLandmark* landmark, const double* x, double* y);
  /// step = H_ll^-1 (b_l - W' x), dl numbers.
  void (*landmark_step)(const SchurLandmark* landmark, const double* x, double* step);

  // ---- Runs of edges in lanes -------------------------------------------------------------------
  // A value of a run is an array with one number per edge; row k, column c of a matrix of `cols`
  // columns is the array at (k * cols + c) * lanes. `lanes` is a multiple of kLaneBlock.

  /// 1 where all numbers are finite, else 0; count is a multiple of kLaneBlock.
  int (*lanes_finite)(int64_t count, const double* x);
  /// x <- L x, x rows x cols, L rows x rows: one for all (row-major), or an array of lanes per
  /// entry where per_lane is 1. work: rows * lanes numbers.
  void (*whiten_lanes)(int rows, int cols, int lanes, const double* l, int per_lane, double* x,
                       double* work);
  /// r <- scale mask r (mask per lane, null: 1), squares = r'r per lane; returns their sum.
  double (*lane_squares)(int rows, int lanes, double scale, const double* mask, double* r,
                         double* squares);
  /// J <- scale (J - alpha_over_s r (r'J)), scale and alpha_over_s per lane.
  void (*correct_lanes)(int rows, int cols, int lanes, const double* r, const double* scale,
                        const double* alpha_over_s, double* J);
  /// A loss (not kNone) of the squared residuals s, widths per lane (infinite: none). root =
  /// sqrt(rho'(s)); returns the sum of rho(s) / 2.
  double (*loss_lanes)(LaneLoss loss, int lanes, const double* s, const double* width,
                       double* root);
  /// x <- scale x.
  void (*scale_lanes)(int rows, int lanes, const double* scale, double* x);
  /// out (dim_a x dim_b, row-major) += alpha sum over rows and lanes of a'b. a == b: symmetric,
  /// both triangles are written.
  void (*lane_products)(int rows, int lanes, int dim_a, const double* a, int dim_b, const double* b,
                        double alpha, double* out);
  /// For each of the first `count` lanes: base[offset[lane] ...] (dim_a x dim_b, row-major) += a'b,
  /// summed over its rows, or = where `sets`; dim_b is 1 to 4. Adds to offsets that are the same,
  /// too.
  void (*lane_couplings)(int rows, int lanes, int count, int dim_a, const double* a, int dim_b,
                         const double* b, const int64_t* offset, bool sets, double* base);
  /// The same with [J'J | -J'r], J rows x dl, dl 1 to 4: H_ll and b_l.
  void (*lane_landmarks)(int rows, int lanes, int count, int dl, const double* J, const double* r,
                         const int64_t* offset, double* base);

  // ---- Landmarks in groups, poses as twists (kernels/twists.h) ---------------------------------

  /// Residuals and Jacobians of reprojections (kernels/two_view.h); finite where a lane does not
  /// count.
  void (*two_view_lanes)(const TwoViewRun* run, const TwoViewValues* values);
  /// Their cost: half the sum of their losses.
  double (*two_view_cost)(const TwoViewRun* run, const TwoViewWeights* weights);
  /// Evaluates, weighs and adds to the sums in one. cost: out. Returns 0 where a sum or the cost is
  /// not finite, else 1. The frame of the target is its camera's, with turn = R.
  int (*two_view_sums)(const TwoViewRun* run, const TwoViewWeights* weights, const TwistTotals* to,
                       double* cost);
  /// Adds what a run of edges makes. Returns 0 where a sum is not finite, else 1.
  int (*twist_sums)(const TwistRun* run, const TwistTotals* to);
  /// The same for points (kernels/points.h), J_l of three columns.
  int (*point_sums)(const TwistRun* run, const PointTotals* to);
  /// As two_view_sums and two_view_cost.
  int (*point_view_sums)(const PointViewRun* run, const TwoViewWeights* weights,
                         const PointTotals* to, double* cost);
  double (*point_view_cost)(const PointViewRun* run, const TwoViewWeights* weights);
  /// Adds what a pose sees of the points of a group to theirs and to its own. Returns 0 where a sum
  /// is not finite, else 1.
  int (*point_frame_sums)(const PointFrame* frame);
  /// [beta'; W C'] of a group's landmarks, dim columns per lane, of n = 1 + 6 (frames of W) rows
  /// rounded up to kPanelRows; beta = C b_l. That of lane s and component k is column dim s + k.
  /// Rows of targets that do not see the lane are zero up to the end of their block of kPanelRows,
  /// and not written in the blocks after that.
  void (*twist_panel)(const TwistGroup* group, const double* factor, const double* beta, double* w);
  /// reduced = -w w' of such a panel, lower triangle, column-major with its stride. The upper
  /// triangle and what belongs to rows beyond n is scratch.
  void (*twist_reduce)(const TwistGroup* group, const double* w, double* reduced);
  /// product = W' xi per lane, dim arrays; twists: 6 numbers for the host, then for each target.
  void (*twist_transpose_product)(const TwistGroup* group, const double* twists, double* product);
  /// sums = W u, in twists: 6 numbers for the host, then for each target.
  void (*twist_product)(const TwistGroup* group, const double* u, double* sums);
  /// C of each landmark (TwistGroup) from h = H_ll, with lambda clamp(diagonal, min, max) as
  /// damping, and beta = C b; finite numbers in lanes of the last vector that have no landmark.
  /// Returns the first lane with a pivot that is not positive and finite, or -1.
  int (*landmark_pivots)(const TwistGroup* group, const double* h, const double* b, double lambda,
                         double min_diagonal, double max_diagonal, double* factor, double* beta);
  /// step = C'C (b - product), dim arrays of lanes; b null: 0.
  void (*landmark_steps)(const TwistGroup* group, const double* factor, const double* b,
                         const double* product, double* step);
  /// blocks[m] += block (i, j) of `reduced` (6 x 6 blocks, column-major with `stride`) for all i >=
  /// j, with m the next number of map; transposed into block ~m where m < 0; INT32_MIN: left out.
  /// Blocks are column-major with columns of 8, of which the last two are scratch; so are two
  /// numbers behind `reduced`. Of diagonal blocks the lower triangle counts only.
  void (*add_twist_blocks)(int frames, const int32_t* map, const double* reduced, int stride,
                           double* blocks);
  /// out += alpha Ti' B Tj, 6 x 6 row-major: B with rows of ldb, out of row_stride, T = [I, X; 0,
  /// R] of 8.
  void (*map_block)(double alpha, const double* ti, const double* b, int ldb, const double* tj,
                    double* out, int row_stride);

  /// C, lower triangular, with H^-1 = C'C: in place of a symmetric positive definite matrix of
  /// size n (1 to 4), row-major (only the lower triangle is read; zeros above C's diagonal).
  /// Returns 0, or 1 when H is not positive definite or not finite; h is then unchanged.
  int (*inverse_factor)(int n, double* h);
};

/// The table in use: chosen once, at the first call. It is the best one the CPU supports, or the
/// one the environment variable GLISSADE_ISA (baseline, avx2, avx512) names; see
/// IsaSelectionNote().
const KernelTable& Kernels();

/// The table of one instruction set; null where the CPU (or the build) has not got it.
const KernelTable* KernelsFor(Isa isa);

/// Why Kernels() is what it is where GLISSADE_ISA could not be honoured: one line of text, static
/// storage. Empty when there is nothing to report.
const char* IsaSelectionNote();

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_KERNELS_H_
