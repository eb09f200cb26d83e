// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <type_traits>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/edges/diagnostics.h"
#include "glissade/edges/edge_ops.h"
#include "glissade/edges/evaluate_in_packs.h"
#include "glissade/graph/edge_options.h"
#include "glissade/graph/first_estimates.h"
#include "glissade/graph/fix.h"
#include "glissade/graph/hold.h"
#include "glissade/graph/snapshot.h"
#include "glissade/vertices/diagnostics.h"

namespace glissade {

// How a graph keeps what it is given: graph/pools.h, for the modules below.
class DynamicEdge;
class EdgePool;
class EdgePoolBase;
class VertexPoolBase;
template <VertexType V>
class VertexPool;
struct PooledVertex;

/// Observations that do not fit: what GetOutlierEdges() looks for.
struct OutlierOptions {
  /// An edge is an outlier where r' Omega r exceeds this. Default: 99 % of chi2 with 2 DoF.
  double max_chi2 = 9.21;
  /// ... or where it observes a point at less than this depth [m] (behind the camera: < 0).
  double min_depth = 0.0;
};

/// What RemoveVertex() does about a marginal prior on the vertex.
enum class PriorOnVertex : std::uint8_t {
  kRefuse,  ///< nothing: it refuses (kUnderPrior)
  kRemove,  ///< the prior goes with the vertex, and all that it knew of others with it
};

/// The factor graph: vertices and edges by type in contiguous pools, weights, losses, and what is
/// held fixed. It knows nothing of linear algebra; Problem adds solving.
///
/// Every call that changes something validates first and changes nothing on failure. Handles of
/// removed things and of other graphs are refused. The first call that was refused is remembered
/// (first_refusal()). Vertices and edges keep their insertion order. Not thread-safe for writers;
/// instances are independent of each other.
class Graph {
 public:
  Graph();
  /// What was moved from is empty, and can be used again.
  Graph(Graph&& other) noexcept;
  Graph& operator=(Graph&& other) noexcept;
  ~Graph();
  Graph(const Graph&) = delete;
  Graph& operator=(const Graph&) = delete;

  // --- Building -----------------------------------------------------------------------------
  /// V: a VertexType.
  template <class V>
  Result<VertexHandle<V>> AddVertex(const V& value);
  /// All or nothing.
  template <VertexType V>
  Result<std::vector<VertexHandle<V>>> AddVertices(std::span<const V> values);

  /// Refuses: dead handles and those of other graphs, one vertex twice, two eliminated vertices, a
  /// measurement that its type declares invalid, information that is not finite or not positive
  /// semi-definite.
  /// E: an EdgeType. Not a constraint, so that the compiler says in one line what is wrong with an
  /// edge or its handles (edges/diagnostics.h).
  template <class E, class Unit = internal::UnitOf<E>>
  requires(!std::is_constructible_v<std::unique_ptr<DynamicEdge>, E>) Result<EdgeHandle<E>> AddEdge(
      const E& edge, const std::type_identity_t<EdgeVertices<E>>& vertices,
      const EdgeOptions<E>& options = {});
  /// All or nothing; the options hold for each.
  template <EdgeType E, class Unit = internal::UnitOf<E>>
  Result<std::vector<EdgeHandle<E>>> AddEdges(std::span<const E> edges,
                                              std::span<const EdgeVertexHandles<E>> vertices,
                                              const EdgeOptions<E>& options = {});
  /// A dynamic edge; a robust loss is refused for one with a constant Hessian.
  Result<EdgeHandle<DynamicEdge>> AddEdge(std::unique_ptr<DynamicEdge> edge,
                                          std::span<const AnyVertex> vertices, Loss loss = {});

  /// Removes a vertex and the edges connected to it. Refuses a vertex under a marginal prior
  /// (kUnderPrior; names vertex and prior): the prior would go as a whole, and with it what it says
  /// about other vertices. Marginalize() (marginal/marginalize.h) takes a vertex out and keeps
  /// that.
  Status RemoveVertex(AnyVertex vertex, PriorOnVertex prior = PriorOnVertex::kRefuse);
  Status RemoveEdge(AnyEdge edge);

