// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/problem/problem.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "glissade/base/index.h"
#include "glissade/base/out_of_memory.h"
#include "glissade/base/validate.h"
#include "glissade/covariance/last_solve.h"
#include "glissade/graph/pools.h"
#include "glissade/minimizer/minimizer.h"

namespace glissade {

namespace {
using internal::Index;
}  // namespace

/// What a Problem keeps between solves, and where the step API stands.
class Workspace {
 public:
  SolverWorkspace solver;
  /// For null-space checks after a solve under a gauge, whose H lacks the gauge's own columns.
  SolverWorkspace check;
  MarginalWorkspace marginal;
  bool linearized = false;
  bool solved = false;
  bool updated = false;

  /// H, b, dx and the states to roll back to are numbered as the graph was: they are void once its
  /// structure has changed.
  [[nodiscard]] bool Linearized(const Graph& graph) const {
    return linearized && solver.structure.IsCurrent(graph);
  }
};

namespace {

/// Runs a step on a workspace; after one that throws, the workspace starts from nothing.
template <class F>
Status Guarded(SolverWorkspace* w, F&& step) {
  try {
    const Status status = internal::OrOutOfMemory(step);
    if (status.code() == StatusCode::kOutOfMemory) w->Discard();
    return status;
  } catch (...) {  // of user code
    w->Discard();
    throw;
  }
}

}  // namespace

Problem::Problem() : workspace_(std::make_unique<Workspace>()) {}
Problem::Problem(Graph graph)
    : Graph(std::move(graph)), workspace_(std::make_unique<Workspace>()) {}
Problem::~Problem() = default;
Problem::Problem(Problem&& other) noexcept
    : Graph(std::move(other)), workspace_(std::move(other.workspace_)) {}
Problem& Problem::operator=(Problem&& other) noexcept {
  Graph::operator=(std::move(other));
  workspace_ = std::move(other.workspace_);
  return *this;
}

const SolveSummary& Problem::Solve(const SolveOptions& options) {
  // Out of a callback's reach for the time of the solve: it might move the Problem, or solve it.
  struct Lent {
    std::unique_ptr<Workspace>& home;
    std::unique_ptr<Workspace> workspace;
    ~Lent() { home = std::move(workspace); }
  } lent{workspace_, std::move(workspace_)};
  if (lent.workspace == nullptr) lent.workspace = std::make_unique<Workspace>();  // moved from
  Workspace& w = *lent.workspace;
  w.linearized = w.solved = w.updated = false;
  return glissade::Solve(this, &w.solver, options);
}

Result<MemoryEstimate> Problem::EstimateMemory(const SolveOptions& options) {
  if (Status status = options.Validate(); !status.ok()) return status;
  if (workspace_ == nullptr) workspace_ = std::make_unique<Workspace>();
  SolverWorkspace& w = workspace_->solver;
  SolveOptions unlimited = options;
  unlimited.memory_limit = 0;
  MemoryEstimate memory;
  const Status status = Guarded(&w, [&]() -> Status {
    w.Restore();
    if (Status s = AnalyzeForSolve(this, &w, unlimited); !s.ok()) return s;
    memory = glissade::EstimateMemory(*this, w.structure, &w.equations, w.sparse_cholesky,
                                      w.choice.type, options.num_threads);
    return {};
  });
  if (!status.ok()) return status;
  return memory;
}

Result<NullspaceReport> Problem::CheckNullspace(const NullspaceOptions& options) {
  if (workspace_ == nullptr) workspace_ = std::make_unique<Workspace>();
  SolverWorkspace& last = workspace_->solver;
  if (last.structure.IsCurrent(*this) && last.equations.IsLinearized(last.structure)) {
    return glissade::CheckNullspace(*this, last.structure, &last.equations, options);
  }
  SolverWorkspace& w = workspace_->check;
  const Status status = Guarded(&w, [&] {
    w.Restore();
    Status s = w.structure.Analyze(this, {.allow_duplicate_observations = true});
    double cost = 0.0;
    if (s.ok()) s = w.equations.Linearize(w.structure, this, &w.threads, &cost);
    return s;
  });
  if (!status.ok()) return status;
  return glissade::CheckNullspace(*this, w.structure, &w.equations, options);
}

Result<Marginalization> Problem::Marginalize(std::span<const AnyVertex> vertices,
                                             const MarginalizeOptions& options) {
  if (workspace_ == nullptr) workspace_ = std::make_unique<Workspace>();  // moved from
  return glissade::Marginalize(this, vertices, options, &workspace_->marginal);
}

Status Problem::MakeHessian() {
  if (workspace_ == nullptr) workspace_ = std::make_unique<Workspace>();
  Workspace& w = *workspace_;
  w.linearized = w.solved = w.updated = w.solver.solved.is_there = false;
  return Guarded(&w.solver, [&] {
    w.solver.Restore();
    // Studying a graph with a doubled observation is fine; only Solve insists. Groups of
    // landmarks keep no W blocks, which are to be looked at here.
    Status status = w.solver.structure.Analyze(
        this, {.allow_duplicate_observations = true, .group_landmarks = false});
    if (!status.ok()) return status;
    double cost = 0.0;
    status = w.solver.equations.Linearize(w.solver.structure, this, &w.solver.threads, &cost);
    w.linearized = status.ok();
    return status;
  });
}

Status Problem::SolveLinearSystem(double lambda, const SolveOptions& options) {
  if (workspace_ == nullptr || !workspace_->Linearized(*this)) {
    return {StatusCode::kInvalidArgument, "SolveLinearSystem: call MakeHessian() first"};
  }
  if (Status status = options.Validate(); !status.ok()) return status;
  if (!(lambda >= 0.0) || !std::isfinite(lambda)) {
    return {StatusCode::kInvalidArgument, "SolveLinearSystem: lambda must not be negative"};
  }
  SolverWorkspace& w = workspace_->solver;
  workspace_->solved = false;
  const DampingTerm damping = MakeDamping(options, lambda);
  return Guarded(&w, [&]() -> Status {
    if (Status status = ChooseSolver(*this, &w, options, &w.choice); !status.ok()) return status;
    LinearSolver* const solver = w.Solver(options, w.choice.type);
    const LentThreads lent(solver, &w.threads);
    const SolverWorkspace::Wish wish = w.AskWhatToStore(solver);
    StepFailure failure =
        w.equations.Eliminate(w.structure, *this, damping, wish.form, &w.threads, wish.blocks);
    if (!failure.ok()) return failure;
    LinearSolverResult result;
    failure =
        w.equations.Solve(w.structure, *this, solver,
                          MakeRequest(options, options.pcg.forcing, 1.0), &w.threads, &result);
    if (!failure.ok()) return failure;
    const std::vector<double>& step = w.equations.step();
    if (!internal::AllFinite(step.data(), static_cast<int>(step.size()))) {
      return {StatusCode::kNotFinite, "SolveLinearSystem: the step is not finite"};
    }
    workspace_->solved = true;
    return {};
  });
}

Status Problem::UpdateStates() {
  if (workspace_ == nullptr || !workspace_->solved || !workspace_->Linearized(*this)) {
    return {StatusCode::kInvalidArgument, "UpdateStates: call SolveLinearSystem() first"};
  }
  SaveStates();
  ApplyStep(workspace_->solver.structure, workspace_->solver.equations.step(), this);
  for (const AnyVertex& vertex : FreeVertices()) {
    const VertexPoolBase& pool = *PoolOf(vertex.type);
    const Status status = pool.ops().validate(pool.Data(pool.slots().IndexOf(vertex.slot)));
    if (status.ok()) continue;
    RestoreStates();
    return {status.code(),
            "UpdateStates: the step leads out of what can be a state: " + status.message(), vertex};
  }
  workspace_->updated = true;
  workspace_->solved = false;  // a step is applied once
  return {};
}

Status Problem::RollbackStates() {
  if (workspace_ == nullptr || !workspace_->updated || !workspace_->Linearized(*this)) {
    return {StatusCode::kInvalidArgument, "RollbackStates: there is no update to take back"};
  }
  RestoreStates();
  workspace_->updated = false;
  workspace_->solved = true;
  return {};
}

std::vector<AnyVertex> Problem::FreeVertices() const {
  std::vector<AnyVertex> vertices;
  if (workspace_ == nullptr || !workspace_->Linearized(*this)) return vertices;
  const Structure& structure = workspace_->solver.structure;
  const auto add = [&](const auto& block) {
    vertices.push_back(vertex_pools()[Index(block.pool)]->HandleAt(block.index));
  };
  for (const PoseBlock& pose : structure.poses())
    add(pose);
  for (const LandmarkBlock& landmark : structure.landmarks())
    add(landmark);
  return vertices;
}

std::vector<int> Problem::FreeOffsets() const {
  std::vector<int> offsets{0};
  if (workspace_ == nullptr || !workspace_->Linearized(*this)) return offsets;
  const Structure& structure = workspace_->solver.structure;
  for (const PoseBlock& pose : structure.poses()) {
    const int dim =
        pose.free_tangent < 0 ? pose.dim : free_tangents()[Index(pose.free_tangent)].free_dim;
    offsets.push_back(offsets.back() + dim);
  }
  for (const LandmarkBlock& landmark : structure.landmarks()) {
    offsets.push_back(offsets.back() + landmark.dim);
  }
  return offsets;
}

int Problem::DenseSize() const {
  return FreeOffsets().back();
}

void Problem::FillHessian(double* H) const {
  const Structure& structure = workspace_->solver.structure;
  const glissade::Hessian hessian = workspace_->solver.equations.GetHessian(structure);
  const std::vector<int> offsets = FreeOffsets();
  const std::size_t n = Index(offsets.back());
  std::fill_n(H, n * n, 0.0);
  // The first rows and cols of a block: free coordinates are its first.
  const auto set = [&](std::int32_t row, std::int32_t col, const DenseBlock& block) {
    for (int r = 0; r < offsets[Index(row + 1)] - offsets[Index(row)]; ++r) {
      for (int c = 0; c < offsets[Index(col + 1)] - offsets[Index(col)]; ++c) {
        const std::size_t i = Index(offsets[Index(row)] + r), j = Index(offsets[Index(col)] + c);
        H[i * n + j] = H[j * n + i] = block(r, c);
      }
    }
  };
  for (std::size_t k = 0; k < hessian.num_pairs(); ++k) {
    const glissade::Hessian::PosePair pair = hessian.Pair(k);
    set(pair.row, pair.col, pair.H);
  }
  for (std::size_t l = 0; l < hessian.num_landmarks(); ++l) {
    const glissade::Hessian::LandmarkPart landmark = hessian.Landmark(l);
    const auto index = static_cast<std::int32_t>(structure.poses().size() + l);
    set(index, index, landmark.H());
    for (int s = 0; s < landmark.num_slots(); ++s)
      set(landmark.pose(s), index, landmark.W(s));
  }
}

namespace {

/// Picks the free coordinates out of a vector over the padded ones.
void PickFree(const Structure& structure, const std::vector<int>& offsets, const double* pose_part,
              const double* landmark_part, double* out) {
  for (std::size_t p = 0; p < structure.poses().size(); ++p) {
    const PoseBlock& pose = structure.poses()[p];
    for (int k = offsets[p]; k < offsets[p + 1]; ++k)
      *out++ = pose_part[pose.offset + k - offsets[p]];
  }
  std::copy_n(landmark_part, structure.num_landmark_scalars(), out);
}

}  // namespace

void Problem::FillRhs(double* b) const {
  const SolverWorkspace& w = workspace_->solver;
  PickFree(w.structure, FreeOffsets(), w.equations.b().data(),
           w.equations.b().data() + w.structure.num_pose_scalars(), b);
}

void Problem::FillStep(double* dx) const {
  const SolverWorkspace& w = workspace_->solver;
  if (!workspace_->solved && !workspace_->updated) {
    std::fill_n(dx, DenseSize(), 0.0);  // what a failed solve left is no step
    return;
  }
  PickFree(w.structure, FreeOffsets(), w.equations.step().data(),
           w.equations.step().data() + w.structure.num_pose_scalars(), dx);
}

Status Problem::MoveToGauge(const Gauge& gauge, const MoveOptions& options) {
  return glissade::MoveToGauge(this, gauge, options);
}

Result<JointCovariance> Problem::ComputeCovariance(std::span<const AnyVertex> vertices,
                                                   const CovarianceOptions& options) {
  return glissade::ComputeCovariance(this, vertices, options);
}

Result<JointCovariance> Problem::CovarianceOfLastSolve(std::span<const AnyVertex> vertices) {
  if (workspace_ == nullptr) workspace_ = std::make_unique<Workspace>();  // moved from
  return glissade::CovarianceOfLastSolve(*this, &workspace_->solver, vertices);
}

Result<Marginalization> Problem::Marginalize(std::initializer_list<AnyVertex> vertices,
                                             const MarginalizeOptions& options) {
  return Marginalize(std::span<const AnyVertex>(vertices.begin(), vertices.size()), options);
}

Result<MarginalPrior> Problem::ComputeMarginalPrior(std::span<const AnyVertex> vertices,
                                                    const MarginalizeOptions& options) const {
  return glissade::ComputeMarginalPrior(*this, vertices, options);
}

Result<Problem> Problem::Clone() const {
  Result<Graph> copy = Graph::Clone();
  if (!copy.ok()) return copy.status();
  return Problem(std::move(copy).value());
}

}  // namespace glissade
