// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/g2o_check.h"

#include <cmath>
#include <span>

#include "glissade/base/out_of_memory.h"
#include "glissade/base/validate.h"
#include "glissade/graph/edge_options.h"

namespace glissade {

namespace internal {

namespace {

class Checker {
 public:
  Checker(const G2oProblem& problem, const std::string& path, const G2oLines* lines, G2oIds* ids)
      : problem_(problem), path_(path), lines_(lines), ids_(ids) {}

  Status Run() {
    Enter(problem_.offsets, G2oKind::kOffset, &ids_->offsets);
    Enter(problem_.poses, G2oKind::kPose, &ids_->vertices);
    Enter(problem_.points, G2oKind::kPoint, &ids_->vertices);
    Enter(problem_.cameras, G2oKind::kCamera, &ids_->vertices);
    std::size_t k = 0;
    for (const G2oOffset& x : problem_.offsets) {
      At(G2oKind::kOffset, k++);
      CheckPose(x.T_b_s);
    }
    k = 0;
    for (const G2oPose& x : problem_.poses) {
      At(G2oKind::kPose, k++);
      CheckPose(x.T_w_b);
    }
    k = 0;
    for (const G2oPoint& x : problem_.points) {
      At(G2oKind::kPoint, k++);
      CheckFinite(x.xyz);
    }
    k = 0;
    for (const G2oCamera& x : problem_.cameras) {
      At(G2oKind::kCamera, k++);
      CheckPose(x.T_w_c);
      const double intrinsics[] = {x.fx, x.fy, x.cx, x.cy, x.baseline};
      CheckFinite(intrinsics);
    }
    CheckEdges();
    return status_;
  }

 private:
  void CheckEdges() {
    std::size_t k = 0;
    for (const G2oRelativePose& x : problem_.relative_poses) {
      At(G2oKind::kRelativePose, k++);
      CheckVertex(x.from, G2oKind::kPose);
      CheckVertex(x.to, G2oKind::kPose);
      if (x.from == x.to) Fail("from vertex " + std::to_string(x.from) + " to itself");
      CheckPose(x.T_i_j);
      CheckInformation<6>(x.information);
    }
    k = 0;
    for (const G2oPosePrior& x : problem_.priors) {
      At(G2oKind::kPrior, k++);
      CheckVertex(x.pose, G2oKind::kPose);
      CheckOffset(x.offset);
      CheckPose(x.T_w_s);
      CheckInformation<6>(x.information);
    }
    k = 0;
    for (const G2oPointMeasurement& x : problem_.point_measurements) {
      At(G2oKind::kPointMeasurement, k++);
      CheckVertex(x.pose, G2oKind::kPose);
      CheckVertex(x.point, G2oKind::kPoint);
      CheckOffset(x.offset);
      CheckFinite(x.xyz);
      CheckInformation<3>(x.information);
    }
    k = 0;
    for (const G2oProjection& x : problem_.projections) {
      At(G2oKind::kProjection, k++);
      CheckVertex(x.point, G2oKind::kPoint);
      CheckVertex(x.camera, G2oKind::kCamera);
      const double uv[] = {x.u, x.v};
      CheckFinite(uv);
      CheckInformation<2>(x.information);
    }
  }

  /// What is looked at from here on.
  void At(G2oKind kind, std::size_t index) {
    kind_ = kind;
    index_ = index;
  }
  [[nodiscard]] static const char* TagOf(G2oKind kind) {
    for (const G2oTag& tag : kG2oTags) {
      if (tag.kind == kind) return tag.tag;
    }
    return "";
  }
  [[nodiscard]] std::string NameOf(G2oKind kind, std::size_t index) const {
    if (lines_ != nullptr) return "line " + std::to_string((*lines_)[kind][index]);
    return std::string(TagOf(kind)).append(" ").append(std::to_string(index));
  }
  void Fail(const std::string& what) {
    if (!status_.ok()) return;
    std::string message;
    if (lines_ != nullptr) {
      message.append(path_).append(":").append(std::to_string((*lines_)[kind_][index_]));
      message.append(": ").append(TagOf(kind_));
    } else {
      message.append("g2o problem: ").append(NameOf(kind_, index_));
    }
    status_ = Status(lines_ != nullptr ? StatusCode::kParseError : StatusCode::kInvalidArgument,
                     message.append(": ").append(what));
  }

  template <class List>
  void Enter(const List& list, G2oKind kind, G2oIndex* index) {
    for (std::size_t k = 0; k < list.size(); ++k) {
      At(kind, k);
      if (list[k].id < 0) Fail("id " + std::to_string(list[k].id) + " is negative");
      const auto [there, is_new] = index->try_emplace(list[k].id, G2oPlace{kind, k});
      if (is_new) continue;
      Fail("id " + std::to_string(list[k].id) + " is there already, in " +
           NameOf(there->second.kind, there->second.index));
    }
  }
  void CheckVertex(std::int64_t id, G2oKind kind) {
    const auto found = ids_->vertices.find(id);
    if (found == ids_->vertices.end()) {
      Fail("there is no vertex " + std::to_string(id));
    } else if (found->second.kind != kind) {
      Fail("expected a " + std::string(TagOf(kind)) + ", and vertex " + std::to_string(id) +
           " is a " + TagOf(found->second.kind));
    }
  }
  void CheckOffset(std::int64_t id) {
    if (!ids_->offsets.contains(id)) Fail("there is no PARAMS_SE3OFFSET " + std::to_string(id));
  }
  void CheckFinite(std::span<const double> x) {
    if (!AllFinite(x.data(), static_cast<int>(x.size()))) Fail("a number is not finite");
  }
  void CheckPose(const Pose& pose) {
    CheckFinite(pose.data);
    const double norm = pose.q().coeffs().stableNorm();
    if (!(std::abs(norm - 1.0) < 1e-2))
      Fail("quaternion has norm " + std::to_string(norm) + ", not 1");
  }
  template <int N>
  void CheckInformation(const std::array<double, N*(N + 1) / 2>& triangle) {
    CheckFinite(triangle);
    if (!status_.ok()) return;
    double omega[N * N], root[N * N];
    const double* x = triangle.data();
    for (int r = 0; r < N; ++r) {
      for (int c = r; c < N; ++c)
        omega[r * N + c] = omega[c * N + r] = *x++;
    }
    if (!SqrtOfInformation(N, omega, root)) Fail("information is not positive semi-definite");
  }

  const G2oProblem& problem_;
  const std::string& path_;
  const G2oLines* lines_;
  G2oIds* ids_;
  G2oKind kind_ = G2oKind::kOffset;
  std::size_t index_ = 0;
  Status status_;
};

}  // namespace

Status CheckG2o(const G2oProblem& problem, const std::string& path, const G2oLines* lines,
                G2oIds* ids) {
  G2oIds own;
  return Checker(problem, path, lines, ids != nullptr ? ids : &own).Run();
}

}  // namespace internal

Status CheckG2o(const G2oProblem& problem) {
  return internal::OrOutOfMemory([&] { return internal::CheckG2o(problem, "", nullptr, nullptr); });
}

}  // namespace glissade
