// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/viowin_check.h"

#include <string>

#include "glissade/base/validate.h"

namespace glissade {

namespace internal {

namespace {

using Kind = ViowinMarginalPrior::Kind;

Status Invalid(std::string message) {
  return {StatusCode::kInvalidArgument, std::move(message)};
}

bool InRange(int index, int size) {
  return index >= 0 && index < size;
}

Status UnknownFrame(const char* what, int frame, int num_frames) {
  return Invalid(std::string(what) + ": unknown keyframe " + std::to_string(frame) + " of " +
                 std::to_string(num_frames));
}

Status CheckWeights(const double* s, int n, const char* what) {
  if (Status status = ValidateFinite(s, n, what); !status.ok()) return status;
  for (int k = 0; k < n; ++k) {
    if (s[k] < 0.0) return {StatusCode::kNotPositive, std::string(what) + ": negative weight"};
  }
  return {};
}

}  // namespace

int AmbientDim(Kind kind) {
  return kind == Kind::kPose ? 7 : kind == Kind::kSpeedBias ? 9 : 1;
}

int TangentDim(Kind kind) {
  return kind == Kind::kPose ? 6 : AmbientDim(kind);
}

Status CheckCamera(const ViowinCamera& c) {
  if (Status s = ValidatePositive(c.fx, "camera fx"); !s.ok()) return s;
  if (Status s = ValidatePositive(c.fy, "camera fy"); !s.ok()) return s;
  const double centre[2] = {c.cx, c.cy};
  if (Status s = ValidateFinite(centre, 2, "camera centre"); !s.ok()) return s;
  if (c.width < 1 || c.height < 1) return Invalid("camera: width and height must be at least 1");
  return ValidatePositive(c.sigma_px, "camera sigma_px");
}

Status CheckKeyframe(const ViowinKeyframe& keyframe, const char* what) {
  if (Status s = ValidateFinite(&keyframe.stamp, 1, what); !s.ok()) return s;
  if (Status s = ValidatePose(keyframe.T_w_b.data, what); !s.ok()) return s;
  return ValidateFinite(keyframe.speed_bias.data, 9, what);
}

Status CheckLandmark(const ViowinLandmark& landmark, int num_frames) {
  if (!InRange(landmark.host, num_frames)) {
    return UnknownFrame("host of a landmark", landmark.host, num_frames);
  }
  const double numbers[4] = {landmark.u_host, landmark.v_host, landmark.rho, landmark.rho_true};
  if (Status s = ValidateFinite(numbers, 4, "landmark"); !s.ok()) return s;
  for (const ViowinObservation& o : landmark.observations) {
    if (!InRange(o.frame, num_frames)) return UnknownFrame("observation", o.frame, num_frames);
    if (o.frame == landmark.host) {
      return Invalid("observation in the landmark's own host frame " + std::to_string(o.frame));
    }
    const double uv[2] = {o.u, o.v};
    if (!AllFinite(uv, 2)) return ValidateFinite(uv, 2, "observation");
  }
  return {};
}

Status CheckPosePrior(const ViowinPosePrior& prior, int num_frames) {
  if (!InRange(prior.frame, num_frames)) return UnknownFrame("pose prior", prior.frame, num_frames);
  if (prior.use < 0 || prior.use > 3) return Invalid("pose prior: use must be 0 to 3");
  if (Status s = ValidatePose(prior.T_w_b.data, "pose prior"); !s.ok()) return s;
  return CheckWeights(prior.sqrt_information.data(), 6, "pose prior");
}

Status CheckSpeedBiasPrior(const ViowinSpeedBiasPrior& prior, int num_frames) {
  if (!InRange(prior.frame, num_frames)) {
    return UnknownFrame("speed/bias prior", prior.frame, num_frames);
  }
  if (Status s = ValidateFinite(prior.prior.data, 9, "speed/bias prior"); !s.ok()) return s;
  return CheckWeights(prior.sqrt_information.data(), 9, "speed/bias prior");
}

Status CheckImu(const ViowinImu& imu, int num_frames) {
  if (!InRange(imu.i, num_frames)) return UnknownFrame("IMU term", imu.i, num_frames);
  if (!InRange(imu.j, num_frames)) return UnknownFrame("IMU term", imu.j, num_frames);
  if (imu.i == imu.j) {
    return Invalid("IMU term from keyframe " + std::to_string(imu.i) + " to itself");
  }
  if (Status s = imu.imu.Validate(); !s.ok()) return s;
  if (Status s = ValidateFinite(imu.sqrt_information.data(), 225, "IMU square-root information");
      !s.ok()) {
    return s;
  }
  for (int r = 1; r < 15; ++r) {
    for (int c = 0; c < r; ++c) {
      if (imu.sqrt_information(r, c) != 0.0) {
        return Invalid("IMU square-root information is not upper triangular");
      }
    }
  }
  return {};
}

Status CheckPriorSize(std::size_t tangent) {
  if (tangent <= ViowinMarginalPrior::kMaxTangentDim) return {};
  return Invalid("marginal prior on more than " +
                 std::to_string(ViowinMarginalPrior::kMaxTangentDim) + " tangent dimensions");
}

Status CheckMarginalPrior(const ViowinMarginalPrior& prior, int num_frames, int num_landmarks) {
  std::size_t ambient = 0, tangent = 0;
  if (prior.blocks.empty()) return Invalid("marginal prior without a block");
  const double* x0 = prior.x0.data();
  for (std::size_t k = 0; k < prior.blocks.size(); ++k) {
    const auto& block = prior.blocks[k];
    const bool landmark = block.kind == Kind::kInverseDepth;
    if (!landmark && block.kind != Kind::kPose && block.kind != Kind::kSpeedBias) {
      return Invalid("marginal prior: unknown kind of block");
    }
    if (!InRange(block.index, landmark ? num_landmarks : num_frames)) {
      if (!landmark) return UnknownFrame("marginal prior", block.index, num_frames);
      return Invalid("marginal prior: unknown landmark " + std::to_string(block.index) + " of " +
                     std::to_string(num_landmarks));
    }
    for (std::size_t i = 0; i < k; ++i) {
      if (prior.blocks[i].kind == block.kind && prior.blocks[i].index == block.index) {
        return Invalid("marginal prior: one state twice");
      }
    }
    ambient += static_cast<std::size_t>(AmbientDim(block.kind));
    tangent += static_cast<std::size_t>(TangentDim(block.kind));
  }
  if (Status s = CheckPriorSize(tangent); !s.ok()) return s;
  if (prior.x0.size() != ambient || prior.jacobian.size() != prior.r0.size() * tangent ||
      prior.r0.empty()) {
    return Invalid("marginal prior: sizes of x0, r0 and J do not match its blocks");
  }
  for (const auto& block : prior.blocks) {
    if (block.kind == Kind::kPose) {
      if (Status s = ValidatePose(x0, "x0 of a marginal prior"); !s.ok()) return s;
    }
    x0 += AmbientDim(block.kind);
  }
  for (const auto* list : {&prior.x0, &prior.r0, &prior.jacobian}) {
    for (const double x : *list) {
      if (!AllFinite(&x, 1)) return ValidateFinite(&x, 1, "marginal prior");
    }
  }
  return {};
}

}  // namespace internal

Status ViowinWindow::Validate() const {
  using namespace internal;
  const int K = static_cast<int>(keyframes.size());
  const int L = static_cast<int>(landmarks.size());
  if (K == 0) return {StatusCode::kInvalidArgument, "window without keyframes"};
  if (ground_truth.size() != keyframes.size()) {
    return {StatusCode::kInvalidArgument, "window: one ground truth per keyframe is needed"};
  }
  if (Status s = CheckCamera(camera); !s.ok()) return s;
  if (Status s = ValidatePose(T_b_c.data, "extrinsic"); !s.ok()) return s;
  if (Status s = ValidateFinite(gravity.data(), 3, "gravity"); !s.ok()) return s;
  for (const auto& keyframe : keyframes) {
    if (Status s = CheckKeyframe(keyframe, "keyframe"); !s.ok()) return s;
  }
  for (const auto& keyframe : ground_truth) {
    if (Status s = CheckKeyframe(keyframe, "ground truth"); !s.ok()) return s;
  }
  for (const auto& landmark : landmarks) {
    if (Status s = CheckLandmark(landmark, K); !s.ok()) return s;
  }
  for (const auto& prior : pose_priors) {
    if (Status s = CheckPosePrior(prior, K); !s.ok()) return s;
  }
  for (const auto& prior : speed_bias_priors) {
    if (Status s = CheckSpeedBiasPrior(prior, K); !s.ok()) return s;
  }
  for (const auto& term : imu) {
    if (Status s = CheckImu(term, K); !s.ok()) return s;
  }
  for (const auto& prior : marginal_priors) {
    if (Status s = CheckMarginalPrior(prior, K, L); !s.ok()) return s;
  }
  return {};
}

}  // namespace glissade
