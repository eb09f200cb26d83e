// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
// What a solution is like: gauge, null space, covariance, and the course's steps.
#include <nanobind/stl/array.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <optional>
#include <string>

#include "add_edges.h"
#include "arrays.h"
#include "errors.h"
#include "glissade/covariance/transform.h"
#include "handles.h"
#include "problem.h"

namespace glissade::python {

namespace {

VertexHandle<VertexPose> PoseHandle(const VertexArray& array, const char* name) {
  (void)OnlyOne(array, name);
  return TypedHandle<VertexPose>({&array, name}, 0);
}
VertexHandle<VertexPose> PoseHandle(const std::optional<VertexArray>& array, const char* name) {
  return array ? PoseHandle(*array, name) : VertexHandle<VertexPose>();
}
std::optional<Pose> PoseOf(const std::optional<ArrayLike>& reference) {
  if (!reference) return std::nullopt;
  const Rows rows(*reference, 7, "reference");
  rows.Expect(1);
  return PoseFrom(rows[0]);
}

void BindNullspace(nb::module_& m) {
  nb::class_<NullspaceDirection>(m, "NullspaceDirection", "One direction of the gauge group.")
      .def_prop_ro("name", [](const NullspaceDirection& d) { return std::string(d.name); })
      .def_ro("kappa", &NullspaceDirection::kappa,
              "u'Hu / sum_k u_k' H_kk u_k: 0 where nothing observes the direction")
      .def_ro("information", &NullspaceDirection::information, "u'Hu [1/rad^2, 1/m^2]")
      .def("__repr__", [](const NullspaceDirection& d) {
        return std::string("NullspaceDirection(")
            .append(d.name)
            .append(", kappa=")
            .append(nb::str(nb::cast(d.kappa)).c_str())
            .append(")");
      });
  nb::class_<NullspaceReport>(m, "NullspaceReport",
                              "How far H is from having the null space that the measurements have.")
      .def_ro("group", &NullspaceReport::group)
      .def_ro("directions", &NullspaceReport::directions)
      .def_prop_ro("max_kappa", &NullspaceReport::MaxKappa)
      .def_prop_ro(
          "edges",
          [](const NullspaceReport& r) {
            EdgeArray edges;
            for (const GaugeBreach& b : r.edges)
              edges.handles.push_back(b.edge);
            return edges;
          },
          "Edges that are not blind to the gauge, the first of num_edges")
      .def_ro("num_edges", &NullspaceReport::num_edges)
      .def_prop_ro(
          "held", [](const NullspaceReport& r) { return VertexArray(r.held); },
          "Vertices that would move with the gauge but are fixed");
}

void BindCovariance(nb::module_& m) {
  nb::class_<JointCovariance>(m, "Covariance",
                              "The joint covariance of a few vertices, in their tangents.")
      .def_prop_ro("vertices", [](const JointCovariance& c) { return VertexArray(c.vertices); })
      .def_ro("offsets", &JointCovariance::offsets,
              "first row of each vertex, and the number of rows")
      .def_prop_ro(
          "matrix",
          [](nb::handle self) {
            const auto& c = nb::cast<const JointCovariance&>(self);
            const auto n = static_cast<std::size_t>(c.size());
            return View(c.values.data(), {n, n}, self);
          },
          "(n, n), not a copy: keeps this object alive")
      .def(
          "block",
          [](const JointCovariance& c, const VertexArray& a, const std::optional<VertexArray>& b) {
            const AnyVertex of_a = OnlyOne(a, "a"), of_b = b ? OnlyOne(*b, "b") : of_a;
            const int i = c.IndexOf(of_a), j = c.IndexOf(of_b);
            if (i < 0 || j < 0) {
              Raise(Status(StatusCode::kUnknownHandle, "not a vertex of this covariance",
                           i < 0 ? of_a : of_b));
            }
            const auto at = [&](int k) { return c.offsets[static_cast<std::size_t>(k)]; };
            const int rows = at(i + 1) - at(i), cols = at(j + 1) - at(j);
            std::vector<double> block;
            for (int r = 0; r < rows; ++r) {
              for (int k = 0; k < cols; ++k)
                block.push_back(
                    c.values[static_cast<std::size_t>((at(j) + k) * c.size() + at(i) + r)]);
            }
            return Own(std::move(block),
                       {static_cast<std::size_t>(rows), static_cast<std::size_t>(cols)});
          },
          nb::arg("a"), nb::arg("b") = nb::none(), "Cov(a, b).")
      .def(
          "transform",
          [](const JointCovariance& c, const Gauge& gauge) {
            return Unwrap(TransformCovariance(c, gauge));
          },
          nb::arg("gauge"),
          "The same knowledge in another gauge: Zhang et al. (RA-L 2018), Eqs. 12 to 15.");
}

void BindSteps(nb::class_<PyProblem>& problem) {
  problem
      .def(
          "make_hessian",
          [](PyProblem& p) {
            Check(p.Work([](Problem& problem) { return problem.MakeHessian(); }));
          },
          "Linearizes at the present values: H = J'J and b = -J'r over all free variables.")
      .def(
          "solve_linear_system",
          [](PyProblem& p, double lambda, const std::optional<SolveOptions>& options) {
            Check(p.Work([&](Problem& problem) {
              return problem.SolveLinearSystem(lambda, options ? *options : SolveOptions());
            }));
          },
          nb::arg("damping"), nb::arg("options") = nb::none(),
          "Solves (H + lambda D) dx = b by eliminating landmarks.")
      .def(
          "update_states", [](PyProblem& p) { Check(p.write().UpdateStates()); },
          "x <- x boxplus dx, remembering x.")
      .def(
          "rollback_states", [](PyProblem& p) { Check(p.write().RollbackStates()); },
          "Back to x before the last update_states().")
      .def(
          "hessian",
          [](PyProblem& p) {
            const Eigen::MatrixXd H = p.read().Hessian();
            const auto n = static_cast<std::size_t>(H.rows());
            return Own(std::vector<double>(H.data(), H.data() + H.size()), {n, n});
          },
          "H of the last make_hessian(), dense: rows in the order of free_vertices(). (0, 0) "
          "before.")
      .def(
          "rhs",
          [](PyProblem& p) {
            const Eigen::VectorXd b = p.read().Rhs();
            return Own(std::vector<double>(b.data(), b.data() + b.size()),
                       {static_cast<std::size_t>(b.size())});
          },
          "b of the last make_hessian(), minus the gradient.")
      .def(
          "step",
          [](PyProblem& p) {
            const Eigen::VectorXd dx = p.read().Step();
            return Own(std::vector<double>(dx.data(), dx.data() + dx.size()),
                       {static_cast<std::size_t>(dx.size())});
          },
          "dx of the last solve_linear_system().")
      .def(
          "free_vertices", [](PyProblem& p) { return VertexArray(p.read().FreeVertices()); },
          "Order of hessian(): kept vertices first, then eliminated ones.")
      .def(
          "free_offsets", [](PyProblem& p) { return p.read().FreeOffsets(); },
          "First row of each of free_vertices() in hessian(), and the number of rows.");
}

}  // namespace

void BindGauge(nb::module_& m) {
  nb::enum_<GaugeGroup>(m, "GaugeGroup", "The motions of a whole scene that no residual sees.")
      .value("AUTO", GaugeGroup::kAuto)
      .value("VISUAL_INERTIAL", GaugeGroup::kVisualInertial, "yaw and translation: 4")
      .value("STEREO", GaugeGroup::kStereo, "rotation and translation: 6")
      .value("MONO", GaugeGroup::kMono, "rotation, translation, scale: 7");
  nb::class_<Gauge>(m, "Gauge", "How a solve or a covariance treats what nothing observes.")
      .def(nb::init<>(), "Free: damping alone holds it.")
      .def_static(
          "fixed",
          [](const VertexArray& anchor, const std::optional<ArrayLike>& reference,
             const std::optional<VertexArray>& second, GaugeGroup group) {
            return Gauge(Gauge::Fixed{PoseHandle(anchor, "anchor"), PoseOf(reference),
                                      PoseHandle(second, "second"), group});
          },
          nb::arg("anchor"), nb::arg("reference") = nb::none(), nb::arg("second") = nb::none(),
          nb::arg("group") = GaugeGroup::kAuto,
          "Removes the anchor's gauge coordinates (Zhang et al., RA-L 2018, Eqs. 9 and 10).")
      .def_static(
          "fixed_poses",
          [](const VertexArray& anchor, const VertexArray& second) {
            return Gauge(
                Gauge::FixedPoses{PoseHandle(anchor, "anchor"), PoseHandle(second, "second")});
          },
          nb::arg("anchor"), nb::arg("second"), "Holds both poses whole.")
      .def_static(
          "prior",
          [](const VertexArray& anchor, double weight, const std::optional<ArrayLike>& reference,
             const std::optional<VertexArray>& second, GaugeGroup group) {
            return Gauge(Gauge::Prior{PoseHandle(anchor, "anchor"), weight, PoseOf(reference),
                                      PoseHandle(second, "second"), group});
          },
          nb::arg("anchor"), nb::arg("weight") = 1e5, nb::arg("reference") = nb::none(),
          nb::arg("second") = nb::none(), nb::arg("group") = GaugeGroup::kAuto,
          "Adds sqrt(weight) (p - p0, dphi_z); weight in 1/m^2 and 1/rad^2 (Eq. 11).");
}

void BindStudy(nb::module_& m, nb::class_<PyProblem>& problem) {
  BindNullspace(m);
  BindCovariance(m);
  BindSteps(problem);
  problem
      .def(
          "check_nullspace",
          [](PyProblem& p, GaugeGroup group, double tolerance, int max_edges) {
            NullspaceOptions options{group, tolerance, max_edges};
            return Unwrap(p.Work([&](Problem& x) { return x.CheckNullspace(options); }));
          },
          nb::arg("group") = GaugeGroup::kAuto, nb::arg("tolerance") = NullspaceOptions().tolerance,
          nb::arg("max_edges") = NullspaceOptions().max_edges,
          "How far H is from having the null space that the measurements have: from the last "
          "linearization where it is of this structure, else from a fresh one.")
      .def(
          "covariance",
          [](PyProblem& p, const VertexArray& vertices, const Gauge& gauge, int num_threads) {
            CovarianceOptions options;
            options.gauge = gauge;
            options.num_threads = num_threads;
            return p.Seen(
                p.Work([&](Problem& x) { return x.ComputeCovariance(vertices.handles, options); }));
          },
          nb::arg("vertices"), nb::arg("gauge") = Gauge(), nb::arg("num_threads") = 1,
          "The joint covariance of some vertices at the present values.\n\ngauge: of a scene that "
          "nothing ties down, what is certain. Error SINGULAR names a vertex without information.")
      .def(
          "covariance_of_last_solve",
          [](PyProblem& p, const VertexArray& vertices) {
            return Unwrap(
                p.Work([&](Problem& x) { return x.CovarianceOfLastSolve(vertices.handles); }));
          },
          nb::arg("vertices"),
          "The same of vertices that are not eliminated, from the system of the last step: costs "
          "no linearization.")
      .def(
          "move_to_gauge",
          [](PyProblem& p, const Gauge& gauge, bool move_absolute_priors) {
            MoveOptions options;
            options.move_absolute_priors = move_absolute_priors;
            p.Seen(p.Work([&](Problem& x) { return x.MoveToGauge(gauge, options); }));
          },
          nb::arg("gauge"), nb::arg("move_absolute_priors") = false,
          "Slides the scene along its orbit until the anchor is at the gauge's reference; the cost "
          "stays.");
}

}  // namespace glissade::python