  // --- Refused calls ------------------------------------------------------------------------
  /// The first call that was refused: one that adds, removes, sets, fixes, weighs, restores,
  /// marginalizes or moves. Its status; ok if there was none. The graph is then not what its caller
  /// has asked for, and Solve fails with this status, so that an unchecked call cannot vanish.
  /// Clones and moved graphs take it along.
  [[nodiscard]] const Status& first_refusal() const { return first_refusal_; }
  /// Forgets it, and returns it: the caller has seen it and means to go on with the graph as it is.
  Status AcknowledgeRefusal();

  // --- Values -------------------------------------------------------------------------------
  [[nodiscard]] bool Contains(AnyVertex vertex) const;
  [[nodiscard]] bool Contains(AnyEdge edge) const;
  /// Null for a dead handle. Valid until the graph is changed.
  template <VertexType V>
  [[nodiscard]] const V* Find(VertexHandle<V> vertex) const;
  template <EdgeType E>
  [[nodiscard]] const E* Find(EdgeHandle<E> edge) const;
  /// The value; a default-constructed one for a dead handle (use Find where that can happen).
  template <VertexType V>
  [[nodiscard]] const V& Get(VertexHandle<V> vertex) const;
  template <VertexType V>
  [[nodiscard]] const V& Get(const Result<VertexHandle<V>>& vertex) const {
    return Get(vertex.value());
  }
  /// Replaces the value. For a pose whose yaw is held, the chart is anchored anew at it.
  template <VertexType V>
  Status Set(VertexHandle<V> vertex, const V& value);
  template <VertexType V>
  Status Set(const Result<VertexHandle<V>>& vertex, const V& value) {
    return Set(vertex.value(), value);
  }

  // --- What is held, what is eliminated -----------------------------------------------------
  /// Holds a vertex, or part of a pose, at its present value; Fix::kFree lets it go.
  Status SetFixed(AnyVertex vertex, Fix fix = Fix::kWhole);
  /// Holds some numbers of an additive vertex (VertexVector, VertexCameraBal, ...) of up to 9 of
  /// them: the principal point of intrinsics, say. Bit k of `held` is number k; none of them is
  /// Fix::kFree, all are Fix::kWhole, some Fix::kNumbers. Refuses what is eliminated: a landmark is
  /// held as a whole.
  Status SetFixedNumbers(AnyVertex vertex, std::uint32_t held);
  /// Bit k for number k; 0 unless the vertex is held in part (Fix::kNumbers).
  [[nodiscard]] std::uint32_t FixedNumbers(AnyVertex vertex) const;
  /// kFree for a dead handle.
  [[nodiscard]] Fix GetFixed(AnyVertex vertex) const;
  /// Whether a vertex is eliminated by the Schur complement; default: what its type says. Only
  /// vertices with a tangent of at most 4 dimensions can be.
  Status SetEliminated(AnyVertex vertex, bool eliminated);

  // --- First estimates (first_estimates.h) ---------------------------------------------------
  /// Where solves and marginalizations of this graph linearize.
  [[nodiscard]] FirstEstimates first_estimates() const { return first_estimates_; }
  /// Refuses what is no FirstEstimates.
  Status SetFirstEstimates(FirstEstimates mode);
  /// Whether a marginal prior touches the vertex: it then has an x_lin, its value when a prior
  /// first touched it, and keeps it until no prior touches it any more.
  [[nodiscard]] bool HasFirstEstimate(AnyVertex vertex) const;
  /// x_lin, or the present value of a vertex without one: ambient coordinates. Empty for a dead
  /// handle. Valid until the graph is changed.
  [[nodiscard]] std::span<const double> LinearizationPoint(AnyVertex vertex) const;
  /// Replaces x_lin: for whoever moves a solution with its priors, x0 of which must move along.
  /// Refuses what the vertex's type refuses as a state.
  Status SetFirstEstimate(AnyVertex vertex, std::span<const double> x_lin);

  // --- Weights ------------------------------------------------------------------------------
  template <EdgeType E>
  Status SetInformation(EdgeHandle<E> edge, const SquareMatrix<E::kResidualDim>& information);
  template <EdgeType E>
  Status SetSqrtInformation(EdgeHandle<E> edge, const SquareMatrix<E::kResidualDim>& sqrt);
  Status SetLoss(AnyEdge edge, const Loss& loss);

