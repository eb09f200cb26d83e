// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <string_view>

#include "glissade/base/out_of_memory.h"
#include "glissade/io/g2o.h"
#include "io/text_writer.h"

namespace glissade {

namespace {

using internal::TextWriter;

/// g2o wants vertices before the edges on them: so it is with lines that it alone understands.
bool GoesLast(std::string_view line) {
  return line.starts_with("EDGE") || line.starts_with("FIX ");
}

Status CheckOtherLines(const G2oProblem& problem) {
  for (std::size_t k = 0; k < problem.other_lines.size(); ++k) {
    const std::string_view line = problem.other_lines[k];
    // A first word that is a letter: it comes back as a line of its own, and not as a comment.
    const bool good = !line.empty() && line[0] > ' ' && line[0] != '#' && line.back() > ' ' &&
                      line.find('\n') == std::string_view::npos;
    if (good) continue;
    return {StatusCode::kInvalidArgument,
            "g2o problem: other line " + std::to_string(k) + " is not one line of text"};
  }
  return {};
}

class Writer {
 public:
  explicit Writer(TextWriter& out) : out_(out) {}

  void Write(const G2oProblem& problem) {
    for (const G2oOffset& x : problem.offsets)
      out_.Word("PARAMS_SE3OFFSET").Integer(x.id).Numbers(x.T_b_s.data, 7).EndLine();
    for (const G2oPose& x : problem.poses) {
      out_.Word("VERTEX_SE3:QUAT").Integer(x.id).Numbers(x.T_w_b.data, 7).EndLine();
      Fix(x);
    }
    for (const G2oCamera& x : problem.cameras) {
      const double intrinsics[] = {x.fx, x.fy, x.cx, x.cy, x.baseline};
      out_.Word("VERTEX_CAM").Integer(x.id).Numbers(x.T_w_c.data, 7);
      out_.Numbers(intrinsics, 5).EndLine();
      Fix(x);
    }
    for (const G2oPoint& x : problem.points) {
      out_.Word(x.sba ? "VERTEX_XYZ" : "VERTEX_TRACKXYZ").Integer(x.id).Numbers(x.xyz, 3).EndLine();
      Fix(x);
    }
    OtherLines(problem, false);
    for (const G2oPosePrior& x : problem.priors) {
      out_.Word("EDGE_SE3_PRIOR").Integer(x.pose).Integer(x.offset).Numbers(x.T_w_s.data, 7);
      Information(x.information);
    }
    for (const G2oRelativePose& x : problem.relative_poses) {
      out_.Word("EDGE_SE3:QUAT").Integer(x.from).Integer(x.to).Numbers(x.T_i_j.data, 7);
      Information(x.information);
    }
    for (const G2oPointMeasurement& x : problem.point_measurements) {
      out_.Word("EDGE_SE3_TRACKXYZ").Integer(x.pose).Integer(x.point).Integer(x.offset);
      out_.Numbers(x.xyz, 3);
      Information(x.information);
    }
    for (const G2oProjection& x : problem.projections) {
      out_.Word("EDGE_PROJECT_P2MC").Integer(x.point).Integer(x.camera).Number(x.u).Number(x.v);
      Information(x.information);
    }
    OtherLines(problem, true);
  }

 private:
  template <class Vertex>
  void Fix(const Vertex& vertex) {
    if (vertex.fixed) out_.Word("FIX").Integer(vertex.id).EndLine();
  }
  template <std::size_t N>
  void Information(const std::array<double, N>& information) {
    out_.Numbers(information.data(), static_cast<int>(N)).EndLine();
  }
  void OtherLines(const G2oProblem& problem, bool last) {
    for (const std::string& line : problem.other_lines) {
      if (GoesLast(line) == last) out_.Line(line);
    }
  }

  TextWriter& out_;
};

}  // namespace

Status WriteG2o(const G2oProblem& problem, const std::string& path) {
  return internal::OrOutOfMemory([&]() -> Status {
    if (Status s = CheckG2o(problem); !s.ok()) return s;
    if (Status s = CheckOtherLines(problem); !s.ok()) return s;
    auto writer = TextWriter::Create(path);
    if (!writer.ok()) return writer.status();
    Writer(writer.value()).Write(problem);
    return writer->Close();
  });
}

}  // namespace glissade
