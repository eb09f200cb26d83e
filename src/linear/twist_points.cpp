// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Groups of points in TwistTerms: from their edges to H_ll, F and the sums of the poses.

#include <algorithm>

#include "glissade/base/index.h"
#include "linear/twist_terms.h"

namespace glissade {

namespace {
using internal::Index;
}  // namespace

void TwistTerms::FillPoints(const LandmarkPlan& plan, const Graph& graph,
                            const LandmarkGroup& group) {
  const VertexPool<VertexPointXYZ>& points = *graph.Pool<VertexPointXYZ>();
  const LinearizationTable& table = points.first_estimates();
  const bool full = graph.first_estimates() == FirstEstimates::kFull && !table.empty();
  double* const point = point_.data() + group.step_begin;
  for (std::int32_t s = 0; s < group.used; ++s) {
    const std::int32_t landmark = plan.landmark_of_lane[Index(group.lane_begin + s)];
    const double* at = full ? table.At(landmark) : nullptr;
    const double* x = at != nullptr ? at : points.Data(landmark);
    for (int i = 0; i < 3; ++i)
      point[i * group.lanes + s] = x[i] - linearized_at_[i];
  }
}

kernels::PointTotals TwistTerms::PointTotalsOf(const LandmarkPlan& plan, const LandmarkGroup& group,
                                               const Segment& segment, Chunk* chunk) {
  const LandmarkRun& run = plan.runs[Index(segment.run)];
  kernels::PointTotals totals{};
  if (run.pair < 0) {
    // What the landmark has of itself goes to H_ll at once.
    const std::size_t index = Index(&group - plan.groups.data());
    totals.F = h_.data() + h_begin_[index] + segment.lane;
    totals.g = b_.data() + group.step_begin + segment.lane;
    totals.stride = group.lanes;
    return totals;
  }
  const LandmarkPair& pair = plan.pairs[Index(run.pair)];
  const std::int64_t before = pair.begin - plan.pairs[Index(group.pair_begin)].begin;
  totals.F = force_.data() + 6 * std::int64_t{pair.begin} + segment.lane;
  totals.g = chunk->pull.data() + 3 * before + segment.lane;
  totals.stride = pair.lanes;
  totals.sets = segment.sets_force;
  // An edge's own values are in the world's axes, those of an ideal camera in the camera's.
  const kernels::TwistFrame& frame =
      segment.in_one ? FrameOf(segment, pair.target.pose) : frames_[Index(pair.target.pose)];
  totals.turn = frame.turned ? frame.turn : nullptr;
  return totals;
}

int TwistTerms::AddPointValues(const LandmarkPlan& plan, const Graph& graph,
                               const LandmarkGroup& group, const Segment& segment,
                               const kernels::PointTotals& totals, Chunk* chunk,
                               double* cost) const {
  const kernels::KernelTable& kernel = kernels::Kernels();
  if (segment.in_one) {
    const kernels::PointViewRun points = PointViewsOf(plan, group, segment);
    const kernels::TwoViewWeights weights = TwoViewWeightsOf(segment);
    double added = 0.0;
    if (kernel.point_view_sums(&points, &weights, &totals, &added) != 0) {
      *cost += added;
      return -1;
    }
    // Once more with the values written down, to find whose it is.
  }
  const Values values = Place(segment, group.dim, 0, chunk);
  LaneWeights::Factors factors;
  const int failed = Evaluate(plan, graph, group, segment, values, chunk, cost, &factors);
  if (failed >= 0) return failed;
  const kernels::TwistRun run{segment.weights.rows, segment.lanes, values.r, values.J_l, nullptr,
                              factors.scale,        factors.weight};
  if (!segment.in_one && kernel.point_sums(&run, &totals) != 0) return -1;
  return FindNotFiniteLane(segment.lanes, values.count, values.r);
}

bool TwistTerms::LinearizePoints(const LandmarkPlan& plan, const Graph& graph, int index,
                                 NormalEquationsSink* sink, Chunk* chunk, std::int32_t* pool) {
  const LandmarkGroup& group = plan.groups[Index(index)];
  FillStates(plan, graph, group);
  FillPoints(plan, graph, group);
  double* const h = h_.data() + h_begin_[Index(index)];
  double* const b = b_.data() + group.step_begin;
  std::fill_n(h, 6 * group.lanes, 0.0);
  std::fill_n(b, 3 * group.lanes, 0.0);
  double* pull = chunk->pull.data();
  for (std::int32_t p = group.pair_begin; p < group.pair_end; ++p) {
    const LandmarkPair& pair = plan.pairs[Index(p)];
    if (!force_is_set_[Index(p)]) {
      std::fill_n(force_.begin() + 6 * std::int64_t{pair.begin}, 6 * pair.lanes, 0.0);
      std::fill_n(pull, 3 * pair.lanes, 0.0);
    }
    pull += 3 * pair.lanes;
  }
  for (std::int32_t k = segment_begin_[Index(index)]; k < segment_begin_[Index(index) + 1]; ++k) {
    const Segment& segment = segments_[Index(k)];
    const kernels::PointTotals totals = PointTotalsOf(plan, group, segment, chunk);
    const int failed = AddPointValues(plan, graph, group, segment, totals, chunk, &sink->cost);
    if (failed >= 0) return Fail(plan, segment, failed, sink, pool);
  }
  pull = chunk->pull.data();
  for (std::int32_t p = group.pair_begin; p < group.pair_end; ++p) {
    const LandmarkPair& pair = plan.pairs[Index(p)];
    TwistSum* sum = &chunk->pairs[Index(p - group.pair_begin)];
    *sum = {};
    const kernels::PointFrame frame{pair.lanes,  force_.data() + 6 * std::int64_t{pair.begin},
                                    pull,        point_.data() + group.step_begin,
                                    h,           b,
                                    group.lanes, sum->x};
    // What is not finite here is not in the values: it is in the cost, or the sums.
    static_cast<void>(kernels::Kernels().point_frame_sums(&frame));
    pull += 3 * pair.lanes;
    if (pair.target.block >= 0) chunk->frames[Index(pair.target.block)].Add(*sum, 1.0);
  }
  return true;
}

}  // namespace glissade