  // --- Queries ------------------------------------------------------------------------------
  [[nodiscard]] int NumVertices() const;
  [[nodiscard]] int NumEdges() const;
  template <VertexType V>
  [[nodiscard]] int NumVertices() const;
  template <EdgeType E>
  [[nodiscard]] int NumEdges() const;
  /// In insertion order within a type, types in order of first use.
  [[nodiscard]] std::vector<AnyVertex> Vertices() const;
  [[nodiscard]] std::vector<AnyEdge> Edges() const;
  /// In the order of the edge's type; kUnknownHandle for a dead handle.
  [[nodiscard]] Result<std::vector<AnyVertex>> VerticesOf(AnyEdge edge) const;
  /// In the order of Edges(); kUnknownHandle for a dead handle. Both take as many steps as the
  /// vertex has edges, or had since the last solve.
  [[nodiscard]] Result<std::vector<AnyEdge>> EdgesOf(AnyVertex vertex) const;
  [[nodiscard]] Result<int> NumEdgesOf(AnyVertex vertex) const;
  /// f(VertexHandle<V>, const V&) for all, in insertion order.
  template <VertexType V, class F>
  void ForEachVertex(F&& f) const;
  /// f(EdgeHandle<E>, const E&) for all, in insertion order; or, where f takes a third argument,
  /// f(EdgeHandle<E>, const E&, const EdgeVertexHandles<E>&): a tuple of the edge's vertices.
  template <EdgeType E, class F>
  void ForEachEdge(F&& f) const;

  /// s = r' Omega r of one edge (no 1/2, no loss).
  [[nodiscard]] Result<double> Chi2(AnyEdge edge) const;
  /// Sum of Chi2 over all edges; NaN-free: an edge without a value makes it a status.
  [[nodiscard]] Result<double> Chi2() const;
  /// 1/2 sum rho(Chi2): what Solve minimizes.
  [[nodiscard]] Result<double> Cost() const;
  /// Depth of the observed point in the observing camera [m], for edges that have one.
  [[nodiscard]] Result<double> DepthOf(AnyEdge edge) const;
  /// Observations over the limit, behind the camera, or without a value, in insertion order.
  [[nodiscard]] std::vector<AnyEdge> GetOutlierEdges(const OutlierOptions& options = {}) const;

  // --- Copies -------------------------------------------------------------------------------
  /// A deep copy. Handles that this graph has given out so far are valid in the copy; what is added
  /// later, to either, is unknown to the other. Fails where the Clone() of a dynamic edge returns
  /// null, and names the edge.
  [[nodiscard]] Result<Graph> Clone() const;
  /// All vertex values (and gauge charts), to come back to.
  [[nodiscard]] Snapshot GetSnapshot() const;
  /// Back to a snapshot of this graph or of its original. Refused: one that does not have each
  /// vertex of the graph once (kInvalidArgument), states, linearization points or charts that are
  /// none. Charts that fit their restored poses are restored, others are anchored anew.
  Status RestoreSnapshot(const Snapshot& snapshot);

