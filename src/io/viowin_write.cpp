// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/viowin.h"
#include "io/text_writer.h"

namespace glissade {

namespace {

using internal::TextWriter;

template <class List>
std::int64_t Size(const List& list) {
  return static_cast<std::int64_t>(list.size());
}

void WriteKeyframes(TextWriter& out, const char* keyword,
                    const std::vector<ViowinKeyframe>& keyframes) {
  for (std::size_t k = 0; k < keyframes.size(); ++k) {
    const ViowinKeyframe& keyframe = keyframes[k];
    out.Word(keyword).Integer(static_cast<std::int64_t>(k)).Number(keyframe.stamp);
    out.Numbers(keyframe.T_w_b.data, 7).Numbers(keyframe.speed_bias.data, 9).EndLine();
  }
}

void WriteImu(TextWriter& out, const ViowinImu& term) {
  const PreintegratedImu& imu = term.imu;
  out.Word("IM").Integer(term.i).Integer(term.j).Number(imu.dt);
  out.Numbers(imu.dp.data(), 3).Numbers(imu.dq.coeffs().data(), 4).Numbers(imu.dv.data(), 3);
  out.Numbers(imu.ba_lin.data(), 3).Numbers(imu.bg_lin.data(), 3);
  for (const Matrix3* m : {&imu.dp_dba, &imu.dp_dbg, &imu.dq_dbg, &imu.dv_dba, &imu.dv_dbg}) {
    out.Numbers(m->data(), 9);
  }
  for (int r = 0; r < 15; ++r)
    out.Numbers(term.sqrt_information.data() + 15 * r + r, 15 - r);
  out.EndLine();
}

void WriteMarginalPrior(TextWriter& out, const ViowinMarginalPrior& prior) {
  out.Word("MARG_PRIOR").Integer(Size(prior.blocks)).Integer(Size(prior.r0));
  for (const auto& block : prior.blocks) {
    const char kind = static_cast<char>(block.kind);
    out.Word(std::string_view(&kind, 1)).Integer(block.index);
  }
  for (const auto* list : {&prior.x0, &prior.r0, &prior.jacobian}) {
    out.Numbers(list->data(), static_cast<int>(list->size()));
  }
  out.EndLine();
}

void WriteWindow(TextWriter& out, const ViowinWindow& window) {
  const ViowinCamera& c = window.camera;
  out.Word("WINDOW").Integer(window.id).EndLine();
  out.Word("CAMERA").Number(c.fx).Number(c.fy).Number(c.cx).Number(c.cy);
  out.Integer(c.width).Integer(c.height).Number(c.sigma_px).EndLine();
  out.Word("EXTRINSIC").Numbers(window.T_b_c.data, 7).EndLine();
  out.Word("GRAVITY").Numbers(window.gravity.data(), 3).EndLine();
  out.Word("KEYFRAMES").Integer(Size(window.keyframes)).EndLine();
  WriteKeyframes(out, "KF", window.keyframes);
  WriteKeyframes(out, "GT", window.ground_truth);
  out.Word("LANDMARKS").Integer(Size(window.landmarks)).EndLine();
  std::int64_t number = 0;
  for (const ViowinLandmark& landmark : window.landmarks) {
    out.Word("LM").Integer(number++).Integer(landmark.host);
    out.Number(landmark.u_host).Number(landmark.v_host);
    out.Number(landmark.rho).Number(landmark.rho_true).Integer(Size(landmark.observations));
    for (const ViowinObservation& o : landmark.observations)
      out.Integer(o.frame).Number(o.u).Number(o.v);
    out.EndLine();
  }
  out.Word("POSE_PRIORS").Integer(Size(window.pose_priors)).EndLine();
  for (const ViowinPosePrior& prior : window.pose_priors) {
    out.Word("PP").Integer(prior.frame).Integer(prior.use).Numbers(prior.T_w_b.data, 7);
    out.Numbers(prior.sqrt_information.data(), 6).EndLine();
  }
  out.Word("SB_PRIORS").Integer(Size(window.speed_bias_priors)).EndLine();
  for (const ViowinSpeedBiasPrior& prior : window.speed_bias_priors) {
    out.Word("PS").Integer(prior.frame).Numbers(prior.prior.data, 9);
    out.Numbers(prior.sqrt_information.data(), 9).EndLine();
  }
  out.Word("IMU").Integer(Size(window.imu)).EndLine();
  for (const ViowinImu& term : window.imu)
    WriteImu(out, term);
  for (const ViowinMarginalPrior& prior : window.marginal_priors)
    WriteMarginalPrior(out, prior);
  out.Word("END").EndLine();
}

}  // namespace

Status WriteViowin(const std::vector<ViowinWindow>& windows, const std::string& path) {
  if (windows.empty()) return {StatusCode::kInvalidArgument, "VIOWIN: no windows to write"};
  for (std::size_t k = 0; k < windows.size(); ++k) {
    if (Status s = windows[k].Validate(); !s.ok()) {
      return {s.code(), "VIOWIN window " + std::to_string(k) + ": " + s.message()};
    }
  }
  auto writer = TextWriter::Create(path);
  if (!writer.ok()) return writer.status();
  TextWriter& out = writer.value();
  out.Line("VIOWIN 2");
  for (const ViowinWindow& window : windows)
    WriteWindow(out, window);
  return out.Close();
}

}  // namespace glissade
