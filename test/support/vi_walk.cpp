// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/vi_walk.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "glissade/graph/pools.h"

namespace glissade::test {

namespace {
constexpr double kDt = 0.25;
const Vector3 kGravity(0.0, 0.0, -9.81);

/// Around a circle of 20 m at 1 m/s, up and down, rolling and pitching.
Pose TruePose(double t) {
  const double angle = 0.05 * t;
  const Vector3 p(20.0 * std::cos(angle), 20.0 * std::sin(angle), 0.5 * std::sin(0.7 * t));
  const Quaternion yaw = so3::ExpQuaternion(Vector3(0, 0, angle + 1.5707963267948966));
  const Quaternion tilt =
      so3::ExpQuaternion(Vector3(0.15 * std::sin(0.9 * t), 0.1 * std::cos(1.3 * t), 0.0));
  return {Quaternion(yaw * tilt), p};
}
}  // namespace

ViWalk::ViWalk(std::uint64_t seed, const WalkOptions& options) : options_(options), random_(seed) {
  Matrix3 R_b_c;  // camera z along body x
  R_b_c << 0, 0, 1, -1, 0, 0, 0, -1, 0;
  T_b_c_ = Pose(R_b_c, Vector3(0.05, 0.02, -0.01));
  frames_.reserve(32);
}

void ViWalk::AddFrame() {
  Frame frame;
  if (!spare_.empty()) {
    frame = std::move(spare_.back());
    spare_.pop_back();
  }
  frame.landmarks.clear();
  frame.number = next_++;
  const double t = kDt * frame.number;
  frame.pose_true = TruePose(t);
  frame.v_true = (TruePose(t + 1e-4).p() - TruePose(t - 1e-4).p()) / 2e-4;
  VertexPose start{frame.pose_true};
  double d[6];
  for (int k = 0; k < 6; ++k) {
    d[k] = options_.start_noise * (k < 3 ? 0.02 : 0.005) * random_.Uniform(-1, 1);
  }
  start.Plus(d);
  frame.pose = graph_->AddVertex(start).value();
  const Vector3 v = frame.v_true + 0.02 * options_.start_noise * random_.Vec3(1.0);
  frame.speed_bias =
      graph_->AddVertex(VertexSpeedBias(v, Vector3::Zero(), Vector3::Zero())).value();
  if (!frames_.empty()) AddImu(frames_.back(), frame);
  for (const Frame& host : frames_) {
    if (frame.number - host.number <= options_.track_length) AddObservations(host, frame);
  }
  // Landmarks of this frame are seen from the next ones on.
  const Pose T_w_c = frame.pose_true * T_b_c_;
  for (int k = 0; k < options_.landmarks_per_frame; ++k) {
    Landmark landmark;
    landmark.uv = random_.Vec2(0.6);
    const double depth = random_.Uniform(3.0, 9.0);
    landmark.point = T_w_c * Vector3(depth * landmark.uv[0], depth * landmark.uv[1], depth);
    landmark.depth =
        graph_->AddVertex(VertexInverseDepth{random_.Uniform(0.9, 1.1) / depth}).value();
    frame.landmarks.push_back(landmark);
  }
  frames_.push_back(std::move(frame));
}

void ViWalk::AddImu(const Frame& i, const Frame& j) {
  EdgeImu edge;
  PreintegratedImu& imu = edge.imu;
  const Matrix3 R_i_w = i.pose_true.R().transpose();
  imu.dt = kDt;
  imu.dp =
      R_i_w * (j.pose_true.p() - i.pose_true.p() - kDt * i.v_true - 0.5 * kDt * kDt * kGravity) +
      0.001 * random_.Vec3(1.0);
  imu.dv = R_i_w * (j.v_true - i.v_true - kDt * kGravity) + 0.003 * random_.Vec3(1.0);
  imu.dq = Quaternion(i.pose_true.q().conjugate() * j.pose_true.q()) *
           so3::ExpQuaternion(0.0005 * random_.Vec3(1.0));
  imu.dp_dba = -0.5 * kDt * kDt * Matrix3::Identity();
  imu.dv_dba = -kDt * Matrix3::Identity();
  imu.dq_dbg = -kDt * Matrix3::Identity();
  imu.dv_dbg = 0.5 * kDt * kDt * so3::Hat(Vector3(0.1, -0.2, 9.81));
  imu.dp_dbg = kDt / 3.0 * imu.dv_dbg;
  SquareMatrix<15> root = SquareMatrix<15>::Zero();
  constexpr double kSigma[] = {1e-3, 5e-4, 3e-3, 1e-3, 1e-4};
  for (int k = 0; k < 15; ++k)
    root(k, k) = 1.0 / kSigma[k / 3];
  root(0, 6) = 50.0;
  const auto added = graph_->AddEdge(edge, {i.pose, i.speed_bias, j.pose, j.speed_bias},
                                     {.sqrt_information = root});
  EXPECT_TRUE(added.ok()) << added.status().message();
}

void ViWalk::AddObservations(const Frame& host, const Frame& target) {
  EdgeOptions<EdgeReprojection> options;
  constexpr double kFocal = 460.0;
  options.sqrt_information = Matrix2(kFocal * Matrix2::Identity());
  const Pose T_c_w = (target.pose_true * T_b_c_).Inverse();
  for (const Landmark& landmark : host.landmarks) {
    const Vector3 x = T_c_w * landmark.point;
    if (x[2] < 0.3) continue;
    EdgeReprojection edge;
    edge.T_b_c = T_b_c_;
    edge.uv_host = landmark.uv;
    edge.uv_target =
        Vector2(x[0] / x[2], x[1] / x[2]) + options_.pixel_noise / kFocal * random_.Vec2(1.7);
    const auto added = graph_->AddEdge(edge, {host.pose, target.pose, landmark.depth}, options);
    EXPECT_TRUE(added.ok()) << added.status().message();
  }
}

std::vector<AnyVertex> ViWalk::TakeOldest() {
  std::vector<AnyVertex> vertices;
  TakeOldest(&vertices);
  return vertices;
}

void ViWalk::TakeOldest(std::vector<AnyVertex>* vertices) {
  vertices->clear();
  const Frame& oldest = frames_.front();
  vertices->push_back(oldest.pose);
  vertices->push_back(oldest.speed_bias);
  for (const Landmark& landmark : oldest.landmarks)
    vertices->push_back(landmark.depth);
  spare_.push_back(std::move(frames_.front()));
  frames_.erase(frames_.begin());
}

void ViWalk::Shake(double position, double degrees) {
  for (const Frame& frame : frames_) {
    VertexPose pose = graph_->Get(frame.pose);
    double d[6];
    for (int k = 0; k < 6; ++k)
      d[k] = (k < 3 ? position : degrees * 0.017453292519943295) * random_.Uniform(-1, 1);
    pose.Plus(d);
    EXPECT_TRUE(graph_->Set(frame.pose, pose).ok());
    VertexSpeedBias sb = graph_->Get(frame.speed_bias);
    sb.v() += position * random_.Vec3(1.0);
    EXPECT_TRUE(graph_->Set(frame.speed_bias, sb).ok());
  }
}

GaugeInformation MeasureGauge(const Graph& graph, GaugeDirection direction) {
  double information = 0.0, scale = 0.0;
  std::vector<double> residual, jacobian, product;
  std::vector<const double*> states, points;
  std::vector<double*> blocks;
  for (const auto& pool : graph.edge_pools()) {
    for (int edge = 0; edge < pool->size(); ++edge) {
      if (!pool->Alive(edge)) continue;
      const int rows = pool->residual_dim(edge), arity = pool->arity(edge);
      residual.resize(static_cast<std::size_t>(rows));
      states.clear();
      points.clear();
      blocks.clear();
      std::size_t dims = 0;
      for (int i = 0; i < arity; ++i)
        dims += static_cast<std::size_t>(pool->vertex_pool(edge, i)->ops().tangent_dim);
      jacobian.resize(dims * residual.size());
      double* block = jacobian.data();
      std::vector<std::array<double, 9>> u;
      const DynamicEdge* dynamic = pool->type() == &kTypeInfo<DynamicEdge>
                                       ? &static_cast<const DynamicEdgePool&>(*pool).At(edge)
                                       : nullptr;
      const bool constant = dynamic != nullptr && graph.first_estimates() != FirstEstimates::kOff;
      const double* x0 = dynamic != nullptr ? dynamic->LinearizationPoint() : nullptr;
      for (int i = 0; i < arity; ++i) {
        const VertexPoolBase& vertices = *pool->vertex_pool(edge, i);
        const int index = vertices.slots().IndexOf(pool->vertex_slot(edge, i));
        const double* point = vertices.first_estimates().At(index);
        // A prior that keeps its Jacobian has that of its x0.
        states.push_back(constant && x0 != nullptr ? x0 : vertices.Data(index));
        if (x0 != nullptr) x0 += vertices.ops().ambient_dim;
        points.push_back(graph.first_estimates() == FirstEstimates::kFull ? point : nullptr);
        u.push_back(GaugeVector(vertices.ops(), point != nullptr ? point : vertices.Data(index),
                                direction));
        blocks.push_back(block);
        block += vertices.ops().tangent_dim * rows;
      }
      EXPECT_TRUE(
          pool->EvaluateAt(edge, states.data(), points.data(), residual.data(), blocks.data()));
      pool->Whiten(edge, residual.data(), blocks.data());
      for (int row = 0; row < rows; ++row) {
        double sum = 0.0;
        for (int i = 0; i < arity; ++i) {
          const int dim = pool->vertex_pool(edge, i)->ops().tangent_dim;
          for (int c = 0; c < std::min(dim, 9); ++c) {
            const double term = blocks[static_cast<std::size_t>(i)][row * dim + c] *
                                u[static_cast<std::size_t>(i)][static_cast<std::size_t>(c)];
            sum += term;
            scale += term * term;
          }
        }
        information += sum * sum;
      }
    }
  }
  return {information, scale > 0.0 ? information / scale : 0.0};
}

}  // namespace glissade::test
