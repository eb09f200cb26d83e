// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The first state.
#include <algorithm>
#include <cmath>

#include "glissade/window/initial_state_prior.h"
#include "window/sliding_window_impl.h"

namespace glissade {

Status SlidingWindow::Impl::Start(const WindowState& state, const InitialSigmas& sigmas) {
  if (Status s = sigmas.Validate(); !s.ok()) return s;
  if (Status s = AppendFrame(state.stamp_ns, state.T_w_b, state.speed_bias); !s.ok()) return s;
  frames.back().is_keyframe = true;
  if (HasImu()) {
    Vector<11> inverse;
    inverse.head<2>().setConstant(1.0 / sigmas.tilt);
    inverse.segment<3>(2).setConstant(1.0 / sigmas.speed);
    inverse.segment<3>(5).setConstant(1.0 / sigmas.accel_bias);
    inverse.segment<3>(8).setConstant(1.0 / sigmas.gyro_bias);
    const WindowFrame& frame = frames.back();
    const auto prior = problem.AddEdge(
        EdgeInitialState{state.T_w_b, state.speed_bias}, {frame.pose, frame.speed_bias},
        {.sqrt_information = SquareMatrix<11>(inverse.asDiagonal())});
    if (!prior.ok()) return prior.status();
  }
  phase = WindowPhase::kRunning;
  Count(WindowEvent::kInitialized);
  return {};
}

Status SlidingWindow::Start(const WindowState& state, const InitialSigmas& sigmas) {
  if (!impl_->options_status.ok()) return impl_->options_status;
  if (impl_->phase != WindowPhase::kInitializing) {
    return {StatusCode::kInvalidArgument, "the window has a first state already"};
  }
  return impl_->Start(state, sigmas);
}

Status SlidingWindow::Impl::TryToStart(std::int64_t stamp_ns) {
  if (!HasImu()) return Start({stamp_ns, Pose(), {}}, options.initial);
  if (Status s = imu.Between(stamp_ns - 500'000'000, stamp_ns, &interval); !s.ok()) return {};
  Vector3 gyro = Vector3::Zero(), accel = Vector3::Zero();
  for (const ImuSample& sample : interval.samples) {
    gyro += sample.gyro;
    accel += sample.accel;
  }
  gyro /= static_cast<double>(interval.samples.size());
  accel /= static_cast<double>(interval.samples.size());
  // R_w_b takes the mean specific force to the vertical, with yaw 0.
  const Quaternion q = Quaternion::FromTwoVectors(accel, Vector3::UnitZ());
  return Start(
      {stamp_ns, Pose(q, Vector3::Zero()), VertexSpeedBias(Vector3::Zero(), Vector3::Zero(), gyro)},
      options.initial);
}

Status SlidingWindow::Reset() {
  Impl& w = *impl_;
  if (w.frames.empty()) return {StatusCode::kInvalidArgument, "the window has no state yet"};
  const WindowState state = w.newest;
  w.problem = Problem();
  if (Status s = w.problem.SetFirstEstimates(w.options.first_estimates); !s.ok()) return s;
  w.frames.clear();
  w.preintegrations.clear();
  w.num_landmarks = 0;
  w.tracks.Clear();
  w.summary = nullptr;
  w.Count(WindowEvent::kReset);
  InitialSigmas sigmas = w.options.initial;
  sigmas.tilt = std::max(sigmas.tilt, 0.05);
  sigmas.speed = std::max(sigmas.speed, 0.5);
  return w.Start(state, sigmas);
}

}  // namespace glissade
