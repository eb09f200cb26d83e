// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/bridge/ceres.h"

#include <ceres/crs_matrix.h>
#include <ceres/manifold.h>
#include <ceres/ordered_groups.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "bridge/edge_cost.h"
#include "bridge/vertex_manifold.h"
#include "glissade/bridge/manifold.h"
#include "glissade/graph/pools.h"
#include "glissade/vertices/pose.h"

namespace glissade::bridge {

// ---- The exported problem
// ------------------------------------------------------------------------

struct CeresProblem::Impl {
  // The problem refers to all that stands before it and is destroyed first.
  Graph graph;  ///< the copy; compacted, so that dense indices have no gaps
  std::vector<AnyVertex> handles;
  std::vector<ExportedVertex> vertices;    ///< in the order of handles
  std::vector<double*> blocks;             ///< likewise, into values
  std::vector<double> values;              ///< all parameter blocks, one after the other
  std::vector<std::size_t> first_of_pool;  ///< index in vertices, by vertex pool
  std::vector<std::vector<ceres::ResidualBlockId>> residual_blocks;  ///< by edge pool, dense index
  ceres::Problem problem;
  Status status;

  /// Index in vertices, or -1.
  [[nodiscard]] std::ptrdiff_t IndexOf(AnyVertex vertex) const {
    const auto& pools = graph.vertex_pools();
    for (std::size_t p = 0; p < pools.size(); ++p) {
      if (pools[p]->ops().type != vertex.type) continue;
      const auto& slots = pools[p]->slots();
      if (!slots.Contains(vertex)) return -1;
      return static_cast<std::ptrdiff_t>(first_of_pool[p]) + slots.IndexOf(vertex.slot);
    }
    return -1;
  }
  [[nodiscard]] const ExportedVertex* Find(AnyVertex vertex) const {
    const std::ptrdiff_t index = IndexOf(vertex);
    return index < 0 ? nullptr : &vertices[static_cast<std::size_t>(index)];
  }

