// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/covariance/last_solve.h"

#include <algorithm>

#include "covariance/reduced_factor.h"
#include "glissade/base/index.h"
#include "glissade/base/out_of_memory.h"

namespace glissade {

namespace {

using internal::Index;

Status Refuse(StatusCode code, const std::string& what, AnyVertex vertex = {}) {
  return {code, std::string("CovarianceOfLastSolve: ").append(what), vertex};
}

Status CheckStep(const SolverWorkspace& w) {
  constexpr double kMostDamping = 1e-6;
  if (!w.solved.is_there) {
    return Refuse(StatusCode::kInvalidArgument, "no solve has made a step");
  }
  const DampingTerm& damping = w.equations.damping();
  const bool invisible =
      damping.reduced_only ||
      (damping.identity ? damping.lambda == 0.0 : damping.lambda <= kMostDamping);
  if (!invisible) {
    return Refuse(StatusCode::kInvalidArgument,
                  "the last step was damped, lambda = " + std::to_string(damping.lambda));
  }
  const SchurForm form = w.equations.reduced_form();
  if (form == SchurForm::kDiagonalBlocks || form == SchurForm::kSomeBlocks) {
    return Refuse(StatusCode::kInvalidArgument, "the last step's solver did not store S");
  }
  return {};
}

Result<JointCovariance> Compute(const Graph& graph, SolverWorkspace* workspace,
                                std::span<const AnyVertex> vertices) {
  SolverWorkspace& w = *workspace;
  if (Status s = CheckStep(w); !s.ok()) return s;
  const SolvedSystem& solved = w.solved;
  JointCovariance out;
  std::vector<const PoseBlock*> blocks;
  out.offsets.push_back(0);
  for (const AnyVertex& vertex : vertices) {
    const auto found = std::find(solved.vertices.begin(), solved.vertices.end(), vertex);
    if (found == solved.vertices.end()) {
      return Refuse(StatusCode::kUnknownHandle,
                    "vertex " + ToString(vertex) + " was not in the reduced system", vertex);
    }
    if (out.IndexOf(vertex) >= 0) {
      return Refuse(StatusCode::kRepeatedVertex, "vertex " + ToString(vertex) + " is given twice",
                    vertex);
    }
    const auto k = static_cast<std::size_t>(found - solved.vertices.begin());
    const PoseBlock& block = w.structure.poses()[k];
    blocks.push_back(&block);
    out.vertices.push_back(vertex);
    out.offsets.push_back(out.offsets.back() + block.dim);
    out.state_offsets.push_back(out.states.size());
    out.states.insert(out.states.end(), solved.states.data() + solved.state_offsets[k],
                      solved.states.data() + solved.state_offsets[k + 1]);
  }
  internal::ReducedFactor factor;
  // As of CovarianceOptions.
  constexpr double kMinPivot = 1e-11;
  if (!factor.Factor(&w.equations, kMinPivot)) {
    return Refuse(StatusCode::kSingular,
                  std::to_string(factor.num_missing()) + " directions without information");
  }
  const int n = factor.size(), m = out.size();
  Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(n, m);
  for (std::size_t k = 0; k < blocks.size(); ++k) {
    factor.SelectPose(*blocks[k], solved.tangents, Y.data() + Index(out.offsets[k]) * Index(n));
  }
  factor.ForwardSolve(m, Y.data());
  const Eigen::MatrixXd covariance = Y.transpose() * Y;
  if (!covariance.allFinite()) return Refuse(StatusCode::kNotFinite, "not finite");
  out.values.assign(covariance.data(), covariance.data() + covariance.size());
  out.gauge = solved.gauge;
  out.references = solved.references;
  Result<Orbit> orbit = Orbit::Of(graph, solved.gauge.group);
  if (orbit.ok()) out.orbit = std::move(orbit).value();
  return out;
}

}  // namespace

Result<JointCovariance> CovarianceOfLastSolve(const Graph& graph, SolverWorkspace* workspace,
                                              std::span<const AnyVertex> vertices) {
  return internal::OrOutOfMemory([&] { return Compute(graph, workspace, vertices); });
}

}  // namespace glissade
