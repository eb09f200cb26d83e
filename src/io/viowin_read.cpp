// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <limits>
#include <utility>

#include "glissade/base/out_of_memory.h"
#include "glissade/io/viowin.h"
#include "io/text_reader.h"
#include "io/viowin_check.h"

namespace glissade {

namespace {

using internal::ReserveFor;
using internal::TextReader;
using Kind = ViowinMarginalPrior::Kind;

/// What a line says is judged at once, so that the message can name the line.
void Judge(const Status& status, TextReader& in) {
  if (in.ok() && !status.ok()) in.Fail(status.message());
}

/// "KEYFRAMES 10" and the like.
int Section(TextReader& in, const char* keyword, int low, const char* what) {
  in.Expect(keyword);
  return in.Count(low, what);
}

/// Lines are numbered in order: "KF 0", "KF 1", ...
void Ordinal(TextReader& in, const char* keyword, int expected, const char* what) {
  in.Expect(keyword);
  const auto found = in.Integer(0, std::numeric_limits<std::int32_t>::max(), what, expected);
  if (in.ok() && found != expected) {
    in.Fail(std::string("expected ") + what + " " + std::to_string(expected) + ", found " +
            std::to_string(found) + ": they are numbered in order");
  }
}

/// Any integer: whether the frame exists is judged with the line.
std::int32_t Frame(TextReader& in, const char* what) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  return static_cast<std::int32_t>(in.Integer(-kMost, kMost, what));
}

ViowinCamera ReadCamera(TextReader& in) {
  constexpr int kMost = std::numeric_limits<std::int32_t>::max();
  ViowinCamera c;
  in.Expect("CAMERA");
  c.fx = in.Positive("fx");
  c.fy = in.Positive("fy");
  c.cx = in.Number("cx");
  c.cy = in.Number("cy");
  c.width = static_cast<int>(in.Integer(1, kMost, "width"));
  c.height = static_cast<int>(in.Integer(1, kMost, "height"));
  c.sigma_px = in.Positive("sigma_px");
  return c;
}

std::vector<ViowinKeyframe> ReadKeyframes(TextReader& in, int count, const char* keyword,
                                          const char* what) {
  std::vector<ViowinKeyframe> keyframes;
  keyframes.reserve(ReserveFor(count));
  for (int k = 0; k < count && in.ok(); ++k) {
    ViowinKeyframe& keyframe = keyframes.emplace_back();
    Ordinal(in, keyword, k, what);
    keyframe.stamp = in.Number("stamp of keyframe", k);
    in.Numbers(keyframe.T_w_b.data, 7, "pose of keyframe", k);
    in.Numbers(keyframe.speed_bias.data, 9, "speed and biases of keyframe", k);
    Judge(internal::CheckKeyframe(keyframe, what), in);
  }
  return keyframes;
}

void ReadLandmarks(TextReader& in, int num_frames, std::vector<ViowinLandmark>* landmarks) {
  const int count = Section(in, "LANDMARKS", 0, "number of landmarks");
  landmarks->reserve(ReserveFor(count));
  for (int k = 0; k < count && in.ok(); ++k) {
    ViowinLandmark& landmark = landmarks->emplace_back();
    Ordinal(in, "LM", k, "landmark");
    landmark.host = Frame(in, "host keyframe");
    landmark.u_host = in.Number("u_host of landmark", k);
    landmark.v_host = in.Number("v_host of landmark", k);
    landmark.rho = in.Number("rho_init of landmark", k);
    landmark.rho_true = in.Number("rho_true of landmark", k);
    const int observations = in.Count(0, "number of observations");
    landmark.observations.reserve(ReserveFor(observations));
    for (int i = 0; i < observations && in.ok(); ++i) {
      ViowinObservation& o = landmark.observations.emplace_back();
      o.frame = Frame(in, "keyframe of an observation");
      o.u = in.Number("u of observation", i);
      o.v = in.Number("v of observation", i);
    }
    Judge(internal::CheckLandmark(landmark, num_frames), in);
  }
}

void ReadPriors(TextReader& in, int num_frames, ViowinWindow* window) {
  int count = Section(in, "POSE_PRIORS", 0, "number of pose priors");
  for (int k = 0; k < count && in.ok(); ++k) {
    ViowinPosePrior& prior = window->pose_priors.emplace_back();
    in.Expect("PP");
    prior.frame = Frame(in, "keyframe of a pose prior");
    prior.use = static_cast<int>(in.Integer(0, 3, "use of pose prior", k));
    in.Numbers(prior.T_w_b.data, 7, "pose of pose prior", k);
    in.Numbers(prior.sqrt_information.data(), 6, "weight of pose prior", k);
    Judge(internal::CheckPosePrior(prior, num_frames), in);
  }
  count = Section(in, "SB_PRIORS", 0, "number of speed/bias priors");
  for (int k = 0; k < count && in.ok(); ++k) {
    ViowinSpeedBiasPrior& prior = window->speed_bias_priors.emplace_back();
    in.Expect("PS");
    prior.frame = Frame(in, "keyframe of a speed/bias prior");
    in.Numbers(prior.prior.data, 9, "state of speed/bias prior", k);
    in.Numbers(prior.sqrt_information.data(), 9, "weight of speed/bias prior", k);
    Judge(internal::CheckSpeedBiasPrior(prior, num_frames), in);
  }
}

void ReadImu(TextReader& in, int num_frames, ViowinWindow* window) {
  const int count = Section(in, "IMU", 0, "number of IMU terms");
  for (int k = 0; k < count && in.ok(); ++k) {
    ViowinImu& term = window->imu.emplace_back();
    PreintegratedImu& imu = term.imu;
    in.Expect("IM");
    term.i = Frame(in, "first keyframe of an IMU term");
    term.j = Frame(in, "second keyframe of an IMU term");
    imu.dt = in.Positive("dt of IMU term", k);
    in.Numbers(imu.dp.data(), 3, "dp of IMU term", k);
    in.Numbers(imu.dq.coeffs().data(), 4, "dq of IMU term", k);
    in.Numbers(imu.dv.data(), 3, "dv of IMU term", k);
    in.Numbers(imu.ba_lin.data(), 3, "ba_lin of IMU term", k);
    in.Numbers(imu.bg_lin.data(), 3, "bg_lin of IMU term", k);
    for (Matrix3* m : {&imu.dp_dba, &imu.dp_dbg, &imu.dq_dbg, &imu.dv_dba, &imu.dv_dbg}) {
      in.Numbers(m->data(), 9, "bias Jacobian of IMU term", k);
    }
    for (int r = 0; r < 15; ++r) {
      in.Numbers(&term.sqrt_information(r, r), 15 - r, "U of IMU term", k);
    }
    Judge(internal::CheckImu(term, num_frames), in);
  }
}

/// `count` numbers without trust in the count: memory grows with what is there.
void AppendNumbers(TextReader& in, std::int64_t count, const char* what, std::vector<double>* to) {
  to->reserve(ReserveFor(count));
  for (std::int64_t k = 0; k < count && in.ok(); ++k)
    to->push_back(in.Number(what, k));
}

void ReadMarginalPrior(TextReader& in, const ViowinWindow& window, ViowinMarginalPrior* prior) {
  in.Expect("MARG_PRIOR");
  const int num_blocks = in.Count(1, "number of states of a marginal prior");
  const int rows = in.Count(1, "number of rows of a marginal prior");
  std::int64_t ambient = 0, tangent = 0;
  for (int k = 0; k < num_blocks && in.ok(); ++k) {
    const std::string_view word = in.Word("'p', 's' or 'l' of a marginal prior");
    if (!in.ok()) return;
    if (word != "p" && word != "s" && word != "l") {
      in.Fail("expected 'p', 's' or 'l' of a marginal prior, found '" + internal::Printable(word) +
              "'");
      return;
    }
    ViowinMarginalPrior::Block& block = prior->blocks.emplace_back();
    block.kind = static_cast<Kind>(word[0]);
    block.index = Frame(in, "keyframe or landmark of a marginal prior");
    ambient += internal::AmbientDim(block.kind);
    tangent += internal::TangentDim(block.kind);
  }
  Judge(internal::CheckPriorSize(static_cast<std::size_t>(tangent)), in);
  AppendNumbers(in, ambient, "x0 of a marginal prior", &prior->x0);
  AppendNumbers(in, rows, "r0 of a marginal prior", &prior->r0);
  AppendNumbers(in, rows * tangent, "J of a marginal prior", &prior->jacobian);
  if (!in.ok()) return;
  Judge(internal::CheckMarginalPrior(*prior, static_cast<int>(window.keyframes.size()),
                                     static_cast<int>(window.landmarks.size())),
        in);
}

void ReadWindow(TextReader& in, std::int64_t version, ViowinWindow* window) {
  in.Expect("WINDOW");
  window->id = in.Integer(std::numeric_limits<std::int64_t>::min(),
                          std::numeric_limits<std::int64_t>::max(), "number of the window");
  window->camera = ReadCamera(in);
  in.Expect("EXTRINSIC");
  in.Numbers(window->T_b_c.data, 7, "extrinsic");
  Judge(ValidatePose(window->T_b_c.data, "extrinsic"), in);
  in.Expect("GRAVITY");
  in.Numbers(window->gravity.data(), 3, "gravity");
  const int num_frames = Section(in, "KEYFRAMES", 1, "number of keyframes");
  window->keyframes = ReadKeyframes(in, num_frames, "KF", "keyframe");
  window->ground_truth = ReadKeyframes(in, num_frames, "GT", "ground truth");
  ReadLandmarks(in, num_frames, &window->landmarks);
  ReadPriors(in, num_frames, window);
  ReadImu(in, num_frames, window);
  while (in.ok() && version >= 2 && in.Peek() == "MARG_PRIOR") {
    ReadMarginalPrior(in, *window, &window->marginal_priors.emplace_back());
  }
  in.Expect("END");
}

}  // namespace

Result<std::vector<ViowinWindow>> ReadViowin(const std::string& path) {
  return internal::OrOutOfMemory([&]() -> Result<std::vector<ViowinWindow>> {
    auto reader = TextReader::Open(path, '#');
    if (!reader.ok()) return reader.status();
    TextReader& in = reader.value();
    in.Expect("VIOWIN");
    const std::int64_t version = in.Integer(1, 2, "version of VIOWIN");
    std::vector<ViowinWindow> windows;
    do {
      ReadWindow(in, version, &windows.emplace_back());
    } while (in.ok() && !in.AtEnd());
    if (!in.ok()) return in.status();
    return windows;
  });
}

}  // namespace glissade
