// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// How a frame gets its first state, and what ties it to the frame before.
#include <algorithm>

#include "glissade/imu/imu_factor.h"
#include "glissade/imu/reintegration.h"
#include "glissade/lie/so3.h"
#include "window/sliding_window_impl.h"

namespace glissade {

namespace {

ImuBias BiasOf(const VertexSpeedBias& state) {
  return {state.ba(), state.bg()};
}

/// As the body moved from a to b, it goes on for `times` that time.
Pose ConstantVelocity(const Pose& a, const Pose& b, double times) {
  const Vector3 dp = times * (b.p() - a.p());
  const Vector3 dtheta = times * so3::Log(Quaternion(a.q().conjugate() * b.q()));
  return Pose(Quaternion(b.q() * so3::ExpQuaternion(dtheta)), b.p() + dp);
}

}  // namespace

Status SlidingWindow::Impl::AppendFrame(std::int64_t stamp_ns, const Pose& T_w_b,
                                        const VertexSpeedBias& speed_bias) {
  WindowFrame frame;
  frame.id = next_frame_id;
  frame.stamp_ns = stamp_ns;
  frame.T_w_b = T_w_b;
  const auto pose = problem.AddVertex(VertexPose{T_w_b});
  if (!pose.ok()) {
    static_cast<void>(problem.AcknowledgeRefusal());
    return pose.status();
  }
  frame.pose = *pose;
  if (HasImu()) {
    const auto state = problem.AddVertex(speed_bias);
    if (!state.ok()) {
      static_cast<void>(problem.AcknowledgeRefusal());
      static_cast<void>(problem.RemoveVertex(frame.pose));
      return state.status();
    }
    frame.speed_bias = *state;
  }
  frames.push_back(frame);
  preintegrations.emplace_back();
  ++next_frame_id;
  last_stamp_ns = stamp_ns;
  newest = {stamp_ns, T_w_b, speed_bias};
  return {};
}

void SlidingWindow::Impl::ForgetSamples() {
  if (!HasImu()) return;
  // Terms may be integrated again, standing still is judged by the last second, and a first state
  // looked for in what the last frames saw.
  std::int64_t needed =
      last_stamp_ns - (phase == WindowPhase::kInitializing ? 5'500'000'000 : 1'500'000'000);
  for (const WindowFrame& frame : frames) {
    if (!frame.HasSpeedBias()) continue;
    needed = std::min(needed, frame.stamp_ns);
    break;
  }
  imu.DropBefore(needed);
}

Status SlidingWindow::Impl::Integrate(std::int64_t begin_ns, std::int64_t end_ns,
                                      const ImuBias& bias, ImuPreintegration* preintegration) {
  if (Status s = imu.Between(begin_ns, end_ns, &interval); !s.ok()) return s;
  auto integral = Preintegrate(interval.samples, bias, *options.imu_noise);
  if (!integral.ok()) return integral.status();
  *preintegration = *integral;
  return {};
}

Status SlidingWindow::Impl::AddImuTerm(const ImuPreintegration& preintegration, WindowFrame* from,
                                       WindowFrame* to) {
  auto factor = MakeImuFactor(preintegration);
  if (!factor.ok()) return factor.status();
  factor->edge.gravity = Gravity();
  const auto edge = problem.AddEdge(
      factor->edge, {from->pose, from->speed_bias, to->pose, to->speed_bias}, factor->options);
  if (!edge.ok()) {
    static_cast<void>(problem.AcknowledgeRefusal());
    return edge.status();
  }
  to->imu = *edge;
  return {};
}

Status SlidingWindow::Impl::AppendFrameByImu(std::int64_t stamp_ns, const Pose& T_w_b,
                                             const VertexSpeedBias& speed_bias,
                                             const ImuPreintegration& preintegration) {
  const WindowState before = newest;
  if (Status s = AppendFrame(stamp_ns, T_w_b, speed_bias); !s.ok()) return s;
  const std::size_t n = frames.size();
  if (Status s = AddImuTerm(preintegration, &frames[n - 2], &frames[n - 1]); !s.ok()) {
    static_cast<void>(problem.RemoveVertex(frames.back().pose));
    static_cast<void>(problem.RemoveVertex(frames.back().speed_bias));
    frames.pop_back();
    preintegrations.pop_back();
    --next_frame_id;
    last_stamp_ns = before.stamp_ns;
    newest = before;
    return s;
  }
  preintegrations.back() = preintegration;
  if (preintegration.gaps.count > 0) Count(WindowEvent::kImuGap);
  return {};
}

Status SlidingWindow::Propagate(std::int64_t stamp_ns) {
  Impl& w = impl();
  if (w.frames.empty()) return {StatusCode::kInvalidArgument, "the window has no state yet"};
  if (Status s = w.CheckFrameStamp(stamp_ns); !s.ok()) return s;
  const WindowFrame last = w.frames.back();
  if (!w.HasImu()) {
    Pose predicted = last.T_w_b;
    if (w.frames.size() >= 2) {
      const WindowFrame& before = w.frames[w.frames.size() - 2];
      predicted = ConstantVelocity(
          before.T_w_b, last.T_w_b,
          SecondsBetween(last.stamp_ns, stamp_ns) / SecondsBetween(before.stamp_ns, last.stamp_ns));
    }
    return w.AppendFrame(stamp_ns, predicted, {});
  }

  const VertexSpeedBias state = w.problem.Get(last.speed_bias);
  ImuPreintegration preintegration;
  if (Status s = w.Integrate(last.stamp_ns, stamp_ns, BiasOf(state), &preintegration); !s.ok()) {
    return s;
  }
  EdgeImu edge;
  edge.imu = preintegration.imu;
  edge.gravity = w.Gravity();
  const ImuPrediction predicted = Predict(edge, VertexPose{last.T_w_b}, state);
  return w.AppendFrameByImu(stamp_ns, predicted.pose.pose, predicted.speed_bias, preintegration);
}

Status SlidingWindow::ReplaceImuTerms() {
  Impl& w = impl();
  for (std::size_t k = 1; k < w.frames.size(); ++k) {
    WindowFrame& from = w.frames[k - 1];
    WindowFrame& to = w.frames[k];
    if (!to.HasSpeedBias() || !from.HasSpeedBias() || to.imu.slot == kNullSlot) continue;
    const ImuBias bias = BiasOf(w.problem.Get(from.speed_bias));
    if (!NeedsReintegration(w.preintegrations[k], bias)) continue;
    ImuPreintegration renewed;
    if (Status s = w.Integrate(from.stamp_ns, to.stamp_ns, bias, &renewed); !s.ok()) return s;
    const EdgeHandle<EdgeImu> old = to.imu;
    if (Status s = w.AddImuTerm(renewed, &from, &to); !s.ok()) return s;
    if (Status s = w.problem.RemoveEdge(old); !s.ok()) return s;
    w.preintegrations[k] = renewed;
    w.Count(WindowEvent::kImuTermReplaced);
  }
  return {};
}

}  // namespace glissade
