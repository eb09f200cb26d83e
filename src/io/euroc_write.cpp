// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <string>

#include "glissade/base/validate.h"
#include "glissade/io/euroc.h"
#include "io/csv_row.h"
#include "io/ground_truth.h"
#include "io/text_writer.h"

namespace glissade {

Status internal::CheckGroundTruth(std::span<const GroundTruthState> states) {
  for (std::size_t k = 0; k < states.size(); ++k) {
    if (k > 0 && states[k].stamp_ns <= states[k - 1].stamp_ns) {
      return {StatusCode::kInvalidArgument, "ground truth: stamps must increase"};
    }
    if (states[k].speed_bias.has_value() != states[0].speed_bias.has_value()) {
      return {StatusCode::kInvalidArgument, "ground truth: speeds and biases at some stamps only"};
    }
    if (Status s = ValidatePose(states[k].T_w_b.data, "ground truth"); !s.ok()) return s;
    if (states[k].speed_bias) {
      if (Status s = ValidateFinite(states[k].speed_bias->data, 9, "ground truth"); !s.ok()) {
        return s;
      }
    }
  }
  return {};
}

Status WriteEurocGroundTruth(std::span<const GroundTruthState> states, const std::string& path) {
  if (Status s = internal::CheckGroundTruth(states); !s.ok()) return s;
  auto writer = internal::TextWriter::Create(path);
  if (!writer.ok()) return writer.status();
  const bool whole = !states.empty() && states[0].speed_bias.has_value();
  writer->Line(whole ? "# timestamp_ns, px, py, pz, qw, qx, qy, qz, vx, vy, vz, bgx, bgy, bgz, "
                       "bax, bay, baz"
                     : "# timestamp_ns, px, py, pz, qw, qx, qy, qz");
  for (const GroundTruthState& state : states) {
    const double* pose = state.T_w_b.data;  // p, then x y z w
    internal::CsvRow row;
    row.Integer(state.stamp_ns).Numbers(pose, 3).Number(pose[6]).Numbers(pose + 3, 3);
    if (state.speed_bias) {
      const VertexSpeedBias& s = *state.speed_bias;
      row.Numbers(s.v(), 3).Numbers(s.bg(), 3).Numbers(s.ba(), 3);
    }
    writer->Line(row.text());
  }
  return writer->Close();
}

}  // namespace glissade