  // --- For the modules below ----------------------------------------------------------------
  /// Remembers the status of a call that was refused, if it is the first; returns it.
  Status Refused(Status status);
  /// Why a handle is unknown: null, removed, or of another graph.
  [[nodiscard]] Status UnknownHandle(AnyVertex vertex) const;
  [[nodiscard]] Status UnknownHandle(AnyEdge edge) const;
  /// What Solve asks first: first_refusal(), then kNothingToSolve for a graph without edges.
  [[nodiscard]] Status ReadyToSolve() const;
  using VertexPools = std::vector<std::unique_ptr<VertexPoolBase>>;
  using EdgePools = std::vector<std::unique_ptr<EdgePoolBase>>;
  [[nodiscard]] const VertexPools& vertex_pools() const { return vertex_pools_; }
  [[nodiscard]] const EdgePools& edge_pools() const { return edge_pools_; }
  [[nodiscard]] const std::vector<FreeTangent>& free_tangents() const { return free_tangents_; }
  [[nodiscard]] std::vector<FreeTangent>& free_tangents() { return free_tangents_; }
  /// Changes with every change of structure: vertices, edges, what is fixed or eliminated, the
  /// kind of a loss. Counts for one identity().
  [[nodiscard]] std::uint64_t structure_version() const { return structure_version_; }
  /// Changes with every other change of a weight or loss.
  [[nodiscard]] std::uint64_t weights_version() const { return weights_version_; }
  /// Whose versions these are: another number for every graph of this process, taken along when the
  /// graph is moved. A clone has its own.
  [[nodiscard]] std::uint64_t identity() const { return identity_; }
  /// Closes the gaps that removals left, and sorts the pools by their oldest element; dense indices
  /// change, handles and the order within a type do not. Types then stand as if what was removed
  /// had never been there.
  void Compact();
  /// Keeps all states / goes back to them, without allocating once sized.
  void SaveStates();
  void RestoreStates();
  /// Holds more than SetFixed asked for, for the time of one solve (a gauge), by holds of vertices
  /// or by an edge; EndHold(), or moving the graph, undoes it. Nothing of it counts as a change of
  /// structure: as long as the same is held again and again, one analysis serves. identity() is
  /// another one meanwhile. On failure (of AddEdge) nothing is held.
  Status BeginHold(std::span<const FreeTangent> holds, std::unique_ptr<DynamicEdge> edge = nullptr,
                   std::span<const AnyVertex> edge_vertices = {});
  void EndHold() noexcept;
  [[nodiscard]] bool IsHolding() const { return hold_.active; }
  /// Plans, linearizations and views of constant Hessians that were made of this graph are void.
  void StructureChanged() { ++structure_version_; }
  /// Where a gauge's anchor was when it was first named; Set() and removal forget it.
  [[nodiscard]] std::vector<GaugeReference>& gauge_references() { return gauge_references_; }
  [[nodiscard]] const std::vector<GaugeReference>& gauge_references() const {
    return gauge_references_;
  }
  [[nodiscard]] VertexPoolBase* PoolOf(const TypeInfo* type) const;
  [[nodiscard]] EdgePoolBase* EdgePoolOf(const TypeInfo* type) const;
  /// Null (or as null) where there is none.
  template <VertexType V>
  VertexPool<V> Pool() const {
    return PoolOf(&kTypeInfo<V>);
  }
  template <EdgeType E>
  EdgePool* Pool() const {
    return TypedEdgePoolOf(&kTypeInfo<E>);
  }
  [[nodiscard]] EdgePool* TypedEdgePoolOf(const TypeInfo* type) const;

