// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The first state.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "glissade/eval/alignment.h"
#include "glissade/lie/so3.h"
#include "glissade/window/initial_state_prior.h"
#include "glissade/window/initialize_in_motion.h"
#include "glissade/window/initialize_static.h"
#include "window/sliding_window_impl.h"

namespace glissade {

namespace {

/// So long, until now, a body must have stood still to begin there.
constexpr std::int64_t kStandingNs = 1'000'000'000;
/// A body in motion is begun with so many of the last frames: the most there may be, and the least
/// that will do, or fewer where these span the time that acceleration takes to show.
constexpr std::size_t kMostFrames = 20, kEnoughFrames = 10, kFewestFrames = 5;
constexpr double kEnoughSeconds = 2.0;
/// An attempt takes many times as long as a frame, and one that has failed will hardly do better
/// with a single image more: at 20 Hz every second frame.
constexpr double kAttemptSeconds = 0.09;

/// L' L = covariance^-1, scaled to a unit diagonal before it is factored so that units do not
/// matter.
bool SqrtInformation(const SquareMatrix<11>& covariance, SquareMatrix<11>* sqrt) {
  const Vector<11> scale = covariance.diagonal().cwiseSqrt().cwiseInverse();
  if (!scale.allFinite()) return false;
  const Eigen::Matrix<double, 11, 11> scaled = scale.asDiagonal() * covariance * scale.asDiagonal();
  const Eigen::LLT<Eigen::Matrix<double, 11, 11>> llt(scaled);
  if (llt.info() != Eigen::Success) return false;
  // covariance = D^-1 L L' D^-1, so (L^-1 D)' (L^-1 D) is its inverse.
  *sqrt = llt.matrixL().solve(Eigen::Matrix<double, 11, 11>(scale.asDiagonal()));
  return sqrt->allFinite();
}

SquareMatrix<11> Covariance11(const InitialSigmas& sigmas) {
  Vector<11> s;
  s.head<2>().setConstant(sigmas.tilt);
  s.segment<3>(2).setConstant(sigmas.speed);
  s.segment<3>(5).setConstant(sigmas.accel_bias);
  s.segment<3>(8).setConstant(sigmas.gyro_bias);
  return s.cwiseAbs2().asDiagonal();
}

/// The covariance of p, theta, v, ba, bg in that of what EdgeInitialState holds.
SquareMatrix<11> Covariance11(const StaticState& state) {
  const Matrix3 R = state.pose.pose.R();
  const Vector3 up = R.row(2).transpose();
  Matrix<11, 15> J = Matrix<11, 15>::Zero();
  J.block<2, 3>(0, 3) = EdgeInitialState::Perpendicular(up).transpose() * so3::Hat(up);
  J.block<3, 3>(2, 3) = so3::Hat(R.transpose() * state.speed_bias.v());
  J.block<3, 3>(2, 6) = R.transpose();
  J.block<6, 6>(5, 9).setIdentity();
  return J * state.covariance * J.transpose();
}

}  // namespace

Status SlidingWindow::Impl::Start(const WindowState& state, const SquareMatrix<11>& covariance11) {
  initial_scale_sigma = 0.0;
  SquareMatrix<11> sqrt;
  if (HasImu() && !SqrtInformation(covariance11, &sqrt)) {
    return {StatusCode::kNotPositive, "covariance of the first state"};
  }
  if (Status s = AppendFrame(state.stamp_ns, state.T_w_b, state.speed_bias); !s.ok()) return s;
  frames.back().is_keyframe = true;
  if (HasImu()) {
    const WindowFrame& frame = frames.back();
    const auto prior = problem.AddEdge(EdgeInitialState{state.T_w_b, state.speed_bias},
                                       {frame.pose, frame.speed_bias}, {.sqrt_information = sqrt});
    if (!prior.ok()) return prior.status();
  }
  phase = WindowPhase::kRunning;
  Count(WindowEvent::kInitialized);
  return {};
}

Status SlidingWindow::Start(const WindowState& state, const InitialSigmas& sigmas) {
  if (!impl().options_status.ok()) return impl().options_status;
  if (Status s = sigmas.Validate(); !s.ok()) return s;
  if (impl().phase != WindowPhase::kInitializing) {
    return {StatusCode::kInvalidArgument, "the window has a first state already"};
  }
  return impl().Start(state, sigmas);
}

Status SlidingWindow::Impl::Start(const WindowState& state, const InitialSigmas& sigmas) {
  return Start(state, Covariance11(sigmas));
}

/// From the world of a first state to that of the window: by a turn about the vertical and a shift
/// to where the window began anew, if it did.
Pose SlidingWindow::Impl::ResumedWorld(const Pose& first) const {
  return resume_at ? eval::AlignPose(first, *resume_at).T_r_e : Pose();
}

Status SlidingWindow::Impl::TryToStartStanding(std::int64_t stamp_ns) {
  if (Status s = imu.Between(stamp_ns - kStandingNs, stamp_ns, &interval); !s.ok()) {
    init_verdict.reason = InitReason::kTooFewSamples;
    init_verdict.message = s.message();
    return {};
  }
  StaticOptions how;
  how.stillness = options.stillness;
  how.bias_prior = bias_prior;
  how.gravity = options.gravity;
  how.cameras = options.cameras;
  how.frames = SeenSince(stamp_ns - kStandingNs);
  const auto standing = InitializeStatic(interval.samples, *options.imu_noise, how, &init_verdict);
  if (!standing.ok()) return {};
  const Pose T_w_s = ResumedWorld(standing->pose.pose);
  return Start({stamp_ns, T_w_s * standing->pose.pose, standing->speed_bias},
               Covariance11(*standing));
}

Status SlidingWindow::TryToStart(std::int64_t stamp_ns) {
  Impl& w = impl();
  if (!w.HasImu()) {
    return w.Start({stamp_ns, w.resume_at.value_or(Pose()), {}}, SquareMatrix<11>::Identity());
  }
  if (Status s = w.TryToStartStanding(stamp_ns); !s.ok()) return s;
  if (w.phase == WindowPhase::kRunning || w.seen.size() < kFewestFrames) return {};
  if (w.seen.size() < kEnoughFrames &&
      SecondsBetween(w.seen.front().stamp_ns, stamp_ns) < kEnoughSeconds) {
    return {};
  }
  if (w.attempted_ns && *w.attempted_ns < stamp_ns &&
      SecondsBetween(*w.attempted_ns, stamp_ns) < kAttemptSeconds) {
    return {};
  }
  w.attempted_ns = stamp_ns;
  return TryToStartMoving();
}

/// A first state from the last frames, if the body moves: they become the window's frames, and
/// their observations and IMU terms say what is known of them.
Status SlidingWindow::TryToStartMoving() {
  Impl& w = impl();
  InitializationInput input;
  input.cameras = w.options.cameras;
  input.frames = w.SeenSince(std::numeric_limits<std::int64_t>::min());
  input.frames = input.frames.last(std::min(input.frames.size(), kMostFrames));
  input.imu = w.imu.samples();
  input.noise = *w.options.imu_noise;
  input.bias_prior = w.bias_prior;
  input.gravity = w.options.gravity;
  input.stillness = w.options.stillness;
  const auto moving = InitializeInMotion(input, &w.init_verdict);
  if (!moving.ok()) return {};

  const Pose T_w_s = w.ResumedWorld(moving->frames.front().pose.pose);
  std::vector<WindowState> found;
  for (const InitializedFrame& frame : moving->frames) {
    VertexSpeedBias state = frame.speed_bias;
    state.v() = T_w_s.R() * state.v();
    found.push_back({frame.stamp_ns, T_w_s * frame.pose.pose, state});
  }
  const WindowState& first = found.front();
  // Nothing but the bias is known beforehand; frames and IMU say the rest.
  VertexSpeedBias before(first.speed_bias.v(), w.bias_prior.mean.ba, w.bias_prior.mean.bg);
  const InitialSigmas unknown{.tilt = 10.0,
                              .speed = 100.0,
                              .accel_bias = w.bias_prior.accel_sigma,
                              .gyro_bias = w.bias_prior.gyro_sigma};
  if (Status s = w.Start({first.stamp_ns, first.T_w_b, before}, Covariance11(unknown)); !s.ok()) {
    return s;
  }
  if (Status s = w.problem.Set(w.frames.front().speed_bias, first.speed_bias); !s.ok()) return s;
  w.initial_scale_sigma = moving->log_scale_sigma;
  const std::vector<FrameObservations> seen(input.frames.begin(), input.frames.end());
  for (std::size_t k = 0; k < seen.size(); ++k) {
    if (k > 0) {
      const WindowState& frame = found[k];
      const VertexSpeedBias& state = found[k - 1].speed_bias;
      ImuPreintegration preintegration;
      if (Status s = w.Integrate(seen[k - 1].stamp_ns, frame.stamp_ns, {state.ba(), state.bg()},
                                 &preintegration);
          !s.ok()) {
        return s;
      }
      if (Status s =
              w.AppendFrameByImu(frame.stamp_ns, frame.T_w_b, frame.speed_bias, preintegration);
          !s.ok()) {
        return s;
      }
    }
    if (k + 1 == seen.size()) break;  // AddFrame goes on with the newest
    if (Status s = Associate(seen[k].observations); !s.ok()) return s;
    ChooseKeyframe(KeyframeChoice::kByRules);
  }
  return {};
}

}  // namespace glissade
