// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "linear/reprojection_terms.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "glissade/losses/huber.h"

namespace glissade {

namespace {

std::size_t Index(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

using RowMajor3 = Eigen::Matrix<double, 3, 3, Eigen::RowMajor | Eigen::DontAlign>;

}  // namespace

void ReprojectionTerms::Pack(const Structure& structure, const Graph& graph) {
  if (analysis_ == structure.analysis() && weights_ == graph.weights_version()) return;
  analysis_ = structure.analysis();
  weights_ = graph.weights_version();
  const ReprojectionPlan& plan = structure.reprojections();
  hosts_.clear();
  targets_.clear();
  chunks_.resize(std::max(chunks_.size(), Index(structure.num_chunks())));
  maps_.assign(structure.poses().size(), {});
  projected_maps_.resize(structure.poses().size());
  if (plan.empty()) return;
  const EdgePool<EdgeReprojection>& pool = *graph.Pool<EdgeReprojection>();

  ListExtrinsics(plan, pool);
  const std::size_t lanes = plan.landmark_of_lane.size();
  for (auto* array : {&x_, &y_, &b_, &h_, &scale_, &beta_, &inverse_h_})
    array->assign(lanes, 0.0);
  rho_.assign(lanes, 1.0);  // padding: a point in front of the camera
  point_.assign(3 * lanes, 0.0);
  const std::size_t slots = plan.edge_of_slot.size();
  for (auto* array : {&u_, &v_, &mask_})
    array->assign(slots, 0.0);
  force_.assign(3 * slots, 0.0);

  // What a whole group shares need not be stored per observation.
  bool any_huber = false, same_information = true;
  const double* common = nullptr;
  for (const std::int32_t edge : plan.edge_of_slot) {
    if (edge < 0) continue;
    if (common == nullptr) common = pool.sqrt_information(edge);
    any_huber = any_huber || !pool.loss(edge).trivial();
    same_information =
        same_information && std::equal(common, common + 4, pool.sqrt_information(edge));
  }
  huber_.assign(any_huber ? slots : 0, std::numeric_limits<double>::infinity());
  sqrt_information_.assign(same_information ? 0 : 4 * slots, 0.0);

  for (const ReprojectionGroup& group : plan.groups) {
    Host host{};
    host.lanes = group.lanes;
    host.num_targets = group.pair_end - group.pair_begin;
    host.x = x_.data() + group.lane_begin;
    host.y = y_.data() + group.lane_begin;
    host.rho = rho_.data() + group.lane_begin;
    host.h = h_.data() + group.lane_begin;
    host.b = b_.data() + group.lane_begin;
    host.point = point_.data() + 3 * group.lane_begin;
    std::copy_n(common, 4, host.L);
    hosts_.push_back(host);
    for (std::int32_t p = group.pair_begin; p < group.pair_end; ++p) {
      const ReprojectionPair& pair = plan.pairs[Index(p)];
      Target target{};
      target.lanes = pair.lanes;
      target.u = u_.data() + pair.slots;
      target.v = v_.data() + pair.slots;
      target.mask = mask_.data() + pair.slots;
      if (!same_information) target.sqrt_information = sqrt_information_.data() + 4 * pair.slots;
      if (any_huber) target.huber = huber_.data() + pair.slots;
      target.force = force_.data() + 3 * pair.slots;
      targets_.push_back(target);
      for (std::int32_t lane = 0; lane < pair.lanes; ++lane) {
        const std::size_t slot = Index(pair.slots + lane);
        const std::int32_t edge = plan.edge_of_slot[slot];
        if (edge < 0) continue;
        const EdgeReprojection& value = pool.At(edge);
        x_[Index(group.lane_begin + lane)] = value.uv_host[0];
        y_[Index(group.lane_begin + lane)] = value.uv_host[1];
        u_[slot] = value.uv_target[0];
        v_[slot] = value.uv_target[1];
        mask_[slot] = 1.0;
        for (int k = 0; !same_information && k < 4; ++k) {
          sqrt_information_[Index(4 * pair.slots + k * pair.lanes + lane)] =
              pool.sqrt_information(edge)[k];
        }
        if (const Huber* huber = pool.loss(edge).As<Huber>()) huber_[slot] = huber->width;
      }
    }
  }
  Target* next = targets_.data();
  for (Host& host : hosts_) {
    host.targets = next;
    next += host.num_targets;
  }
}

void ReprojectionTerms::ListExtrinsics(const ReprojectionPlan& plan,
                                       const EdgePool<EdgeReprojection>& pool) {
  extrinsics_.clear();
  extrinsic_of_group_.clear();
  for (const ReprojectionGroup& group : plan.groups) {
    const Pose& T_b_c = pool.At(group.edge).T_b_c;
    std::size_t k = 0;
    while (k < extrinsics_.size() && !std::equal(T_b_c.data, T_b_c.data + 7, extrinsics_[k].data))
      ++k;
    if (k == extrinsics_.size()) extrinsics_.push_back(T_b_c);
    extrinsic_of_group_.push_back(static_cast<std::int32_t>(k));
  }
}

void ReprojectionTerms::UpdateCameras(const VertexPool<VertexPose>& poses) {
  cameras_.resize(extrinsics_.size() * Index(poses.size()));
  Camera* out = cameras_.data();
  for (const Pose& T_b_c : extrinsics_) {
    for (int k = 0; k < poses.size(); ++k, ++out) {
      // Taken from the centre's position first: far from the world's origin the rest would lose
      // its last digits to that distance.
      Pose T_o_b = poses.At(k).pose;
      for (int r = 0; r < 3; ++r)
        T_o_b.data[r] -= origin_[r];
      const Pose T_o_c = T_o_b * T_b_c;
      const Matrix3 R = T_o_c.R();
      for (int r = 0; r < 3; ++r) {
        for (int c = 0; c < 3; ++c)
          out->R_wc[3 * r + c] = R(r, c);
        out->c[r] = T_o_c.data[r];
      }
    }
  }
}

void ReprojectionTerms::UpdateHost(const ReprojectionPlan& plan, const ReprojectionGroup& group,
                                   const Camera* cameras, Host* host) const {
  const Camera& h = cameras[group.host.pose];
  std::copy_n(h.R_wc, 9, host->R_wc);
  std::copy_n(h.c, 3, host->c);
  for (int k = 0; k < host->num_targets; ++k) {
    Target& target = host->targets[k];
    const Camera& t = cameras[plan.pairs[Index(group.pair_begin + k)].target.pose];
    for (int r = 0; r < 3; ++r) {
      target.d[r] = 0.0;
      for (int c = 0; c < 3; ++c) {
        target.R_cw[3 * r + c] = t.R_wc[3 * c + r];
        target.d[r] += t.R_wc[3 * c + r] * (h.c[c] - t.c[c]);
        double sum = 0.0;
        for (int k2 = 0; k2 < 3; ++k2)
          sum += t.R_wc[3 * k2 + r] * h.R_wc[3 * k2 + c];
        target.A[3 * r + c] = sum;
      }
    }
  }
}

void ReprojectionTerms::Update(const Structure& structure, const Graph& graph) {
  const ReprojectionPlan& plan = structure.reprojections();
  if (plan.empty()) return;
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  // Moments are taken about a point among the cameras, so that they do not grow with the distance
  // from the world's origin (ReprojectionPlan::kMaxReach).
  std::copy_n(poses.At(plan.center).pose.data, 3, origin_);
  UpdateCameras(poses);
}

void ReprojectionTerms::UpdateChunk(const Structure& structure, const Graph& graph, int chunk) {
  const ReprojectionPlan& plan = structure.reprojections();
  if (plan.empty()) return;
  const std::size_t poses = Index(graph.Pool<VertexPose>()->size());
  const VertexPool<VertexInverseDepth>& depths = *graph.Pool<VertexInverseDepth>();
  for (int g = plan.chunk_begin[Index(chunk)]; g < plan.chunk_begin[Index(chunk) + 1]; ++g) {
    const ReprojectionGroup& group = plan.groups[Index(g)];
    UpdateHost(plan, group, cameras_.data() + Index(extrinsic_of_group_[Index(g)]) * poses,
               HostOf(g));
    for (std::int32_t k = group.lane_begin; k < group.lane_begin + group.lanes; ++k) {
      const std::int32_t landmark = plan.landmark_of_lane[Index(k)];
      if (landmark >= 0) rho_[Index(k)] = depths.At(landmark).rho;
    }
  }
}

void ReprojectionTerms::UpdateMaps(const Structure& structure, const Graph& graph) {
  if (structure.reprojections().empty()) return;
  const VertexPool<VertexPose>& poses = *graph.Pool<VertexPose>();
  for (std::size_t k = 0; k < maps_.size(); ++k) {
    const PoseBlock& block = structure.poses()[k];
    if (block.pool != poses.id()) continue;
    const Pose& pose = poses.At(block.index).pose;
    const Matrix3 R = pose.R();
    const Matrix3 QR = so3::Hat(Vector3(pose.data[0] - origin_[0], pose.data[1] - origin_[1],
                                        pose.data[2] - origin_[2])) *
                       R;
    double* T = maps_[k].T;
    for (int r = 0; r < 3; ++r) {
      T[8 * r + r] = 1.0;
      for (int c = 0; c < 3; ++c) {
        T[8 * r + 3 + c] = QR(r, c);
        T[8 * (3 + r) + 3 + c] = R(r, c);
      }
    }
  }
}

double ReprojectionTerms::Cost(const Structure& structure, int chunk) {
  const ReprojectionPlan& plan = structure.reprojections();
  if (plan.empty()) return 0.0;
  double cost = 0.0;
  for (int g = plan.chunk_begin[Index(chunk)]; g < plan.chunk_begin[Index(chunk) + 1]; ++g) {
    cost += kernels::Kernels().reprojection_cost(HostOf(g));
  }
  return cost;
}

double ReprojectionTerms::Linearize(const Structure& structure, int chunk, double* h_pp,
                                    double* b_p) {
  const ReprojectionPlan& plan = structure.reprojections();
  if (plan.empty()) return 0.0;
  const kernels::KernelTable& kernel = kernels::Kernels();
  double cost = 0.0;
  // Diagonal blocks and right-hand sides are summed as twists and mapped once per frame.
  std::vector<FrameSum>& frames = chunks_[Index(chunk)].frames;
  frames.assign(structure.poses().size(), {});
  for (int g = plan.chunk_begin[Index(chunk)]; g < plan.chunk_begin[Index(chunk) + 1]; ++g) {
    const ReprojectionGroup& group = plan.groups[Index(g)];
    Host* host = HostOf(g);
    kernel.reprojection_linearize(host);
    cost += host->cost;
    const std::int32_t h = group.host.block;
    FrameSum at_host;
    for (int k = 0; k < host->num_targets; ++k) {
      const Target& target = host->targets[k];
      const ReprojectionPair& pair = plan.pairs[Index(group.pair_begin + k)];
      at_host.Add(target.H, target.g, -1.0);
      const std::int32_t t = pair.target.block;
      if (t < 0) continue;
      frames[Index(t)].Add(target.H, target.g, 1.0);
      if (pair.h_block < 0) continue;
      const std::int32_t row = pair.h_transposed ? t : h, col = pair.h_transposed ? h : t;
      kernel.map_block(-1.0, maps_[Index(row)].T, target.H, 6, maps_[Index(col)].T,
                       h_pp + pair.h_block, 6, 1);
    }
    if (h >= 0) frames[Index(h)].Add(at_host.H, at_host.g, 1.0);
  }
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (!frames[k].used) continue;
    const double* T = maps_[k].T;
    const PoseBlock& pose = structure.poses()[k];
    kernel.map_block(1.0, T, frames[k].H, 6, T, h_pp + pose.h_diagonal, 6, 1);
    // b = -J'r in the tangent: T' of the twist's.
    for (int c = 0; c < 6; ++c) {
      double sum = 0.0;
      for (int i = 0; i < 6; ++i)
        sum += T[8 * i + c] * frames[k].g[i];
      b_p[pose.offset + c] += sum;
    }
  }
  return cost;
}

int ReprojectionTerms::FindFailed(const Graph& graph) const {
  const EdgePool<EdgeReprojection>* pool = graph.Pool<EdgeReprojection>();
  for (int edge = 0; pool != nullptr && edge < pool->size(); ++edge) {
    if (!std::isfinite(pool->Chi2(edge))) return edge;
  }
  return -1;
}

}  // namespace glissade
