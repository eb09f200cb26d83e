// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <algorithm>
#include <initializer_list>
#include <optional>
#include <string>

#include "add_edges.h"
#include "glissade/edges/bal.h"
#include "glissade/edges/relative_pose.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_stereo_same.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/edges/speed_bias_prior.h"

namespace glissade::python {

std::size_t NumEdges(std::span<const NamedVertices> arguments, std::size_t rows) {
  std::size_t n = rows;
  for (const NamedVertices& a : arguments)
    n = std::max(n, a.vertices->size());
  for (const NamedVertices& a : arguments)
    ExpectOneOr(*a.vertices, n, a.name);
  return n;
}

void WrongType(const NamedVertices& argument, std::string_view needed) {
  std::string message(argument.name);
  message.append(" must be of type ").append(needed).append(", not ");
  message.append(argument.vertices->TypeName());
  throw nb::value_error(message.c_str());
}

namespace {

using MaybeArray = std::optional<ArrayLike>;

/// T_body_camera: (7,) for all or (n, 7); the identity where nothing is given.
class Extrinsics {
 public:
  Extrinsics(const MaybeArray& array, const char* name) {
    if (array) rows_.emplace(*array, 7, name);
  }
  void ExpectOneOr(std::size_t n) const {
    if (rows_) rows_->ExpectOneOr(n);
  }
  [[nodiscard]] Pose Of(std::size_t k) const {
    return rows_ ? PoseFrom(rows_->ForEach(k)) : Pose();
  }

