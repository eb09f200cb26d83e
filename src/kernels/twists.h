// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Data of the kernels for landmarks in groups: those of one number that all are seen from one host,
// by edges that know the poses of host and target by their relative pose alone; and points in the
// world (kernels/points.h). Lanes are landmarks.
//
// Poses are linearized as twists about a point o common to all frames, xi = (v, w): dX = v + w x (X
// - o). A change of both poses by the same twist changes no relative pose, so that of a row of the
// residual d r / d xi_host = -d r / d xi_target: one 6-vector serves both frames. With d r /
// d(target) = [a, b] by position and rotation (p + dp, R Exp(dtheta)),
//     d r / d xi_host = [f; q],   f = -a,   q = -R b + (p - o) x f.

#ifndef GLISSADE_KERNELS_TWISTS_H_
#define GLISSADE_KERNELS_TWISTS_H_

#include <stdint.h>

namespace glissade::kernels {

/// Arrays of lanes come in blocks of this many, whatever the instruction set.
constexpr int kLaneBlock = 8;

/// Rows of a panel (see KernelTable::twist_panel) in one block.
constexpr int kPanelRows = 8;

/// Numbers of a sum over a run, with padding: 21 of a symmetric matrix and 6 of a vector.
constexpr int kTwistSums = 32;

/// The target of a run of edges.
struct TwistFrame {
  double R[9];     ///< row-major
  double p[3];     ///< minus o
  double turn[9];  ///< R R_x', where the Jacobian is that at another rotation R_x: f = -turn a
  bool turned;     ///< turn is not the identity
};

/// Where a run of edges, lanes of one target, adds its sums.
struct TwistTotals {
  const TwistFrame* frame;  ///< of the target
  double* h;                ///< H_ll per lane: added to, as all that follows
  double* b;                ///< b_l = -J_l'r per lane
  double* force;  ///< six arrays of force_lanes: sum over rows of j [f; q], j = dr/dlandmark
  int64_t force_lanes;
  bool sets_force;  ///< force is set, not added to
  double* sums;     ///< kTwistSums numbers: [f; q][f; q]', lower triangle by rows, and r [f; q]
};

/// Values of a run of edges; rows and columns as in kernels.h.
struct TwistRun {
  int32_t rows;
  int32_t lanes;  ///< multiple of kLaneBlock
  const double* r;
  const double* J_l;     ///< by the landmark
  const double* J;       ///< by the target, rows x 6; null: edges on the landmark alone
  double scale;          ///< multiplies J_l and J
  const double* weight;  ///< null: 1; else multiplies r, J_l and J, per lane
};

/// What a target, or a pose that sees points, has of a group after its runs.
struct TwistTarget {
  int32_t used;         ///< after the last lane that it sees
  int32_t lanes;        ///< that rounded up to a multiple of kLaneBlock
  const double* force;  ///< six arrays of `lanes`; of points F (kernels/points.h)
};

/// W of a group has rows for the host, if there is one, and then for each target. What there is of
/// a landmark in arrays of lanes has `dim` of them, or dim (dim + 1) / 2 of a lower triangle by
/// rows: H_ll, and C with (H_ll + damping)^-1 = C'C.
struct TwistGroup {
  int32_t dim;    ///< of a landmark: 1, with a host; 3: points, without
  int32_t used;   ///< lanes that have a landmark
  int32_t lanes;  ///< that rounded up to a multiple of kLaneBlock
  int32_t num_targets;
  const TwistTarget* targets;  ///< by falling number of lanes
  const double* X;             ///< of points: relative to o
};

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_TWISTS_H_
