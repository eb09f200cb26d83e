// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Defines the table of one instruction set: included once by each src/kernels/<isa>/table.cpp.
// The table is the only symbol such an object exports.

#include "kernels/impl/cholesky.h"
#include "kernels/impl/couplings.h"
#include "kernels/impl/householder.h"
#include "kernels/impl/landmark.h"
#include "kernels/impl/lanes.h"
#include "kernels/impl/left_multiply.h"
#include "kernels/impl/losses.h"
#include "kernels/impl/packed_update.h"
#include "kernels/impl/partial.h"
#include "kernels/impl/point_elimination.h"
#include "kernels/impl/point_views.h"
#include "kernels/impl/points.h"
#include "kernels/impl/rank_update.h"
#include "kernels/impl/schur.h"
#include "kernels/impl/small.h"
#include "kernels/impl/triangular.h"
#include "kernels/impl/triangular_many.h"
#include "kernels/impl/twist_blocks.h"
#include "kernels/impl/twist_reduce.h"
#include "kernels/impl/twists.h"
#include "kernels/impl/two_view.h"
#include "kernels/impl/two_view_sums.h"
#include "kernels/impl/vector.h"
#include "kernels/kernels.h"

#define GLISSADE_CONCAT_(a, b) a##b
#define GLISSADE_CONCAT(a, b) GLISSADE_CONCAT_(a, b)
#define GLISSADE_STRING_(a) #a
#define GLISSADE_STRING(a) GLISSADE_STRING_(a)

namespace glissade::kernels {

#define GLISSADE_KERNEL_TABLE GLISSADE_CONCAT(glissade_kernels_, GLISSADE_KERNEL_ISA)

extern const KernelTable GLISSADE_KERNEL_TABLE;

const KernelTable GLISSADE_KERNEL_TABLE = {
    .isa = GLISSADE_KERNEL_ISA_ENUM,
    .name = GLISSADE_STRING(GLISSADE_KERNEL_ISA),
    .width = kW,
    .cholesky = Cholesky,
    .cholesky_solve = CholeskySolve,
    .forward_solve = ForwardSolve,
    .cholesky_partial = CholeskyPartial,
    .cholesky_panel = CholeskyPanel,
    .forward_solve_partial = ForwardSolvePartial,
    .backward_solve_partial = BackwardSolvePartial,
    .forward_solve_many = ForwardSolveMany,
    .symv_lower = SymvLower,
    .symv_lower_columns = SymvLowerColumns,
    .dot = Dot,
    .axpy = Axpy,
    .syrk_lower_sub = SyrkLowerSub,
    .pack_rows = PackRows,
    .syrk_packed_sub = SyrkPackedSub,
    .syrk_lower_add = SyrkLowerAdd,
    .syrk_lower_set_negative = SyrkLowerSetNegative,
    .left_multiply = LeftMultiply,
    .householder_column = HouseholderColumn,
    .schur_panel = SchurPanelOf,
    .schur_blocks = SchurBlocks,
    .schur_multiply = SchurMultiply,
    .landmark_step = LandmarkStep,
    .lanes_finite = LanesFinite,
    .whiten_lanes = WhitenLanes,
    .lane_squares = LaneSquares,
    .correct_lanes = CorrectLanes,
    .loss_lanes = LossLanes,
    .scale_lanes = ScaleLanes,
    .lane_products = LaneProducts,
    .lane_couplings = LaneCouplings,
    .lane_landmarks = LaneLandmarks,
    .two_view_lanes = TwoViewLanes,
    .two_view_cost = TwoViewCost,
    .two_view_sums = TwoViewSums,
    .twist_sums = TwistSums,
    .point_sums = PointSums,
    .point_view_sums = PointViewSums,
    .point_view_cost = PointViewCost,
    .point_frame_sums = PointFrameSums,
    .twist_panel = TwistPanel,
    .twist_reduce = TwistReduce,
    .twist_transpose_product = TwistTransposeProduct,
    .twist_product = TwistProduct,
    .landmark_pivots = LandmarkPivots,
    .landmark_steps = LandmarkSteps,
    .add_twist_blocks = AddTwistBlocks,
    .map_block = MapBlock,
    .inverse_factor = InverseFactor,
};

}  // namespace glissade::kernels