  void CopyVertices();
  void AddParameterBlocks();
  void AddResidualBlocks();
};

void CeresProblem::Impl::CopyVertices() {
  for (const auto& pool : graph.vertex_pools()) {
    first_of_pool.push_back(vertices.size());
    for (int k = 0; k < pool->size(); ++k) {
      ExportedVertex vertex;
      vertex.vertex = pool->HandleAt(k);
      vertex.ops = &pool->ops();
      vertex.fix = pool->fix(k);
      vertex.eliminated = pool->eliminated(k);
      const bool in_part = vertex.fix != Fix::kFree && vertex.fix != Fix::kWhole;
      for (std::size_t t = 0; in_part && t < graph.free_tangents().size(); ++t) {
        const FreeTangent& tangent = graph.free_tangents()[t];
        if (tangent.vertex != vertex.vertex) continue;
        vertex.held = tangent.held;
        if (vertex.fix != Fix::kPositionAndYaw) continue;
        vertex.in_chart = true;
        vertex.chart = tangent;
        std::copy_n(pool->Data(k), 3, vertex.chart_position);
      }
      const double* state = vertex.in_chart ? vertex.chart.dphi : pool->Data(k);
      values.insert(values.end(), state, state + vertex.block_size());
      handles.push_back(vertex.vertex);
      vertices.push_back(vertex);
    }
  }
}

namespace {
std::vector<int> NumbersOf(std::uint32_t held) {
  std::vector<int> numbers;
  for (int k = 0; k < 32; ++k) {
    if ((held >> k & 1u) != 0) numbers.push_back(k);
  }
  return numbers;
}
}  // namespace

void CeresProblem::Impl::AddParameterBlocks() {
  double* next = values.data();
  for (const ExportedVertex& vertex : vertices) {
    std::unique_ptr<ceres::Manifold> manifold;
    if (vertex.fix == Fix::kPosition) {
      manifold = std::make_unique<RotationOnlyManifold>();
    } else if (vertex.fix == Fix::kBiases) {
      manifold = std::make_unique<ceres::SubsetManifold>(9, std::vector<int>{3, 4, 5, 6, 7, 8});
    } else if (vertex.fix == Fix::kNumbers) {
      manifold =
          std::make_unique<ceres::SubsetManifold>(vertex.ops->ambient_dim, NumbersOf(vertex.held));
    } else if (!vertex.in_chart) {
      manifold = MakeManifold(*vertex.ops);
    }
    problem.AddParameterBlock(next, vertex.block_size(), manifold.release());
    if (vertex.fix == Fix::kWhole) problem.SetParameterBlockConstant(next);
    blocks.push_back(next);
    next += vertex.block_size();
  }
}

void CeresProblem::Impl::AddResidualBlocks() {
  for (const auto& pool : graph.edge_pools()) {
    auto& ids = residual_blocks.emplace_back();
    for (int edge = 0; edge < pool->size(); ++edge) {
      std::vector<const ExportedVertex*> vertices_of_edge;
      std::vector<double*> blocks_of_edge;
      for (int i = 0; i < pool->arity(edge); ++i) {
        const auto index = static_cast<std::size_t>(IndexOf(pool->VertexOf(edge, i)));
        vertices_of_edge.push_back(&vertices[index]);
        blocks_of_edge.push_back(blocks[index]);
      }
      auto cost = std::make_unique<EdgeCost>(*pool, edge, std::move(vertices_of_edge));
      const Loss& loss = pool->loss(edge);
      auto ceres_loss = loss.trivial() ? nullptr : std::make_unique<LossOfEdge>(loss);
      ids.push_back(problem.AddResidualBlock(cost.release(), ceres_loss.release(), blocks_of_edge));
    }
  }
}

CeresProblem Export(const Graph& graph) {
  auto impl = std::make_unique<CeresProblem::Impl>();
  Result<Graph> copy = graph.Clone();
  impl->status = copy.status();
  impl->graph = std::move(copy).value();
  impl->graph.Compact();
  impl->CopyVertices();
  impl->AddParameterBlocks();
  impl->AddResidualBlocks();
  return CeresProblem(std::move(impl));
}

CeresProblem::CeresProblem(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
CeresProblem::CeresProblem(CeresProblem&&) noexcept = default;
CeresProblem& CeresProblem::operator=(CeresProblem&&) noexcept = default;
CeresProblem::~CeresProblem() = default;

const Status& CeresProblem::status() const {
  return impl_->status;
}
ceres::Problem& CeresProblem::problem() {
  return impl_->problem;
}
const ceres::Problem& CeresProblem::problem() const {
  return impl_->problem;
}
std::span<const AnyVertex> CeresProblem::vertices() const {
  return impl_->handles;
}

double* CeresProblem::ParameterBlock(AnyVertex vertex) const {
  const std::ptrdiff_t index = impl_->IndexOf(vertex);
  return index < 0 ? nullptr : impl_->blocks[static_cast<std::size_t>(index)];
}

ceres::ResidualBlockId CeresProblem::ResidualBlock(AnyEdge edge) const {
  if (!impl_->graph.Contains(edge)) return nullptr;
  const auto& pools = impl_->graph.edge_pools();
  for (std::size_t p = 0; p < pools.size(); ++p) {
    if (pools[p]->type() != edge.type) continue;
    return impl_
        ->residual_blocks[p][static_cast<std::size_t>(pools[p]->slots().IndexOf(edge.slot))];
  }
  return nullptr;
}

int CeresProblem::FreeDim(AnyVertex vertex) const {
  const ExportedVertex* exported = impl_->Find(vertex);
  return exported == nullptr ? 0 : exported->free_dim();
}

std::vector<double> CeresProblem::State(AnyVertex vertex) const {
  const std::ptrdiff_t index = impl_->IndexOf(vertex);
  if (index < 0) return {};
  const ExportedVertex& exported = impl_->vertices[static_cast<std::size_t>(index)];
  std::vector<double> state(static_cast<std::size_t>(exported.ops->ambient_dim));
  exported.ToState(impl_->blocks[static_cast<std::size_t>(index)], state.data());
  return state;
}

std::shared_ptr<ceres::ParameterBlockOrdering> CeresProblem::MakeOrdering() const {
  auto ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  bool any_eliminated = false;
  for (std::size_t k = 0; k < impl_->vertices.size(); ++k) {
    const ExportedVertex& vertex = impl_->vertices[k];
    const bool eliminated = vertex.eliminated && vertex.fix != Fix::kWhole;
    any_eliminated = any_eliminated || eliminated;
    ordering->AddElementToGroup(impl_->blocks[k], eliminated ? 0 : 1);
  }
  return any_eliminated ? ordering : nullptr;
}

// ---- Back, and the convenience
// ---------------------------------------------------------------------

Status ReadBack(const CeresProblem& exported, Graph* graph) {
  if (graph == nullptr) return {StatusCode::kInvalidArgument, "ReadBack: graph is null"};
  if (!exported.status().ok()) return exported.status();
  for (const AnyVertex& vertex : exported.vertices()) {
    if (!graph->Contains(vertex)) {
      return {StatusCode::kUnknownHandle, "ReadBack: " + ToString(vertex) + " was removed since",
              vertex};
    }
    for (const double x : exported.State(vertex)) {
      if (!std::isfinite(x)) {
        return {StatusCode::kNotFinite, "ReadBack: state of " + ToString(vertex) + " is not finite",
                vertex};
      }
    }
  }
  // Through a snapshot: it carries gauge charts, and restoring it anchors anew those that are not
  // the exported ones.
  Snapshot snapshot = graph->GetSnapshot();
  std::erase_if(snapshot.free_tangents, [&](const FreeTangent& tangent) {
    return exported.impl_->Find(tangent.vertex) != nullptr;
  });
  double* to = snapshot.states.data();
  for (const AnyVertex& vertex : snapshot.vertices) {
    const int ambient_dim = graph->PoolOf(vertex.type)->ops().ambient_dim;
    const std::ptrdiff_t index = exported.impl_->IndexOf(vertex);
    if (index >= 0) {
      const auto k = static_cast<std::size_t>(index);
      const ExportedVertex& from = exported.impl_->vertices[k];
      from.ToState(exported.impl_->blocks[k], to);
      if (from.in_chart) {
        FreeTangent tangent = from.ChartAt(exported.impl_->blocks[k]);
        tangent.UpdateBasis(to);
        snapshot.free_tangents.push_back(tangent);
      }
    }
    to += ambient_dim;
  }
  return graph->RestoreSnapshot(snapshot);
}

ceres::Solver::Summary SolveWithCeres(Graph* graph, ceres::Solver::Options options) {
  ceres::Solver::Summary summary;
  if (graph == nullptr) {
    summary.message = "SolveWithCeres: graph is null";
    return summary;
  }
  CeresProblem exported = Export(*graph);
  if (!exported.status().ok()) {
    summary.message = exported.status().message();
    return summary;
  }
  if (options.linear_solver_ordering == nullptr) {
    options.linear_solver_ordering = exported.MakeOrdering();
  }
  ceres::Solve(options, &exported.problem(), &summary);
  if (!summary.IsSolutionUsable()) return summary;
  if (const Status status = ReadBack(exported, graph); !status.ok()) {
    summary.termination_type = ceres::FAILURE;
    summary.message = status.message();
  }
  return summary;
}

// ---- Evaluation
// ------------------------------------------------------------------------------------

Result<CeresLinearization> Linearize(const CeresProblem& exported,
                                     std::span<const AnyVertex> order) {
  CeresLinearization out;
  ceres::Problem::EvaluateOptions options;
  out.offsets.push_back(0);
  for (const AnyVertex& vertex : order) {
    double* block = exported.ParameterBlock(vertex);
    if (block == nullptr) {
      return Status(StatusCode::kUnknownHandle,
                    "Linearize: " + ToString(vertex) + " was not exported", vertex);
    }
    const int dim = exported.FreeDim(vertex);
    if (dim == 0) {
      return Status(StatusCode::kInvalidArgument, "Linearize: " + ToString(vertex) + " is fixed",
                    vertex);
    }
    options.parameter_blocks.push_back(block);
    out.offsets.push_back(out.offsets.back() + dim);
  }
  if (order.empty()) {  // to Ceres this would mean all blocks
    return Status(StatusCode::kInvalidArgument, "Linearize: no vertices given");
  }

  std::vector<double> residuals, gradient;
  ceres::CRSMatrix jacobian;
  auto& problem =
      const_cast<ceres::Problem&>(exported.problem());  // Evaluate is not const in Ceres
  if (!problem.Evaluate(options, &out.cost, &residuals, &gradient, &jacobian)) {
    return Status(StatusCode::kEvaluationFailed, "Linearize: an edge has no value");
  }
  out.residuals = Eigen::Map<const Eigen::VectorXd>(residuals.data(),
                                                    static_cast<Eigen::Index>(residuals.size()));
  out.gradient = Eigen::Map<const Eigen::VectorXd>(gradient.data(),
                                                   static_cast<Eigen::Index>(gradient.size()));
  out.jacobian = Eigen::Map<const Eigen::SparseMatrix<double, Eigen::RowMajor>>(
      jacobian.num_rows, jacobian.num_cols, static_cast<Eigen::Index>(jacobian.values.size()),
      jacobian.rows.data(), jacobian.cols.data(), jacobian.values.data());
  return out;
}

}  // namespace glissade::bridge