 private:
  std::optional<Rows> rows_;
};

struct Weighing {
  const MaybeArray& sqrt_information;
  const MaybeArray& information;
  const Loss& loss;
};

/// Edges of type E: as many as the longest of vertices and measurements; fill(&edge, k) writes what
/// was measured.
template <class E, std::size_t N, class Fill>
EdgeArray AddMeasured(PyProblem& p, const std::array<NamedVertices, N>& vertices,
                      std::initializer_list<const Rows*> measured,
                      std::initializer_list<const Extrinsics*> extrinsics, const Weighing& w,
                      Fill&& fill) {
  std::size_t n = 0;
  for (const Rows* rows : measured)
    n = std::max(n, rows->size());
  n = NumEdges(vertices, n);
  for (const Rows* rows : measured)
    rows->ExpectOneOr(n);
  for (const Extrinsics* poses : extrinsics)
    poses->ExpectOneOr(n);
  const Weights weights(w.sqrt_information, w.information, E::kResidualDim, n);
  return AddEdges<E>(p, n, vertices, weights, w.loss, [&](std::size_t k) {
    E edge;
    fill(&edge, k);
    return edge;
  });
}

EdgeArray AddReprojections(PyProblem& p, const VertexArray& landmarks, const VertexArray& hosts,
                           const VertexArray& targets, const ArrayLike& uv_host,
                           const ArrayLike& uv_target, const MaybeArray& T_b_c,
                           const MaybeArray& sqrt_information, const MaybeArray& information,
                           const Loss& loss) {
  const std::array<NamedVertices, 3> vertices = {
      {{&hosts, "hosts"}, {&targets, "targets"}, {&landmarks, "landmarks"}}};
  const Rows host(uv_host, 2, "uv_host"), target(uv_target, 2, "uv_target");
  const Extrinsics extrinsics(T_b_c, "T_body_camera");
  return AddMeasured<EdgeReprojection>(p, vertices, {&host, &target}, {&extrinsics},
                                       {sqrt_information, information, loss},
                                       [&](EdgeReprojection* edge, std::size_t k) {
                                         edge->uv_host = Vector2From(host.ForEach(k));
                                         edge->uv_target = Vector2From(target.ForEach(k));
                                         edge->T_b_c = extrinsics.Of(k);
                                       });
}

/// Observations of a landmark of one camera by another one, in the same frame or another.
template <class E, std::size_t N>
EdgeArray AddByTwoCameras(PyProblem& p, const std::array<NamedVertices, N>& vertices,
                          const ArrayLike& uv_host, const ArrayLike& uv_target,
                          const ArrayLike& T_b_host, const ArrayLike& T_b_target,
                          const Weighing& weighing) {
  const Rows host(uv_host, 2, "uv_host"), target(uv_target, 2, "uv_target");
  const Extrinsics of_host(T_b_host, "T_body_host_camera");
  const Extrinsics of_target(T_b_target, "T_body_target_camera");
  return AddMeasured<E>(p, vertices, {&host, &target}, {&of_host, &of_target}, weighing,
                        [&](E* edge, std::size_t k) {
                          edge->uv_host = Vector2From(host.ForEach(k));
                          edge->uv_target = Vector2From(target.ForEach(k));
                          edge->T_b_host = of_host.Of(k);
                          edge->T_b_target = of_target.Of(k);
                        });
}

EdgeArray AddStereo(PyProblem& p, const VertexArray& landmarks, const VertexArray& hosts,
                    const VertexArray& targets, const ArrayLike& uv_host,
                    const ArrayLike& uv_target, const ArrayLike& T_b_host,
                    const ArrayLike& T_b_target, const MaybeArray& sqrt_information,
                    const MaybeArray& information, const Loss& loss) {
  const std::array<NamedVertices, 3> vertices = {
      {{&hosts, "hosts"}, {&targets, "targets"}, {&landmarks, "landmarks"}}};
  return AddByTwoCameras<EdgeReprojectionStereo>(p, vertices, uv_host, uv_target, T_b_host,
                                                 T_b_target, {sqrt_information, information, loss});
}

EdgeArray AddStereoSame(PyProblem& p, const VertexArray& landmarks, const ArrayLike& uv_host,
                        const ArrayLike& uv_target, const ArrayLike& T_b_host,
                        const ArrayLike& T_b_target, const MaybeArray& sqrt_information,
                        const MaybeArray& information, const Loss& loss) {
  const std::array<NamedVertices, 1> vertices = {{{&landmarks, "landmarks"}}};
  return AddByTwoCameras<EdgeReprojectionStereoSame>(
      p, vertices, uv_host, uv_target, T_b_host, T_b_target, {sqrt_information, information, loss});
}

EdgeArray AddPointReprojections(PyProblem& p, const VertexArray& poses, const VertexArray& points,
                                const ArrayLike& uv, const MaybeArray& T_b_c,
                                const MaybeArray& sqrt_information, const MaybeArray& information,
                                const Loss& loss) {
  const std::array<NamedVertices, 2> vertices = {{{&poses, "poses"}, {&points, "points"}}};
  const Rows measured(uv, 2, "uv");
  const Extrinsics extrinsics(T_b_c, "T_body_camera");
  return AddMeasured<EdgeReprojectionXYZ>(p, vertices, {&measured}, {&extrinsics},
                                          {sqrt_information, information, loss},
                                          [&](EdgeReprojectionXYZ* edge, std::size_t k) {
                                            edge->uv = Vector2From(measured.ForEach(k));
                                            edge->T_b_c = extrinsics.Of(k);
                                          });
}

EdgeArray AddBal(PyProblem& p, const VertexArray& cameras, const VertexArray& points,
                 const ArrayLike& uv, const MaybeArray& sqrt_information,
                 const MaybeArray& information, const Loss& loss) {
  const std::array<NamedVertices, 2> vertices = {{{&cameras, "cameras"}, {&points, "points"}}};
  const Rows measured(uv, 2, "uv");
  return AddMeasured<EdgeBal>(
      p, vertices, {&measured}, {}, {sqrt_information, information, loss},
      [&](EdgeBal* edge, std::size_t k) { edge->uv = Vector2From(measured.ForEach(k)); });
}

EdgeArray AddPosePriors(PyProblem& p, const VertexArray& poses, const ArrayLike& T,
                        const MaybeArray& sqrt_information, const MaybeArray& information,
                        const Loss& loss) {
  const std::array<NamedVertices, 1> vertices = {{{&poses, "poses"}}};
  const Rows priors(T, 7, "priors");
  return AddMeasured<EdgeSE3Prior>(
      p, vertices, {&priors}, {}, {sqrt_information, information, loss},
      [&](EdgeSE3Prior* edge, std::size_t k) { edge->T_w_b = PoseFrom(priors.ForEach(k)); });
}

EdgeArray AddRelativePoses(PyProblem& p, const VertexArray& from, const VertexArray& to,
                           const ArrayLike& T, const MaybeArray& sqrt_information,
                           const MaybeArray& information, const Loss& loss) {
  const std::array<NamedVertices, 2> vertices = {{{&from, "from_poses"}, {&to, "to_poses"}}};
  const Rows measured(T, 7, "T_from_to");
  return AddMeasured<EdgeRelativePose>(
      p, vertices, {&measured}, {}, {sqrt_information, information, loss},
      [&](EdgeRelativePose* edge, std::size_t k) { edge->T_i_j = PoseFrom(measured.ForEach(k)); });
}

EdgeArray AddSpeedBiasPriors(PyProblem& p, const VertexArray& speed_biases, const ArrayLike& x,
                             const MaybeArray& sqrt_information, const MaybeArray& information,
                             const Loss& loss) {
  const std::array<NamedVertices, 1> vertices = {{{&speed_biases, "speed_biases"}}};
  const Rows priors(x, 9, "priors");
  return AddMeasured<EdgeSpeedBiasPrior>(p, vertices, {&priors}, {},
                                         {sqrt_information, information, loss},
                                         [&](EdgeSpeedBiasPrior* edge, std::size_t k) {
                                           std::copy_n(priors.ForEach(k), 9, edge->prior.Data());
                                         });
}

#define GLISSADE_WEIGHT_ARGS                                                                    \
  nb::kw_only(), nb::arg("sqrt_information") = nb::none(), nb::arg("information") = nb::none(), \
                 nb::arg("loss") = Loss()

}  // namespace

void BindEdges(nb::class_<PyProblem>& problem) {
  static const std::string weights =
      std::string("\n\nAll or none are added; arguments of length 1 are for all edges.\n")
          .append(kWeightDoc);
  const auto doc = [](const char* text) { return std::string(text).append(weights); };
  problem
      .def("add_reprojections", &AddReprojections, nb::arg("landmarks"), nb::arg("hosts"),
           nb::arg("targets"), nb::arg("uv_host"), nb::arg("uv_target"),
           nb::arg("T_body_camera") = nb::none(), GLISSADE_WEIGHT_ARGS,
           doc("Observations of inverse-depth landmarks in other frames by the same "
               "camera.\n\nlandmarks, hosts, targets: vertices, one each for an edge. uv_host, "
               "uv_target: (n, 2), normalized coordinates (x/z, y/z); noise of s px is "
               "sqrt_information = f / s. T_body_camera: (7,) or (n, 7).")
               .c_str())
      .def("add_stereo_reprojections", &AddStereo, nb::arg("landmarks"), nb::arg("hosts"),
           nb::arg("targets"), nb::arg("uv_host"), nb::arg("uv_target"),
           nb::arg("T_body_host_camera"), nb::arg("T_body_target_camera"), GLISSADE_WEIGHT_ARGS,
           doc("Observations of inverse-depth landmarks of one camera by another one in another "
               "frame; else as add_reprojections().")
               .c_str())
      .def("add_same_frame_reprojections", &AddStereoSame, nb::arg("landmarks"), nb::arg("uv_host"),
           nb::arg("uv_target"), nb::arg("T_body_host_camera"), nb::arg("T_body_target_camera"),
           GLISSADE_WEIGHT_ARGS,
           doc("Observations of inverse-depth landmarks of one camera by another one in the host "
               "frame itself: the second image of a stereo pair.")
               .c_str())
      .def("add_point_reprojections", &AddPointReprojections, nb::arg("poses"), nb::arg("points"),
           nb::arg("uv"), nb::arg("T_body_camera") = nb::none(), GLISSADE_WEIGHT_ARGS,
           doc("Observations of points in the world.\n\nuv: (n, 2), normalized coordinates (x/z, "
               "y/z). T_body_camera: (7,) or (n, 7).")
               .c_str())
      .def("add_bal_observations", &AddBal, nb::arg("cameras"), nb::arg("points"), nb::arg("uv"),
           GLISSADE_WEIGHT_ARGS,
           doc("Observations as in BAL files.\n\nuv: (n, 2) [px] from the image centre, y up.")
               .c_str())
      .def("add_pose_priors", &AddPosePriors, nb::arg("poses"), nb::arg("priors"),
           GLISSADE_WEIGHT_ARGS,
           doc("Priors on poses: r = [p - p0 [m], Log(q0^-1 q) [rad]].\n\npriors: (n, 7).").c_str())
      .def("add_relative_poses", &AddRelativePoses, nb::arg("from_poses"), nb::arg("to_poses"),
           nb::arg("T_from_to"), GLISSADE_WEIGHT_ARGS,
           doc("Measured relative poses, odometry or loop closures: r = [R_i'(p_j - p_i) - p_ij, "
               "Log(q_ij^-1 q_i^-1 q_j)].\n\nT_from_to: (n, 7).")
               .c_str())
      .def("add_speed_bias_priors", &AddSpeedBiasPriors, nb::arg("speed_biases"), nb::arg("priors"),
           GLISSADE_WEIGHT_ARGS,
           doc("Priors on velocities and biases.\n\npriors: (n, 9).").c_str());
}

}  // namespace glissade::python
