// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>

#include <memory>
#include <optional>
#include <span>

#include "arrays.h"
#include "errors.h"
#include "glissade/edges/marginal_prior.h"
#include "glissade/graph/pools.h"
#include "handles.h"
#include "problem.h"

namespace glissade::python {

namespace {

template <class T>
Out<const double> ViewOf(nb::handle self, const std::vector<double> T::*member,
                         std::size_t rows = 0) {
  const auto& values = nb::cast<const T&>(self).*member;
  const double* data = values.data();
  if (rows == 0) return View(data, {values.size()}, self);
  return View(data, {rows, values.size() / rows}, self);
}

MarginalizeOptions Options(MarginalForm form, InformationRoot root, double relative_cut,
                           const std::optional<EdgeArray>& drop) {
  MarginalizeOptions options;
  options.form = form;
  options.root = root;
  options.relative_cut = relative_cut;
  if (drop) options.drop = drop->handles;
  return options;
}

EdgeArray AddMarginalPrior(PyProblem& p, const VertexArray& vertices, const ArrayLike& x0,
                           const ArrayLike& r0, const ArrayLike& jacobian) {
  Problem& problem = p.write();
  std::vector<const VertexOps*> types;
  for (const AnyVertex& v : vertices.handles) {
    if (!problem.Contains(v)) Raise(problem.UnknownHandle(v));
    types.push_back(&problem.PoolOf(v.type)->ops());
  }
  const Doubles at(x0, "x0"), r(r0, "r0"), J(jacobian, "jacobian");
  auto prior = Unwrap(EdgeMarginalPrior::Create(types, {at.data(), at.size()}, {r.data(), r.size()},
                                                {J.data(), J.size()}));
  const auto edge = p.Seen(problem.AddEdge(std::move(prior), vertices.handles));
  return EdgeArray({AnyEdge(edge)});
}

}  // namespace

void BindMarginal(nb::module_& m, nb::class_<PyProblem>& problem) {
  nb::enum_<MarginalForm>(m, "MarginalForm", "How a marginal prior is computed.")
      .value("SQUARE_ROOT_QR", MarginalForm::kSquareRootQr)
      .value("SCHUR", MarginalForm::kSchur);
  nb::enum_<InformationRoot>(m, "InformationRoot", "Of the information that SCHUR leaves.")
      .value("CHOLESKY", InformationRoot::kCholesky)
      .value("EIGEN", InformationRoot::kEigen);
  nb::class_<MarginalReport>(m, "MarginalReport", "What happened, apart from the prior itself.")
      .def_ro("folded_edges", &MarginalReport::folded_edges)
      .def_ro("folded_priors", &MarginalReport::folded_priors)
      .def_ro("dropped_edges", &MarginalReport::dropped_edges)
      .def_ro("eliminated_landmarks", &MarginalReport::eliminated_landmarks)
      .def_ro("marginalized_dim", &MarginalReport::marginalized_dim)
      .def_ro("rank_deficiency", &MarginalReport::rank_deficiency)
      .def_prop_ro("deficient", [](const MarginalReport& r) { return VertexArray(r.deficient); })
      .def_ro("constant_cost", &MarginalReport::constant_cost);
  nb::class_<MarginalPrior>(
      m, "MarginalPrior",
      "r(x) = r0 + J (x boxminus x0), as numbers: arrays look into this object and keep it alive.")
      .def_prop_ro(
          "vertices", [](const MarginalPrior& p) { return VertexArray(p.vertices); },
          "What is left and touched; columns of J in this order")
      .def_prop_ro(
          "x0", [](nb::handle self) { return ViewOf(self, &MarginalPrior::x0); },
          "states, one after the other")
      .def_prop_ro(
          "r0", [](nb::handle self) { return ViewOf(self, &MarginalPrior::r0); }, "(rows,)")
      .def_prop_ro(
          "jacobian",
          [](nb::handle self) {
            const auto& p = nb::cast<const MarginalPrior&>(self);
            return View(p.jacobian.data(), {p.r0.size(), static_cast<std::size_t>(p.tangent_dim)},
                        self);
          },
          "(rows, tangent_dim)")
      .def_ro("tangent_dim", &MarginalPrior::tangent_dim)
      .def_ro("report", &MarginalPrior::report);
  nb::class_<Marginalization>(m, "Marginalization", "The prior in the problem.")
      .def_prop_ro(
          "prior",
          [](const Marginalization& x) {
            EdgeArray edges;
            if (AnyEdge(x.prior)) edges.handles.push_back(x.prior);
            return edges;
          },
          "Empty if nothing was connected to what went.")
      .def_ro("rows", &Marginalization::rows)
      .def_ro("tangent_dim", &Marginalization::tangent_dim)
      .def_ro("report", &Marginalization::report);

  problem
      .def_prop_rw(
          "first_estimates", [](PyProblem& p) { return p.read().first_estimates(); },
          [](PyProblem& p, FirstEstimates mode) { p.Seen(p.write().SetFirstEstimates(mode)); },
          "Where vertices under a marginal prior are linearized.")
      .def(
          "marginalize",
          [](PyProblem& p, const VertexArray& vertices, MarginalForm form, InformationRoot root,
             double relative_cut, const std::optional<EdgeArray>& drop) {
            const MarginalizeOptions options = Options(form, root, relative_cut, drop);
            return p.Seen(
                p.Work([&](Problem& x) { return x.Marginalize(vertices.handles, options); }));
          },
          nb::arg("vertices"), nb::kw_only(), nb::arg("form") = MarginalForm::kSquareRootQr,
          nb::arg("root") = InformationRoot::kCholesky, nb::arg("relative_cut") = 0.0,
          nb::arg("drop") = nb::none(),
          "Takes vertices and all edges that touch them out and puts a marginal prior in their "
          "place.\n\ndrop: edges that are lost instead of folded into the prior.")
      .def(
          "marginal_prior",
          [](PyProblem& p, const VertexArray& vertices, MarginalForm form, InformationRoot root,
             double relative_cut, const std::optional<EdgeArray>& drop) {
            const MarginalizeOptions options = Options(form, root, relative_cut, drop);
            return Unwrap(p.Work(
                [&](Problem& x) { return x.ComputeMarginalPrior(vertices.handles, options); }));
          },
          nb::arg("vertices"), nb::kw_only(), nb::arg("form") = MarginalForm::kSquareRootQr,
          nb::arg("root") = InformationRoot::kCholesky, nb::arg("relative_cut") = 0.0,
          nb::arg("drop") = nb::none(), "That prior alone; the problem is not changed.")
      .def("add_marginal_prior", &AddMarginalPrior, nb::arg("vertices"), nb::arg("x0"),
           nb::arg("r0"), nb::arg("jacobian"),
           "Adds r(x) = r0 + J (x boxminus x0) on any vertices.\n\nx0: their states, one after the "
           "other. r0: (rows,). jacobian: (rows, sum of tangent dimensions).");
}

}  // namespace glissade::python
