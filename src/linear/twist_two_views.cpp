// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Reprojections between ideal cameras in TwistTerms: their measurements and cameras.

#include <algorithm>

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
  using Weights = LaneWeights::Run;
  segment->in_one = (segment->weights.whitening == Weights::Whitening::kIdentity ||
                     segment->weights.whitening == Weights::Whitening::kScaled) &&
                    !segment->weights.other_loss;
  const bool has_host = observation.uv_host != nullptr;
  // Where values are written down, those of points are their edges' own.
  if (!has_host && !segment->in_one) return;
  if (has_host) segment->host_camera = FindCamera(group.host.pose, observation.T_b_host);
  segment->target_camera =
      FindCamera(plan.pairs[Index(run.pair)].target.pose, observation.T_b_target);
  segment->uv = static_cast<std::int64_t>(uv_.size());
  uv_.resize(uv_.size() + (has_host ? 4 : 2) * Index(segment->lanes));
  double* uv = uv_.data() + segment->uv;
  for (std::int32_t s = 0; s < segment->lanes; ++s, ++uv) {
    static_cast<void>(pool.TwoView(edges[s], &observation));
    double* to = uv;
    for (const double* from : {observation.uv_host, observation.uv_target}) {
      if (from == nullptr) continue;
      to[0] = from[0];
      to[segment->lanes] = from[1];
      to += 2 * segment->lanes;
    }
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
  return {weights_.ScaleOf(run), run.loss, weights_.WidthsOf(run)};
}

}  // namespace glissade