 private:
  struct VertexSite {
    VertexPoolBase* pool = nullptr;
    int index = -1;
  };
  struct EdgeSite {
    EdgePoolBase* pool = nullptr;
    int index = -1;
  };
  [[nodiscard]] VertexSite Locate(AnyVertex vertex) const;
  [[nodiscard]] EdgeSite Locate(AnyEdge edge) const;
  [[nodiscard]] Status CheckEdgeVertices(std::span<const AnyVertex> vertices,
                                         std::string_view edge_name) const;
  [[nodiscard]] Status RemoveVertexChecked(AnyVertex vertex, PriorOnVertex prior);
  [[nodiscard]] Status CheckFixed(const VertexSite& site, AnyVertex vertex, Fix fix) const;
  [[nodiscard]] Status CheckEliminated(const VertexSite& site, AnyVertex vertex) const;
  [[nodiscard]] Status CheckDynamicEdge(const DynamicEdge* edge,
                                        std::span<const AnyVertex> vertices, const Loss& loss);
  [[nodiscard]] Status CheckLoss(AnyEdge edge, const Loss& loss) const;
  /// This graph's part of handles.
  std::uint32_t Id() {
    if (id_ == 0) id_ = NewId();
    return id_;
  }
  static std::uint32_t NewId();
  static std::uint64_t NewIdentity();
  void DropFreeTangent(AnyVertex vertex);
  void EnterFirstEstimate(const VertexSite& site, const double* x_lin);
  void EnterFirstEstimates(const DynamicEdge& edge, std::span<const AnyVertex> vertices);
  /// A prior that touches the vertex; null if there is none.
  [[nodiscard]] AnyEdge PriorOn(const VertexPoolBase& pool, int index) const;
  void DropOrphanedFirstEstimates();
  [[nodiscard]] Status CheckSnapshot(const Snapshot& snapshot) const;
  [[nodiscard]] Status CheckStates(std::span<const AnyVertex> vertices,
                                   std::span<const double> states, std::string_view what) const;
  void RestoreFirstEstimates(const Snapshot& snapshot);
  void DropGaugeReference(AnyVertex vertex);
  void Reanchor(AnyVertex vertex);
  void Reanchor(FreeTangent* tangent) const;
  void SetFixedTo(const VertexSite& site, AnyVertex vertex, Fix fix, const FreeTangent* tangent);
  /// Vertices of one type on their way into the graph, as all that is not a template sees them.
  struct NewVertices {
    const VertexOps* ops;
    const void* values;
    std::size_t count;
    void* handles;
    void (*put_handle)(void* handles, std::size_t k, const AnyVertex& handle);
  };
  template <class V>
  static NewVertices NewVerticesOf(std::span<const V> values, VertexHandle<V>* handles);
  [[nodiscard]] static Status CheckVertex(const VertexOps& ops, const void* value);
  Status AddNewVertex(const NewVertices& vertex);
  Status AddNewVertices(const NewVertices& vertices);
  Status SetValue(AnyVertex vertex, const void* value);
  /// Null for a dead handle.
  [[nodiscard]] const void* FindValue(AnyVertex vertex) const;
  [[nodiscard]] const void* FindValue(AnyEdge edge) const;
  [[nodiscard]] int NumVerticesOf(const TypeInfo* type) const;
  [[nodiscard]] int NumEdgesOf(const TypeInfo* type) const;
  /// The next one that is alive, from *index on, which is moved behind it; null at the end.
  const void* NextVertex(const TypeInfo* type, int* index, AnyVertex* handle) const;
  /// vertices: of the edge; may be null.
  const void* NextEdge(const TypeInfo* type, int* index, AnyEdge* handle,
                       AnyVertex* vertices) const;
  /// Edges of one type on their way into the graph, as all that is not a template sees them.
  struct NewEdges {
    const EdgeOps* ops;
    EvaluateLanes evaluate_lanes;
    const void* edges;
    std::size_t count;
    internal::EdgeWeight weight;
    const Loss* loss;
    const void* vertices;
    void (*vertices_of)(const void* vertices, std::size_t k, AnyVertex* out);
    void* handles;
    void (*put_handle)(void* handles, std::size_t k, const AnyEdge& handle);
  };
  template <EdgeType E, class Unit, class Handles>
  static NewEdges NewEdgesOf(const EdgeOptions<E>& options, const Handles* vertices,
                             EdgeHandle<E>* handles);
  Status AddNewEdge(const NewEdges& edge);
  Status AddNewEdges(const NewEdges& edges);
  [[nodiscard]] Status CheckEdge(const EdgeOps& ops, const void* edge,
                                 const AnyVertex* vertices) const;
  VertexPoolBase& MakePool(const VertexOps& ops);
  EdgePool& MakeEdgePool(const EdgeOps& ops);
  Status SetWeight(AnyEdge edge, const internal::EdgeWeight& weight);

  VertexPools vertex_pools_;
  EdgePools edge_pools_;
  std::vector<FreeTangent> free_tangents_, saved_free_tangents_;
  TemporaryHold hold_;
  std::vector<GaugeReference> gauge_references_;
  // Of AddEdge, kept so that adding a dynamic edge allocates nothing by itself.
  std::vector<const VertexOps*> added_ops_;
  std::vector<PooledVertex> added_vertices_;
  std::vector<double> added_weight_;
  FirstEstimates first_estimates_ = FirstEstimates::kFull;
  std::uint64_t structure_version_ = 1;
  std::uint64_t weights_version_ = 1;
  std::uint64_t identity_;
  std::uint32_t id_ = 0;  ///< 0 until it is needed
  Status first_refusal_;
};

}  // namespace glissade

#include "glissade/graph/graph_impl.h"
