// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/window/initialize_in_motion.h"

#include <algorithm>
#include <cmath>

#include "glissade/base/validate.h"
#include "window/init_alignment.h"
#include "window/init_refinement.h"
#include "window/init_scene.h"
#include "window/init_structure.h"
#include "window/quantiles.h"
#include "window/verdicts.h"

namespace glissade {

namespace {

using internal::Refusal;

constexpr std::size_t kMinFrames = 4;
/// Of the scale of the closed form, over the scale: what is worse is not worth refining.
constexpr double kMaxScaleSigma = 1.0;

/// The samples between the first and the last frame.
std::span<const ImuSample> SamplesOfWindow(const InitializationInput& input) {
  const auto before = [](const ImuSample& s, std::int64_t stamp) { return s.stamp_ns < stamp; };
  const auto begin =
      std::lower_bound(input.imu.begin(), input.imu.end(), input.frames.front().stamp_ns, before);
  const auto end = std::lower_bound(begin, input.imu.end(), input.frames.back().stamp_ns, before);
  return input.imu.subspan(static_cast<std::size_t>(begin - input.imu.begin()),
                           static_cast<std::size_t>(end - begin));
}

InitVerdict CheckStanding(const InitializationInput& input) {
  const StillnessTest imu = TestStillness(SamplesOfWindow(input), input.noise, input.stillness);
  if (!imu.verdict.ok()) return {};
  if (!TestImageStillness(input.cameras, input.frames, input.stillness).verdict.ok()) return {};
  return Refusal(InitReason::kStandingStill, std::max(imu.gyro_chi2, imu.accel_chi2), imu.max_chi2,
                 "chi2 of standing still", "");
}

/// Vision and its alignment with the IMU; *vision is the scene as vision alone has it.
InitVerdict Align(const InitializationInput& input, internal::InertialTerms* terms,
                  internal::Scene* scene, internal::Scene* vision, internal::WindowStates* states) {
  InitVerdict verdict =
      scene->stereo ? internal::LocateWithStereo(terms->terms(), scene)
                    : internal::LocateWithOneCamera(terms->terms(), input.bias_prior.gyro_sigma,
                                                    input.stillness.false_alarm, scene);
  if (!verdict.ok()) return verdict;
  // A hundred points, all of which have a part in a pose's six numbers.
  const double sigma_rotation = 0.3 * scene->cameras[0].sigma.maxCoeff();
  const double sigma_centre = sigma_rotation * internal::MedianDepth(*scene);
  std::vector<Pose> T_v_b;
  for (const Pose& T_v_r : scene->poses)
    T_v_b.push_back(T_v_r * scene->T_b_r.Inverse());
  const Vector3 bg =
      internal::AlignGyroBias(terms->terms(), T_v_b, input.bias_prior, sigma_rotation);
  if (Status s = terms->Integrate({.ba = input.bias_prior.mean.ba, .bg = bg}); !s.ok()) {
    return {InitReason::kNotConverged, 0.0, 0.0, s.message()};
  }
  const internal::Alignment alignment =
      internal::AlignLinear(terms->terms(), scene->poses, scene->T_b_r, scene->stereo, sigma_centre,
                            input.bias_prior, input.gravity);
  const double sigma = alignment.relative_scale_sigma;
  if (!alignment.ok) {
    return Refusal(InitReason::kNoAcceleration, sigma, kMaxScaleSigma,
                   "the closed form has no solution; its relative sigma of the scale", "");
  }
  if (!scene->stereo && !(alignment.scale > 0.0 && sigma < kMaxScaleSigma)) {
    return Refusal(InitReason::kNoAcceleration, sigma, kMaxScaleSigma,
                   alignment.scale > 0.0 ? "relative sigma of the scale of the closed form"
                                         : "the scale comes out negative; its relative sigma",
                   "");
  }
  *vision = *scene;
  *states = internal::TakeToWorld(alignment, bg, scene);
  return {};
}

/// What the refined state is not known well enough for.
InitVerdict Judge(const MotionState& state, const MotionLimits& limits) {
  const auto check = [](double figure, double limit, const char* what, const char* unit) {
    return figure <= limit ? InitVerdict()
                           : Refusal(InitReason::kNoAcceleration, figure, limit, what, unit);
  };
  InitVerdict v;
  // The baseline has the scale: with stereo it says nothing but how far the body came.
  if (!state.stereo) {
    v = check(state.log_scale_sigma, limits.log_scale_sigma, "sigma of log scale", "");
  }
  if (v.ok()) v = check(state.gravity_sigma, limits.gravity_sigma, "sigma of gravity", "rad");
  if (v.ok()) v = check(state.velocity_sigma, limits.velocity_sigma, "sigma of velocity", "m/s");
  if (v.ok() && !(state.chi2_per_dof <= limits.chi2_per_dof)) {
    return Refusal(InitReason::kNotConverged, state.chi2_per_dof, limits.chi2_per_dof,
                   "chi2 per degree of freedom", "");
  }
  if (v.ok() && !(state.imu_chi2_per_dof <= limits.imu_chi2_per_dof)) {
    return Refusal(InitReason::kNotConverged, state.imu_chi2_per_dof, limits.imu_chi2_per_dof,
                   "what the IMU adds to chi2, per degree of freedom,", "");
  }
  return v;
}

/// An IMU that does worse than its noise densities is taken for one with as much more noise.
void Widen(double false_alarm, MotionState* state) {
  const double factor = state->imu_chi2_per_dof;
  if (!(factor > 1.0 &&
        factor * state->imu_dof > internal::Chi2Quantile(state->imu_dof, false_alarm))) {
    return;
  }
  state->covariance *= factor;
  for (double* sigma : {&state->gravity_sigma, &state->velocity_sigma, &state->log_scale_sigma})
    *sigma *= std::sqrt(factor);
}

InitVerdict Initialize(const InitializationInput& input, MotionState* state) {
  if (Status s = input.Validate(); !s.ok()) return internal::InvalidInput(s);
  if (input.frames.size() < kMinFrames) {
    return Refusal(InitReason::kTooFewFrames, static_cast<double>(input.frames.size()),
                   double{kMinFrames}, "number of frames", "");
  }
  internal::InertialTerms terms;
  if (InitVerdict v = terms.Cut(input); !v.ok()) return v;
  if (Status s = terms.Integrate(input.bias_prior.mean); !s.ok()) {
    return {InitReason::kNotFinite, 0.0, 0.0, s.message()};
  }
  if (InitVerdict v = CheckStanding(input); !v.ok()) return v;
  internal::Scene scene = internal::CollectScene(input);
  const auto tracks = static_cast<double>(scene.tracks.size());
  if (tracks < internal::kMinTracks) {
    return Refusal(InitReason::kTooFewTracks, tracks, internal::kMinTracks,
                   "number of tracks seen more than once", "");
  }
  internal::WindowStates states;
  internal::Scene vision;
  if (InitVerdict v = Align(input, &terms, &scene, &vision, &states); !v.ok()) return v;
  if (InitVerdict v =
          internal::RefineJointly(input, std::move(vision), &terms, &scene, &states, state);
      !v.ok()) {
    return v;
  }
  Widen(input.limits.false_alarm, state);
  return Judge(*state, input.limits);
}

}  // namespace

Status MotionLimits::Validate() const {
  if (Status s = ValidatePositive(gravity_sigma, "gravity_sigma"); !s.ok()) return s;
  if (Status s = ValidatePositive(velocity_sigma, "velocity_sigma"); !s.ok()) return s;
  if (Status s = ValidatePositive(log_scale_sigma, "log_scale_sigma"); !s.ok()) return s;
  if (Status s = ValidatePositive(chi2_per_dof, "chi2_per_dof"); !s.ok()) return s;
  if (Status s = ValidatePositive(imu_chi2_per_dof, "imu_chi2_per_dof"); !s.ok()) return s;
  if (!(false_alarm > 0.0 && false_alarm < 0.5)) {
    return {StatusCode::kInvalidArgument, "false_alarm must be between 0 and 0.5"};
  }
  return {};
}

Status InitializationInput::Validate() const {
  if (cameras.empty()) return {StatusCode::kInvalidArgument, "no cameras"};
  for (const WindowCamera& camera : cameras) {
    if (Status s = camera.Validate(); !s.ok()) return s;
  }
  for (std::size_t k = 0; k < frames.size(); ++k) {
    if (k > 0 && frames[k].stamp_ns <= frames[k - 1].stamp_ns) {
      return {StatusCode::kInvalidArgument, "stamps of frames do not increase"};
    }
    for (const FrameObservation& o : frames[k].observations) {
      if (o.camera < 0 || static_cast<std::size_t>(o.camera) >= cameras.size()) {
        return {StatusCode::kInvalidArgument, "observation by a camera that is not"};
      }
    }
  }
  if (Status s = noise.Validate(); !s.ok()) return s;
  if (Status s = bias_prior.Validate(); !s.ok()) return s;
  if (Status s = ValidatePositive(gravity, "gravity"); !s.ok()) return s;
  if (Status s = limits.Validate(); !s.ok()) return s;
  return stillness.Validate();
}

Result<MotionState> InitializeInMotion(const InitializationInput& input, InitVerdict* verdict) {
  InitVerdict unused;
  InitVerdict& judged = verdict ? *verdict : unused;
  MotionState state;
  judged = Initialize(input, &state);
  if (!judged.ok()) return judged.ToStatus();
  return state;
}

}  // namespace glissade
