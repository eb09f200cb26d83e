// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Reprojections between cameras without distortion in TwistTerms: their measurements and cameras.

#include <algorithm>
#include <cmath>

#include "linear/twist_terms.h"

#include "glissade/base/index.h"

namespace glissade {

namespace {

using internal::Index;

/// A camera is looked for among so many of its pose: a rig has a handful.
constexpr int kMaxLookedAt = 16;

}  // namespace

void TwistTerms::PackTwoViews(const LandmarkPlan& plan, const EdgePoolBase& pool,
                              const LandmarkGroup& group, Segment* segment) {
  const LandmarkRun& run = plan.runs[Index(segment->run)];
  const std::int32_t* edges = plan.edge_of_slot.data() + run.begin + segment->first;
  TwoViewObservation observation;
  if (!pool.TwoView(edges[0], &observation)) return;
  const bool has_host = observation.uv_host != nullptr;
  const double *f = observation.f, *c = observation.c;
  const bool ideal = f[0] == 1.0 && f[1] == 1.0 && c[0] == 0.0 && c[1] == 0.0;
  double* const scale = segment->scale;
  segment->in_one = weights_.DiagonalOf(segment->weights, scale) && !segment->weights.other_loss;
  for (int i = 0; i < 2; ++i)
    scale[i] *= f[i];
  // Sums of inverse depths take the second row with the weight of the first, and the difference: of
  // weights that differ by far it would be one of large numbers.
  constexpr double kMostUnequal = 4.0;
  const double ratio = std::abs(scale[1] / scale[0]);
  if (has_host && !(ratio <= kMostUnequal && ratio >= 1.0 / kMostUnequal)) segment->in_one = false;
  // Where values are written down, those of points and of other cameras are their edges' own.
  if (!segment->in_one && (!has_host || !ideal)) return;
  if (has_host) segment->host_camera = FindCamera(group.host.pose, observation.T_b_host);
  segment->target_camera =
      FindCamera(plan.pairs[Index(run.pair)].target.pose, observation.T_b_target);
  segment->uv = static_cast<std::int64_t>(uv_.size());
  uv_.resize(uv_.size() + (has_host ? 4 : 2) * Index(segment->lanes));
  double* uv = uv_.data() + segment->uv;
  for (std::int32_t s = 0; s < segment->lanes; ++s, ++uv) {
    static_cast<void>(pool.TwoView(edges[s], &observation));
    double* to = uv;
    if (has_host) {
      to[0] = observation.uv_host[0];
      to[segment->lanes] = observation.uv_host[1];
      to += 2 * segment->lanes;
    }
    const double* seen = observation.uv_target;
    to[0] = ideal ? seen[0] : (seen[0] - c[0]) / f[0];
    to[segment->lanes] = ideal ? seen[1] : (seen[1] - c[1]) / f[1];
  }
}

// Cameras of one pose are chained, newest first. One that is not found among the newest is there
// twice, which costs its update and nothing else.
std::int32_t TwistTerms::FindCamera(std::int32_t pose, const double* T_b_c) {
  if (newest_camera_.size() <= Index(pose)) newest_camera_.resize(Index(pose) + 1, -1);
  std::int32_t& newest = newest_camera_[Index(pose)];
  int looked_at = 0;
  for (std::int32_t c = newest; c >= 0 && looked_at < kMaxLookedAt;
       c = cameras_[Index(c)].next, ++looked_at) {
    if (std::equal(T_b_c, T_b_c + 7, cameras_[Index(c)].T_b_c.data)) return c;
  }
  Camera camera;
  camera.pose = pose;
  camera.next = newest;
  std::copy_n(T_b_c, 7, camera.T_b_c.data);
  newest = static_cast<std::int32_t>(cameras_.size());
  cameras_.push_back(camera);
  return newest;
}

const kernels::TwistFrame& TwistTerms::FrameOf(const Segment& segment, std::int32_t pose) const {
  return segment.target_camera < 0 ? frames_[Index(pose)]
                                   : cameras_[Index(segment.target_camera)].frame;
}

void TwistTerms::FillStates(const LandmarkPlan& plan, const Graph& graph,
                            const LandmarkGroup& group) {
  if (cameras_.empty()) return;
  const std::int32_t* landmark = plan.landmark_of_lane.data() + group.lane_begin;
  double* const state = state_.data() + group.step_begin;
  if (group.dim == 1) {
    const double* depths = graph.Pool<VertexInverseDepth>()->Data(0);
    for (std::int32_t s = 0; s < group.used; ++s)
      state[s] = depths[landmark[s]];
    return;
  }
  const VertexPool<VertexPointXYZ>& points = *graph.Pool<VertexPointXYZ>();
  for (std::int32_t s = 0; s < group.used; ++s) {
    const double* x = points.Data(landmark[s]);
    for (int i = 0; i < 3; ++i)
      state[i * group.lanes + s] = x[i] - origin_[i];
  }
}

kernels::TwoViewRun TwistTerms::TwoViewsOf(const LandmarkPlan& plan, const LandmarkGroup& group,
                                           const Segment& segment) const {
  const LandmarkRun& run = plan.runs[Index(segment.run)];
  return {segment.lanes,
          uv_.data() + segment.uv,
          state_.data() + group.step_begin + segment.lane,
          segment.masked ? plan.mask_of_slot.data() + run.begin + segment.first : nullptr,
          &cameras_[Index(segment.host_camera)].at,
          &cameras_[Index(segment.target_camera)].at};
}

kernels::PointViewRun TwistTerms::PointViewsOf(const LandmarkPlan& plan, const LandmarkGroup& group,
                                               const Segment& segment) const {
  const LandmarkRun& run = plan.runs[Index(segment.run)];
  return {segment.lanes,
          uv_.data() + segment.uv,
          state_.data() + group.step_begin + segment.lane,
          group.lanes,
          segment.masked ? plan.mask_of_slot.data() + run.begin + segment.first : nullptr,
          &cameras_[Index(segment.target_camera)].at};
}

double TwistTerms::CostInOne(const LandmarkPlan& plan, const LandmarkGroup& group,
                             const Segment& segment) const {
  const kernels::KernelTable& kernel = kernels::Kernels();
  const kernels::TwoViewWeights weights = TwoViewWeightsOf(segment);
  if (segment.host_camera < 0) {
    const kernels::PointViewRun points = PointViewsOf(plan, group, segment);
    return kernel.point_view_cost(&points, &weights);
  }
  const kernels::TwoViewRun lanes = TwoViewsOf(plan, group, segment);
  return kernel.two_view_cost(&lanes, &weights);
}

kernels::TwoViewWeights TwistTerms::TwoViewWeightsOf(const Segment& segment) const {
  const LaneWeights::Run& run = segment.weights;
  return {{segment.scale[0], segment.scale[1]}, run.loss, weights_.WidthsOf(run)};
}

}  // namespace glissade
