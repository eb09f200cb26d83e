// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The first state.
#include <algorithm>
#include <cmath>

#include "glissade/window/initial_state_prior.h"
#include "window/sliding_window_impl.h"

namespace glissade {

Status SlidingWindow::Impl::Start(std::int64_t stamp_ns, const Pose& T_w_b,
                                  const VertexSpeedBias& speed_bias, const Vector<11>& sigmas) {
  if (Status s = AppendFrame(stamp_ns, T_w_b, speed_bias); !s.ok()) return s;
  if (HasImu()) {
    const WindowFrame& frame = frames.back();
    const auto prior =
        problem.AddEdge(EdgeInitialState{T_w_b, speed_bias}, {frame.pose, frame.speed_bias},
                        {.sqrt_information = SquareMatrix<11>(sigmas.cwiseInverse().asDiagonal())});
    if (!prior.ok()) return prior.status();
  }
  phase = WindowPhase::kRunning;
  Count(WindowEvent::kInitialized);
  return {};
}

Status SlidingWindow::Impl::TryToStart(std::int64_t stamp_ns) {
  if (!HasImu()) return Start(stamp_ns, Pose(), {}, Vector<11>::Ones());
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
  Vector<11> sigmas;
  sigmas.head<2>().setConstant(options.prior_sigma_tilt);
  sigmas.segment<3>(2).setConstant(options.prior_sigma_speed);
  sigmas.segment<3>(5).setConstant(options.prior_sigma_accel_bias);
  sigmas.segment<3>(8).setConstant(options.prior_sigma_gyro_bias);
  return Start(stamp_ns, Pose(q, Vector3::Zero()),
               VertexSpeedBias(Vector3::Zero(), Vector3::Zero(), gyro), sigmas);
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
  Vector<11> sigmas;
  sigmas.head<2>().setConstant(0.05);
  sigmas.segment<3>(2).setConstant(0.5);
  sigmas.segment<3>(5).setConstant(w.options.prior_sigma_accel_bias);
  sigmas.segment<3>(8).setConstant(w.options.prior_sigma_gyro_bias);
  return w.Start(state.stamp_ns, state.T_w_b, state.speed_bias, sigmas);
}

}  // namespace glissade
